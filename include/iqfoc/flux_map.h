/*
 * One-cycle current prediction by a flux map: for iron that loses much of its inductance, each axis by its own and by
 * the other's current. Like flux_predictor.h, with the map that a diagnosis fits (docs/diagnosis.md, "Flux maps").
 *
 *     psi_d = l_d i_d + psi + sum of a_d x/rho     x = k_d i_d - x_0     rho = sqrt(1 + x^2 + y^2)
 *     psi_q = l_q i_q       + sum of a_q y/rho     y = k_q i_q           a_d = e k_d, a_q = e k_q
 *
 * Straight iron, the magnet, and up to two parts that saturate. The flux is the gradient of a convex energy, so that
 * each flux has one current, at any current.
 *
 *     psi(T) = psi(0) + integral of (u - R i)
 *
 * as in flux_predictor.h: R and dead time act on the mean current of the cycle, from a first pass. The current of a flux
 * is found by Newton's method from the current at the start: one step for the first pass, two for the second. The steps
 * are held to 1, 1/2 and 1/4 of the rated current a component. Without that limit, steps from saturated iron to
 * unsaturated iron grow.
 *
 * Three steps leave, of 100000 drawn cycles with R T/L up to 0.05 and up to twice the rated current, in percent of that:
 * 0.02 % rms and 1.0 % at most if the current changes by up to a quarter of it in the cycle, 0.08 % and 5.2 % up to a
 * half, 0.27 % and 12.5 % up to the whole. With R T/L = 0.02 the residual error of the formula is 0.004 % at 0.1 rad a cycle
 * and 0.03 % at 0.3 (tests/unit/library/test_flux_map.c).
 *
 * The saturation of the extension is not used; its voltage corrections are.
 */
#ifndef IQFOC_FLUX_MAP_H
#define IQFOC_FLUX_MAP_H

#include "extension.h"
#include "iq24_sincos.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_FLUX_MAP_PARTS 2

/* A part of the iron that saturates: energy E, the currents I_d and I_q at which it does, I_c about which it is alike. */
typedef struct iqfoc_flux_map_part {
    iq24_t e;   /* E / (U_b T I_b): 0 ... 64; 0: no part, the other values are not used */
    iq24_t k_d; /* I_b / I_d: 1/16 ... 10 */
    iq24_t k_q; /* I_b / I_q: 1/16 ... 10 */
    iq24_t x_0; /* I_c / I_d: -16 ... 16 */
} iqfoc_flux_map_part_t;

/* Flux in per-unit voltage times cycles, U_b T. Made by iqfoc/extension_params.h. */
typedef struct iqfoc_flux_map {
    iq24_t l_d; /* straight iron, L I_b / (U_b T): 1/64 ... 8 */
    iq24_t l_q; /* likewise */
    iq24_t r;   /* R I_b / U_b: 0 ... 1 */
    iq24_t psi; /* (psi_f + sum of E/I_d x_0/sqrt(1 + x_0^2)) / (U_b T): -16 ... 16 */
    iqfoc_flux_map_part_t part[IQFOC_FLUX_MAP_PARTS];
} iqfoc_flux_map_t;

/*
 * Checks that all values are within their ranges; that the parts' fluxes e k_d and e k_q have sums of 16 at most; and
 * that l_d plus all e k_d^2, and l_q plus all e k_q^2, are 64 at most. The error names the value: IQFOC_ERROR_FLUX_PART
 * for those of the parts and their sums. Call it once, before the drive runs.
 */
iqfoc_error_t iqfoc_flux_map_check(const iqfoc_flux_map_t *map);

/*
 * The current at the start of the next cycle. It only reads its arguments: any context.
 *
 * i: true current at the start, |i| <= 8 and |l i| <= 32. u: commanded voltage, |u| <= 2; the extension turns it
 * into what acts. start, end: sine and cosine of the true rotor angle at both ends of the cycle. Out: |component| <=
 * 9.75 in the rotor frame. Largest error of 100000 drawn, against the same steps in double with the same constants:
 * 8 + (2.5 + a)(1/l_d + 1/l_q) LSB with the sum a of all e k_d and e k_q.
 *
 * Range, of lengths, which no turn changes: |l i| <= 32, psi <= 16 and the parts' flux, 16 at most, are 64; the acting
 * voltage adds 2 * 2 + 1/3, the drop of the mean of i and a prediction r (8 + 9.75 sqrt(2))/2 <= 10.9. Their sum, 80, is
 * within the 90.6 that iqfoc_park makes of its largest argument, and below 128: no wrap. A component of i is held to 8
 * in the rotor frame, so that any i leaves every value within iq24_t.
 */
iqfoc_ab_t iqfoc_flux_map_step(const iqfoc_flux_map_t *map, const iqfoc_extension_t *extension, iqfoc_ab_t i,
                               iqfoc_ab_t u, iq24_sincos_t start, iq24_sincos_t end);

#ifdef __cplusplus
}
#endif

#endif
