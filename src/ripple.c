/* The ripple's coefficients at a speed (iqfoc/ripple.h). */
#include "iqfoc/ripple.h"

/* k x/24, k in Q26 and x in IQ24: |k x| <= 16 * 2.1 is 2^55.1 in Q50, and within IQ24 before the division. */
static iq24_t share(int32_t k_q26, iq24_t x)
{
    return iq24_mul_shift(k_q26, x, 26) / 24;
}

/* Range: phi^2 <= 4.39. */
iqfoc_ripple_t iqfoc_ripple_at_speed(const iqfoc_salient_machine_t *machine, const iqfoc_rotor_t *rotor)
{
    const iqfoc_ripple_t ripple = {.square = iq24_mul_round(rotor->phi, rotor->phi) / 80,
                                   .along_d = share(machine->k_d_q26, iq24_asr32(machine->rho_d_q30 + 32, 6)),
                                   .across_d = share(machine->k_d_q26, rotor->phi),
                                   .along_q = share(machine->k_q_q26, iq24_asr32(machine->rho_q_q30 + 32, 6)),
                                   .across_q = share(machine->k_q_q26, rotor->phi)};
    return ripple;
}

/* k x/12 as above: within 2.8. */
static iq24_t twelfth(int32_t k_q26, iq24_t x)
{
    return iq24_mul_shift(k_q26, x, 26) / 12;
}

/* Range: rho <= 1, so 0.5 <= 1 - rho/2 <= 1 and k times it is within 16, half of it within 8. */
static iq24_t even_share(int32_t k_q26, int32_t rho_q30)
{
    return iq24_asr32(iq24_mul_shift(k_q26, IQ24_ONE - iq24_asr32(rho_q30 + 64, 7), 26), 1);
}

iqfoc_ripple_half_t iqfoc_ripple_half_at_speed(const iqfoc_salient_machine_t *machine,
                                               const iqfoc_rotor_t *rotor)
{
    const iqfoc_ripple_half_t ripple = {
        .square = iq24_mul_round(rotor->phi, rotor->phi) / 24,
        .even_d = even_share(machine->k_d_q26, machine->rho_d_q30),
        .along_d = -twelfth(machine->k_d_q26, iq24_asr32(machine->rho_d_q30 + 32, 6)),
        .across_d = twelfth(machine->k_d_q26, rotor->phi),
        .even_q = even_share(machine->k_q_q26, machine->rho_q_q30),
        .along_q = -twelfth(machine->k_q_q26, iq24_asr32(machine->rho_q_q30 + 32, 6)),
        .across_q = twelfth(machine->k_q_q26, rotor->phi)};
    return ripple;
}

/* One leg's shares of both vectors: within 0.25 and 0.1. */
static void half_of_leg(iq24_t d, iq24_t square, iq24_t *even, iq24_t *odd)
{
    const iq24_t bow = iq24_mul_round(d, IQ24_ONE - d);
    *odd = iq24_mul_round(bow, IQ24_ONE - 2 * d);
    *even = bow - iq24_mul_round(bow, iq24_mul_round(square, IQ24_ONE - 2 * bow));
}

/*
 * Range: vectors of the shares are within 0.34 and 0.13, times u_dc within 0.7 and 0.26, turned as long. In Q48
 * the sums are below 8 0.7 + 4.2 0.26 = 6.7 in per unit.
 */
iqfoc_dq_t iqfoc_ripple_half_seen(const iqfoc_ripple_half_t *ripple, iqfoc_abc_t high, iq24_t u_dc,
                                  bool to_peak, iq24_sincos_t sc_mid)
{
    iqfoc_abc_t even;
    iqfoc_abc_t odd;
    half_of_leg(high.a, ripple->square, &even.a, &odd.a);
    half_of_leg(high.b, ripple->square, &even.b, &odd.b);
    half_of_leg(high.c, ripple->square, &even.c, &odd.c);
    const iq24_t u = to_peak ? -u_dc : u_dc;
    const iqfoc_dq_t v = iqfoc_park(iqfoc_clarke3(even), sc_mid);
    const iqfoc_dq_t w = iqfoc_park(iqfoc_clarke3(odd), sc_mid);
    const iqfoc_dq_t a = {iq24_mul_round(v.d, u), iq24_mul_round(v.q, u)};
    const iqfoc_dq_t b = {iq24_mul_round(w.d, u_dc), iq24_mul_round(w.q, u_dc)};
    const iq24_acc_t d = iq24_acc_mac(iq24_acc_mul(ripple->even_d, a.d), ripple->along_d, b.d);
    const iq24_acc_t q = iq24_acc_mac(iq24_acc_mul(ripple->even_q, a.q), ripple->along_q, b.q);
    const iqfoc_dq_t seen = {iq24_acc_round(iq24_acc_mac(d, -ripple->across_d, b.q)),
                             iq24_acc_round(iq24_acc_mac(q, ripple->across_q, b.d))};
    return seen;
}
