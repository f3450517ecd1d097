/* Prediction by a flux map (include/iqfoc/flux_map.h). */
#include "iqfoc/flux_map.h"

#include "iqfoc/extension_params.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include "flux_step.h"

#include <stddef.h>

/* Sums of the parts' fluxes and of the slopes. */
#define FLUX_MAX  IQ24(16.0)
#define SLOPE_MAX IQ24(64.0)

/* |x|, |y| above which the sum of squares is taken at a 256th: it has to fit iq24_t. */
#define SQUARES_MAX (INT64_C(127) << 48)

/* A map at one current: the flux, and dflux/di (dq = qd). */
typedef struct point {
    iqfoc_dq_t flux;
    iq24_t dd;
    iq24_t dq;
    iq24_t qq;
} point_t;

/* Values of each part, in their ranges; then their sums. */
static bool parts_fit(const iqfoc_flux_map_t *map)
{
    iqfoc_dq_t flux = {0, 0};
    iqfoc_dq_t slope = {map->l_d, map->l_q};
    for (int32_t n = 0; n < IQFOC_FLUX_MAP_PARTS; n++) {
        const iqfoc_flux_map_part_t *const p = &map->part[n];
        if (p->e == 0) {
            continue;
        }
        const iqfoc_dq_t a = {iq24_mul_sat(p->e, p->k_d), iq24_mul_sat(p->e, p->k_q)};
        flux.d = iq24_add_sat(flux.d, a.d);
        flux.q = iq24_add_sat(flux.q, a.q);
        slope.d = iq24_add_sat(slope.d, iq24_mul_sat(a.d, p->k_d));
        slope.q = iq24_add_sat(slope.q, iq24_mul_sat(a.q, p->k_q));
        if (!iq24_within(p->e, 0, IQ24(IQFOC_MAX_MAP_E)) ||
            !iq24_within(p->k_d, IQ24(IQFOC_MIN_MAP_K), IQ24(IQFOC_MAX_MAP_K)) ||
            !iq24_within(p->k_q, IQ24(IQFOC_MIN_MAP_K), IQ24(IQFOC_MAX_MAP_K)) ||
            !iq24_within(p->x_0, -IQ24(IQFOC_MAX_MAP_X), IQ24(IQFOC_MAX_MAP_X))) {
            return false;
        }
    }
    return flux.d <= FLUX_MAX && flux.q <= FLUX_MAX && slope.d <= SLOPE_MAX && slope.q <= SLOPE_MAX;
}

iqfoc_error_t iqfoc_flux_map_check(const iqfoc_flux_map_t *map)
{
    if (map == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(map->l_d, IQ24(IQFOC_MIN_MAP_L), IQ24(IQFOC_MAX_FLUX_L))) {
        return IQFOC_ERROR_INDUCTANCE_D;
    }
    if (!iq24_within(map->l_q, IQ24(IQFOC_MIN_MAP_L), IQ24(IQFOC_MAX_FLUX_L))) {
        return IQFOC_ERROR_INDUCTANCE_Q;
    }
    if (!iq24_within(map->r, 0, IQ24(IQFOC_MAX_FLUX_R))) {
        return IQFOC_ERROR_RESISTANCE;
    }
    if (!iq24_within(map->psi, -IQ24(IQFOC_MAX_FLUX_PSI), IQ24(IQFOC_MAX_FLUX_PSI))) {
        return IQFOC_ERROR_FLUX;
    }
    return parts_fit(map) ? IQFOC_OK : IQFOC_ERROR_FLUX_PART;
}

/*
 * 1/rho in Q30. Range: |x| <= 10 * 9.75 + 16 = 113.5 and |y| <= 97.5, so the sum of squares is 1 ... 22390, below
 * 32768 in the accumulator and below 128 once divided by 256. Its root is rho, 1 ... 11.3, or rho/16, 0.70 ... 9.4;
 * the quotient is at most 2^30 either way. Relative error: 0.63 LSB of the root and 0.5 of Q30.
 */
static int32_t per_rho_q30(iq24_t x, iq24_t y)
{
    const iq24_acc_t squares = iq24_acc_mac(iq24_acc_mac(iq24_acc_mul(IQ24_ONE, IQ24_ONE), x, x), y, y);
    return squares < SQUARES_MAX ? iq24_div(IQ24(64.0), iq24_sqrt(iq24_acc_round(squares)))
                                 : iq24_div(IQ24(4.0), iq24_sqrt(iq24_wrap(iq24_asr64(squares, 32))));
}

/*
 * Adds a part. Range: u, w and n are 1 at most and lie on a sphere, n^2 + u^2 + w^2 = 1. So the flux is a_d, a_q at most,
 * dd and qq are a_d k_d and a_q k_q at most, which iqfoc_flux_map_check holds to 16 and 64; n u w is 0.2 at most,
 * and dq 16 * 10 * 0.2.
 */
static void add_part(const iqfoc_flux_map_part_t *part, iqfoc_dq_t i, point_t *to)
{
    const iq24_t a_d = iq24_mul_round(part->e, part->k_d);
    const iq24_t a_q = iq24_mul_round(part->e, part->k_q);
    const iq24_t x = iq24_mul_round(part->k_d, i.d) - part->x_0;
    const iq24_t y = iq24_mul_round(part->k_q, i.q);
    const int32_t n_q30 = per_rho_q30(x, y);
    const iq24_t u = iq24_mul_shift(x, n_q30, 30);
    const iq24_t w = iq24_mul_shift(y, n_q30, 30);
    const iq24_t n = iq24_asr32(n_q30, 6);
    const iq24_acc_t nn = iq24_acc_mul(n, n);
    const iq24_t of_d = iq24_mul_round(n, iq24_acc_round(iq24_acc_mac(nn, w, w)));
    const iq24_t of_q = iq24_mul_round(n, iq24_acc_round(iq24_acc_mac(nn, u, u)));
    const iq24_t of_both = iq24_mul_round(n, iq24_mul_round(u, w));
    to->flux.d = iq24_add_wrap(to->flux.d, iq24_mul_round(a_d, u));
    to->flux.q = iq24_add_wrap(to->flux.q, iq24_mul_round(a_q, w));
    to->dd = iq24_add_wrap(to->dd, iq24_mul_round(a_d, iq24_mul_round(part->k_d, of_d)));
    to->qq = iq24_add_wrap(to->qq, iq24_mul_round(a_q, iq24_mul_round(part->k_q, of_q)));
    to->dq = iq24_sub_wrap(to->dq, iq24_mul_round(a_d, iq24_mul_round(part->k_q, of_both)));
}

/* Range: |i| <= 9.75 a component, so the flux is at most 8 * 9.75 + 16 + 16 = 110, and the slopes 64. */
static point_t map_at(const iqfoc_flux_map_t *map, iqfoc_dq_t i)
{
    point_t at = {{iq24_add_wrap(iq24_mul_round(map->l_d, i.d), map->psi), iq24_mul_round(map->l_q, i.q)},
                  map->l_d,
                  0,
                  map->l_q};
    for (int32_t n = 0; n < IQFOC_FLUX_MAP_PARTS; n++) {
        if (map->part[n].e != 0) {
            add_part(&map->part[n], i, &at);
        }
    }
    return at;
}

/*
 * Newton's step towards a flux, by elimination of i_d: held to `most` a component.
 *
 * Range: the slopes less those of straight iron are those of a convex energy, so t^2 is qq/dd at most, 64^2, t dq is qq
 * at most, and their difference l_q at least, 1/64, but for 200 LSB of t dq. |dq| <= 32 and a step of 1 fit. All
 * else saturates.
 */
static iqfoc_dq_t towards(const point_t *at, iqfoc_dq_t i, iqfoc_dq_t flux, iq24_t most)
{
    const iqfoc_dq_t off = {iq24_sub_sat(flux.d, at->flux.d), iq24_sub_sat(flux.q, at->flux.q)};
    const iq24_t t = iq24_div(at->dq, at->dd);
    const iq24_t of_q = iq24_sub_sat(off.q, iq24_mul_sat(t, off.d));
    const iq24_t q = iq24_clamp(iq24_div(of_q, iq24_sub_sat(at->qq, iq24_mul_sat(t, at->dq))), -most, most);
    const iq24_t d =
        iq24_clamp(iq24_div(iq24_sub_sat(off.d, iq24_mul_round(at->dq, q)), at->dd), -most, most);
    const iqfoc_dq_t next = {i.d + d, i.q + q};
    return next;
}

/* Held to +-8, less one LSB above. */
static iq24_t held(iq24_t i)
{
    return IQ24_HOLD_BITS(i, 28);
}

iqfoc_ab_t iqfoc_flux_map_step(const iqfoc_flux_map_t *map, const iqfoc_extension_t *extension, iqfoc_ab_t i,
                               iqfoc_ab_t u, iq24_sincos_t start, iq24_sincos_t end)
{
    const iqfoc_dq_t seen = iqfoc_park(i, start);
    const iqfoc_dq_t from = {held(seen.d), held(seen.q)};
    point_t at = map_at(map, from);
    const iqfoc_ab_t flux = iqfoc_park_inverse(at.flux, start);
    iqfoc_dq_t goal =
        iqfoc_park(flux_after_cycle(map->r, flux, iqfoc_extension_acting(extension, u, i), i), end);
    iqfoc_dq_t next = towards(&at, from, goal, IQ24_ONE);
    const iqfoc_ab_t first = iqfoc_park_inverse(next, end);
    const iqfoc_ab_t mean = flux_mean_current(i, first);
    goal = iqfoc_park(flux_after_cycle(map->r, flux, iqfoc_extension_acting(extension, u, mean), mean), end);
    at = map_at(map, next);
    next = towards(&at, next, goal, IQ24(0.5));
    at = map_at(map, next);
    next = towards(&at, next, goal, IQ24(0.25));
    return iqfoc_park_inverse(next, end);
}
