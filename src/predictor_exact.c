/*
 * The coefficients of exact prediction and mean, in fixed point (docs/exact-prediction.md).
 *
 * With y = -1 ... 1 over the span, G is an integral over the span's memory of the EMF:
 *
 *     G = 1/2 int e^(-(rho/2)(1 - y)) e^(j phi y/2) dy
 *
 * Its power series in phi needs only the moments of the memory, which come from a recursion that runs
 * downwards and never divides by rho:
 *
 *     p_n = int e^(-(rho/2)(1 - y)) y^n dy,       p_(n-1) = (1 - (-1)^n E - (rho/2) p_n)/n
 *
 * The mean's memory is that of all later instants, and its moments follow from the same:
 *
 *     q_n = ((-1)^n p_0/2 + p_(n+1)/2)/(n+1)
 */
#include "iqfoc/predictor_exact.h"

#include "series.h"

/*
 * Moments 0 ... 2 TERMS are needed. The recursion starts at MOMENT_START with 0 in place of at most 2/21; each step
 * down divides that error by 2 n or more: below 1e-9 at moment 13.
 */
enum { MOMENTS = 2 * IQFOC_EXACT_TERMS + 1, MOMENT_START = 20, EXPONENTIAL_TERMS = 13 };

/*
 * e^-rho in Q30 by Horner's rule on 1 - rho (1 - rho/2 (1 - rho/3 ( ...
 *
 * Range: 0 <= rho <= 1; each bracket lies in [0, 1]. Error: the series ends below 1/14! = 1.1e-11; roundings
 * below 2 units of Q30.
 */
static int32_t exponential_q30(int32_t rho_q30)
{
    const int32_t one = INT32_C(1) << 30;
    int32_t bracket = one;
    for (int32_t n = EXPONENTIAL_TERMS; n >= 1; n--) {
        bracket = one - iq24_mul_shift(rho_q30 / n, bracket, 30);
    }
    return bracket;
}

/* The moments p_0 ... of the memory in Q29, and E. */
typedef struct memory {
    int32_t E_q30;
    int32_t p_q29[MOMENTS];
} memory;

/*
 * Range: 0 <= p_n <= 2/(n+1), so p_n <= 2^30 in Q29; 1 + E <= 2 is 2^30, and the difference is n p_(n-1).
 * Error: below 2 units of Q29, as each moment divides the one above it by 2 n or more.
 */
static memory memory_of(int32_t rho_q30)
{
    memory m = {.E_q30 = exponential_q30(rho_q30)};
    const int32_t one = INT32_C(1) << 29;
    const int32_t E = iq24_asr32(m.E_q30 + 1, 1);
    int32_t p = 0;
    for (int32_t n = MOMENT_START; n >= 1; n--) {
        const int32_t ends = n % 2 == 0 ? one - E : one + E;
        p = (ends - iq24_mul_shift(p, rho_q30, 31)) / n; /* p rho/2: Q29 Q30 2^-31 */
        if (n <= MOMENTS) {
            m.p_q29[n - 1] = p;
        }
    }
    return m;
}

/* (pi/2)^2 in Q29: 1324675878.97. */
#define HALF_PI_SQUARED_Q29 INT32_C(1324675879)
/* pi/4 in Q31: 1686629713.07. */
#define QUARTER_PI_Q31 INT32_C(1686629713)

/*
 * The law whose memory has these moments, in Q29 with a factor of 1/2 to come.
 *
 *     k_psi phi Re G = x k_psi 2 pi s  sum (-1)^k ((pi s/2)^2)^k w^k/(2k)!    m_2k/2
 *     k_psi phi Im G = w k_psi 2 pi s (pi s/4) sum (-1)^k ((pi s/2)^2)^k w^k/(2k+1)! m_(2k+1)/2
 *
 * Range: k_psi 2 pi s <= 50.3 and m/2 <= 1: below 2^31 in Q25; every later factor is at most (pi/2)^2/2
 * = 1.24 for k = 1 of the first sum, where m_2/2 <= 1/3 makes up for it, and below 0.42 from then on.
 */
static void series(iqfoc_exact_law_t *law, const int32_t moment_q29[], int32_t k_psi_q27, iq24_t span)
{
    const int32_t span_q30 = span * 64;
    const int32_t square = iq24_mul_shift(span_q30, span_q30, 30);
    const int32_t reach_q29 = iq24_mul_shift(HALF_PI_SQUARED_Q29, square, 30);
    int32_t even_q25 = iq24_mul_shift(iq24_mul_shift(k_psi_q27, IQFOC_Q28_2_PI, 30), span_q30, 30);
    int32_t odd_q25 = iq24_mul_shift(even_q25, iq24_mul_shift(QUARTER_PI_Q31, span_q30, 30), 31);
    for (int32_t k = 0; k < IQFOC_EXACT_TERMS; k++) {
        law->real_q25[k] = iq24_mul_shift(even_q25, moment_q29[2 * k], 30);
        law->imag_q25[k] = iq24_mul_shift(odd_q25, moment_q29[2 * k + 1], 30);
        even_q25 = -iq24_mul_shift(even_q25, reach_q29 / ((2 * k + 1) * (2 * k + 2)), 29);
        odd_q25 = -iq24_mul_shift(odd_q25, reach_q29 / ((2 * k + 2) * (2 * k + 3)), 29);
    }
}

/* Common values of both laws: rho and k_u of the span. Range: the span is at most 1. */
static int32_t over_span(int32_t per_cycle, iq24_t span)
{
    return iq24_mul_shift(per_cycle, span, 24);
}

iqfoc_exact_law_t iqfoc_exact_prediction(const iqfoc_exact_winding_t *winding, iq24_t span)
{
    const memory m = memory_of(over_span(winding->rho_q30, span));
    iqfoc_exact_law_t law;
    law.stays_q26 = iq24_asr32(m.E_q30 + 8, 4);
    law.k_u_q26 = iq24_mul_shift(over_span(winding->k_u_q26, span), m.p_q29[0], 30);
    series(&law, m.p_q29, winding->k_psi_q27, span);
    return law;
}

iqfoc_exact_law_t iqfoc_exact_mean(const iqfoc_exact_winding_t *winding, iq24_t span)
{
    const memory m = memory_of(over_span(winding->rho_q30, span));
    int32_t q_q29[MOMENTS - 1]; /* |p_n| <= p_0 <= 2^30 and p_n < 1 past it: no sum reaches 2^31 */
    for (int32_t n = 0; n < MOMENTS - 1; n++) {
        const int32_t end = n % 2 == 0 ? m.p_q29[0] : -m.p_q29[0];
        q_q29[n] = (end + m.p_q29[n + 1]) / (2 * (n + 1));
    }
    iqfoc_exact_law_t law;
    law.stays_q26 = iq24_asr32(m.p_q29[0] + 8, 4); /* p_0/2 */
    law.k_u_q26 = iq24_mul_shift(over_span(winding->k_u_q26, span), q_q29[0], 30);
    series(&law, q_q29, winding->k_psi_q27, span);
    return law;
}

/*
 * Range: |x| <= 2^24/3, so 2 x in Q32 is |512 x| <= 2^33/3 and too long; 256 x squared, times 4, is below
 * 2^31: w <= 4/9.
 * Horner's rule in Q25, both polynomials side by side: the coefficients alternate and fall, |P| <= 50.3 < 64.
 * Error: half a unit a step, later ones times w: below 0.9 units.
 */
iqfoc_exact_t iqfoc_exact_at_speed(const iqfoc_exact_law_t *law, iq24_t speed)
{
    return iqfoc_exact_at_speed_inline(law, iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
}
