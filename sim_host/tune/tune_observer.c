/* The observer's design (tune_observer.h). */
#include "tune_observer.h"

#include "base/vector.h"
#include "tuned_drive.h"

#include <math.h>
#include <stdio.h>

#define SLOWEST 0.01 /* of w T */

/* A gain other than the usual one must have so many times its margin: the gain also limits the pull-in. */
#define GAIN_WORTH 1.2

/* Limit of the flux' length, shares of psi_f: usual, and over the largest steady error of the set. */
#define FLUX_LEAST 0.125
#define FLUX_ROOM  1.5

static const double degrees = 360.0 / VEC_TWO_PI;

/* A point of the set: a machine of the region, and the sides of the other tolerances; 0: nominal. */
typedef struct corner {
    int point, psi, gain, load;
} corner;

enum { SIDES = 8, SIDES_MOTORING = 4 };

/* n: 0 ... SIDES - 1. */
static corner side_of(int point, int n)
{
    const corner c = {point, (n & 1) != 0 ? 1 : -1, (n & 2) != 0 ? 1 : -1, n < SIDES_MOTORING ? 1 : -1};
    return c;
}

static tune_operating_point place_of(const tune_result *r, const corner *c, int speed)
{
    const tune_region *region = &r->region;
    tune_operating_point at = {.truth = region->point[c->point].machine,
                               .voltage_gain = 1.0 + TUNE_TOLERANCE_GAIN * c->gain,
                               .phi_rad = r->at[speed + 1].phi_rad,
                               .i_q_A = motor_rated_peak_A(&r->motor) * (c->load < 0 ? -1.0 : 1.0)};
    at.truth.psi_f_Wb = region->centre.psi_f_Wb + (c->psi > 0   ? region->psi_high
                                                   : c->psi < 0 ? region->psi_low
                                                                : 0.0);
    return at;
}

static const corner nominal = {0, 0, 0, 1};

static void describe(const tune_result *r, const corner *c, char *text, size_t size)
{
    const tune_region *region = &r->region;
    const double psi = c->psi > 0 ? region->psi_high : region->psi_low;
    (void)snprintf(text, size, "%s, psi_f %+.3g %%, voltage %+.3g %%%s", region->point[c->point].text,
                   100.0 * psi / region->centre.psi_f_Wb, 100.0 * TUNE_TOLERANCE_GAIN * c->gain,
                   c->load < 0 ? ", generating" : "");
}

static const tune_sensorless_error no_steady_state = {INFINITY, INFINITY, INFINITY, INFINITY};

static double disk_at(const tune_result *r, const tune_sensorless *s, const corner *c, int speed,
                      tune_sensorless_error *off)
{
    const tune_operating_point at = place_of(r, c, speed);
    tune_loop loop;
    const bool steady = tune_sensorless_make(s, &at, 0.0, &loop, off);
    if (!steady) {
        *off = no_steady_state;
    }
    return steady ? tune_disk_margin(&loop) : 0.0;
}

static void measure_worst(const tune_result *r, const tune_sensorless *s, int speed, tune_observer_speed *at)
{
    at->disk = INFINITY;
    at->angle_deg = -1.0;
    for (int n = 0; n < r->region.points * SIDES; n++) {
        const corner c = side_of(n / SIDES, n % SIDES);
        tune_sensorless_error off;
        const double disk = disk_at(r, s, &c, speed, &off);
        const double angle_deg = degrees * fabs(off.angle_rad);
        at->flux_off = fmax(at->flux_off, fabs(off.flux_off_Wb) / r->design.machine.psi_f_Wb);
        if (disk < at->disk) {
            at->disk = disk;
            describe(r, &c, at->disk_worst, sizeof at->disk_worst);
        }
        if (angle_deg > at->angle_deg) {
            at->angle_deg = angle_deg;
            describe(r, &c, at->angle_worst, sizeof at->angle_worst);
        }
    }
}

static tune_sensorless_error nominal_at(const tune_result *r, const tune_sensorless *s, double noise_A,
                                        int speed, tune_loop *loop)
{
    const tune_operating_point at = place_of(r, &nominal, speed);
    tune_sensorless_error off;
    const bool steady = tune_sensorless_make(s, &at, noise_A, loop, &off);
    return steady ? off : no_steady_state;
}

static void measure_nominal(const tune_result *r, const tune_sensorless *s, double noise_A, int speed,
                            tune_observer_speed *at)
{
    tune_loop loop;
    const tune_sensorless_error off = nominal_at(r, s, noise_A, speed, &loop);
    at->rpm = r->at[speed + 1].rpm;
    at->sffr = r->at[speed + 1].sffr;
    at->disk_nominal = isfinite(off.angle_rad) ? tune_disk_margin(&loop) : 0.0;
    at->noise_deg = degrees * off.angle_rms_rad;
    at->speed_noise_percent = 100.0 * off.speed_rms / r->at[speed + 1].phi_rad;
}

/* The worst margin of motoring machines at a speed. */
static double disk_motoring(const tune_result *r, const tune_sensorless *s, int speed)
{
    double least = INFINITY;
    for (int n = 0; n < r->region.points * SIDES_MOTORING; n++) {
        const corner c = side_of(n / SIDES_MOTORING, n % SIDES_MOTORING);
        tune_sensorless_error off;
        least = fmin(least, disk_at(r, s, &c, speed, &off));
    }
    return least;
}

/* The usual gain, unless another one has a larger margin at n_max. */
static double choose_gain(const tune_result *r, double w_T)
{
    static const double gains[] = {0.48, 0.25, 0.35, 0.7, 1.0};
    double best = 0.0;
    double gain = gains[0];
    for (size_t n = 0; n < sizeof gains / sizeof gains[0]; n++) {
        const tune_sensorless s = tune_sensorless_of(&r->design, r->halves, w_T, gains[n]);
        const double disk = disk_motoring(r, &s, TUNE_OBSERVER_SPEEDS - 1);
        if (disk > GAIN_WORTH * best) {
            best = disk;
            gain = gains[n];
        }
    }
    return gain;
}

/* w T for the lag of a run-up. */
static double loop_for(const tune_result *r, double run_up_s)
{
    const double T_s = r->design.T_s;
    const double top = r->at[TUNE_SPEEDS - 1].phi_rad / VEC_TWO_PI;
    return sqrt(top * T_s / run_up_s / (TUNE_LAG_DEG / 360.0));
}

static double run_up_for(const tune_result *r, double w_T)
{
    const double of_a_second = loop_for(r, 1.0);
    return of_a_second * of_a_second / (w_T * w_T);
}

static void choices(const tune_result *r, tune_observer *o)
{
    static const double w_T[TUNE_OBSERVER_CHOICES] = {0.02, 0.04, 0.08, 0.16, 0.32, 0.64};
    for (int n = 0; n < TUNE_OBSERVER_CHOICES; n++) {
        const tune_sensorless s = tune_sensorless_of(&r->design, r->halves, w_T[n], o->gain_max);
        tune_observer_choice *c = &o->choice[n];
        *c = (tune_observer_choice){w_T[n] / r->design.T_s, run_up_for(r, w_T[n]), 0.0, INFINITY};
        for (int speed = 1; speed < TUNE_OBSERVER_SPEEDS; speed += 2) {
            tune_loop loop;
            const tune_sensorless_error off = nominal_at(r, &s, o->noise_A, speed, &loop);
            c->noise_deg = fmax(c->noise_deg, degrees * off.angle_rms_rad);
            c->disk = fmin(c->disk, disk_motoring(r, &s, speed));
        }
    }
}

/* The firmware's constants. False: the observer refuses the machine. */
static bool configure(const tune_result *r, double w_T, tune_observer *o)
{
    motor believed = tuned_motor(&r->motor, &r->design.machine);
    error refused = {0};
    if (!observer_from_motor(&believed, &o->config, &refused)) {
        return false;
    }
    observer_set_loop(&o->config, w_T);
    o->config.gain_max = iq24_from_double(o->gain_max);
    o->config.flux_max = iq24_from_double(fmin(7.9, o->flux_max * iq24_to_double(o->config.machine.psi)));
    o->speed_min = iq24_to_double(o->config.speed_min);
    return true;
}

void tune_observer_find(const tune_result *r, double run_up_s, tune_observer *o)
{
    const double wanted = fmax(loop_for(r, run_up_s), SLOWEST);
    const double w_T = fmin(wanted, OBSERVER_LOOP_RAD_MOST);
    *o = (tune_observer){.run_up_s = run_up_s,
                         .bandwidth_rad_s = w_T / r->design.T_s,
                         .fastest = wanted > OBSERVER_LOOP_RAD_MOST,
                         .noise_A = r->region.noise_A,
                         .noise_measured = r->region.noise_A > 0.0,
                         .gain_max = 0.48,
                         .flux_max = FLUX_LEAST};
    if (!configure(r, w_T, o)) {
        o->none = "the magnet's flux is too small, or L_d and L_q differ too much (iqfoc/observer.h)";
        return;
    }
    if (!o->noise_measured) {
        o->noise_A = TUNE_NOISE_SHARE * motor_rated_peak_A(&r->motor);
    }
    o->gain_max = choose_gain(r, w_T);
    const tune_sensorless s = tune_sensorless_of(&r->design, r->halves, w_T, o->gain_max);
    for (int speed = 0; speed < TUNE_OBSERVER_SPEEDS; speed++) {
        tune_observer_speed *at = &o->at[speed];
        measure_nominal(r, &s, o->noise_A, speed, at);
        measure_worst(r, &s, speed, at);
        o->disk_worst = at->disk < o->at[o->disk_worst].disk ? speed : o->disk_worst;
        o->angle_worst = at->angle_deg > o->at[o->angle_worst].angle_deg ? speed : o->angle_worst;
        o->flux_max = isfinite(at->flux_off) ? fmax(o->flux_max, FLUX_ROOM * at->flux_off) : o->flux_max;
    }
    (void)configure(r, w_T, o);
    choices(r, o);
}
