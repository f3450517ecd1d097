/* The design of the speed control (tune_speed.h). */
#include "tune_speed.h"

#include "base/solve.h"
#include "params_host.h"

#include "iqfoc/speed_control.h"
#include "iqfoc/tracker.h"

#include <complex.h>
#include <math.h>
#include <string.h>

const double tune_shafts[TUNE_SHAFTS] = {1.0 + TUNE_INERTIA_OFF, 1.0, 1.0 - TUNE_INERTIA_OFF};

/* States at a valley: the currents i_k and i_(k+1), the speed, the tracker's error, speed and acceleration; of the whole loop also I. */
enum { NOW, NEXT, SPEED, ERROR, TRACKED, ACCELERATION, STATES, INTEGRAL = STATES, ORDER };

/* One cycle with a constant reference of the current and a load, both per rated peak current. */
static void cycle_on(const tune_design *design, double a, double w_rad_s, double i_ref, double load,
                     double x[STATES])
{
    const double pole = IQFOC_RAW_TRACKER_POLE(w_rad_s, design->T_s);
    const double torque = 0.5 * (x[NOW] + x[NEXT]) - load;
    const double late = x[ERROR] + x[SPEED] + 0.5 * a * torque - x[TRACKED] - 0.5 * x[ACCELERATION];
    x[NOW] = x[NEXT];
    x[NEXT] = design->follow * x[NEXT] + (1.0 - design->follow) * i_ref;
    x[SPEED] += a * torque;
    x[TRACKED] += x[ACCELERATION] + IQFOC_RAW_TRACKER_K2_3(pole) * late;
    x[ACCELERATION] += IQFOC_RAW_TRACKER_K3_3(pole) * late;
    x[ERROR] = (1.0 - IQFOC_RAW_TRACKER_K1_3(pole)) * late;
}

/* The closed loop over one step of the speed control; what is added to its output enters by `push`. */
typedef struct speed_loop {
    double a[ORDER * ORDER];
    double push[ORDER];
    double out[ORDER]; /* the controller's output */
} speed_loop;

static void speed_loop_make(const tune_result *r, const tune_speed *s, double w_rad_s, double J_kgm2,
                            speed_loop *loop)
{
    const tune_design *d = &r->design;
    const double a = tune_speed_acceleration(r, J_kgm2);
    const double kp = IQFOC_RAW_SPEED_KP(w_rad_s, tune_speed_acceleration(r, s->J_kgm2), d->T_s, s->cycles);
    const double share = IQFOC_RAW_SPEED_SHARE(w_rad_s, d->T_s, s->cycles);
    memset(loop, 0, sizeof *loop);
    loop->out[TRACKED] = -kp;
    loop->out[INTEGRAL] = 1.0;
    for (int column = 0; column <= ORDER; column++) {
        double x[STATES] = {0.0};
        const double i_ref = column < ORDER ? loop->out[column] : 1.0;
        if (column < STATES) {
            x[column] = 1.0;
        }
        for (int k = 0; k < s->cycles; k++) {
            cycle_on(d, a, TUNE_TRACKER_TIMES * w_rad_s, i_ref, 0.0, x);
        }
        for (int row = 0; row < STATES; row++) {
            if (column < ORDER) {
                loop->a[row * ORDER + column] = x[row];
            } else {
                loop->push[row] = x[row];
            }
        }
    }
    loop->a[INTEGRAL * ORDER + INTEGRAL] = 1.0;
    loop->a[INTEGRAL * ORDER + TRACKED] = -share * kp;
}

static bool stable(const speed_loop *loop)
{
    double re[ORDER];
    double im[ORDER];
    double largest = 0.0;
    if (!solve_eigenvalues(ORDER, loop->a, re, im)) {
        return false;
    }
    for (int n = 0; n < ORDER; n++) {
        largest = fmax(largest, hypot(re[n], im[n]));
    }
    return largest < 1.0;
}

/* |S - 1/2|; S from what is added to the controller's output to what acts. */
static double distance(const speed_loop *loop, double rad_per_step)
{
    double complex a[ORDER * ORDER];
    double complex x[ORDER * 2];
    const double complex z = cexp(I * rad_per_step);
    for (int n = 0; n < ORDER * ORDER; n++) {
        a[n] = -loop->a[n];
    }
    for (int n = 0; n < ORDER; n++) {
        a[n * ORDER + n] += z;
        x[n * 2] = x[n * 2 + 1] = loop->push[n];
    }
    if (!solve_complex_pair(ORDER, (const double *)a, (double *)x)) {
        return INFINITY;
    }
    double complex sensitivity = 0.5;
    for (int n = 0; n < ORDER; n++) {
        sensitivity += loop->out[n] * x[n * 2];
    }
    return cabs(sensitivity);
}

double tune_speed_acceleration(const tune_result *r, double J_kgm2)
{
    return IQFOC_RAW_SPEED_ACCELERATION(J_kgm2, r->motor.pole_pairs, r->design.machine.psi_f_Wb,
                                        motor_rated_peak_A(&r->motor), r->design.T_s);
}

double tune_speed_disk(const tune_result *r, const tune_speed *s, double bandwidth_rad_s, double J_kgm2)
{
    enum { POINTS = 400 };
    speed_loop loop;
    double most = 0.0;
    speed_loop_make(r, s, bandwidth_rad_s, J_kgm2, &loop);
    if (!stable(&loop)) {
        return 0.0;
    }
    for (int n = 0; n < POINTS; n++) {
        most = fmax(most, distance(&loop, VEC_PI * pow(10.0, 4.0 * ((double)(n + 1) / POINTS - 1.0))));
    }
    return 1.0 / most;
}

/* The largest fall of the speed after a step of the load, turns per cycle. */
static double dip_of(const tune_result *r, const tune_speed *s)
{
    const double T_s = r->design.T_s;
    const double a = tune_speed_acceleration(r, s->J_kgm2);
    const double kp = IQFOC_RAW_SPEED_KP(s->bandwidth_rad_s, a, T_s, s->cycles);
    const double share = IQFOC_RAW_SPEED_SHARE(s->bandwidth_rad_s, T_s, s->cycles);
    const long steps = (long)ceil(5.0 / (s->bandwidth_rad_s * T_s * s->cycles));
    double x[STATES] = {0.0};
    double integral = 0.0;
    double dip = 0.0;
    for (long n = 0; n < steps; n++) {
        const double i_ref = integral - kp * x[TRACKED];
        integral -= share * kp * x[TRACKED];
        for (int k = 0; k < s->cycles; k++) {
            cycle_on(&r->design, a, s->tracker_rad_s, i_ref, s->load, x);
            dip = fmax(dip, -x[SPEED]);
        }
    }
    return dip;
}

static double worst_disk(const tune_result *r, const tune_speed *s, double w_rad_s)
{
    return fmin(tune_speed_disk(r, s, w_rad_s, tune_shafts[0] * s->J_kgm2),
                tune_speed_disk(r, s, w_rad_s, tune_shafts[TUNE_SHAFTS - 1] * s->J_kgm2));
}

static bool check_ranges(const tune_result *r, const tune_speed *s, error *e)
{
    const double a = tune_speed_acceleration(r, s->J_kgm2);
    const double kp = IQFOC_RAW_SPEED_KP(s->bandwidth_rad_s, a, r->design.T_s, s->cycles);
    const double ramp = IQFOC_RAW_SPEED_RAMP(s->ramp_rpm_s, r->motor.pole_pairs, r->design.T_s, s->cycles);
    if (!(kp >= IQFOC_MIN_SPEED_KP && kp <= IQFOC_MAX_SPEED_KP)) {
        return error_input(e, NULL, 0, 0,
                           "tune: --inertia %g gives kp = %.3g per turn per cycle; expected %g to %g, from "
                           "an inertia of %.3g to %.3g kg m2",
                           s->J_kgm2, kp, IQFOC_MIN_SPEED_KP, IQFOC_MAX_SPEED_KP,
                           s->J_kgm2 * IQFOC_MIN_SPEED_KP / kp, s->J_kgm2 * IQFOC_MAX_SPEED_KP / kp);
    }
    return (ramp >= IQFOC_MIN_SPEED_RAMP && ramp <= IQFOC_MAX_SPEED_RAMP) ||
           error_input(e, NULL, 0, 0,
                       "tune: a ramp of %.3g rpm/s is outside the library's range; expected another --run-up",
                       s->ramp_rpm_s);
}

bool tune_speed_find(const tune_result *r, double J_kgm2, double run_up_s, tune_speed *s, error *e)
{
    const double T_s = r->design.T_s;
    *s = (tune_speed){.J_kgm2 = J_kgm2, .cycles = (int)fmax(1.0, floor(TUNE_SPEED_STEP_S / T_s + 1e-9))};
    /* Slow enough to hold, up to a tracker as fast as the sampling. */
    double low = 1e-6 / T_s;
    double high = 1.0 / (TUNE_TRACKER_TIMES * T_s);
    for (int n = 0; n < 40; n++) {
        const double middle = sqrt(low * high);
        if (worst_disk(r, s, middle) >= r->disk_wanted) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const double a = tune_speed_acceleration(r, J_kgm2);
    const double rpm_per_turn = 60.0 / (r->motor.pole_pairs * T_s);
    const double ramp_most = 0.9 * a * rpm_per_turn / T_s;
    s->bandwidth_rad_s = low;
    s->tracker_rad_s = TUNE_TRACKER_TIMES * low;
    s->disk = worst_disk(r, s, low);
    s->disk_nominal = tune_speed_disk(r, s, low, J_kgm2);
    s->ramp_rpm_s = fmin(r->motor.n_max_rpm / run_up_s, ramp_most);
    s->ramp_limited = s->ramp_rpm_s < r->motor.n_max_rpm / run_up_s;
    s->load = 1.0;
    const double full_rpm = rpm_per_turn * dip_of(r, s);
    s->load = fmin(TUNE_SPEED_LOAD, TUNE_SPEED_DIP * r->motor.n_max_rpm / full_rpm);
    s->dip_rpm = s->load * full_rpm;
    s->rpm = 0.5 * r->motor.n_max_rpm;
    return s->disk >= 0.99 * r->disk_wanted
               ? check_ranges(r, s, e)
               : error_input(e, NULL, 0, 0,
                             "tune: no speed control with a disk margin of %g; the best has %.3g",
                             r->disk_wanted, s->disk);
}
