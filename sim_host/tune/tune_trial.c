/* Trials of designs in the plant (tune_trial.h). */
#include "tune_trial.h"

#include "base/progress.h"
#include "loops/current_loops.h"
#include "sensorless_drive.h"

#include <math.h>

const double tune_ratios[TUNE_RATIOS] = {5, 8, 10, 20, 50};
const char *const tune_controller_text[TUNE_CONTROLLERS] = {
    "PI, mid-point sample", "PI, quasi-discrete mean",      "deadbeat, exact", "tuned PI",
    "tuned deadbeat",       "deadbeat, exact, true machine"};
const char *const tune_controller_key[TUNE_CONTROLLERS] = {"pi_midpoint", "pi_mean",        "deadbeat_exact",
                                                           "tuned_pi",    "tuned_deadbeat", "deadbeat_true"};

/* In their order. */
enum { PI_MIDPOINT, PI_MEAN, DEADBEAT, TUNED, DEADBEAT_TRUE = TUNED + 2 };

const char *const tune_truth_text[TUNE_TRUTHS] = {"nominal", "L low", "L high"};

#define STEP_FROM 0.3
#define STEP_TO   0.7

/* ---- Prediction by the linear loop ---- */

enum { PROMISE_CYCLES = LOOP_TRANSIENT_CYCLES };

/* Of the mean of each cycle. */
static tune_promise promise_of(const tune_design *design, const tune_machine *truth, double phi_rad)
{
    const double step = STEP_TO - STEP_FROM;
    tune_loop loop;
    double mean[PROMISE_CYCLES][2];
    tune_promise p = {0.0, 0.0};
    tune_loop_make(design, truth, phi_rad, &tune_no_fault, &loop);
    tune_loop_step(&loop, PROMISE_CYCLES, mean);
    for (int n = 0; n < PROMISE_CYCLES; n++) {
        p.overshoot_percent = fmax(p.overshoot_percent, 100.0 * (mean[n][1] - 1.0));
        if (step * hypot(mean[n][0], mean[n][1] - 1.0) > LOOP_SETTLED) {
            p.settling_cycles = n + 1;
        }
    }
    return p;
}

/* ---- The trial ---- */

/*
 * The voltage that the step needs at a speed, over the largest voltage at any angle. The flux of the
 * mean current turns within the cycle, so that its chord's voltage is omega psi/s1.
 */
static double voltage_share(const tune_result *r, const tune_machine *m, double rpm)
{
    const double omega = motor_speed_rad_s(&r->motor, rpm);
    const double h = 0.5 * omega / r->motor.f_pwm_Hz;
    const double s1 = h > 1e-6 ? sin(h) / h : 1.0;
    const double peak_A = motor_rated_peak_A(&r->motor);
    const double flux = hypot(m->psi_f_Wb, m->L_q_H * STEP_TO * peak_A);
    const double moves = r->design.machine.L_q_H * (STEP_TO - STEP_FROM) * peak_A * r->motor.f_pwm_Hz;
    const double u_V =
        omega * flux / s1 + m->R_ohm * STEP_TO * peak_A + (1.0 - r->design.follow) * moves / s1;
    return u_V * sqrt(3.0) / r->motor.u_dc_V;
}

/* The highest speed, of a hundred up to n_max, at which the voltage suffices for every machine of the region. */
static double speed_with_voltage(const tune_result *r)
{
    for (int n = 100; n > 1; n--) {
        const double rpm = r->motor.n_max_rpm * n / 100.0;
        bool enough = true;
        for (int p = 0; p < r->region.points && enough; p++) {
            enough = voltage_share(r, &r->region.point[p].machine, rpm) < 0.95;
        }
        if (enough) {
            return rpm;
        }
    }
    return r->motor.n_max_rpm / 100.0;
}

static loop_case case_of(const tune_result *r, const motor *truth, double rpm)
{
    const double rated_A = motor_rated_peak_A(truth);
    const double omega = motor_speed_rad_s(truth, rpm);
    const double turns = fabs(omega) / truth->f_pwm_Hz / VEC_TWO_PI;
    const loop_case c = {.truth = *truth,
                         .halves = r->halves,
                         .omega_e_rad_s = omega,
                         .i_q_before_A = STEP_FROM * rated_A,
                         .i_q_after_A = STEP_TO * rated_A,
                         .periods = (int)fmax(1.0, nearbyint(100.0 * turns)),
                         .seed = LOOP_SEED};
    return c;
}

static bool run_tuned(const motor *believed, const tune_design *design, const loop_case *c,
                      loop_result *result, error *e)
{
    tuned_firmware_t drive;
    if (!tuned_drive_init(&drive, believed, design, e)) {
        return false;
    }
    const drive_firmware firmware = tuned_drive_firmware(&drive);
    return closed_loop_run(c, &firmware, result, e);
}

/*
 * With two updates the mean of a carrier period is judged, which ends a half later. It beats with the rotor by the ripple of
 * the halves, up to 6 % of rated at a carrier ratio of 5, without any loop.
 */
#define BEAT_PERCENT 10.0

static void judge(const tune_promise *p, const loop_result *found, bool halves, tune_trial *t)
{
    const bool beats = halves && found->wander_percent < BEAT_PERCENT;
    if ((found->outcome == LOOP_UNSTABLE && !beats) || found->outcome == LOOP_TRIPS) {
        t->unstable++;
        return;
    }
    const double settling = found->settling_beside_cycles;
    t->promised.overshoot_percent = fmax(t->promised.overshoot_percent, p->overshoot_percent);
    t->promised.settling_cycles = fmax(t->promised.settling_cycles, p->settling_cycles);
    t->found.overshoot_percent = fmax(t->found.overshoot_percent, found->overshoot_percent);
    t->found.settling_cycles = fmax(t->found.settling_cycles, settling);
    t->overshoot_off = fmax(t->overshoot_off, fabs(found->overshoot_percent - p->overshoot_percent));
    t->settling_off = fmax(t->settling_off, fabs(settling - p->settling_cycles));
    t->rms_percent = fmax(t->rms_percent, found->rms_percent);
    t->late += settling > 1.1 * p->settling_cycles + (halves ? 2.0 : 1.0) ? 1 : 0;
    t->high += found->overshoot_percent > p->overshoot_percent + 10.0 ? 1 : 0;
}

bool tune_trial_run(const tune_result *r, int drives, uint64_t seed, tune_trial *trial, error *e)
{
    plant_random random;
    plant_random_seed(&random, seed, 0);
    *trial = (tune_trial){.drives = drives, .rpm_most = speed_with_voltage(r)};
    progress shown = progress_begin("tune", (double)drives, "drives");
    for (int n = 0; n < drives; n++) {
        const tune_machine machine = tune_region_draw(&r->region, &random);
        const double rpm = trial->rpm_most * (0.02 + 0.98 * plant_random_uniform(&random));
        const motor truth = tuned_motor(&r->motor, &machine);
        const loop_case c = case_of(r, &truth, rpm);
        const tune_promise p = promise_of(&r->design, &machine, c.omega_e_rad_s / r->motor.f_pwm_Hz);
        loop_result result;
        if (!run_tuned(&r->motor, &r->design, &c, &result, e)) {
            progress_end(&shown);
            return false;
        }
        judge(&p, &result, r->halves, trial);
        progress_update(&shown, (double)(n + 1));
    }
    progress_end(&shown);
    return true;
}

/* ---- The trial without a sensor ---- */

/* The steady angle error of a drive after the step, by the linear loop, degrees; INFINITY: no steady state. */
static double angle_promised(const tune_result *r, const tune_observer *o, const tune_machine *truth,
                             double phi_rad)
{
    const tune_sensorless s =
        tune_sensorless_of(&r->design, r->halves, o->bandwidth_rad_s * r->design.T_s, o->gain_max);
    const tune_operating_point at = {.truth = *truth,
                                     .voltage_gain = 1.0,
                                     .phi_rad = phi_rad,
                                     .i_q_A = STEP_TO * motor_rated_peak_A(&r->motor)};
    tune_loop loop;
    tune_sensorless_error off;
    return tune_sensorless_make(&s, &at, 0.0, &loop, &off) ? 360.0 / VEC_TWO_PI * off.angle_rad : INFINITY;
}

static void judge_angle(double promised_deg, const sensorless_drive *drive, const loop_result *found,
                        bool halves, tune_observer_trial *t)
{
    const bool beats = halves && found->wander_percent < BEAT_PERCENT;
    if ((found->outcome == LOOP_UNSTABLE && !beats) || found->outcome == LOOP_TRIPS) {
        t->unstable++;
    } else if (drive->lost || !isfinite(promised_deg)) {
        t->lost++;
    } else {
        const double simulated_deg = 360.0 * spread_mean(&drive->off);
        t->predicted_deg = fmax(t->predicted_deg, fabs(promised_deg));
        t->simulated_deg = fmax(t->simulated_deg, fabs(simulated_deg));
        t->off_deg = fmax(t->off_deg, fabs(simulated_deg - promised_deg));
    }
}

bool tune_observer_trial_run(const tune_result *r, const tune_observer *o, int drives, uint64_t seed,
                             tune_observer_trial *trial, error *e)
{
    plant_random random;
    const double rpm_most = speed_with_voltage(r);
    const double rpm_least = fmin(r->at[1].rpm, rpm_most);
    plant_random_seed(&random, seed, 1);
    *trial = (tune_observer_trial){.drives = drives};
    progress shown = progress_begin("tune", (double)drives, "drives without a sensor");
    bool ok = true;
    for (int n = 0; n < drives && ok; n++) {
        const tune_machine machine = tune_region_draw(&r->region, &random);
        const double rpm = rpm_least + (rpm_most - rpm_least) * plant_random_uniform(&random);
        const motor truth = tuned_motor(&r->motor, &machine);
        loop_case c = case_of(r, &truth, rpm);
        sensorless_drive drive;
        loop_result found;
        c.noise_A = o->noise_A;
        ok = sensorless_drive_init(&drive, &r->motor, &r->design, &o->config,
                                   LOOP_SETTLE_CYCLES + LOOP_TRANSIENT_CYCLES, e);
        drive.halves = r->halves;
        const drive_firmware firmware = sensorless_drive_firmware(&drive);
        ok = ok && closed_loop_run(&c, &firmware, &found, e);
        if (ok) {
            const double phi_rad = c.omega_e_rad_s / r->motor.f_pwm_Hz;
            judge_angle(angle_promised(r, o, &machine, phi_rad), &drive, &found, r->halves, trial);
        }
        progress_update(&shown, (double)(n + 1));
    }
    progress_end(&shown);
    return ok;
}

/* ---- The comparison ---- */

static bool run_other(int controller, const motor *believed, const loop_case *c, loop_result *result,
                      error *e)
{
    if (controller == DEADBEAT || controller == DEADBEAT_TRUE) {
        const motor *assumed = controller == DEADBEAT ? believed : &c->truth;
        return deadbeat_loop_run(c, assumed, IQFOC_MODEL_EXACT, 0.0, false, result, e);
    }
    const scenario_control control = {.feedback = controller == PI_MIDPOINT ? FEEDBACK_MIDPOINT
                                                                            : FEEDBACK_QUASI_DISCRETE_MEAN,
                                      .modulation = MODULATION_PWM};
    return cycle_loop_run(c, believed, &control, NULL, result, e);
}

/* Both designs at a ratio: the motor with the switching frequency that makes it so at c->rpm. */
static bool compare_at(const tune_result *r, const tune_tolerances *t, int k, tune_comparison *c, error *e)
{
    tune_result tuned[2];
    motor believed = tuned_motor(&r->motor, &r->region.centre);
    believed.n_max_rpm = c->rpm;
    believed.f_pwm_Hz = tune_ratios[k] * motor_speed_rad_s(&r->motor, c->rpm) / VEC_TWO_PI;
    for (int method = TUNE_PI; method <= TUNE_DEADBEAT; method++) {
        tuned[method] = *r;
        tuned[method].motor = believed;
        tuned[method].method = (tune_method)method;
        if (!tune_design_bandwidth(&tuned[method], e)) {
            return false;
        }
        c->bandwidth_rad_s[k][method] = tuned[method].bandwidth_rad_s;
    }
    for (int truth = 0; truth < TUNE_TRUTHS; truth++) {
        motor m = believed;
        const double share = truth == 0 ? 1.0 : truth == 1 ? 1.0 - t->L : 1.0 + t->L;
        m.L_d_H *= share;
        m.L_q_H *= share;
        const loop_case run = case_of(r, &m, c->rpm);
        for (int n = 0; n < TUNE_CONTROLLERS; n++) {
            loop_result *result = &c->at[k][n][truth];
            const bool is_tuned = n >= TUNED && n < DEADBEAT_TRUE;
            if (!(is_tuned ? run_tuned(&believed, &tuned[n - TUNED].design, &run, result, e)
                           : run_other(n, &believed, &run, result, e))) {
                return false;
            }
        }
    }
    return true;
}

bool tune_compare(const tune_result *r, const tune_tolerances *t, tune_comparison *c, error *e)
{
    c->rpm = 0.9 * speed_with_voltage(r);
    c->L_share = t->L;
    for (int k = 0; k < TUNE_RATIOS; k++) {
        error refused = {0};
        c->held[k] = compare_at(r, t, k, c, &refused);
        if (refused.status == STATUS_FAILED) {
            *e = refused;
            return false;
        }
    }
    return true;
}
