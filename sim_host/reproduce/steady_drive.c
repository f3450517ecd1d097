/* The drive in steady state (steady_drive.h). */
#include "steady_drive.h"

#include "base/solve.h"
#include "model/pwm_cycle.h"
#include "plant/plant.h"
#include "plant/plant_electrical.h"

#include <math.h>
#include <stdlib.h>

double steady_drive_voltage_limit(double u_dc_V)
{
    return u_dc_V * VEC_1_SQRT3;
}

/* ---- The steady state without ripple ---- */

/* The current after one half of a cycle; u_dq_V: the voltage in the rotor frame at the half's start. */
static double complex half_cycle(const electrical_linear *m, double T_s, double complex i_dq_A,
                                 double complex u_dq_V)
{
    electrical_state x = {.i_dq_A = vec_dq_of(i_dq_A)};
    electrical_advance(m, 0.5 * T_s, vec_dq_of(u_dq_V), &x);
    return vec_complex_dq(x.i_dq_A);
}

enum { UNKNOWNS = 4 }; /* i_valley d, q; u d, q */

/* What must vanish: the current repeats from valley to valley, and is the one asked for at the middle. */
static void residual(const electrical_linear *m, double T_s, const double x[UNKNOWNS],
                     double complex i_mid_dq_A, double r[UNKNOWNS])
{
    const double complex i_valley = vec_complex(x[0], x[1]);
    const double complex u_mid = vec_complex(x[2], x[3]);
    const double half_phi = 0.5 * m->omega_e_rad_s * T_s;
    const double complex i_mid = half_cycle(m, T_s, i_valley, u_mid * vec_turn(half_phi));
    const double complex i_end = half_cycle(m, T_s, i_mid, u_mid);
    r[0] = creal(i_end - i_valley);
    r[1] = cimag(i_end - i_valley);
    r[2] = creal(i_mid - i_mid_dq_A);
    r[3] = cimag(i_mid - i_mid_dq_A);
}

steady_point steady_point_solve(const motor *m, double omega_rad_s, double complex i_mid_dq_A)
{
    const electrical_linear machine = {.R_ohm = m->R_ohm,
                                       .L_d_H = m->L_d_H,
                                       .L_q_H = m->L_q_H,
                                       .psi_f_Wb = m->psi_f_Wb,
                                       .omega_e_rad_s = omega_rad_s};
    const double T_s = 1.0 / m->f_pwm_Hz;
    /* The residual is affine, r(x) = r(0) + J x: J's columns are differences. x in amperes and volts, scaled
     * to alike sizes of r. */
    const double scale[UNKNOWNS] = {1.0, 1.0, m->L_d_H / T_s, m->L_q_H / T_s};
    const double zero[UNKNOWNS] = {0.0, 0.0, 0.0, 0.0};
    double r0[UNKNOWNS];
    double jacobian[UNKNOWNS * UNKNOWNS];
    residual(&machine, T_s, zero, i_mid_dq_A, r0);
    for (int col = 0; col < UNKNOWNS; col++) {
        double x[UNKNOWNS] = {0.0, 0.0, 0.0, 0.0};
        double r[UNKNOWNS];
        x[col] = scale[col];
        residual(&machine, T_s, x, i_mid_dq_A, r);
        for (int row = 0; row < UNKNOWNS; row++) {
            jacobian[row * UNKNOWNS + col] = r[row] - r0[row];
        }
    }
    double x[UNKNOWNS] = {-r0[0], -r0[1], -r0[2], -r0[3]};
    /* Regular: the voltage moves the middle, and the valley follows from the middle backwards. */
    (void)solve_linear(UNKNOWNS, jacobian, x);
    const steady_point p = {vec_complex(x[0] * scale[0], x[1] * scale[1]),
                            vec_complex(x[2] * scale[2], x[3] * scale[3])};
    return p;
}

/* ---- The same under PWM ---- */

static void run_cycle(plant *p, const steady_drive *d, drive_cycle *at)
{
    plant_samples valley;
    plant_samples peak;
    plant_means means;
    double duty[3];
    at->theta_rad = plant_now(p).theta_e_rad;
    at->u_V = d->u_dq_V * vec_turn(at->theta_rad + 0.5 * d->omega_rad_s * d->T_s);
    pwm_duties(at->u_V, d->u_dc_V, duty);
    plant_cycle(p, duty, &valley, &peak, &means);
    at->i_valley_A = vec_complex_of_phases(valley.i_A);
    at->i_mid_A = vec_complex_of_phases(peak.i_A);
    at->i_mean_A = vec_complex_ab(means.i_ab_A);
    at->i_mean_dq_A = vec_complex_dq(means.i_dq_A);
    at->i_next_valley_A = vec_complex_of_phases(plant_now(p).i_A);
}

static void start_plant(const motor *m, const steady_drive *d, double theta_rad, double complex i_dq_A,
                        plant *p)
{
    plant_config c = plant_config_from_motor(m);
    c.inverter.u_dc_V = d->u_dc_V;
    c.shaft.omega_e_start_rad_s = d->omega_rad_s;
    c.shaft.theta_mech_start_rad = theta_rad / m->pole_pairs;
    plant_init(p, &c);
    plant_set_current(p, vec_dq_of(i_dq_A));
}

void steady_drive_duties(const steady_drive *d, const drive_cycle *at, double duty[3])
{
    pwm_duties(at->u_V, d->u_dc_V, duty);
}

typedef struct tracer {
    drive_trace *trace;
    void *context;
} tracer;

static void pass_on(void *context, const plant_point *point)
{
    const tracer *t = context;
    const drive_point of_phase_a = {point->t_s, point->u_V[0], point->i_A[0]};
    t->trace(t->context, &of_phase_a);
}

void steady_drive_trace(const motor *m, const steady_drive *d, size_t first, size_t cycles, double step_s,
                        drive_trace *trace, void *context)
{
    const drive_cycle *at = &d->cycle[first];
    tracer t = {trace, context};
    plant p;
    start_plant(m, d, at->theta_rad, at->i_valley_A * vec_turn(-at->theta_rad), &p);
    p.trace = pass_on;
    p.trace_context = &t;
    p.trace_step_s = step_s;
    for (size_t n = 0; n < cycles; n++) {
        double duty[3];
        steady_drive_duties(d, &d->cycle[first + n], duty);
        plant_cycle(&p, duty, NULL, NULL, NULL);
    }
}

/*
 * From the ripple-free steady state until what PWM changes has settled, then the record. Returns the mean of
 * the mid-point samples in the rotor frame.
 */
static double complex run(const motor *m, const steady_point *point, steady_drive *d)
{
    /* Twelve time constants leave 6e-6 of what is already only a ripple's trace; a winding of next to no
     * resistance does not settle and is not waited for. */
    const double tau_cycles = fmax(m->L_d_H, m->L_q_H) / fmax(m->R_ohm, 1e-9) / d->T_s;
    const size_t settling = (size_t)fmin(12.0 * tau_cycles, 20000.0) + 2;
    plant p;
    start_plant(m, d, 0.0, point->i_valley_dq_A, &p);
    d->u_dq_V = point->u_dq_V;
    drive_cycle dropped;
    for (size_t n = 0; n < settling; n++) {
        run_cycle(&p, d, &dropped);
    }
    double complex sum_dq = 0.0;
    for (size_t n = 0; n < d->count; n++) {
        drive_cycle *at = &d->cycle[n];
        run_cycle(&p, d, at);
        sum_dq += at->i_mid_A * vec_turn(-at->theta_rad - 0.5 * d->omega_rad_s * d->T_s);
    }
    return sum_dq / (double)d->count;
}

/* The count from `cycles` up, within as many again, that comes nearest to whole turns of the rotor. */
static size_t beat_count(double turns_per_cycle, size_t cycles)
{
    size_t best = cycles;
    double least = 1.0;
    for (size_t n = cycles; n <= 2 * cycles; n++) {
        const double turns = (double)n * fabs(turns_per_cycle);
        const double off = fabs(turns - rint(turns));
        /* A longer record must be clearly better. */
        if (off < least - 1e-9) {
            least = off;
            best = n;
        }
    }
    return best;
}

bool steady_drive_run(const motor *m, double n_rpm, double complex i_mid_dq_A, size_t cycles, steady_drive *d,
                      error *e)
{
    const double omega = motor_speed_rad_s(m, n_rpm);
    *d = (steady_drive){.T_s = 1.0 / m->f_pwm_Hz,
                        .omega_rad_s = omega,
                        .turns_per_cycle = omega / (VEC_TWO_PI * m->f_pwm_Hz),
                        .i_mid_dq_A = i_mid_dq_A,
                        .u_dc_V = m->u_dc_V};
    d->count = beat_count(d->turns_per_cycle, cycles);
    d->cycle = calloc(d->count, sizeof *d->cycle);
    if (d->cycle == NULL) {
        return error_failure(e, 0, "steady state: out of memory");
    }
    double complex aim = i_mid_dq_A;
    steady_point point = steady_point_solve(m, omega, aim);
    /* Two hundredths above the need, for what the corrections below still change. */
    const double needed_V = 1.02 * cabs(point.u_dq_V);
    d->link_raised = needed_V > steady_drive_voltage_limit(d->u_dc_V);
    if (d->link_raised) {
        d->u_dc_V *= needed_V / steady_drive_voltage_limit(d->u_dc_V);
    }
    /* Ripple moves the sampled mean by parts per million; one correction leaves parts per billion. */
    for (int pass = 0; pass < 2; pass++) {
        aim += i_mid_dq_A - run(m, &point, d);
        point = steady_point_solve(m, omega, aim);
    }
    run(m, &point, d);
    return true;
}

void steady_drive_free(steady_drive *d)
{
    free(d->cycle);
    d->cycle = NULL;
    d->count = 0;
}
