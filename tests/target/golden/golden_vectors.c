/*
 * Digests of the library's functions (golden_vectors.h). Inputs keep to each function's stated range.
 */
#include "golden_vectors.h"

#include "golden_around.h"
#include "golden_commission.h"
#include "golden_cycle.h"
#include "golden_limits.h"
#include "golden_models.h"
#include "golden_recorder.h"
#include "golden_sensorless.h"
#include "golden_tuned.h"
#include "golden_types.h"

#include "iqfoc/current_control.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/mean_current.h"
#include "iqfoc/modulation.h"
#include "iqfoc/predictor.h"
#include "iqfoc/rotor.h"
#include "iqfoc/transform.h"

static iqfoc_predictor_t any_machine(golden_inputs_t *inputs)
{
    iqfoc_predictor_t machine;
    machine.k_u = 1 + golden_positive(inputs, IQ24(16.0) - 1);
    machine.k_r = golden_positive(inputs, IQ24_ONE);
    machine.k_psi = golden_positive(inputs, IQ24(8.0));
    return machine;
}

static iqfoc_current_control_gains_t any_gains(golden_inputs_t *inputs)
{
    iqfoc_current_control_gains_t gains;
    gains.kp_d = golden_positive(inputs, IQ24(32.0));
    gains.kp_q = golden_positive(inputs, IQ24(32.0));
    gains.ki_d = golden_positive(inputs, IQ24(32.0));
    gains.ki_q = golden_positive(inputs, IQ24(32.0));
    gains.anti_windup = golden_positive(inputs, IQ24_ONE);
    gains.x_d = golden_positive(inputs, IQ24(96.0));
    gains.x_q = golden_positive(inputs, IQ24(96.0));
    gains.emf = golden_positive(inputs, IQ24(96.0));
    return gains;
}

static void arithmetic(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    digest_add(digest, iq24_add_wrap(a, b));
    digest_add(digest, iq24_sub_wrap(a, b));
    digest_add(digest, iq24_add_sat(a, b));
    digest_add(digest, iq24_sub_sat(a, b));
    digest_add(digest, iq24_neg_sat(a));
    digest_add(digest, iq24_abs_sat(a));
    digest_add(digest, iq24_mul_trunc(a, b));
    digest_add(digest, iq24_mul_round(a, b));
    digest_add(digest, iq24_mul_sat(a, b));
}

static void division(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    digest_add(digest, iq24_div(a, b));
}

static void root(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    digest_add(digest, iq24_sqrt(a));
    digest_add(digest, iq24_sqrt(b));
}

static void sine_and_cosine(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    const iq24_sincos_t sc = iq24_sincos(iq24_add_wrap(a, b));
    digest_add(digest, sc.sin);
    digest_add(digest, sc.cos);
}

static void arc_tangent(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    digest_add(digest, iq24_atan2(a, b));
}

static void transforms(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_abc_t abc;
    abc.a = golden_within(inputs, IQ24(31.9));
    abc.b = golden_within(inputs, IQ24(31.9));
    abc.c = golden_within(inputs, IQ24(31.9));
    const iqfoc_ab_t ab = iqfoc_clarke3(abc);
    const iq24_sincos_t sc = iq24_sincos(golden_within(inputs, IQ24_MAX));
    const iqfoc_dq_t dq = iqfoc_park(ab, sc);
    digest_ab(digest, ab);
    digest_ab(digest, iqfoc_clarke2(abc.a, abc.b));
    digest_abc(digest, iqfoc_clarke_inverse(ab));
    digest_dq(digest, dq);
    digest_ab(digest, iqfoc_park_inverse(golden_dq(inputs, IQ24(64.0)), sc));
}

static void rotor_movement(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    const iqfoc_rotor_t wide = iqfoc_rotor_from_speed(a);
    const iqfoc_rotor_t valid = iqfoc_rotor_from_speed(b % IQFOC_ROTOR_SPEED_MAX);
    digest_add(digest, wide.speed);
    digest_add(digest, wide.s1);
    digest_add(digest, wide.s2);
    digest_add(digest, valid.s1);
    digest_add(digest, valid.s2);
    digest_add(digest, iqfoc_rotor_steady_gain(a));
    digest_add(digest, iqfoc_rotor_steady_gain(b % IQFOC_ROTOR_SPEED_MAX));
}

static void mean_current(golden_inputs_t *inputs, uint64_t *digest)
{
    const iqfoc_ab_t i = golden_ab(inputs, IQ24(32.0));
    const iqfoc_ab_t delta = golden_ab(inputs, IQ24(32.0));
    const iq24_t speed = golden_within(inputs, IQFOC_ROTOR_SPEED_MAX);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
    const iq24_sincos_t sc = iq24_sincos(golden_within(inputs, IQ24_ONE));
    digest_dq(digest, iqfoc_mean_current_correct(i, delta, &rotor, sc));
    digest_dq(digest, iqfoc_mean_current_correct_steady(i, iqfoc_rotor_steady_gain(speed), sc));
    const iqfoc_predictor_t machine = any_machine(inputs);
    const iqfoc_ab_t u = golden_ab(inputs, IQ24(2.0));
    digest_ab(digest, iqfoc_mean_current_quasi_discrete(&machine, i, u, &rotor, sc));
    const iqfoc_ab_t start = golden_ab(inputs, IQ24(21.3));
    const iqfoc_ab_t end = golden_ab(inputs, IQ24(51.2));
    const iq24_t w = golden_within(inputs, IQ24(13.9));
    digest_dq(digest, iqfoc_mean_current_seen(start, end, w, &rotor, sc));
}

static void prediction(golden_inputs_t *inputs, uint64_t *digest)
{
    const iqfoc_predictor_t machine = any_machine(inputs);
    const iqfoc_ab_t i = golden_ab(inputs, IQ24(32.0));
    const iqfoc_ab_t u = golden_ab(inputs, IQ24(2.0));
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(golden_within(inputs, IQFOC_ROTOR_SPEED_MAX));
    const iq24_sincos_t sc = iq24_sincos(golden_within(inputs, IQ24_ONE));
    digest_ab(digest, iqfoc_predictor_euler(&machine, i, u, &rotor, sc));
    digest_ab(digest, iqfoc_predictor_quasi_discrete(&machine, i, u, &rotor, sc));
}

static void add_integrals(uint64_t *digest, const iqfoc_current_control_t *control)
{
    const iqfoc_dq_t low = {iq24_wrap(control->integral_d), iq24_wrap(control->integral_q)};
    const iqfoc_dq_t high = {iq24_wrap(iq24_asr64(control->integral_d, 32)),
                             iq24_wrap(iq24_asr64(control->integral_q, 32))};
    digest_dq(digest, low);
    digest_dq(digest, high);
}

/* The integrators stay from input to input, as in a drive. */
static void current_control(golden_inputs_t *inputs, uint64_t *digest)
{
    static iqfoc_current_control_t control;
    if (inputs->number++ == 0) {
        control.integral_d = 0;
        control.integral_q = 0;
    }
    const iqfoc_current_control_gains_t gains = any_gains(inputs);
    const iqfoc_dq_t i_ref = golden_dq(inputs, IQ24(32.0));
    const iqfoc_dq_t i = golden_dq(inputs, IQ24(32.0));
    const iq24_t speed = golden_within(inputs, IQFOC_ROTOR_SPEED_MAX);
    const iqfoc_dq_t u = iqfoc_current_control_step(&control, &gains, i_ref, i);
    digest_dq(digest, u);
    digest_dq(digest, iqfoc_current_control_decoupling(&gains, i, speed));
    add_integrals(digest, &control);
    iqfoc_current_control_limited(&control, &gains, u, golden_positive(inputs, IQ24_ONE));
    add_integrals(digest, &control);
}

static void modulation(golden_inputs_t *inputs, uint64_t *digest)
{
    /* |u| <= 32, so each component up to 32/sqrt(2). */
    const iqfoc_ab_t u = golden_ab(inputs, inputs->number++ % 2 == 0 ? IQ24(22.6) : IQ24_ONE);
    const iq24_t u_dc_inverse = 1 + golden_positive(inputs, IQ24(2.0) - 1);
    const iq24_t span_max = 1 + golden_positive(inputs, IQ24_ONE - 1);
    const iqfoc_duties_t duties = iqfoc_modulate(u, u_dc_inverse, span_max);
    digest_abc(digest, duties.high);
    digest_add(digest, duties.scale);
}

static void six_step(golden_inputs_t *inputs, uint64_t *digest)
{
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    const int32_t state = iqfoc_six_step_state(a);
    digest_add(digest, state);
    digest_abc(digest, iqfoc_six_step_duties(state).high);
    digest_ab(digest, iqfoc_six_step_voltage(state, b / 2));
    digest_add(digest, iqfoc_six_step_remaining(a, b));
}

void golden_vectors(golden_report *report)
{
    static const struct {
        const char *name;
        void (*add)(golden_inputs_t *inputs, uint64_t *digest);
    } functions[] = {
        {"arithmetic", arithmetic},
        {"div", division},
        {"sqrt", root},
        {"sincos", sine_and_cosine},
        {"atan2", arc_tangent},
        {"transform", transforms},
        {"rotor", rotor_movement},
        {"mean_current", mean_current},
        {"predictor", prediction},
        {"current_control", current_control},
        {"modulation", modulation},
        {"six_step", six_step},
        {"predictor_exact", golden_exact},
        {"predictor_salient", golden_salient},
        {"extension", golden_extension},
        {"mean_modulated", golden_modulated},
        {"induction", golden_induction},
        {"predictive_control", golden_predictive_control},
        {"angle_sensors", golden_angle_sensors},
        {"start_and_watch", golden_start_and_watch},
        {"commission", golden_commission},
        {"overmodulation", golden_overmodulation},
        {"reference", golden_reference},
        {"ripple_half", golden_ripple_half},
        {"tuned_and_watched", golden_tuned_and_watched},
        {"sensorless", golden_sensorless},
        {"pattern", golden_pattern},
        {"edges", golden_edges},
        {"pattern_control", golden_pattern_control},
        {"pulse_mode", golden_pulse_mode},
        {"recorder", golden_recorder},
    };
    for (uint32_t k = 0; k < sizeof functions / sizeof functions[0]; k++) {
        golden_inputs_t inputs = {0, GOLDEN_SEED};
        uint64_t digest = DIGEST_START;
        for (uint32_t n = 0; n < GOLDEN_INPUTS; n++) {
            functions[k].add(&inputs, &digest);
        }
        report(functions[k].name, digest);
    }
    (void)golden_cycle(report);
}
