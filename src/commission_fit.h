/* The estimators of self-commissioning on the means of 32 blocks (include/iqfoc/commission.h). Private to src/. */
#ifndef IQFOC_SRC_COMMISSION_FIT_H
#define IQFOC_SRC_COMMISSION_FIT_H

#include "iqfoc/commission.h"

/* A straight line y = a + b x by least squares, |x| and |y| <= 8 per unit. */
typedef struct {
    iqfoc_commission_value_t at_zero; /* a */
    iqfoc_commission_value_t slope;   /* b */
} commission_line_t;

/* Mean of a block's sum of 2^n terms, n >= 1, to nearest. */
iq24_t commission_block_mean(int64_t sum, uint32_t n);

/* Mean of the blocks, |x| <= 64; exact to 0.5 LSB. */
iq24_t commission_mean(const iq24_t x[IQFOC_COMMISSION_BLOCKS]);

/* The line and its half widths. Largest error: a and b 1.5 LSB; half widths 2 LSB too small, 4 too large. */
commission_line_t commission_line(const iq24_t x[IQFOC_COMMISSION_BLOCKS],
                                  const iq24_t y[IQFOC_COMMISSION_BLOCKS]);

/* The mean with its half width. */
iqfoc_commission_value_t commission_spread(const iq24_t x[IQFOC_COMMISSION_BLOCKS]);

/* L of the blocks' D and S by the results R and v_dead, with its half width. */
iqfoc_commission_value_t commission_inductance(const iqfoc_commission_result_t *known,
                                               const iq24_t d[IQFOC_COMMISSION_BLOCKS],
                                               const iq24_t s[IQFOC_COMMISSION_BLOCKS], iq24_t h_u);

/* Means in the frame of the commanded angle: current, voltage. */
typedef struct {
    iqfoc_dq_t i;
    iqfoc_dq_t u;
} commission_means_t;

/* psi_f of one block; phi_s1: 2 sin(phi/2). */
iq24_t commission_flux(const iqfoc_commission_result_t *known, const commission_means_t *means,
                       iq24_t phi_s1);

/* The half width that the parameters in `known` add to it. */
iq24_t commission_flux_half(const iqfoc_commission_result_t *known, const commission_means_t *means,
                            iq24_t phi_s1);

/* Whether a current i_align aligns the rotor's d axis, by the results and the share `across` of the header. Range: 1/16 <= L <= 8. */
bool commission_aligns(const iqfoc_commission_result_t *known, iq24_t across, iq24_t i_align);

/* sqrt(a^2 + b^2), at most 1 LSB too small. */
iq24_t commission_both(iq24_t a, iq24_t b);

#endif
