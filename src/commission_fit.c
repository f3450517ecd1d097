/* Estimators of self-commissioning (src/commission_fit.h, derivation: include/iqfoc/commission.h). */
#include "commission_fit.h"

#include "iqfoc/iq24_math.h"
#include "root.h"

#define N            IQFOC_COMMISSION_BLOCKS
#define N_LOG2       5
#define STUDENT      IQ24(2.042)     /* 97.5 %, 30 degrees of freedom */
#define FOUR_OVER_PI IQ24(1.2732395) /* fundamental of a square wave of 1 */
#define CROSSING     32 /* 1/share of the dead time's fundamental that the zero crossings leave unknown */
#define RESIDUAL_MAX IQ24(2.0)

iq24_t commission_block_mean(int64_t sum, uint32_t n)
{
    return (iq24_t)iq24_asr64(sum + (INT64_C(1) << (n - 1)), n);
}

iq24_t commission_mean(const iq24_t x[N])
{
    int64_t sum = N / 2;
    for (uint32_t k = 0; k < N; k++) {
        sum += x[k];
    }
    return (iq24_t)iq24_asr64(sum, N_LOG2);
}

/* Standard deviation of residuals from the sum of their squares (Q48), in Q27, rounded up. Range: |residual| <= 2, so that
 * the sum is at most 32 * 2^50 = 2^55, and 2^61 times 64. */
static int32_t deviation_q27(int64_t squares)
{
    return root_of(squares * 64 / (N - 2)) + 1;
}

static int64_t square(iq24_t residual)
{
    const iq24_t held = iq24_clamp(residual, -RESIDUAL_MAX, RESIDUAL_MAX);
    return IQ24_MUL64(held, held);
}

/* Half width of a mean from the deviation of the blocks. */
static iq24_t half_of_mean(int32_t deviation_q27_)
{
    const iq24_t of_mean = iq24_mul_shift(deviation_q27_, INT32_C(379625062), 31); /* 1/sqrt(32) in Q31 */
    return iq24_asr32(iq24_mul_sat(of_mean, STUDENT), 3) + 1;
}

/* a/b of two sums, b > 0: saturates. The shift leaves 30 bits of the larger one. */
static iq24_t ratio(int64_t a, int64_t b)
{
    while (b > INT32_MAX || a > INT32_MAX || a < -INT32_MAX) {
        a /= 2;
        b /= 2;
    }
    return iq24_div((iq24_t)a, (iq24_t)b);
}

iq24_t commission_both(iq24_t a, iq24_t b)
{
    const int32_t root = root_of(IQ24_MUL64(a, a) / 2 + IQ24_MUL64(b, b) / 2); /* over sqrt(2) */
    return iq24_sat((int64_t)iq24_asr64(IQ24_MUL64(root, INT32_C(1518500250)), 30) + 2);
}

/* Range: |x - mean| and |y - mean| <= 16, products 2^56, sums 2^61. */
commission_line_t commission_line(const iq24_t x[N], const iq24_t y[N])
{
    const iq24_t x_mean = commission_mean(x);
    const iq24_t y_mean = commission_mean(y);
    int64_t xx = 0;
    int64_t xy = 0;
    for (uint32_t k = 0; k < N; k++) {
        const iq24_t dx = iq24_sub_wrap(x[k], x_mean);
        xx = IQ24_MAC64(xx, dx, dx);
        xy = IQ24_MAC64(xy, dx, iq24_sub_wrap(y[k], y_mean));
    }
    const iq24_t b = ratio(xy, xx);
    int64_t squares = 0;
    for (uint32_t k = 0; k < N; k++) {
        const iq24_t expected = iq24_mul_sat(b, iq24_sub_wrap(x[k], x_mean));
        squares += square(iq24_sub_sat(iq24_sub_wrap(y[k], y_mean), expected));
    }
    const int32_t s_q27 = deviation_q27(squares);
    const iq24_t half_b = iq24_mul_sat(ratio((int64_t)s_q27, (int64_t)8 * root_of(xx) + 1), STUDENT);
    const iq24_t half_a = commission_both(half_of_mean(s_q27), iq24_mul_sat(half_b, x_mean));
    const commission_line_t line = {{iq24_sub_sat(y_mean, iq24_mul_sat(b, x_mean)), half_a},
                                    {b, iq24_add_sat(half_b, 1)}};
    return line;
}

iqfoc_commission_value_t commission_spread(const iq24_t x[N])
{
    const iq24_t mean = commission_mean(x);
    int64_t squares = 0;
    for (uint32_t k = 0; k < N; k++) {
        squares += square(iq24_sub_sat(x[k], mean));
    }
    const iqfoc_commission_value_t value = {mean, half_of_mean(deviation_q27(squares))};
    return value;
}

/* L's correction for the current's course between the samples. */
static iq24_t between_samples(const iqfoc_commission_result_t *known, iq24_t l)
{
    const iq24_t r = known->r.value;
    const iq24_t late = iq24_asr32(known->v_dead.value, 1);
    return iq24_mul_sat(r, iq24_sub_sat(late, iq24_div(iq24_mul_sat(r, IQ24(3.0 / 32.0)), l)));
}

iqfoc_commission_value_t commission_inductance(const iqfoc_commission_result_t *known, const iq24_t d[N],
                                               const iq24_t s[N], iq24_t h_u)
{
    const iq24_t r = known->r.value;
    const iq24_t d_mean = commission_mean(d);
    const iq24_t s_mean = commission_mean(s);
    const iq24_t l = iq24_div(iq24_sub_sat(h_u, iq24_mul_sat(r, s_mean)), d_mean);
    int64_t squares = 0;
    for (uint32_t k = 0; k < N; k++) {
        const iq24_t by_d = iq24_mul_sat(l, iq24_sub_sat(d[k], d_mean));
        const iq24_t by_s = iq24_mul_sat(r, iq24_sub_sat(s[k], s_mean));
        squares += square(iq24_add_sat(by_d, by_s));
    }
    const iq24_t noise = half_of_mean(deviation_q27(squares));
    const iq24_t of_r = iq24_abs_sat(iq24_mul_sat(known->r.half, s_mean));
    const iqfoc_commission_value_t value = {
        iq24_add_sat(l, between_samples(known, l)),
        iq24_add_sat(iq24_div(iq24_add_sat(noise, of_r), iq24_abs_sat(d_mean)), 1)};
    return value;
}

static iq24_t length(iqfoc_dq_t x)
{
    return root_of(IQ24_MAC64(IQ24_MUL64(x.d, x.d), x.q, x.q));
}

/* psi - L_q i. Range: |i| <= 4 and |u| <= 2 a component. What acts is within 2 + 4 + 0.4, over phi_s1 it saturates; held to 60, so that the
 * squares' sum is below 2^61. */
static iqfoc_dq_t active_flux(const iqfoc_commission_result_t *known, const commission_means_t *means,
                              iq24_t phi_s1)
{
    const iq24_t size = length(means->i);
    const iq24_t lost = iq24_mul_sat(known->v_dead.value, FOUR_OVER_PI);
    const iq24_t drop = iq24_add_sat(known->r.value, iq24_div(lost, size)); /* along the current */
    const iqfoc_dq_t e = {iq24_sub_sat(means->u.d, iq24_mul_sat(drop, means->i.d)),
                          iq24_sub_sat(means->u.q, iq24_mul_sat(drop, means->i.q))};
    const iq24_t d = iq24_sub_sat(iq24_div(e.q, phi_s1), iq24_mul_sat(known->l_q.value, means->i.d));
    const iq24_t q =
        iq24_sub_sat(iq24_div(iq24_neg_sat(e.d), phi_s1), iq24_mul_sat(known->l_q.value, means->i.q));
    const iqfoc_dq_t a = {iq24_clamp(d, IQ24(-60.0), IQ24(60.0)), iq24_clamp(q, IQ24(-60.0), IQ24(60.0))};
    return a;
}

/* |i| cos(delta): the part of the current along the active flux. */
static iq24_t along(iqfoc_dq_t a, iqfoc_dq_t i)
{
    return ratio(IQ24_MAC64(IQ24_MUL64(a.d, i.d), a.q, i.q), (int64_t)length(a) * IQ24_ONE + 1);
}

iq24_t commission_flux(const iqfoc_commission_result_t *known, const commission_means_t *means, iq24_t phi_s1)
{
    const iqfoc_dq_t a = active_flux(known, means, phi_s1);
    const iq24_t saliency = iq24_sub_sat(known->l_d.value, known->l_q.value);
    return iq24_sub_sat(length(a), iq24_mul_sat(saliency, along(a, means->i)));
}

iq24_t commission_flux_half(const iqfoc_commission_result_t *known, const commission_means_t *means,
                            iq24_t phi_s1)
{
    const iqfoc_dq_t a = active_flux(known, means, phi_s1);
    const iqfoc_dq_t across = {a.q, -a.d};
    const iq24_t size = length(means->i);
    const iq24_t of_l = iq24_abs_sat(iq24_mul_sat(known->l_d.half, along(a, means->i)));
    const iq24_t drop =
        iq24_add_sat(known->r.half, iq24_div(iq24_mul_sat(known->v_dead.half, FOUR_OVER_PI), size));
    const iq24_t crossing = iq24_mul_sat(iq24_abs_sat(known->v_dead.value), FOUR_OVER_PI) / CROSSING;
    const iq24_t of_drop = iq24_abs_sat(iq24_mul_sat(drop, along(across, means->i)));
    return iq24_add_sat(of_l, iq24_div(iq24_add_sat(of_drop, crossing), iq24_abs_sat(phi_s1)));
}

bool commission_aligns(const iqfoc_commission_result_t *known, iq24_t across, iq24_t i_align)
{
    const iq24_t l_d = known->l_d.value;
    const iq24_t l_q = known->l_q.value;
    const iq24_t k = iq24_clamp(across, IQ24(-3.0), IQ24(3.0));
    const iq24_t saliency = commission_both(iq24_sub_sat(l_q, l_d), iq24_mul_sat(2 * k, l_q));
    const iq24_t m =
        iq24_max(iq24_sub_sat(IQ24_ONE, iq24_mul_sat(iq24_mul_sat(k, k), iq24_div(l_q, l_d))), 0);
    return iq24_mul_sat(known->psi.value, m) >= iq24_mul_sat(saliency, i_align + i_align / 2);
}
