/*
 * One-cycle current prediction by flux linkage: for machines with L_d != L_q, with saturation, and for the
 * voltage that really acts.
 *
 * In the stationary frame Faraday's law needs no model of the rotor at all, and so nothing is approximated
 * but the drop over R:
 *
 *     psi(T) = psi(0) + integral of (u - R i),     psi = e^(j theta) (L_d i_d + psi_f, L_q i_q)
 *
 * The current is turned into flux at the angle of the cycle's start and back at the angle of its end;
 * saliency, EMF and the rotor's movement are exact at any speed. R and dead time see the current's mean over
 * the cycle, (i(0) + i(T))/2, from a first pass that has i(0) in its place. With R T/L = 0.02 what is left is
 * 0.006 % of the rated current at 0.1 rad a cycle, 0.13 % at 0.5 and 0.45 % at 1
 * (tests/unit/test_flux_predictor.c).
 *
 * Saturation, L_0/(1 + (i/I_sat)^2) on both axes, i^2 = 2 (L_d i_d^2 + L_q i_q^2)/(L_d + L_q), which is |i|^2
 * where the axes are alike; otherwise by the energy, or the flux would be no gradient. With y the current that an
 * unsaturated machine would have at the same flux, i = y (1 + s i^2) has the solution
 * i = y * 2/(1 + sqrt(1 - 4 s y^2)), s = (I_b/I_sat)^2 and y^2 in the same measure, no iteration.
 *
 * A drive whose duties are compensated and whose DC link is corrected (extension.h) makes the voltage that it
 * commands: it gives this predictor an extension that puts nothing right but the saturation.
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
    iq24_t skew; /* (l_d - l_q)/(l_d + l_q), between -1 and 1; of use to saturation alone, else 0 will do */
} iqfoc_flux_predictor_t;

/*
 * Are all values within their ranges, and k_d, k_q the reciprocals of l_d, l_q (to 2^-10), and skew nought or
 * theirs (its product with their sum to 2^-10; an error of skew is one of l_q)? The error names the value.
 */
iqfoc_error_t iqfoc_flux_predictor_check(const iqfoc_flux_predictor_t *predictor);

/*
 * The current at the start of the next cycle.
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
