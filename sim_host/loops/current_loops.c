/* The study of current loops (current_loops.h). */
#include "current_loops.h"

#include "base/progress.h"
#include "reproduce/paper_2019.h"

#include <math.h>

const iqfoc_model_t loop_models[LOOP_MODELS] = {IQFOC_MODEL_EULER, IQFOC_MODEL_QUASI_DISCRETE,
                                                IQFOC_MODEL_EXACT};
const char *const loop_model_text[LOOP_MODELS] = {"Euler", "quasi-discrete", "exact"};

const char *const loop_method_text[LOOP_METHODS] = {
    "PI, mid-point sample", "PI, quasi-discrete mean", "deadbeat, Euler",          "deadbeat, quasi-discrete",
    "deadbeat, exact",      "observer, Euler",         "observer, quasi-discrete", "observer, exact"};
const char *const loop_method_key[LOOP_METHODS] = {
    "pi_midpoint",    "pi_mean",        "deadbeat_euler",          "deadbeat_quasi_discrete",
    "deadbeat_exact", "learning_euler", "learning_quasi_discrete", "learning_exact"};

const double loop_ratios[LOOP_RATIOS] = {5, 6, 8, 10, 12, 16, 20, 30, 50};

const loop_belief loop_beliefs[LOOP_BELIEFS] = {{"right", "right", 1.0, 1.0, 1.0},
                                                {"L 30 % too large", "L+30", 1.3, 1.0, 1.0},
                                                {"L 30 % too small", "L-30", 0.7, 1.0, 1.0},
                                                {"psi 10 % too large", "psi+10", 1.0, 1.1, 1.0},
                                                {"psi 10 % too small", "psi-10", 1.0, 0.9, 1.0},
                                                {"R 50 % too large", "R+50", 1.0, 1.0, 1.5},
                                                {"R 50 % too small", "R-50", 1.0, 1.0, 0.5}};

motor loop_motor_at(double ratio)
{
    motor m = paper_2019_motor();
    m.n_max_rpm = LOOP_RPM;
    m.f_pwm_Hz = ratio * LOOP_RPM / 60.0 * m.pole_pairs;
    return m;
}

static motor believed(const motor *truth, const loop_belief *belief)
{
    motor m = *truth;
    m.L_d_H *= belief->L;
    m.L_q_H *= belief->L;
    m.psi_f_Wb *= belief->psi;
    m.R_ohm *= belief->R;
    return m;
}

bool cycle_loop_run(const loop_case *c, const motor *assumed, const scenario_control *control,
                    const iqfoc_extension_t *extension, loop_result *result, error *e)
{
    drive_host host = {.extension = NULL};
    iqfoc_cycle_config_t config;
    if (!config_from_motor(assumed, control, &config, e)) {
        return false;
    }
    config.trips = 0;
    const drive_firmware firmware = drive_firmware_host(&host, extension);
    return firmware.start(firmware.context, &config, e) && closed_loop_run(c, &firmware, result, e);
}

bool deadbeat_loop_run(const loop_case *c, const motor *assumed, iqfoc_model_t model, double learning,
                       bool extended, loop_result *result, error *e)
{
    deadbeat_drive drive;
    const drive_firmware firmware = deadbeat_drive_firmware(&drive);
    return deadbeat_drive_init(&drive, assumed, model, learning, extended, e) &&
           closed_loop_run(c, &firmware, result, e);
}

loop_case current_loop_case(double ratio, double noise)
{
    const motor truth = loop_motor_at(ratio);
    const double rated_A = per_unit_of(&truth).I_A;
    const loop_case c = {.truth = truth,
                         .omega_e_rad_s = motor_speed_rad_s(&truth, LOOP_RPM),
                         .i_q_before_A = 0.3 * rated_A,
                         .i_q_after_A = 0.7 * rated_A,
                         .periods = 20,
                         .noise_A = noise * rated_A,
                         .seed = LOOP_SEED};
    return c;
}

bool loop_method_run(const loop_case *c, const motor *assumed, loop_method how, loop_result *result, error *e)
{
    if (how < LOOP_DEADBEAT_EULER) {
        /* At the usual bandwidth f_pwm/20. */
        const scenario_control control = {.feedback = how == LOOP_PI_MIDPOINT ? FEEDBACK_MIDPOINT
                                                                              : FEEDBACK_QUASI_DISCRETE_MEAN,
                                          .modulation = MODULATION_PWM};
        return cycle_loop_run(c, assumed, &control, NULL, result, e);
    }
    const bool learns = how >= LOOP_LEARNING_EULER;
    const int kind = (int)how - (learns ? LOOP_LEARNING_EULER : LOOP_DEADBEAT_EULER);
    return deadbeat_loop_run(c, assumed, loop_models[kind], learns ? LOOP_LEARNING : 0.0, false, result, e);
}

bool current_loop_run(double ratio, loop_method how, const loop_belief *belief, double noise,
                      loop_result *result, error *e)
{
    const loop_case c = current_loop_case(ratio, noise);
    const motor assumed = believed(&c.truth, belief);
    return loop_method_run(&c, &assumed, how, result, e);
}

/* Raises the believed L in steps of 0.1 until the loop is no longer stable, then bisects to 0.01. */
static bool find_L_most(double ratio, loop_method how, double *most, error *e)
{
    double stable = 1.0;
    double lost = 0.0;
    while (stable < LOOP_L_MOST - 1e-9 && (lost <= 0.0 || lost - stable > 0.01)) {
        const double L = lost > 0.0 ? 0.5 * (stable + lost) : fmin(stable + 0.1, LOOP_L_MOST);
        const loop_belief belief = {.L = L, .psi = 1.0, .R = 1.0};
        loop_result result;
        if (!current_loop_run(ratio, how, &belief, 0.0, &result, e)) {
            return false;
        }
        if (result.outcome == LOOP_UNSTABLE || result.outcome == LOOP_TRIPS) {
            lost = L;
        } else {
            stable = L;
        }
    }
    *most = stable;
    return true;
}

bool current_loops_run(current_loops *all, error *e)
{
    progress shown = progress_begin("loops", LOOP_RATIOS * LOOP_METHODS, "loops");
    bool ok = true;
    for (int k = 0; k < LOOP_RATIOS && ok; k++) {
        for (int n = 0; n < LOOP_METHODS && ok; n++) {
            const loop_method how = (loop_method)n;
            for (int b = 0; b < LOOP_BELIEFS && ok; b++) {
                ok = current_loop_run(loop_ratios[k], how, &loop_beliefs[b], 0.0, &all->at[k][b][n], e);
            }
            ok = ok &&
                 current_loop_run(loop_ratios[k], how, &loop_beliefs[LOOP_NOMINAL], LOOP_NOISE,
                                  &all->noisy[k][n], e) &&
                 find_L_most(loop_ratios[k], how, &all->L_most[k][n], e);
            progress_update(&shown, (double)(k * LOOP_METHODS + n + 1));
        }
    }
    progress_end(&shown);
    return ok;
}
