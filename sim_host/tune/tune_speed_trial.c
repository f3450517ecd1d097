/* Speed control, tracker and tuned current control on the switching plant with its shaft (tune_speed.h). */
#include "tune_speed.h"

#include "drive/drive_loop.h"
#include "tuned_drive.h"

#include "iqfoc/speed_control.h"
#include "iqfoc/tracker.h"

#include <math.h>

typedef struct speed_drive {
    tuned_firmware_t tuned;
    iqfoc_tracker_config_t tracking;
    iqfoc_tracker_t tracker;
    iqfoc_speed_control_config_t config;
    iqfoc_speed_control_t control;
    iq24_t target;
    bool halves;
} speed_drive;

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    speed_drive *d = context;
    iqfoc_sample_t seen = *sample;
    (void)e;
    iqfoc_tracker_step(&d->tracker, sample->theta, 0, true);
    seen.theta = iqfoc_tracker_theta(&d->tracker, 0);
    seen.speed = iqfoc_tracker_speed(&d->tracker);
    i_ref.q = iqfoc_speed_control_step(&d->control, d->target, seen.speed, d->config.i_max);
    tuned_firmware_valley(&d->tuned, i_ref, &seen);
    return true;
}

static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    speed_drive *d = context;
    (void)i_ref;
    (void)e;
    if (!d->halves) {
        iqfoc_sample_t seen = *sample;
        seen.theta = iqfoc_tracker_theta(&d->tracker, IQ24(0.5));
        seen.speed = iqfoc_tracker_speed(&d->tracker);
        tuned_firmware_peak(&d->tuned, &seen);
    }
    answer->command = d->tuned.command;
    answer->status = d->tuned.status;
    return true;
}

/* The firmware's constants, as the macros of the header make them. False: a value is out of range. */
static bool speed_drive_init(const tune_result *r, const tune_speed *s, speed_drive *d, error *e)
{
    const tune_design *design = &r->design;
    const double a = tune_speed_acceleration(r, s->J_kgm2);
    const double pole = IQFOC_RAW_TRACKER_POLE(s->tracker_rad_s, design->T_s);
    const double kp = IQFOC_RAW_SPEED_KP(s->bandwidth_rad_s, a, design->T_s, s->cycles);
    const double ramp = IQFOC_RAW_SPEED_RAMP(s->ramp_rpm_s, r->motor.pole_pairs, design->T_s, s->cycles);
    *d = (speed_drive){
        .tracking = {iq24_from_double(IQFOC_RAW_TRACKER_K1_3(pole)),
                     iq24_from_double(IQFOC_RAW_TRACKER_K2_3(pole)),
                     iq24_from_double(IQFOC_RAW_TRACKER_K3_3(pole)), IQ24(0.1), 50},
        .config = {(int32_t)lround(ldexp(kp, 16)),
                   iq24_from_double(IQFOC_RAW_SPEED_SHARE(s->bandwidth_rad_s, design->T_s, s->cycles)),
                   (int32_t)lround(ldexp(ramp, 32)), iq24_from_double(ramp / s->cycles / a), IQ24_ONE,
                   (uint32_t)s->cycles},
        .halves = r->halves};
    return tuned_drive_init(&d->tuned, &r->motor, design, e) &&
           ((iqfoc_tracker_init(&d->tracker, &d->tracking) == IQFOC_OK &&
             iqfoc_speed_control_init(&d->control, &d->config) == IQFOC_OK) ||
            error_input(e, NULL, 0, 0, "tune: --inertia %g: a value of the speed control is out of its range",
                        s->J_kgm2));
}

/* Cycles of each part: the run-up with a quarter of it to settle. */
static void lengths(const tune_result *r, const tune_speed *s, double shaft, long length[TUNE_PARTS])
{
    const double T_s = r->design.T_s;
    length[TUNE_RUN_UP] =
        (long)ceil((1.25 * fmax(1.0, shaft) * s->rpm / s->ramp_rpm_s + 10.0 / s->bandwidth_rad_s) / T_s);
    length[TUNE_LOADED] = length[TUNE_STEPPED] = (long)ceil(20.0 / s->bandwidth_rad_s / T_s);
}

/* A curve from its point `*next` on to the one of this instant; what lies between has the same value. */
static void draw(double curve[TUNE_POINTS], int *next, int now, double value)
{
    for (; *next <= now && *next < TUNE_POINTS; ++*next) {
        curve[*next] = value;
    }
}

/* The speed's difference to its set-point, in a part. */
static void look(tune_speed *s, int shaft, int part, double off_rpm, double since_s)
{
    if (part == TUNE_RUN_UP) {
        s->overshoot_rpm[shaft] = fmax(s->overshoot_rpm[shaft], off_rpm);
    } else if (part == TUNE_STEPPED) {
        s->step_overshoot_rpm[shaft] = fmax(s->step_overshoot_rpm[shaft], off_rpm);
    } else {
        s->found_dip_rpm[shaft] = fmax(s->found_dip_rpm[shaft], -off_rpm);
        s->settled_s[shaft] = fabs(off_rpm) > 0.1 * s->dip_rpm ? since_s : s->settled_s[shaft];
    }
}

/* A part on a loop that runs: its curves and what is looked for. */
static bool run_part(const tune_result *r, tune_speed *s, int shaft, int part, long cycles, drive_loop *loop,
                     speed_drive *d, error *e)
{
    tune_trace *trace = &s->trace[part];
    const double T_s = r->design.T_s;
    const double turns_per_rpm = r->motor.pole_pairs * T_s / 60.0;
    const double target_rpm = part == TUNE_STEPPED ? (1.0 + TUNE_SPEED_STEP) * s->rpm : s->rpm;
    int next_rpm = 0;
    int next_i = 0;
    d->target = iq24_from_double(target_rpm * turns_per_rpm);
    for (long k = 0; k < cycles && !s->lost[shaft]; k++) {
        drive_row row;
        const iqfoc_dq_t none = {0, 0};
        if (!drive_loop_span(loop, none, &row, e)) {
            return false;
        }
        const double rpm = plant_now(&loop->drive).omega_e_rad_s / VEC_TWO_PI * T_s / turns_per_rpm;
        const int now = (int)fmin((double)k * T_s / trace->span_s * TUNE_POINTS, TUNE_POINTS - 1);
        draw(trace->rpm[shaft], &next_rpm, now, rpm);
        draw(trace->i_q[shaft], &next_i, now, row.truth.i_dq_A.q / motor_rated_peak_A(&r->motor));
        s->status[shaft] |= row.answer.status;
        s->lost[shaft] = fabs(rpm - target_rpm) > 2.0 * r->motor.n_max_rpm;
        look(s, shaft, part, rpm - target_rpm, (double)(k + 1) * T_s);
    }
    return true;
}

/* The parts one after the other. */
static bool run(const tune_result *r, tune_speed *s, int shaft, error *e)
{
    speed_drive d;
    drive_loop loop;
    const drive_firmware firmware = {&d, NULL, take_valley, give_peak};
    motor truth = tuned_motor(&r->motor, &r->design.machine);
    plant_config config = plant_config_from_motor(&truth);
    long length[TUNE_PARTS];
    if (!speed_drive_init(r, s, &d, e)) {
        return false;
    }
    config.shaft.mode = PLANT_SHAFT_INERTIA;
    config.shaft.J_kgm2 = tune_shafts[shaft] * s->J_kgm2;
    if (!plant_config_check(&config, e)) {
        return false;
    }
    drive_loop_begin(&loop, &truth, &config, &firmware);
    loop.halves = r->halves;
    lengths(r, s, tune_shafts[shaft], length);
    for (int part = 0; part < TUNE_PARTS; part++) {
        if (part == TUNE_LOADED) {
            plant_set_load(&loop.drive, s->load * 1.5 * r->motor.pole_pairs * r->design.machine.psi_f_Wb *
                                            motor_rated_peak_A(&truth));
        }
        if (!run_part(r, s, shaft, part, length[part], &loop, &d, e)) {
            return false;
        }
    }
    return true;
}

/* No curve, over the time of the heaviest shaft. */
static void clear(const tune_result *r, tune_speed *s)
{
    long length[TUNE_PARTS];
    lengths(r, s, tune_shafts[0], length);
    for (int part = 0; part < TUNE_PARTS; part++) {
        tune_trace *trace = &s->trace[part];
        trace->span_s = (double)length[part] * r->design.T_s;
        for (int k = 0; k < TUNE_SHAFTS * TUNE_POINTS; k++) {
            trace->rpm[k / TUNE_POINTS][k % TUNE_POINTS] = NAN;
            trace->i_q[k / TUNE_POINTS][k % TUNE_POINTS] = NAN;
        }
    }
}

bool tune_speed_trial(const tune_result *r, tune_speed *s, error *e)
{
    clear(r, s);
    for (int shaft = 0; shaft < TUNE_SHAFTS; shaft++) {
        if (!run(r, s, shaft, e)) {
            return false;
        }
    }
    return true;
}
