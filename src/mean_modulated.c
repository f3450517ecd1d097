/* The coefficients of the mean under modulation at a speed (iqfoc/mean_modulated.h). */
#include "iqfoc/mean_modulated.h"

/*
 * s2/phi = 1/12 - h2/120 + h2^2/3360 - h2^3/181440, h2 = (phi/2)^2: its series, which needs no division.
 *
 * Range: 0 <= h2 <= 1.097. Error: the next term is below 1.5e-7 at the limit of the speed.
 */
static iq24_t bow_of(iq24_t h2)
{
    iq24_t sum = IQ24(1.0 / 3360.0) - iq24_mul_round(IQ24(1.0 / 181440.0), h2);
    sum = IQ24(1.0 / 120.0) - iq24_mul_round(sum, h2);
    return IQ24(1.0 / 12.0) - iq24_mul_round(sum, h2);
}

/* Range: k_psi (1 - s1^2) <= 8 * 0.32; k_u phi <= 33.6. */
iqfoc_mean_modulated_t iqfoc_mean_modulated_at_speed(const iqfoc_predictor_t *predictor,
                                                     const iqfoc_rotor_t *rotor)
{
    const iq24_t phi2 = iq24_mul_round(rotor->phi, rotor->phi);
    const iq24_t lost = iq24_mul_round(IQ24_ONE - rotor->s1, IQ24_ONE + rotor->s1);
    const iqfoc_mean_modulated_t c = {.half_s1 = iq24_asr32(rotor->s1 + 1, 1),
                                      .s2 = rotor->s2,
                                      .bow = iq24_mul_round(predictor->k_r, bow_of(iq24_asr32(phi2, 2))),
                                      .emf = iq24_mul_round(predictor->k_psi, lost),
                                      .square = phi2 / 80,
                                      .along = iq24_mul_round(predictor->k_u, predictor->k_r) / 24,
                                      .across = iq24_mul_round(predictor->k_u, rotor->phi) / 24};
    return c;
}
