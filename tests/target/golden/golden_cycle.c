/*
 * Digests of the control cycle (golden_cycle.h).
 *
 * The current of a sample is the predicted one with a small error. The predictor thus closes the loop, and the state
 * stays in the range of a real drive. One sample in 32 is a fault, and the set of parameters changes while the cycle
 * runs.
 */
#include "golden_cycle.h"

#include "golden_types.h"

#include "iqfoc/cycle_six_step.h"
#include "iqfoc/cycle_steps.h"
#include "iqfoc/extension_params.h"
#include "iqfoc/params.h"

#define PERIODS 100
#define TICKS   1000

/* The drive of the 2019 paper; L_q is larger where a predictor is for saliency. */
#define R_OHM  0.75
#define L_H    5.2e-3
#define L_Q_H  6.8e-3
#define PSI_WB 0.134
#define T_S    2e-4
#define I_B_A  IQFOC_I_BASE(10.5)
#define U_DC_V 750.0

static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V);
static const iqfoc_salient_machine_t machine =
    IQFOC_SALIENT_MACHINE(R_OHM, L_H, L_Q_H, PSI_WB, T_S, I_B_A, U_DC_V);
static const iqfoc_flux_predictor_t flux =
    IQFOC_FLUX_PREDICTOR(R_OHM, L_H, L_Q_H, PSI_WB, T_S, I_B_A, U_DC_V);
static const iqfoc_flux_map_t flux_map = IQFOC_FLUX_MAP(
    R_OHM, 0.7 * L_H, 0.4 * L_Q_H, PSI_WB,
    IQFOC_FLUX_MAP_PART(0.4 * L_Q_H * 100.0, 18.0, 10.0, -5.0, T_S, I_B_A, U_DC_V),
    IQFOC_FLUX_MAP_PART(0.2 * L_Q_H * 36.0, 12.0, 6.0, 4.0, T_S, I_B_A, U_DC_V), T_S, I_B_A, U_DC_V);
static const iqfoc_extension_t extension = {
    .i_offset = {IQ24(0.01), IQ24(-0.02), IQ24(0.01)},
    .i_gain_inverse = {IQ24(1.02), IQ24(0.98), IQ24_ONE},
    .theta_0 = IQ24(0.01),
    .theta_delay = IQ24(0.1),
    .k_u = IQ24(1.02),
    .v_dead = IQ24(0.02),
    .knee_inverse = IQ24(20.0),
    .saturation = IQ24(0.05),
};

/* A drive, and what its two sets of parameters point to. */
typedef struct drive {
    golden_inputs_t inputs;
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t set[2];
    iqfoc_exact_law_t law;
    iqfoc_exact_law_t mean_law;
    iqfoc_salient_t salient;
    iqfoc_salient_t salient_mean;
    iq24_t speed; /* in the middle of its speeds */
    iq24_t theta;
    uint32_t ticks;
} drive_t;

static drive_t drive;

static bool one_in(uint32_t n)
{
    return (uint32_t)golden_within(&drive.inputs, IQ24_MAX) % n == n / 2;
}

/* At a speed of its own, with what every method needs. */
static void start(const iqfoc_methods_t m)
{
    static const iqfoc_cycle_config_t base = {
        .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
        .gains = IQFOC_GAINS(1500.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
        .safe_state = IQFOC_SAFE_GATES_OFF,
        .span_max = IQ24(0.96),
        .current_limit = IQ24(4.0),
        .period_ticks = TICKS,
        .tolerance_ticks = TICKS / 50,
        .stale_ticks = TICKS / 4,
        .deadline_ticks = TICKS / 2,
        .data = {.flux = &flux,
                 .acting = &extension,
                 .extension = &extension,
                 .learning = IQ24(0.1),
                 .flux_map = &flux_map},
    };
    drive.speed = golden_within(&drive.inputs, IQ24(0.2));
    drive.law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    drive.mean_law = iqfoc_exact_mean(&winding, IQ24_ONE);
    iqfoc_salient_at_speed(&machine, drive.speed, IQ24_ONE, &drive.salient, &drive.salient_mean);
    drive.set[0] = base;
    drive.set[0].data.exact = &drive.law;
    drive.set[0].data.exact_mean = &drive.mean_law;
    drive.set[0].data.salient = &drive.salient;
    drive.set[0].data.salient_mean = &drive.salient_mean;
    drive.set[0].data.k_u_inverse = iqfoc_deadbeat_inverse(drive.law.k_u_q26);
    drive.set[0].data.k_psi = base.predictor.k_psi;
    drive.set[1] = drive.set[0];
    drive.set[1].gains.kp_q /= 2;
    drive.set[1].period_ticks = TICKS + TICKS / 8;
    drive.theta = 0;
    drive.ticks = UINT32_MAX - 20 * TICKS; /* the timer wraps on the way */
    (void)iqfoc_cycle_init_by(m, &drive.cycle, &drive.set[0]);
    drive.cycle.enabled = true;
}

/* What the converters give: the current expected, a little off, or now and then what no drive should have. */
static iqfoc_sample_t sample_of(iqfoc_ab_t expected, iq24_t at)
{
    golden_inputs_t *const inputs = &drive.inputs;
    iqfoc_ab_t i = golden_ab(inputs, IQ24(0.03));
    i.alpha = iq24_clamp(iq24_add_sat(i.alpha, expected.alpha), IQ24(-2.0), IQ24(2.0));
    i.beta = iq24_clamp(iq24_add_sat(i.beta, expected.beta), IQ24(-2.0), IQ24(2.0));
    iqfoc_sample_t s;
    s.i = iqfoc_clarke_inverse(i);
    s.i_mean = s.i;
    s.theta = iq24_add_wrap(drive.theta, golden_within(inputs, IQ24(0.001)));
    s.speed = drive.speed + golden_within(inputs, IQ24(0.005));
    s.u_dc = IQ24_ONE + golden_within(inputs, IQ24(0.1));
    s.instant = at;
    s.time = drive.ticks;
    s.has_mean = one_in(4);
    s.clipped = one_in(64);
    if (one_in(64)) {
        s.u_dc = golden_within(inputs, IQ24(3.0));
        s.speed = golden_within(inputs, IQ24_ONE);
    }
    return s;
}

static uint32_t time_later(uint32_t ticks)
{
    drive.ticks = (uint32_t)(((uint64_t)drive.ticks + ticks) & UINT32_MAX);
    return drive.ticks;
}

static void add_state(uint64_t *digest, const iqfoc_command_t *command)
{
    const iqfoc_cycle_t *const cycle = &drive.cycle;
    digest_abc(digest, command->duties.high);
    digest_add(digest, command->duties.scale);
    digest_add(digest, command->gates ? 1 : 0);
    digest_dq(digest, cycle->i_dq);
    digest_dq(digest, cycle->i_corrected_dq);
    digest_dq(digest, cycle->u_dq);
    digest_dq(digest, cycle->drift);
    digest_ab(digest, cycle->u_ab);
    digest_ab(digest, cycle->i_next);
    digest_ab(digest, cycle->error);
    digest_add(digest, cycle->u_dc_inverse);
    digest_add(digest, (int32_t)cycle->status);
    digest_add(digest, iqfoc_cycle_voltage_angle(cycle));
    digest_add(digest, (int32_t)iqfoc_cycle_next_ticks(cycle));
}

static void period(const iqfoc_methods_t m, uint64_t *digest)
{
    iqfoc_cycle_t *const cycle = &drive.cycle;
    if (one_in(16)) {
        cycle->i_ref = golden_dq(&drive.inputs, IQ24(0.8));
    }
    if (iqfoc_cycle_taken(cycle) && one_in(16)) {
        (void)iqfoc_cycle_offer_by(m, cycle, cycle->config == drive.set ? &drive.set[1] : drive.set);
    }
    iqfoc_sample_t s = sample_of(cycle->i_next, 0);
    iqfoc_cycle_valley_by(m, cycle, &s, s.time);
    const uint32_t half = cycle->config->period_ticks / 2;
    (void)time_later(half);
    drive.theta = iq24_add_wrap(drive.theta, drive.speed / 2);
    iqfoc_ab_t middle;
    middle.alpha = cycle->i_valley.alpha / 2 + cycle->i_next.alpha / 2;
    middle.beta = cycle->i_valley.beta / 2 + cycle->i_next.beta / 2;
    s = sample_of(middle, IQ24(0.5));
    const iqfoc_command_t command = iqfoc_cycle_peak_by(m, cycle, &s, IQ24(1.5), s.time);
    const uint32_t written = s.time + (one_in(64) ? TICKS : TICKS / 4);
    digest_add(digest, iqfoc_cycle_in_time_inline(cycle, s.time, written) ? 1 : 0);
    digest_add(digest, iqfoc_cycle_in_time(cycle, &s, written) ? 1 : 0);
    (void)time_later(cycle->config->period_ticks - half);
    drive.theta = iq24_add_wrap(drive.theta, drive.speed / 2);
    add_state(digest, &command);
}

static const char *const models[] = {"quasi_discrete", "exact", "salient", "flux", "euler", "flux_map"};
static const char *const feedbacks[] = {"midpoint", "corrected_mean", "quasi_discrete_mean", "exact_mean",
                                        "modulated_mean"};
static const char *const controls[] = {"pi", "deadbeat", "deadbeat_learning"};

/* Puts a word and a stroke ahead of it at the end of a name. */
static void name_add(char *name, const char *word)
{
    while (*name != '\0') {
        name++;
    }
    *name++ = '/';
    while (*word != '\0') {
        *name++ = *word++;
    }
    *name = '\0';
}

static void of_configuration(iqfoc_methods_t m, golden_report *report)
{
    char name[64] = "cycle";
    uint64_t digest = DIGEST_START;
    drive.inputs.number = 0;
    drive.inputs.state = GOLDEN_SEED;
    for (int32_t kind = 0; kind < 6; kind++) {
        m.modulation = (iqfoc_modulation_t)(kind % 3);
        m.extended = kind >= 3;
        start(m);
        for (int32_t n = 0; n < PERIODS; n++) {
            period(m, &digest);
        }
    }
    name_add(name, models[m.model]);
    name_add(name, feedbacks[m.feedback]);
    name_add(name, controls[m.control]);
    report(name, digest);
}

/* Six-step by a timer: states of both directions, and back to the carrier. */
static void by_timer(golden_report *report)
{
    static const iqfoc_six_step_config_t config = {IQ24(0.02), IQ24(-0.5), IQ24(0.5), false};
    const iqfoc_methods_t m = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                               IQFOC_CONTROL_PI, IQFOC_MODULATION_OVER, false};
    uint64_t digest = DIGEST_START;
    iqfoc_six_step_t six;
    drive.inputs.number = 0;
    drive.inputs.state = GOLDEN_SEED;
    for (int32_t kind = 0; kind < 6; kind++) {
        start(m);
        drive.speed = kind % 2 == 0 ? iq24_abs_sat(drive.speed) : -iq24_abs_sat(drive.speed);
        iqfoc_sample_t s = sample_of(drive.cycle.i_next, 0);
        iqfoc_six_step_command_t next = iqfoc_cycle_six_step_begin(
            &six, &drive.cycle, &config, golden_within(&drive.inputs, IQ24_ONE), &s);
        for (int32_t n = 0; n < PERIODS; n++) {
            drive.theta = iq24_add_wrap(drive.theta, s.speed < 0 ? -next.movement : next.movement);
            drive.cycle.i_ref = golden_dq(&drive.inputs, IQ24(0.8));
            s = sample_of(golden_ab(&drive.inputs, IQ24_ONE), 0);
            next = iqfoc_cycle_six_step_switch(&six, &drive.cycle, &s, s.time);
            add_state(&digest, &next.command);
            digest_add(&digest, next.movement);
            digest_add(&digest, (int32_t)(next.ticks & INT32_MAX));
        }
        iqfoc_cycle_six_step_end(&six, &drive.cycle, s.speed);
        for (int32_t n = 0; n < PERIODS; n++) {
            period(m, &digest);
        }
    }
    report("cycle/six_step_by_timer", digest);
}

uint32_t golden_cycle(golden_report *report)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < 6 * 5 * 3; k++) {
        const iqfoc_methods_t m = {(iqfoc_model_t)(k / 15), (iqfoc_feedback_t)(k / 3 % 5),
                                   (iqfoc_control_t)(k % 3), IQFOC_MODULATION_PWM, false};
        if (iqfoc_methods_agree(m)) {
            of_configuration(m, report);
            count++;
        }
    }
    by_timer(report);
    return count;
}
