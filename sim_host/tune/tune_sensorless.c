/* The closed loop without an angle sensor as a linear system (tune_sensorless.h). */
#include "tune_sensorless.h"

#include "base/solve.h"
#include "base/vector_complex.h"
#include "model/exact_map.h"
#include "tune_margins.h"

#include "iqfoc/tracker.h"

#include <math.h>
#include <string.h>

enum { ORDER = TUNE_SENSORLESS_ORDER, NOISES = 4 };

_Static_assert(ORDER <= (int)TUNE_ORDER && ORDER <= (int)SOLVE_GENERAL_MOST, "the loop holds the state");

tune_sensorless tune_sensorless_of(const tune_design *design, bool halves, double w_T, double gain_max)
{
    const double pole = IQFOC_RAW_TRACKER_POLE(w_T, 1.0);
    const tune_sensorless s = {.control = *design,
                               .k1 = IQFOC_RAW_TRACKER_K1_2(pole),
                               .k2 = IQFOC_RAW_TRACKER_K2_2(pole),
                               .gain_max = gain_max,
                               .halves = halves};
    return s;
}

typedef struct axes_matrix {
    double of[2][2];
} axes_matrix;

/* i' = F i + G v + m over a span, v seen at its start. */
typedef struct span_map {
    axes_matrix F, G;
    double complex m;
} span_map;

static span_map span_of(const tune_machine *machine, double span_s, double omega_rad_s)
{
    const double L[2] = {machine->L_d_H, machine->L_q_H};
    const double emf = -omega_rad_s * machine->psi_f_Wb;
    exact_map end;
    span_map s;
    exact_maps(machine->R_ohm, L[0], L[1], span_s, omega_rad_s, &end, NULL);
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            s.F.of[n][k] = end.decay[n][k] * L[k] / L[n];
            s.G.of[n][k] = end.drive[n][k] / L[n];
        }
    }
    s.m = vec_complex(end.push[0][1] * emf / L[0], end.push[1][1] * emf / L[1]);
    return s;
}

static double complex times(const axes_matrix *m, double complex x)
{
    const double(*a)[2] = m->of;
    return vec_complex(a[0][0] * creal(x) + a[0][1] * cimag(x), a[1][0] * creal(x) + a[1][1] * cimag(x));
}

static double complex solved(const axes_matrix *m, double complex x)
{
    const double(*a)[2] = m->of;
    const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    return vec_complex((a[1][1] * creal(x) - a[0][1] * cimag(x)) / det,
                       (a[0][0] * cimag(x) - a[1][0] * creal(x)) / det);
}

static double complex over(const span_map *s, double complex i, double complex v)
{
    return times(&s->F, i) + times(&s->G, v) + s->m;
}

/* What does not change while the loop is linearised, and the controller's map at the last speed it was asked for. */
typedef struct scene {
    const tune_sensorless *s;
    const tune_operating_point *at;
    span_map whole, half; /* of the true machine */
    span_map model;
    double model_phi;
    double flux_off_Wb; /* of the last cycle */
    double scale[ORDER];
} scene;

static const span_map *model_at(scene *x, double phi)
{
    if (phi != x->model_phi) {
        x->model = span_of(&x->s->control.machine, x->s->control.T_s, phi / x->s->control.T_s);
        x->model_phi = phi;
    }
    return &x->model;
}

/* The state, in its own units. */
typedef struct cycle_state {
    double complex i, v, drift, offset, seen, flux;
    double angle, faster;
} cycle_state;

static cycle_state unpacked(const scene *x, const double z[ORDER])
{
    double own[ORDER];
    for (int n = 0; n < ORDER; n++) {
        own[n] = z[n] * x->scale[n];
    }
    return (cycle_state){.i = vec_complex(own[TUNE_I], own[TUNE_I + 1]),
                         .v = vec_complex(own[TUNE_V], own[TUNE_V + 1]),
                         .drift = vec_complex(own[TUNE_SENSORLESS_DRIFT], own[TUNE_SENSORLESS_DRIFT + 1]),
                         .offset = vec_complex(own[TUNE_SENSORLESS_OFFSET], own[TUNE_SENSORLESS_OFFSET + 1]),
                         .seen = vec_complex(own[TUNE_SENSORLESS_SEEN], own[TUNE_SENSORLESS_SEEN + 1]),
                         .flux = vec_complex(own[TUNE_SENSORLESS_FLUX], own[TUNE_SENSORLESS_FLUX + 1]),
                         .angle = own[TUNE_SENSORLESS_ANGLE],
                         .faster = own[TUNE_SENSORLESS_SPEED]};
}

static void put(const scene *x, double z[ORDER], int at, double complex value)
{
    z[at] = creal(value) / x->scale[at];
    z[at + 1] = cimag(value) / x->scale[at + 1];
}

static void packed(const scene *x, const cycle_state *c, double z[ORDER])
{
    put(x, z, TUNE_I, c->i);
    put(x, z, TUNE_V, c->v);
    put(x, z, TUNE_SENSORLESS_DRIFT, c->drift);
    put(x, z, TUNE_SENSORLESS_OFFSET, c->offset);
    put(x, z, TUNE_SENSORLESS_SEEN, c->seen);
    put(x, z, TUNE_SENSORLESS_FLUX, c->flux);
    z[TUNE_SENSORLESS_ANGLE] = c->angle / x->scale[TUNE_SENSORLESS_ANGLE];
    z[TUNE_SENSORLESS_SPEED] = c->faster / x->scale[TUNE_SENSORLESS_SPEED];
}

/* The valley current of a mean, iqfoc/valley_reference.h. */
static double complex valley_of(const tune_machine *m, double phi, double complex mean)
{
    const double h = 0.5 * phi;
    const double s1 = sin(h) / h;
    const double magnet_A = m->psi_f_Wb / m->L_d_H;
    return (mean + magnet_A) / (s1 * s1) - magnet_A;
}

/* The offset that the controller sees in the cycle between two samples, iqfoc/tuned_control.h. */
static double complex offset_seen(const tune_machine *m, double phi, double complex start,
                                  double complex middle, double complex end)
{
    const double h = 0.5 * phi;
    const double s1 = sin(h) / h;
    const double bow = (1.0 - s1 * s1) / (1.0 - cos(h));
    const double complex ends = 0.5 * (start + end);
    return ends - valley_of(m, phi, ends + bow * (middle - ends));
}

/* The observer's step; all vectors as seen from the true rotor at the start, the results from that at the end. */
static void observe(scene *x, const cycle_state *c, const double complex i[3], cycle_state *next)
{
    const tune_sensorless *s = x->s;
    const tune_machine *m = &s->control.machine;
    const double phi = x->at->phi_rad;
    const double complex mean = s->halves ? 0.5 * (i[0] + i[2]) : (i[0] + 4.0 * i[1] + i[2]) / 6.0;
    const double complex back = vec_turn(-phi);
    const double complex flux = back * (c->flux + s->control.T_s * (c->v - m->R_ohm * mean));
    const double complex end = back * i[2];
    const double complex active = flux - m->L_q_H * end;
    const double expected = c->angle + c->faster;
    const double complex d = vec_turn(expected);
    const double radius = m->psi_f_Wb + (m->L_d_H - m->L_q_H) * creal(end * conj(d));
    const double complex seen = active * conj(d);
    const double gain = fmin(s->gain_max, 0.4 * fabs(phi + c->faster));
    const double e = cimag(seen) / radius;
    x->flux_off_Wb = radius - creal(seen);
    next->flux = flux + gain * x->flux_off_Wb * d;
    next->angle = expected + s->k1 * e;
    next->faster = c->faster + s->k2 * e;
}

/* One cycle. noise: of the samples at the middle and at the end, A; push: added to the voltage behind the controller. */
static void cycle(scene *x, const double z[ORDER], const double noise[NOISES], double complex push,
                  double out[ORDER])
{
    const tune_design *design = &x->s->control;
    const tune_machine *m = &design->machine;
    const cycle_state c = unpacked(x, z);
    const double phi = x->at->phi_rad;
    const double phi_seen = phi + c.faster;
    const double complex target = vec_complex(0.0, x->at->i_q_A);
    cycle_state next;
    /* The controller at the valley that starts the cycle. */
    const span_map *model = model_at(x, phi_seen);
    const double complex drift = c.drift + model->m;
    const double complex i_next =
        times(&model->F, c.seen) + times(&model->G, c.v * vec_turn(-c.angle)) + drift;
    const double complex wanted = valley_of(m, phi_seen, target) + c.offset;
    const double complex want = wanted + design->keep * vec_turn(-phi_seen) * (i_next - wanted);
    const double complex u = solved(&model->G, want - times(&model->F, i_next) - drift);
    next.v = u * vec_turn(c.angle + c.faster);
    /* The machine over the cycle, and what is sampled of it, from the true rotor at the start. */
    const double complex v = x->at->voltage_gain * c.v + push;
    const double complex middle = over(&x->half, c.i, v) + vec_complex(noise[0], noise[1]);
    next.i = over(&x->whole, c.i, v);
    const double complex end = next.i + vec_complex(noise[2], noise[3]);
    const double complex sampled[3] = {c.seen * vec_turn(c.angle), middle * vec_turn(0.5 * phi),
                                       end * vec_turn(phi)};
    observe(x, &c, sampled, &next);
    /* The controller's estimates at the valley that ends the cycle. */
    next.seen = end * vec_turn(-next.angle);
    next.drift = c.drift + design->learn * (next.seen - i_next);
    const double complex middle_seen = middle * vec_turn(-c.angle - 0.5 * c.faster);
    const double complex offset = offset_seen(m, phi + next.faster, c.seen, middle_seen, next.seen);
    next.offset = x->s->halves ? 0.0 : c.offset + design->learn_offset * (offset - c.offset);
    packed(x, &next, out);
}

static void quiet_cycle(scene *x, const double z[ORDER], double out[ORDER])
{
    const double none[NOISES] = {0.0};
    cycle(x, z, none, 0.0, out);
}

#define STEP 1e-5

static void derivative(scene *x, const double z[ORDER], double a[ORDER][ORDER])
{
    double moved[ORDER];
    double up[ORDER];
    double down[ORDER];
    memcpy(moved, z, sizeof moved);
    for (int k = 0; k < ORDER; k++) {
        moved[k] = z[k] + STEP;
        quiet_cycle(x, moved, up);
        moved[k] = z[k] - STEP;
        quiet_cycle(x, moved, down);
        moved[k] = z[k];
        for (int n = 0; n < ORDER; n++) {
            a[n][k] = (up[n] - down[n]) / (2.0 * STEP);
        }
    }
}

/* The machine at its set-point, without an angle error: the start of Newton's rule. */
static void start_at(scene *x, double z[ORDER])
{
    const tune_machine *m = &x->at->truth;
    const double phi = x->at->phi_rad;
    cycle_state c = {0};
    c.i = valley_of(m, phi, vec_complex(0.0, x->at->i_q_A));
    c.seen = c.i;
    c.v = solved(&x->whole.G, c.i - times(&x->whole.F, c.i) - x->whole.m);
    c.v /= x->at->voltage_gain;
    const tune_machine *model = &x->s->control.machine;
    c.flux = model->psi_f_Wb + vec_complex(model->L_d_H * creal(c.i), model->L_q_H * cimag(c.i));
    packed(x, &c, z);
}

enum { NEWTON_STEPS = 30 };
#define NEWTON_END 1e-10
#define ANGLE_MOST 0.5

/* The fixed point, and the derivative there. */
static bool find_steady(scene *x, double z[ORDER], double a[ORDER][ORDER])
{
    start_at(x, z);
    for (int step = 0; step < NEWTON_STEPS; step++) {
        double h[ORDER * ORDER];
        double off[ORDER];
        double largest = 0.0;
        quiet_cycle(x, z, off);
        derivative(x, z, a);
        for (int n = 0; n < ORDER; n++) {
            off[n] -= z[n];
            for (int k = 0; k < ORDER; k++) {
                h[n * ORDER + k] = (n == k ? 1.0 : 0.0) - a[n][k];
            }
        }
        if (!solve_linear(ORDER, h, off)) {
            return false;
        }
        for (int n = 0; n < ORDER; n++) {
            z[n] += off[n];
            largest = fmax(largest, fabs(off[n]));
        }
        if (!(largest < 1e3) || fabs(z[TUNE_SENSORLESS_ANGLE]) > 2.0 * ANGLE_MOST) {
            return false;
        }
        if (largest < NEWTON_END) {
            derivative(x, z, a);
            return fabs(z[TUNE_SENSORLESS_ANGLE]) < ANGLE_MOST;
        }
    }
    return false;
}

/* The response of the next state to `input`, which is in its own unit over `unit`. */
static void response(scene *x, const double z[ORDER], int noise, int push, double unit, double out[ORDER])
{
    double next[2][ORDER] = {{0.0}};
    for (int side = 0; side < 2; side++) {
        const double by = (side == 0 ? STEP : -STEP) * unit;
        double n[NOISES] = {0.0};
        double complex u = 0.0;
        if (noise >= 0) {
            n[noise] = by;
        } else {
            u = push == 0 ? vec_complex(by, 0.0) : vec_complex(0.0, by);
        }
        cycle(x, z, n, u, next[side]);
    }
    for (int n = 0; n < ORDER; n++) {
        out[n] = (next[0][n] - next[1][n]) / (2.0 * STEP);
    }
}

enum { DOUBLINGS = 24 };

/* Variances of the state by white noise: q + a q a^T + a^2 q a^2T + ..., twice as many terms a round. */
static void variances(const double a[ORDER][ORDER], double q[ORDER][ORDER])
{
    double power[ORDER][ORDER];
    memcpy(power, a, sizeof power);
    for (int round = 0; round < DOUBLINGS; round++) {
        double left[ORDER][ORDER] = {{0.0}};
        double sum[ORDER][ORDER];
        double square[ORDER][ORDER] = {{0.0}};
        memcpy(sum, q, sizeof sum);
        for (int n = 0; n < ORDER; n++) {
            for (int k = 0; k < ORDER; k++) {
                for (int j = 0; j < ORDER; j++) {
                    left[n][k] += power[n][j] * q[j][k];
                    square[n][k] += power[n][j] * power[j][k];
                }
            }
        }
        for (int n = 0; n < ORDER; n++) {
            for (int k = 0; k < ORDER; k++) {
                for (int j = 0; j < ORDER; j++) {
                    sum[n][k] += left[n][j] * power[k][j];
                }
            }
        }
        memcpy(q, sum, sizeof sum);
        memcpy(power, square, sizeof power);
    }
}

static void find_noise(scene *x, const double z[ORDER], const double a[ORDER][ORDER], double noise_A,
                       tune_sensorless_error *off)
{
    /* Clarke's vector of three sensors: 2/3 of a sensor's variance on each axis. */
    const double unit = sqrt(2.0 / 3.0) * noise_A;
    double q[ORDER][ORDER] = {{0.0}};
    for (int input = 0; input < NOISES; input++) {
        double b[ORDER];
        response(x, z, input, -1, unit, b);
        for (int n = 0; n < ORDER; n++) {
            for (int k = 0; k < ORDER; k++) {
                q[n][k] += b[n] * b[k];
            }
        }
    }
    variances(a, q);
    off->angle_rms_rad =
        sqrt(q[TUNE_SENSORLESS_ANGLE][TUNE_SENSORLESS_ANGLE]) * x->scale[TUNE_SENSORLESS_ANGLE];
    off->speed_rms = sqrt(q[TUNE_SENSORLESS_SPEED][TUNE_SENSORLESS_SPEED]) * x->scale[TUNE_SENSORLESS_SPEED];
}

static scene scene_of(const tune_sensorless *s, const tune_operating_point *at)
{
    const tune_machine *m = &s->control.machine;
    const double T_s = s->control.T_s;
    const double omega = at->phi_rad / T_s;
    const double current_A = m->psi_f_Wb / m->L_q_H;
    scene x = {.s = s,
               .at = at,
               .whole = span_of(&at->truth, T_s, omega),
               .half = span_of(&at->truth, 0.5 * T_s, omega),
               .model_phi = NAN};
    for (int n = 0; n < ORDER; n++) {
        x.scale[n] = current_A;
    }
    x.scale[TUNE_V] = x.scale[TUNE_V + 1] = m->psi_f_Wb / T_s;
    x.scale[TUNE_SENSORLESS_ANGLE] = x.scale[TUNE_SENSORLESS_SPEED] = 1.0;
    x.scale[TUNE_SENSORLESS_FLUX] = x.scale[TUNE_SENSORLESS_FLUX + 1] = m->psi_f_Wb;
    return x;
}

bool tune_sensorless_make(const tune_sensorless *s, const tune_operating_point *at, double noise_A,
                          tune_loop *loop, tune_sensorless_error *off)
{
    scene x = scene_of(s, at);
    double z[ORDER];
    double a[ORDER][ORDER];
    memset(loop, 0, sizeof *loop);
    loop->order = ORDER;
    if (!find_steady(&x, z, a)) {
        return false;
    }
    for (int n = 0; n < ORDER; n++) {
        memcpy(loop->a[n], a[n], sizeof a[n]);
    }
    for (int axis = 0; axis < 2; axis++) {
        double b[ORDER];
        response(&x, z, -1, axis, x.scale[TUNE_V], b);
        for (int n = 0; n < ORDER; n++) {
            loop->push[n][axis] = b[n];
        }
    }
    if (off != NULL) {
        double next[ORDER];
        quiet_cycle(&x, z, next);
        *off = (tune_sensorless_error){z[TUNE_SENSORLESS_ANGLE], x.flux_off_Wb, INFINITY, INFINITY};
        if (tune_poles(loop, NULL) < 1.0) {
            find_noise(&x, z, (const double(*)[ORDER])a, noise_A, off);
        }
    }
    return true;
}
