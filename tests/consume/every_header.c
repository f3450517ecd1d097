/*
 * A user's program: C99, C++17 and C++20 alike. It expands every initialiser macro and calls functions of every header, and
 * adds up what they return. The sum is the same on every target, to the bit.
 *
 * Exit status 0: the sum is the one expected; 1: it is another; 2: a set-up function refused.
 */
#include "iqfoc/iqfoc.h"

#ifdef IQFOC_DIAGNOSED
#include "iqfoc_extension.h" /* as `iqfoc diagnose` writes it */
#endif
#ifdef CONSUME_PRINT
#include <stdio.h>
#endif

#define T_S 2e-4               /* control cycle, s */
#define U_B 750.0              /* nominal DC link, V */
#define I_B IQFOC_I_BASE(10.5) /* from the rated current, A rms */

#define EXPECTED UINT32_C(0x847AD27E)

static const iqfoc_predictor_t predictor = IQFOC_PREDICTOR(0.75, 5.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_current_control_gains_t gains =
    IQFOC_GAINS(1500.0, 0.75, 5.2e-3, 6.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_flux_predictor_t flux_predictor =
    IQFOC_FLUX_PREDICTOR(0.75, 5.2e-3, 6.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_flux_map_t flux_map =
    IQFOC_FLUX_MAP(0.75, 5.2e-3, 3.2e-3, 0.134, IQFOC_FLUX_MAP_PART(0.3, 20.0, 10.0, -4.0, T_S, I_B, U_B),
                   IQFOC_FLUX_MAP_NO_PART, T_S, I_B, U_B);
#ifdef IQFOC_DIAGNOSED
static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;
static const iqfoc_predictor_t diagnosed_predictor = IQFOC_DIAGNOSED_PREDICTOR;
static const iqfoc_flux_predictor_t diagnosed_flux_predictor = IQFOC_DIAGNOSED_FLUX_PREDICTOR;
static const iqfoc_current_control_gains_t diagnosed_gains = IQFOC_DIAGNOSED_GAINS(1500.0);
#else
static const iqfoc_extension_t extension = IQFOC_EXTENSION_NONE;
#endif
static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_salient_machine_t salient_machine =
    IQFOC_SALIENT_MACHINE(0.75, 5.2e-3, 6.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_induction_machine_t induction_machine =
    IQFOC_INDUCTION_MACHINE(0.9, 0.6, 9e-3, 0.12, T_S, I_B, U_B);
static const iq24_t n_max = IQFOC_SPEED(8000.0, 3, T_S);

static uint32_t sum;

static void add(int32_t x)
{
    sum = (uint32_t)(((uint64_t)sum * 31U + (uint32_t)x) & UINT32_MAX);
}

static void add_ab(iqfoc_ab_t x)
{
    add(x.alpha);
    add(x.beta);
}

static void add_dq(iqfoc_dq_t x)
{
    add(x.d);
    add(x.q);
}

static void add_duties(iqfoc_duties_t x)
{
    add(x.high.a);
    add(x.high.b);
    add(x.high.c);
    add(x.scale);
}

/* A port in a few lines: a drive at half a turn that ignores its commands. */
#ifdef __cplusplus
extern "C" {
#endif
struct iqfoc_hal {
    iqfoc_sample_t sample;
    iqfoc_command_t command;
    uint32_t now;
};

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    *sample = hal->sample;
    sample->instant = 0;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    *sample = hal->sample;
    sample->instant = IQ24_ONE / 2;
    sample->theta = iq24_add_wrap(sample->theta, sample->speed / 2);
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    hal->command = *command;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    return hal->now;
}
#ifdef __cplusplus
}
#endif

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;
static iqfoc_recorder_t recorder;
static iqfoc_recorder_config_t recorder_config;
static int32_t memory[120];

static const iqfoc_recorder_channel_t channel =
    IQFOC_RECORDER_IQ24(&cycle.i_dq.q, IQFOC_RECORDER_I_BETA, I_B, 26);

static void set_up(void)
{
    config.predictor = predictor;
    config.gains = gains;
    config.feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN;
    config.modulation = IQFOC_MODULATION_PWM;
    config.safe_state = IQFOC_SAFE_GATES_OFF;
    config.span_max = IQ24(0.96);
    config.current_limit = IQ24(2.0);
    config.trips = IQFOC_STATUS_OVERCURRENT;
    config.time_unchecked = true; /* there is no timer here */
    recorder_config.channels[0] = channel;
    recorder_config.channel_count = 1;
    recorder_config.decimation = 1;
    recorder_config.period_mantissa = 1;
    recorder_config.trigger = IQFOC_RECORDER_NOW;
    hal.sample.i.a = IQ24(0.3);
    hal.sample.i.b = IQ24(-0.1);
    hal.sample.i.c = IQ24(-0.2);
    hal.sample.u_dc = IQ24(0.98);
    hal.sample.speed = n_max;
}

/* The cycle behind the HAL, with a recorder that watches it. */
static void drive(void)
{
    cycle.i_ref.q = IQ24(0.5);
    cycle.enabled = true;
    for (int k = 0; k < 20; k++) {
        hal.sample.theta = iq24_add_wrap(hal.sample.theta, n_max);
        iqfoc_isr_valley(&cycle, &hal);
        iqfoc_isr_peak(&cycle, &hal);
        iqfoc_recorder_take(&recorder, cycle.status);
        add_duties(hal.command.duties);
        add_ab(cycle.i_next);
        add_dq(cycle.i_dq);
    }
    iqfoc_recorder_stop(&recorder);
    while (!iqfoc_recorder_finished(&recorder)) {
        add(iqfoc_recorder_octet(&recorder));
    }
    add(iqfoc_cycle_safe(&config).gates);
    iqfoc_cycle_clear(&cycle);
    add((int32_t)cycle.status);
}

static void numbers(void)
{
    add(IQ24(0.1));
    add(iq24_div(IQ24(1.0), IQ24(3.0)));
    add(iq24_sqrt(IQ24(2.0)));
    add(iq24_atan2(IQ24(0.3), IQ24(-0.7)));
    add(iq24_sincos_inline(IQ24(0.123)).cos);
    add(iq24_mul_sat(IQ24_MAX, iq24_abs_sat(IQ24_MIN)));
    add(iq24_mul_high(IQ24_MIN, IQ24_MAX));
    add(IQ24_HOLD_BITS(IQ24_MIN, 20));
}

static void predictions(void)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(n_max);
    const iqfoc_ab_t i = iqfoc_clarke2(IQ24(0.3), IQ24(-0.1));
    const iqfoc_ab_t u = iqfoc_finite_set_voltage(3, IQ24(1.0));
    const iqfoc_abc_t high = {IQ24(0.7), IQ24(0.4), IQ24(0.2)};
    const iq24_sincos_t start = iq24_sincos(0);
    const iq24_sincos_t mid = iq24_sincos(n_max / 2);
    const iqfoc_dq_t i_dq = iqfoc_park(i, start);
    const iqfoc_dq_t u_dq = iqfoc_park(u, start);

    add_ab(iqfoc_predictor_euler(&predictor, i, u, &rotor, start));
    add_ab(iqfoc_mean_current_quasi_discrete(&predictor, i, u, &rotor, mid));
    add_dq(iqfoc_mean_current_correct_steady(i, iqfoc_rotor_steady_gain(n_max), mid));
    add_ab(iqfoc_flux_predictor_step(&flux_predictor, &extension, i, u, start, iq24_sincos(n_max)));
    add_ab(iqfoc_flux_map_step(&flux_map, &extension, i, u, start, iq24_sincos(n_max)));

    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    const iqfoc_exact_law_t mean_law = iqfoc_exact_mean(&winding, IQ24(0.5));
    const iqfoc_exact_t exact = iqfoc_exact_at_speed(&law, n_max);
    const iqfoc_exact_t exact_mean = iqfoc_exact_at_speed(&mean_law, n_max);
    const iqfoc_ab_t i_next = iqfoc_exact_step(&exact, i, u, mid);
    add_ab(i_next);
    add_ab(iqfoc_exact_step(&exact_mean, i, u, mid));
    add(iqfoc_form_euler(&predictor, &rotor).w_imag_q26);

    iqfoc_salient_t end;
    iqfoc_salient_t mean;
    iqfoc_salient_at_speed(&salient_machine, n_max, IQ24_ONE, &end, &mean);
    add_dq(iqfoc_salient_step(&end, i_dq, u_dq));
    const iqfoc_ripple_t ripple = iqfoc_ripple_at_speed(&salient_machine, &rotor);
    add_dq(iqfoc_ripple_seen(&ripple, high, IQ24(1.0), mid));
    const iqfoc_mean_modulated_t modulated = iqfoc_mean_modulated_at_speed(&predictor, &rotor);
    add_dq(iqfoc_mean_modulated(&modulated, i, i_next, high, IQ24(1.0), mid));

    const iqfoc_induction_t induction = iqfoc_induction_at_speed(&induction_machine, n_max, IQ24_ONE);
    const iqfoc_induction_state_t state = {i, i_next};
    add_ab(iqfoc_induction_step(&induction, state, u).flux);

    const iqfoc_valley_reference_t reference = iqfoc_valley_reference_at(&rotor, predictor.k_psi);
    const iqfoc_deadbeat_t deadbeat = {exact, iqfoc_deadbeat_inverse(law.k_u_q26), reference};
    const iqfoc_dq_t i_ref = {0, IQ24(0.5)};
    iqfoc_deadbeat_drift_t drift = {{0, 0}, {0, 0}, false};
    add_ab(iqfoc_deadbeat_step(&deadbeat, i, u, i_ref, 0, n_max));
    add_ab(iqfoc_deadbeat_drift_step(&drift, &deadbeat, IQ24(0.1), i, u, i_ref, 0, n_max));
    const iqfoc_finite_set_t set = {exact, reference, IQ24(0.01), 2};
    add(iqfoc_finite_set_choose(&set, i, 3, i_ref, 0, n_max, IQ24(1.0), 0));
    add_duties(iqfoc_modulate(u, IQ24(1.0), IQ24(0.96)));
    add(iqfoc_six_step_remaining(IQ24(0.1), n_max));
    iqfoc_duties_t duties = iqfoc_six_step_duties(2);
    iqfoc_extension_compensate(&extension, &duties, high, IQ24(1.0));
    add_duties(duties);
}

int main(void)
{
    set_up();
    if (iqfoc_cycle_init(&cycle, &config) != IQFOC_OK || iqfoc_extension_check(&extension) != IQFOC_OK ||
        iqfoc_flux_predictor_check(&flux_predictor) != IQFOC_OK ||
        iqfoc_flux_map_check(&flux_map) != IQFOC_OK ||
        iqfoc_recorder_init(&recorder, &recorder_config, memory, 120) != IQFOC_OK) {
        return 2;
    }
    iqfoc_recorder_arm(&recorder);
    numbers();
    drive();
    predictions();
#ifdef IQFOC_DIAGNOSED
    return diagnosed_predictor.k_u > 0 && diagnosed_gains.kp_d > 0 && extension.v_dead != 0 &&
                   iqfoc_flux_predictor_check(&diagnosed_flux_predictor) == IQFOC_OK
               ? 0
               : 1;
#else
#ifdef CONSUME_PRINT
    printf("iqfoc %s: %08lX\n", IQFOC_VERSION_STRING, (unsigned long)sum);
#endif
    return sum == EXPECTED ? 0 : 1;
#endif
}
