/*
 * Digests of overmodulation, of the current's reference, and of the ripple of half a period (golden_limits.h).
 * Inputs keep to each function's stated range.
 */
#include "golden_limits.h"

#include "golden_types.h"

#include "iqfoc/overmodulation.h"
#include "iqfoc/reference.h"
#include "iqfoc/ripple.h"

/* The length that the last voltages have left is part of the input: it goes on from call to call. */
void golden_overmodulation(golden_inputs_t *inputs, uint64_t *digest)
{
    static iqfoc_overmodulation_t state;
    if (inputs->number++ % 64 == 0) {
        state.length = 0;
    }
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(golden_within(inputs, IQFOC_ROTOR_SPEED_MAX));
    const iq24_t limit = iqfoc_overmodulation_limit(&rotor);
    const iqfoc_ab_t u = golden_ab(inputs, inputs->number % 4 == 0 ? IQ24(22.6) : IQ24(0.6));
    const iq24_t u_dc_inverse =
        1 + golden_positive(inputs, inputs->number % 4 == 0 ? IQ24(2.0) - 1 : IQ24(1.2));
    const iqfoc_duties_t duties = iqfoc_overmodulate(&state, u, u_dc_inverse, limit);
    const iqfoc_duties_t nearest = iqfoc_modulate_nearest(u, u_dc_inverse);
    digest_add(digest, limit);
    digest_abc(digest, duties.high);
    digest_add(digest, duties.scale);
    digest_add(digest, state.length);
    digest_abc(digest, nearest.high);
    digest_add(digest, nearest.scale);
    digest_ab(digest, iqfoc_modulated_voltage(duties.high, golden_positive(inputs, IQ24(2.0))));
}

/* One torque after another: the weakening and the last i_q go on. */
void golden_reference(golden_inputs_t *inputs, uint64_t *digest)
{
    static iqfoc_reference_t state;
    static iqfoc_reference_link_t link;
    iqfoc_reference_config_t config;
    config.i_max = 1 + golden_positive(inputs, IQ24(4.0) - 1);
    config.i_d_min = -golden_positive(inputs, config.i_max);
    config.saliency = golden_within(inputs, IQ24(2.7));
    config.gain = golden_positive(inputs, IQ24(0.5));
    config.share = IQ24(0.5) + golden_positive(inputs, IQ24(0.625));
    if (inputs->number++ % 64 == 0) {
        state.weakening = 0;
        state.i_q = 0;
        link.gain = golden_positive(inputs, IQ24(64.0));
        link.low = golden_positive(inputs, IQ24(1.5));
    }
    state.i_q = iq24_clamp(state.i_q, -config.i_max, config.i_max);
    const iq24_t torque = golden_within(inputs, IQ24(8.0));
    const iqfoc_dq_t u = golden_dq(inputs, IQ24(2.0));
    const iq24_t u_limit =
        iqfoc_reference_link(&state, &link, &config, u, golden_positive(inputs, IQ24(1.5)));
    digest_dq(digest, iqfoc_reference_step(&state, &config, torque, u, u_limit));
    digest_add(digest, u_limit);
    digest_add(digest, link.low);
    digest_add(digest, iq24_acc_round(state.weakening));
    digest_add(digest, (int32_t)iqfoc_reference_check(&config));
}

void golden_ripple_half(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_salient_machine_t machine;
    machine.rho_d_q30 = golden_positive(inputs, INT32_C(1) << 30);
    machine.rho_q_q30 = golden_positive(inputs, INT32_C(1) << 30);
    machine.k_d_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    machine.k_q_q26 = 1 + golden_positive(inputs, (INT32_C(1) << 30) - 1);
    machine.k_psi_d_q27 = 0;
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(golden_within(inputs, IQFOC_ROTOR_SPEED_MAX));
    const iqfoc_ripple_half_t ripple = iqfoc_ripple_half_at_speed(&machine, &rotor);
    iqfoc_abc_t high;
    high.a = golden_positive(inputs, IQ24_ONE);
    high.b = golden_positive(inputs, IQ24_ONE);
    high.c = golden_positive(inputs, IQ24_ONE);
    const iq24_t u_dc = golden_positive(inputs, IQ24(2.0));
    const bool to_peak = inputs->number++ % 2 == 0;
    const iq24_sincos_t sc = iq24_sincos(golden_within(inputs, IQ24_ONE));
    digest_dq(digest, iqfoc_ripple_half_seen(&ripple, high, u_dc, to_peak, sc));
}
