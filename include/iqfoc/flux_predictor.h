/*
 * One-cycle current prediction by flux linkage: for machines with L_d != L_q, for saturation, and for the voltage
 * that really acts.
 *
 * In the stationary frame Faraday's law needs no model of the rotor, so that only the drop over R is approximated:
 *
 *     psi(T) = psi(0) + integral of (u - R i),     psi = e^(j theta) (L_d i_d + psi_f, L_q i_q)
 *
 * The current is converted to flux at the angle of the cycle's start and back at the angle of its end. Saliency, EMF
 * and the rotor's movement are exact at any speed. R and dead time act on the mean current of the cycle, (i(0) +
 * i(T))/2, from a first pass that uses i(0) instead. With R T/L = 0.02 the residual error is 0.006 % of the rated
 * current at 0.1 rad a cycle, 0.13 % at 0.5 and 0.45 % at 1 (tests/unit/library/test_flux_predictor.c).
 *
 * Saturation is L_0/(1 + (i/I_sat)^2) on both axes with i^2 = 2 (L_d i_d^2 + L_q i_q^2)/(L_d + L_q). For L_d = L_q
 * this is |i|^2; otherwise it follows from the energy, because the flux must be a gradient. Let y be the current that
 * an unsaturated machine would have at the same flux. Then i = y (1 + s i^2) has the solution i = y * 2/(1 + sqrt(1 -
 * 4 s y^2)) without iteration, s = (I_b/I_sat)^2 and y^2 in the same measure.
 *
 * With compensated duties and a corrected DC link (extension.h) the commanded voltage acts. Then give this predictor
 * an extension that corrects only the saturation.
 */
#ifndef IQFOC_FLUX_PREDICTOR_H
#define IQFOC_FLUX_PREDICTOR_H

#include "extension.h"
#include "iq24_sincos.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Flux in per-unit voltage times cycles, U_b T. Made by iqfoc/extension_params.h. */
typedef struct iqfoc_flux_predictor {
    iq24_t l_d;  /* L_d I_b / (U_b T): 1/16 ... 8; at zero current, if it saturates */
    iq24_t l_q;  /* likewise */
    iq24_t k_d;  /* 1/l_d */
    iq24_t k_q;  /* 1/l_q */
    iq24_t r;    /* R I_b / U_b: 0 ... 1 */
    iq24_t psi;  /* psi_f / (U_b T): 0 ... 16 */
    iq24_t skew; /* (l_d - l_q)/(l_d + l_q), between -1 and 1; needed for saturation only, otherwise 0 */
} iqfoc_flux_predictor_t;

/*
 * Checks that all values are within their ranges; that k_d, k_q are the reciprocals of l_d, l_q (to 2^-10); and that
 * skew is 0 or matches l_d and l_q (its product with their sum to 2^-10; an error of skew is one of l_q). The error
 * names the value. Call it once, before the drive runs.
 */
iqfoc_error_t iqfoc_flux_predictor_check(const iqfoc_flux_predictor_t *predictor);

/*
 * The current at the start of the next cycle. It only reads its arguments: any context.
 *
 * i: true current at the start, |i| <= 8 and |l i| <= 32. u: commanded voltage, |u| <= 2; the extension turns
 * it into what acts. start, end: sine and cosine of the true rotor angle at both ends of the cycle. Out: held
 * to +-32 a component in the rotor frame. Largest error of 200000 drawn, against the formula in double with
 * the same constants: 8 + 2.5 (k_d + k_q) LSB, twice that with saturation.
 *
 * Range, of lengths, which no turn changes: |l i| <= 32 (four times the rated current for the largest l) and
 * psi <= 16, so the flux is within 48; the acting voltage adds 2 * 2 + 1/3, the drop of the mean of i and a
 * held prediction r (8 + 32 sqrt(2))/2 <= 26.7. Their sum, 79, is within the 90.6 that iqfoc_park makes of
 * its largest argument, and below 128: no wrap.
 */
iqfoc_ab_t iqfoc_flux_predictor_step(const iqfoc_flux_predictor_t *predictor,
                                     const iqfoc_extension_t *extension, iqfoc_ab_t i, iqfoc_ab_t u,
                                     iq24_sincos_t start, iq24_sincos_t end);

#ifdef __cplusplus
}
#endif

#endif
