/*
 * Digests of the exact predictors and of the corrections from a diagnosis (golden_vectors.h). Inputs keep to
 * each function's stated range.
 */
#include "golden_models.h"

#include "golden_types.h"

#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/extension.h"
#include "iqfoc/finite_set.h"
#include "iqfoc/induction.h"
#include "iqfoc/mean_modulated.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_form.h"
#include "iqfoc/predictor_salient.h"

static void add_exact(uint64_t *digest, const iqfoc_exact_law_t *law, golden_inputs_t *inputs)
{
    const iqfoc_exact_t exact = iqfoc_exact_at_speed(law, golden_within(inputs, IQFOC_ROTOR_SPEED_MAX));
    const iqfoc_ab_t i = golden_ab(inputs, IQ24(16.0));
    const iqfoc_ab_t u = golden_ab(inputs, IQ24_ONE);
    const iqfoc_ab_t next = iqfoc_exact_step(&exact, i, u, iq24_sincos(golden_within(inputs, IQ24_ONE)));
    digest_add(digest, exact.stays_q26);
    digest_add(digest, exact.k_u_q26);
    digest_add(digest, exact.w_real_q26);
    digest_add(digest, exact.w_imag_q26);
    digest_ab(digest, next);
}

void golden_exact(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_exact_winding_t winding;
    winding.rho_q30 = golden_positive(inputs, INT32_C(1) << 30);
    winding.k_u_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    winding.k_psi_q27 = golden_positive(inputs, INT32_C(1) << 30);
    const iq24_t span = 1 + golden_positive(inputs, IQ24_ONE - 1);
    const iqfoc_exact_law_t end = iqfoc_exact_prediction(&winding, span);
    const iqfoc_exact_law_t mean = iqfoc_exact_mean(&winding, span);
    add_exact(digest, &end, inputs);
    add_exact(digest, &mean, inputs);
}

static void add_salient(uint64_t *digest, const iqfoc_salient_t *salient, iqfoc_dq_t i, iqfoc_dq_t u)
{
    const iqfoc_dq_t next = iqfoc_salient_step(salient, i, u);
    digest_add(digest, salient->d.i_d_q26);
    digest_add(digest, salient->q.constant_q26);
    digest_dq(digest, next);
}

void golden_salient(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_salient_machine_t machine;
    iqfoc_salient_t end;
    iqfoc_salient_t mean;
    machine.rho_d_q30 = golden_positive(inputs, INT32_C(1) << 30);
    machine.rho_q_q30 = golden_positive(inputs, INT32_C(1) << 30);
    machine.k_d_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    machine.k_q_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    machine.k_psi_d_q27 = golden_positive(inputs, INT32_C(1) << 30);
    machine.k_psi_q_q27 = golden_positive(inputs, INT32_C(1) << 30);
    /* L_q/L_d and its inverse: 1/2 ... 2, each on its own; the bits do not ask whether the pair is
     * consistent. */
    machine.q_to_d_q27 = (INT32_C(1) << 26) + golden_positive(inputs, INT32_C(3) << 26);
    machine.d_to_q_q27 = (INT32_C(1) << 26) + golden_positive(inputs, INT32_C(3) << 26);
    const iq24_t speed = golden_within(inputs, IQFOC_ROTOR_SPEED_MAX);
    iqfoc_salient_at_speed(&machine, speed, 1 + golden_positive(inputs, IQ24_ONE - 1), &end, &mean);
    const iqfoc_dq_t i = golden_dq(inputs, IQ24_ONE);
    const iqfoc_dq_t u = golden_dq(inputs, IQ24_ONE);
    add_salient(digest, &end, i, u);
    add_salient(digest, &mean, i, u);
}

void golden_extension(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_extension_t extension = {.k_u = IQ24_ONE};
    const iqfoc_abc_t gains = golden_abc(inputs, IQ24(0.5));
    extension.i_offset = golden_abc(inputs, IQ24_ONE);
    extension.i_gain_inverse.a = IQ24_ONE + gains.a;
    extension.i_gain_inverse.b = IQ24_ONE + gains.b;
    extension.i_gain_inverse.c = IQ24_ONE + gains.c;
    extension.theta_0 = golden_within(inputs, IQ24(0.5));
    extension.theta_delay = golden_within(inputs, IQ24(8.0));
    extension.v_dead = golden_within(inputs, IQ24(0.25));
    extension.knee_inverse = golden_positive(inputs, IQ24(127.0));
    digest_add(digest, (int32_t)iqfoc_extension_check(&extension));
    digest_abc(digest, iqfoc_extension_current(&extension, golden_abc(inputs, IQ24(4.0))));
    const iq24_t theta = golden_within(inputs, IQ24_ONE);
    const iq24_t speed = golden_within(inputs, IQFOC_ROTOR_SPEED_MAX);
    digest_add(digest, iqfoc_extension_angle(&extension, theta, speed));
    digest_abc(digest, iqfoc_extension_lost(&extension, golden_abc(inputs, IQ24(4.0))));
}

static iqfoc_abc_t duties(golden_inputs_t *inputs)
{
    iqfoc_abc_t high;
    high.a = golden_positive(inputs, IQ24_ONE);
    high.b = golden_positive(inputs, IQ24_ONE);
    high.c = golden_positive(inputs, IQ24_ONE);
    return high;
}

void golden_modulated(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_predictor_t machine;
    machine.k_u = 1 + golden_positive(inputs, IQ24(16.0) - 1);
    machine.k_r = golden_positive(inputs, IQ24_ONE);
    machine.k_psi = golden_positive(inputs, IQ24(8.0));
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(golden_within(inputs, IQFOC_ROTOR_SPEED_MAX));
    const iqfoc_mean_modulated_t c = iqfoc_mean_modulated_at_speed(&machine, &rotor);
    const iqfoc_ab_t i = golden_ab(inputs, IQ24(32.0));
    const iqfoc_ab_t i_next = golden_ab(inputs, IQ24(32.0));
    const iqfoc_abc_t high = duties(inputs);
    const iq24_t u_dc = golden_positive(inputs, IQ24(2.0));
    const iq24_sincos_t sc = iq24_sincos(golden_within(inputs, IQ24_ONE));
    const iqfoc_dq_t mean = iqfoc_mean_modulated(&c, i, i_next, high, u_dc, sc);
    digest_dq(digest, mean);
    iqfoc_salient_machine_t salient = {0};
    salient.rho_d_q30 = golden_positive(inputs, INT32_C(1) << 30);
    salient.rho_q_q30 = golden_positive(inputs, INT32_C(1) << 30);
    salient.k_d_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    salient.k_q_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    const iqfoc_ripple_t ripple = iqfoc_ripple_at_speed(&salient, &rotor);
    const iqfoc_dq_t part = iqfoc_ripple_seen(&ripple, high, u_dc, sc);
    digest_dq(digest, part);
}

void golden_induction(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_induction_machine_t machine;
    machine.rho_s_q30 = golden_positive(inputs, INT32_C(1) << 29);
    machine.rho_r_q30 = golden_positive(inputs, INT32_C(1) << 29);
    machine.a_q30 = golden_positive(inputs, INT32_C(107374182)); /* 0.1 */
    machine.k_u_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    const iq24_t speed = golden_within(inputs, IQFOC_ROTOR_SPEED_MAX);
    const iqfoc_induction_t c =
        iqfoc_induction_at_speed(&machine, speed, 1 + golden_positive(inputs, IQ24_ONE - 1));
    iqfoc_induction_state_t x;
    x.i = golden_ab(inputs, IQ24(5.6));
    x.flux = golden_ab(inputs, IQ24(11.3));
    const iqfoc_ab_t u = golden_ab(inputs, IQ24(1.4));
    const iqfoc_ab_t v = iqfoc_ripple_vector(duties(inputs), 0, IQ24_ONE);
    const iqfoc_induction_state_t next = iqfoc_induction_step(&c, x, u);
    digest_ab(digest, next.i);
    digest_ab(digest, next.flux);
    digest_ab(digest, iqfoc_induction_mean(&c, x, u));
    digest_ab(digest, iqfoc_induction_with_ripple(&c.i, next.i, v));
}

/* The three predictors in turn, deadbeat with and without disturbance observer, and a search of two intervals. */
void golden_predictive_control(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_predictor_t machine;
    machine.k_u = IQ24(1.0 / 64.0) + golden_positive(inputs, IQ24(15.9));
    machine.k_r = golden_positive(inputs, IQ24_ONE);
    machine.k_psi = golden_positive(inputs, IQ24(8.0));
    const iqfoc_exact_winding_t winding = {machine.k_r * 64, machine.k_u * 4, machine.k_psi * 8};
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(golden_within(inputs, IQFOC_ROTOR_SPEED_MAX));
    const iqfoc_exact_t models[] = {iqfoc_form_euler(&machine, &rotor),
                                    iqfoc_form_quasi_discrete(&machine, &rotor),
                                    iqfoc_exact_at_speed(&law, rotor.speed)};
    const iqfoc_deadbeat_t deadbeat = {models[inputs->number % 3], iqfoc_deadbeat_inverse(law.k_u_q26),
                                       iqfoc_valley_reference_at(&rotor, machine.k_psi)};
    const iqfoc_ab_t i = golden_ab(inputs, IQ24(15.0));
    const iqfoc_ab_t u = golden_ab(inputs, IQ24_ONE);
    const iqfoc_ab_t want = golden_ab(inputs, IQ24(15.0));
    const iqfoc_dq_t i_ref = {want.alpha, want.beta};
    const iq24_t theta = golden_within(inputs, IQ24_ONE);
    digest_ab(digest, iqfoc_deadbeat_step(&deadbeat, i, u, i_ref, theta, rotor.speed));
    iqfoc_deadbeat_drift_t drift = {{0, 0}, golden_ab(inputs, IQ24(15.0)), true};
    const iq24_t gain = golden_positive(inputs, IQ24_ONE);
    digest_ab(digest, iqfoc_deadbeat_drift_step(&drift, &deadbeat, gain, i, u, i_ref, theta, rotor.speed));
    digest_ab(digest, drift.i_next);
    const iqfoc_finite_set_t set = {deadbeat.model, deadbeat.reference, gain, 2};
    uint32_t nodes = 0;
    digest_add(digest, iqfoc_finite_set_choose(&set, i, gain % IQFOC_FINITE_SET_STATES, i_ref, theta,
                                               rotor.speed, golden_positive(inputs, IQ24(2.0)), &nodes));
    digest_add(digest, (int32_t)nodes);
}
