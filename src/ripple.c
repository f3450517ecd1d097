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
