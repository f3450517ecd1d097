/*
 * Digests of the exact predictors and of the corrections from a diagnosis (golden_vectors.h). Inputs keep to
 * each function's stated range.
 */
#include "golden_models.h"

#include "digest.h"

#include "iqfoc/extension.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"

static int32_t positive(golden_inputs_t *inputs, int32_t limit)
{
    return iq24_abs_sat(golden_within(inputs, limit));
}

static void add_exact(uint64_t *digest, const iqfoc_exact_law_t *law, golden_inputs_t *inputs)
{
    const iqfoc_exact_t exact = iqfoc_exact_at_speed(law, golden_within(inputs, IQFOC_ROTOR_TURNS_MAX));
    iqfoc_ab_t i;
    iqfoc_ab_t u;
    i.alpha = golden_within(inputs, IQ24(16.0));
    i.beta = golden_within(inputs, IQ24(16.0));
    u.alpha = golden_within(inputs, IQ24_ONE);
    u.beta = golden_within(inputs, IQ24_ONE);
    const iqfoc_ab_t next = iqfoc_exact_step(&exact, i, u, iq24_sincos(golden_within(inputs, IQ24_ONE)));
    digest_add(digest, exact.stays_q26);
    digest_add(digest, exact.k_u_q26);
    digest_add(digest, exact.w_real_q26);
    digest_add(digest, exact.w_imag_q26);
    digest_add(digest, next.alpha);
    digest_add(digest, next.beta);
}

void golden_exact(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_exact_winding_t winding;
    winding.rho_q30 = positive(inputs, INT32_C(1) << 30);
    winding.k_u_q26 = 1 + positive(inputs, (INT32_C(1) << 30) - 1);
    winding.k_psi_q27 = positive(inputs, INT32_C(1) << 30);
    const iq24_t span = 1 + positive(inputs, IQ24_ONE - 1);
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
    digest_add(digest, next.d);
    digest_add(digest, next.q);
}

void golden_salient(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_salient_machine_t machine;
    iqfoc_salient_t end;
    iqfoc_salient_t mean;
    machine.rho_d_q30 = positive(inputs, INT32_C(1) << 30);
    machine.rho_q_q30 = positive(inputs, INT32_C(1) << 30);
    machine.k_d_q26 = 1 + positive(inputs, (INT32_C(1) << 30) - 1);
    machine.k_q_q26 = 1 + positive(inputs, (INT32_C(1) << 30) - 1);
    machine.k_psi_d_q27 = positive(inputs, INT32_C(1) << 30);
    machine.k_psi_q_q27 = positive(inputs, INT32_C(1) << 30);
    /* L_q/L_d and its inverse: 1/2 ... 2, each on its own; the bits do not ask whether the pair is
     * consistent. */
    machine.q_to_d_q27 = (INT32_C(1) << 26) + positive(inputs, INT32_C(3) << 26);
    machine.d_to_q_q27 = (INT32_C(1) << 26) + positive(inputs, INT32_C(3) << 26);
    const iq24_t turns = golden_within(inputs, IQFOC_ROTOR_TURNS_MAX);
    iqfoc_salient_at_speed(&machine, turns, 1 + positive(inputs, IQ24_ONE - 1), &end, &mean);
    iqfoc_dq_t i;
    iqfoc_dq_t u;
    i.d = golden_within(inputs, IQ24_ONE);
    i.q = golden_within(inputs, IQ24_ONE);
    u.d = golden_within(inputs, IQ24_ONE);
    u.q = golden_within(inputs, IQ24_ONE);
    add_salient(digest, &end, i, u);
    add_salient(digest, &mean, i, u);
}

static iqfoc_abc_t phases(golden_inputs_t *inputs, iq24_t limit)
{
    iqfoc_abc_t abc;
    abc.a = golden_within(inputs, limit);
    abc.b = golden_within(inputs, limit);
    abc.c = golden_within(inputs, limit);
    return abc;
}

static void add_phases(uint64_t *digest, iqfoc_abc_t abc)
{
    digest_add(digest, abc.a);
    digest_add(digest, abc.b);
    digest_add(digest, abc.c);
}

void golden_extension(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_extension_t extension = {.k_u = IQ24_ONE};
    const iqfoc_abc_t gains = phases(inputs, IQ24(0.5));
    extension.i_offset = phases(inputs, IQ24_ONE);
    extension.i_gain_inverse.a = IQ24_ONE + gains.a;
    extension.i_gain_inverse.b = IQ24_ONE + gains.b;
    extension.i_gain_inverse.c = IQ24_ONE + gains.c;
    extension.theta_0 = golden_within(inputs, IQ24(0.5));
    extension.theta_delay = golden_within(inputs, IQ24(8.0));
    extension.v_dead = golden_within(inputs, IQ24(0.25));
    extension.knee_inverse = positive(inputs, IQ24(127.0));
    digest_add(digest, (int32_t)iqfoc_extension_check(&extension));
    add_phases(digest, iqfoc_extension_current(&extension, phases(inputs, IQ24(4.0))));
    const iq24_t theta = golden_within(inputs, IQ24_ONE);
    const iq24_t turns = golden_within(inputs, IQFOC_ROTOR_TURNS_MAX);
    digest_add(digest, iqfoc_extension_angle(&extension, theta, turns));
    add_phases(digest, iqfoc_extension_lost(&extension, phases(inputs, IQ24(4.0))));
}
