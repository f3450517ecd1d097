/*
 * The coefficients of exact prediction for salient machines, in fixed point (docs/exact-prediction.md).
 *
 * In fluxes of the currents, L_d i_d and L_q i_q, and over one span, saliency leaves the speed's terms:
 *
 *         | -rho_d   phi     1     0     0  |
 *         |  -phi  -rho_q    0     1   -phi |       the last column times psi_f, whose factor waits
 *     M = |                  0    phi       |       until the end
 *         |                -phi    0        |
 *         |                              0  |
 *
 * The rows of the mean, F = sum M^n/(n+1)!, come by Horner's rule from the last term to the first,
 *
 *     F <- e + F M/(k+1),    k = N ... 1,
 *
 * and those of the end are e + F M. Two rows are needed, those of the fluxes.
 */
#include "iqfoc/predictor_salient.h"

#include "series.h"

/* M over one span, Q28. */
typedef struct generator {
    int32_t rho_d, rho_q, phi;
} generator;

/* A row of F or of its product with M, Q28: the columns of x. */
typedef struct row {
    int32_t i_d, i_q, u_d, u_q, constant;
} row;

/* M/n, once for both rows. */
static generator part_of(const generator *m, int32_t n)
{
    const generator part = {m->rho_d / n, m->rho_q / n, m->phi / n};
    return part;
}

/*
 * row M/n, of that part of M.
 *
 * Range: |phi| <= 2.1, rho <= 1. In F the entries of i are within (e^3.1 - 1)/3.1 = 6.8 in size, for that
 * bounds the sum of the absolute terms, and those of u within half of it: all below the 8 of Q28. The sums of
 * two products stay below 2^63: 2 * 2^31 * 2^30. Error: the quotients of M are cut by 1 unit, products
 * rounded by half a unit. Sums are spelt as such that wrap, which costs nothing: nothing is undefined then even
 * for a machine outside its ranges.
 */
static row times_generator(const row *r, const generator *part, int32_t n)
{
    const row product = {
        .i_d = iq24_sub_wrap(
            0, iq24_add_wrap(iq24_mul_shift(r->i_d, part->rho_d, 28), iq24_mul_shift(r->i_q, part->phi, 28))),
        .i_q = iq24_sub_wrap(iq24_mul_shift(r->i_d, part->phi, 28), iq24_mul_shift(r->i_q, part->rho_q, 28)),
        .u_d = iq24_sub_wrap(r->i_d / n, iq24_mul_shift(r->u_q, part->phi, 28)),
        .u_q = iq24_add_wrap(r->i_q / n, iq24_mul_shift(r->u_d, part->phi, 28)),
        .constant = r->i_q / n,
    };
    return product;
}

/* |M| <= max(rho) + |phi|: 19 terms at 1/3 turn and rho = 1, 3 at standstill without resistance. */
static int32_t terms_of(const generator *m)
{
    const int32_t rho = m->rho_d > m->rho_q ? m->rho_d : m->rho_q;
    return series_terms(rho + (m->phi < 0 ? -m->phi : m->phi));
}

/* The two rows of the mean. */
static void mean_rows(const generator *m, row *d, row *q)
{
    *d = (row){.i_d = ONE_Q28};
    *q = (row){.i_q = ONE_Q28};
    for (int32_t k = terms_of(m); k >= 1; k--) {
        const generator part = part_of(m, k + 1);
        *d = times_generator(d, &part, k + 1);
        *q = times_generator(q, &part, k + 1);
        d->i_d = iq24_add_wrap(d->i_d, ONE_Q28);
        q->i_q = iq24_add_wrap(q->i_q, ONE_Q28);
    }
}

/* The rows of the end: e + F M. */
static void end_rows(const generator *m, row *d, row *q)
{
    *d = times_generator(d, m, 1);
    *q = times_generator(q, m, 1);
    d->i_d = iq24_add_wrap(d->i_d, ONE_Q28);
    q->i_q = iq24_add_wrap(q->i_q, ONE_Q28);
}

/*
 * From fluxes to currents, as the step has them. k_u: of this axis and span. cross: the other axis' L
 * over this one's.
 */
typedef struct axis {
    int32_t k_u_q26, k_psi_phi_q26, cross_q27;
} axis;

/*
 * Range: |flux rows| < 2^31 in Q28 are at most 1 at a true end or mean, so that the products are within
 * 16, 16.8 and 8 of Q26's 32. own, other: entries of this axis' current and of the other's.
 */
static iqfoc_salient_row_t row_of(const row *r, const axis *a, int32_t i_d_q26, int32_t i_q_q26)
{
    const iqfoc_salient_row_t result = {
        .i_d_q26 = i_d_q26,
        .i_q_q26 = i_q_q26,
        .u_d_q26 = iq24_mul_shift(r->u_d, a->k_u_q26, 28),
        .u_q_q26 = iq24_mul_shift(r->u_q, a->k_u_q26, 28),
        .constant_q26 = iq24_sub_wrap(0, iq24_mul_shift(r->constant, a->k_psi_phi_q26, 28))};
    return result;
}

static int32_t own(int32_t flux_q28)
{
    return iq24_asr32(iq24_add_wrap(flux_q28, 2), 2);
}

static int32_t other(int32_t flux_q28, const axis *a)
{
    return iq24_mul_shift(flux_q28, a->cross_q27, 29);
}

static void to_currents(const row *d, const row *q, const axis *of_d, const axis *of_q, iqfoc_salient_t *out)
{
    out->d = row_of(d, of_d, own(d->i_d), other(d->i_q, of_d));
    out->q = row_of(q, of_q, other(q->i_d, of_q), own(q->i_q));
}

/*
 * Range: |phi| <= 2.0944 in Q28 is below 2^30; k_psi phi <= 16.8 in Q26 below 2^31. rho in Q30 times span in
 * Q24 over 2^26 is Q28.
 */
void iqfoc_salient_at_speed(const iqfoc_salient_machine_t *machine, iq24_t speed, iq24_t span,
                            iqfoc_salient_t *end, iqfoc_salient_t *mean)
{
    const iq24_t x = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const generator m = {.rho_d = iq24_mul_shift(machine->rho_d_q30, span, 26),
                         .rho_q = iq24_mul_shift(machine->rho_q_q30, span, 26),
                         .phi = iq24_mul_shift(iq24_mul_shift(x * 64, IQFOC_Q28_2_PI, 30), span, 24)};
    const axis of_d = {.k_u_q26 = iq24_mul_shift(machine->k_d_q26, span, 24),
                       .k_psi_phi_q26 = iq24_mul_shift(machine->k_psi_d_q27, m.phi, 29),
                       .cross_q27 = machine->q_to_d_q27};
    const axis of_q = {.k_u_q26 = iq24_mul_shift(machine->k_q_q26, span, 24),
                       .k_psi_phi_q26 = iq24_mul_shift(machine->k_psi_q_q27, m.phi, 29),
                       .cross_q27 = machine->d_to_q_q27};
    row d;
    row q;
    mean_rows(&m, &d, &q);
    if (mean != NULL) {
        to_currents(&d, &q, &of_d, &of_q, mean);
    }
    if (end != NULL) {
        end_rows(&m, &d, &q);
        to_currents(&d, &q, &of_d, &of_q, end);
    }
}
