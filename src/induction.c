/*
 * The coefficients of exact prediction for induction machines, in fixed point (docs/induction.md).
 *
 *         | -(rho_s + rho_r)   a - j phi   1 |
 *     M = |      rho_r       -(a - j phi)  0 |       in x = [i, p, k_u u], over one span
 *         |                                0 |
 *
 * The rows of the mean, F = sum M^n/(n+1)!, come by Horner's rule from the last term to the first,
 * F <- e + F M/(k+1); those of the end are e + F M: as in predictor_salient.c, with complex numbers.
 */
#include "iqfoc/induction.h"

#include "series.h"

/* Complex, Q28. */
typedef struct cplx {
    int32_t re, im;
} cplx;

/* M over one span, Q28. */
typedef struct generator {
    int32_t rho_s, rho_r, a, phi;
} generator;

typedef struct row {
    cplx i, p, u;
} row;

static int32_t minus_sum(int32_t x, int32_t y)
{
    return iq24_sub_wrap(0, iq24_add_wrap(x, y));
}

/*
 * row M/n:  i' = -rho_s i - rho_r (i - p),   p' = (a - j phi)(i - p),   u' = i.
 *
 * Range: rho <= 0.5, a <= 0.1, phi <= 2.1: the rows' sums are within e^3.2/3.2 = 7.7 in size before the last
 * step, below Q28's 8; so are i - p, whose parts partly cancel: within 7.7 as a row of the same bound. Error:
 * the quotients are cut by 1 unit, products rounded by half a unit. Sums are spelt as such that wrap, as in
 * predictor_salient.c.
 */
static row times_generator(const row *r, const generator *m, int32_t n)
{
    const int32_t rho_s = m->rho_s / n;
    const int32_t rho_r = m->rho_r / n;
    const int32_t a = m->a / n;
    const int32_t phi = m->phi / n;
    const cplx over = {iq24_sub_wrap(r->i.re, r->p.re), iq24_sub_wrap(r->i.im, r->p.im)};
    const row product = {
        .i = {minus_sum(iq24_mul_shift(r->i.re, rho_s, 28), iq24_mul_shift(over.re, rho_r, 28)),
              minus_sum(iq24_mul_shift(r->i.im, rho_s, 28), iq24_mul_shift(over.im, rho_r, 28))},
        .p = {iq24_add_wrap(iq24_mul_shift(over.re, a, 28), iq24_mul_shift(over.im, phi, 28)),
              iq24_sub_wrap(iq24_mul_shift(over.im, a, 28), iq24_mul_shift(over.re, phi, 28))},
        .u = {r->i.re / n, r->i.im / n},
    };
    return product;
}

/* |M| <= rho_s + rho_r + a + |phi|. */
static int32_t terms_of(const generator *m)
{
    return series_terms(m->rho_s + m->rho_r + m->a + (m->phi < 0 ? -m->phi : m->phi));
}

static iqfoc_induction_factor_t factor(cplx x)
{
    const iqfoc_induction_factor_t f = {iq24_asr32(iq24_add_wrap(x.re, 2), 2),
                                        iq24_asr32(iq24_add_wrap(x.im, 2), 2)};
    return f;
}

/* Without the ripple, which follows. */
static iqfoc_induction_row_t coefficients(const row *r, int32_t k_u_q26)
{
    const iqfoc_induction_row_t c = {
        factor(r->i),
        factor(r->p),
        {iq24_mul_shift(r->u.re, k_u_q26, 28), iq24_mul_shift(r->u.im, k_u_q26, 28)},
        {0, 0}};
    return c;
}

/*
 * The pulses' factor -k_u x/24. With B the voltage's column, x is (e^M - 1) B for the mean and (e^M - 1) M B
 * for the end: e^(M/2) M B and e^(M/2) M^2 B of the derivation, which these equal up to M^2/24 of themselves.
 */
static iqfoc_induction_factor_t pulses(cplx x, int32_t k_u_q26)
{
    const iqfoc_induction_factor_t f = {iq24_sub_wrap(0, iq24_mul_shift(x.re, k_u_q26, 28)) / 24,
                                        iq24_sub_wrap(0, iq24_mul_shift(x.im, k_u_q26, 28)) / 24};
    return f;
}

iqfoc_induction_t iqfoc_induction_at_speed(const iqfoc_induction_machine_t *machine, iq24_t speed,
                                           iq24_t span)
{
    const iq24_t x = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const generator m = {.rho_s = iq24_mul_shift(machine->rho_s_q30, span, 26),
                         .rho_r = iq24_mul_shift(machine->rho_r_q30, span, 26),
                         .a = iq24_mul_shift(machine->a_q30, span, 26),
                         .phi = iq24_mul_shift(iq24_mul_shift(x * 64, IQFOC_Q28_2_PI, 30), span, 24)};
    const int32_t k_u_q26 = iq24_mul_shift(machine->k_u_q26, span, 24);
    row i = {.i = {ONE_Q28, 0}};
    row p = {.p = {ONE_Q28, 0}};
    for (int32_t k = terms_of(&m); k >= 1; k--) {
        i = times_generator(&i, &m, k + 1);
        p = times_generator(&p, &m, k + 1);
        i.i.re = iq24_add_wrap(i.i.re, ONE_Q28);
        p.p.re = iq24_add_wrap(p.p.re, ONE_Q28);
    }
    iqfoc_induction_t result;
    result.i_mean = coefficients(&i, k_u_q26);
    i = times_generator(&i, &m, 1); /* now e^M - 1 */
    p = times_generator(&p, &m, 1);
    result.i_mean.of_ripple = pulses(i.i, k_u_q26);
    const iqfoc_induction_factor_t i_pulses = pulses(times_generator(&i, &m, 1).i, k_u_q26);
    const iqfoc_induction_factor_t flux_pulses = pulses(times_generator(&p, &m, 1).i, k_u_q26);
    i.i.re = iq24_add_wrap(i.i.re, ONE_Q28);
    p.p.re = iq24_add_wrap(p.p.re, ONE_Q28);
    result.i = coefficients(&i, k_u_q26);
    result.i.of_ripple = i_pulses;
    result.flux = coefficients(&p, k_u_q26);
    result.flux.of_ripple = flux_pulses;
    return result;
}
