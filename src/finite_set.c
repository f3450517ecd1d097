/*
 * The search of finite-control-set control (include/iqfoc/finite_set.h).
 *
 * A state's voltage adds the same to the current in every interval, and the EMF the same in every branch. Both are
 * computed before the search, so that each node needs two additions.
 */
#include "iqfoc/finite_set.h"

#include <stddef.h>

#define ERROR_MAX IQ24(32.0)

static int32_t leg_is_high(int32_t state, uint32_t leg)
{
    return iq24_asr32(state, leg) & 1;
}

/* 0 ... 3. */
static int32_t legs_switched(int32_t from, int32_t to)
{
    const int32_t changed = from ^ to;
    return leg_is_high(changed, 0) + leg_is_high(changed, 1) + leg_is_high(changed, 2);
}

/* alpha = (2 a - b - c) u_dc/3, beta = (b - c) u_dc/sqrt(3). */
iqfoc_ab_t iqfoc_finite_set_voltage(int32_t state, iq24_t u_dc)
{
    const int32_t a = leg_is_high(state, 0);
    const int32_t b = leg_is_high(state, 1);
    const int32_t c = leg_is_high(state, 2);
    const iqfoc_ab_t u = {(2 * a - b - c) * iq24_mul_shift(u_dc, IQFOC_Q31_1_3, 31),
                          (b - c) * iq24_mul_shift(u_dc, IQFOC_Q31_1_SQRT3, 31)};
    return u;
}

/* Values that are the same in all branches: per interval of the horizon, per state, and in all. */
typedef struct plan {
    const iqfoc_finite_set_t *set;
    iqfoc_ab_t target[IQFOC_FINITE_SET_HORIZON]; /* target current at the interval's end */
    iq24_sincos_t sc_mid[IQFOC_FINITE_SET_HORIZON];
    iqfoc_ab_t moved[IQFOC_FINITE_SET_STATES]; /* change of the current by the state's voltage */
    int32_t last;                              /* interval of the horizon */
} plan;

static plan plan_of(const iqfoc_finite_set_t *set, iqfoc_dq_t i_ref, iq24_t theta, iq24_t speed, iq24_t u_dc)
{
    plan p = {.set = set, .last = iq24_clamp(set->horizon, 1, IQFOC_FINITE_SET_HORIZON) - 1};
    const iqfoc_dq_t valley = iqfoc_valley_reference(&set->reference, i_ref);
    for (int32_t k = 0; k <= p.last; k++) {
        theta = iq24_add_wrap(theta, speed);
        p.sc_mid[k] = iq24_sincos(iq24_add_wrap(theta, iq24_asr32(speed, 1)));
        p.target[k] = iqfoc_park_inverse(valley, iq24_sincos(iq24_add_wrap(theta, speed)));
    }
    for (int32_t s = 0; s < IQFOC_FINITE_SET_STATES; s++) {
        const iqfoc_ab_t u = iqfoc_finite_set_voltage(s, u_dc);
        const int64_t half = INT64_C(1) << 25;
        p.moved[s].alpha = iq24_shift_wrap(IQ24_MAC64(half, u.alpha, set->model.k_u_q26), 26);
        p.moved[s].beta = iq24_shift_wrap(IQ24_MAC64(half, u.beta, set->model.k_u_q26), 26);
    }
    return p;
}

/* One interval of the sequence under search. */
typedef struct level {
    iqfoc_ab_t drifts_to; /* its end without voltage */
    iq24_acc_t cost;      /* of the sequence before it */
    int32_t before;       /* state of the interval before */
    int32_t state;        /* tried in it */
} level;

static level level_from(const plan *p, int32_t k, iqfoc_ab_t i, iq24_acc_t cost, int32_t before)
{
    const iqfoc_ab_t none = {0, 0};
    const level l = {iqfoc_exact_step(&p->set->model, i, none, p->sc_mid[k]), cost, before, 0};
    return l;
}

static iq24_acc_t error_squared(iqfoc_ab_t target, iqfoc_ab_t i)
{
    const iq24_t alpha = iq24_clamp(iq24_sub_sat(target.alpha, i.alpha), -ERROR_MAX, ERROR_MAX);
    const iq24_t beta = iq24_clamp(iq24_sub_sat(target.beta, i.beta), -ERROR_MAX, ERROR_MAX);
    return iq24_acc_mac(iq24_acc_mul(alpha, alpha), beta, beta);
}

int32_t iqfoc_finite_set_choose(const iqfoc_finite_set_t *set, iqfoc_ab_t i, int32_t state_now,
                                iqfoc_dq_t i_ref, iq24_t theta, iq24_t speed, iq24_t u_dc, uint32_t *nodes)
{
    const plan p = plan_of(set, i_ref, theta, speed, u_dc);
    const iq24_sincos_t sc_now = iq24_sincos(iq24_add_wrap(theta, iq24_asr32(speed, 1)));
    const iqfoc_ab_t i_next =
        iqfoc_exact_step(&set->model, i, iqfoc_finite_set_voltage(state_now, u_dc), sc_now);
    level stack[IQFOC_FINITE_SET_HORIZON];
    iq24_acc_t best = INT64_MAX;
    int32_t chosen = state_now;
    uint32_t visited = 0;
    int32_t k = 0;
    stack[0] = level_from(&p, 0, i_next, 0, state_now);
    /*@ split p.last; */
    /*@ dynamic_split k; */
    while (k >= 0) {
        level *l = &stack[k];
        /*@ assert finite_set: 0 <= l->cost <= 1154610354467110912 && 0 <= l->state <= 8; */
        if (l->state == IQFOC_FINITE_SET_STATES) {
            k--;
            continue;
        }
        const int32_t s = l->state++;
        const iqfoc_ab_t i_end = {iq24_add_wrap(l->drifts_to.alpha, p.moved[s].alpha),
                                  iq24_add_wrap(l->drifts_to.beta, p.moved[s].beta)};
        const iq24_acc_t cost = iq24_acc_mac(l->cost, set->weight, legs_switched(l->before, s) * IQ24_ONE) +
                                error_squared(p.target[k], i_end);
        visited++;
        if (cost >= best) {
            continue;
        }
        if (k == p.last) {
            best = cost;
            chosen = stack[0].state - 1;
        } else {
            k++;
            stack[k] = level_from(&p, k, i_end, cost, s);
        }
    }
    if (nodes != NULL) {
        *nodes += visited;
    }
    return chosen;
}
