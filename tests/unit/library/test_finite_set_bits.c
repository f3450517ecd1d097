/*
 * The search of finite_set.h to the last bit, by recursion and in integers: the cost of each sequence, of equal ones the
 * first, and how many currents are predicted on the way. Currents of a few LSB show each rounding.
 */
#include "bits.h"

#include "iqfoc/finite_set.h"

#include <stddef.h>

#define DRAWS (6000 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

static int leg(int state, int n)
{
    return state >> n & 1;
}

/* Thirds and over sqrt(3) of u_dc to nearest, times whole numbers. */
static iqfoc_ab_t voltage(int state, int64_t u_dc)
{
    const int64_t third = bits_product_of(u_dc, llround(ldexp(1.0 / 3.0, 31)), 31);
    const int64_t over_root = bits_product_of(u_dc, llround(ldexp(1.0 / sqrt(3.0), 31)), 31);
    const iqfoc_ab_t u = {(iq24_t)((2 * leg(state, 0) - leg(state, 1) - leg(state, 2)) * third),
                          (iq24_t)((leg(state, 1) - leg(state, 2)) * over_root)};
    return u;
}

typedef struct problem {
    iqfoc_finite_set_t set;
    iqfoc_ab_t i;
    int state_now;
    iqfoc_dq_t i_ref;
    iq24_t theta, turns, u_dc;
} problem;

static struct {
    const problem *p;
    int64_t best;
    int chosen, last;
    uint32_t nodes;
} search;

static iq24_sincos_t at(int64_t angle)
{
    return iq24_sincos(iq24_wrap(angle));
}

static int64_t square(int64_t error)
{
    const int64_t held = bits_held(error, -32 * (int64_t)IQ24_ONE, 32 * (int64_t)IQ24_ONE);
    return held * held;
}

/* All continuations of a current at the start of interval k, cheaper than the best so far. */
static void look(int k, iqfoc_ab_t i, int64_t cost_so_far, int before, int first)
{
    const problem *p = search.p;
    const iqfoc_ab_t none = {0, 0};
    const int64_t start = p->theta + (int64_t)(k + 1) * p->turns;
    const iqfoc_ab_t drifts = iqfoc_exact_step(&p->set.model, i, none, at(start + bits_floor(p->turns, 2)));
    const iqfoc_ab_t target =
        iqfoc_park_inverse(iqfoc_valley_reference(&p->set.reference, p->i_ref), at(start + p->turns));
    for (int s = 0; s < IQFOC_FINITE_SET_STATES; s++) {
        const iqfoc_ab_t u = voltage(s, p->u_dc);
        const iqfoc_ab_t end = {iq24_wrap(drifts.alpha + bits_product_of(u.alpha, p->set.model.k_u_q26, 26)),
                                iq24_wrap(drifts.beta + bits_product_of(u.beta, p->set.model.k_u_q26, 26))};
        const int x = before ^ s;
        const int64_t cost =
            cost_so_far + (leg(x, 0) + leg(x, 1) + leg(x, 2)) * (int64_t)IQ24_ONE * p->set.weight +
            square((int64_t)target.alpha - end.alpha) + square((int64_t)target.beta - end.beta);
        search.nodes++;
        if (cost >= search.best) {
            continue;
        }
        if (k == search.last) {
            search.best = cost;
            search.chosen = k == 0 ? s : first;
        } else {
            look(k + 1, end, cost, s, k == 0 ? s : first);
        }
    }
}

static problem any_problem(uint64_t *seed, int n)
{
    const iqfoc_exact_winding_t winding = {bits_random(seed, 0, 1 << 28), bits_random(seed, 1 << 22, 1 << 28),
                                           n % 3 == 0 ? 0 : bits_random(seed, 0, 1 << 28)};
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    problem p;
    p.turns = random_iq24(seed, -0.3, 0.3);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(p.turns);
    const double reach = n % 3 == 0 ? 6e-7 : n % 3 == 1 ? 1.5 : 14.0;
    p.set.model = iqfoc_exact_at_speed(&law, p.turns);
    p.set.reference = iqfoc_valley_reference_at(&rotor, winding.k_psi_q27 / 8);
    p.set.weight = n % 3 == 0 ? bits_random(seed, 0, 1) : random_iq24(seed, 0.0, n % 2 == 0 ? 1.0 : 0.01);
    p.set.horizon = bits_random(seed, -1, 5);
    p.i.alpha = random_iq24(seed, -reach, reach);
    p.i.beta = random_iq24(seed, -reach, reach);
    p.i_ref.d = random_iq24(seed, -reach, reach);
    p.i_ref.q = random_iq24(seed, -reach, reach);
    p.state_now = bits_random(seed, 0, 7);
    p.theta = bits_random(seed, INT32_MIN, INT32_MAX);
    p.u_dc = n % 3 == 0 ? bits_random(seed, 0, 30) : random_iq24(seed, 0.0, 2.0);
    return p;
}

static void the_search(void)
{
    uint64_t seed = 1;
    uint32_t nodes = 7;
    for (int n = 0; n < DRAWS; n++) {
        const problem p = any_problem(&seed, n);
        const iq24_sincos_t sc = at(p.theta + bits_floor(p.turns, 2));
        const iqfoc_ab_t next = iqfoc_exact_step(&p.set.model, p.i, voltage(p.state_now, p.u_dc), sc);
        search.p = &p;
        search.best = INT64_MAX;
        search.chosen = p.state_now;
        search.last = (int)bits_held(p.set.horizon, 1, 3) - 1;
        search.nodes = nodes;
        look(0, next, 0, p.state_now, 0);
        TEST_ASSERT_EQUAL_INT32(search.chosen, iqfoc_finite_set_choose(&p.set, p.i, p.state_now, p.i_ref,
                                                                       p.theta, p.turns, p.u_dc, &nodes));
        TEST_ASSERT_EQUAL_UINT32(search.nodes, nodes);
        TEST_ASSERT_EQUAL_INT32(search.chosen, iqfoc_finite_set_choose(&p.set, p.i, p.state_now, p.i_ref,
                                                                       p.theta, p.turns, p.u_dc, NULL));
    }
}

static void voltages(void)
{
    uint64_t seed = 2;
    for (int n = 0; n < 8 * DRAWS; n++) {
        const iq24_t u_dc = bits_random(&seed, -32 * IQ24_ONE, 32 * IQ24_ONE);
        const iqfoc_ab_t want = voltage(n % 8, u_dc);
        const iqfoc_ab_t got = iqfoc_finite_set_voltage(n % 8, u_dc);
        TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof want);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_search);
    RUN_TEST(voltages);
    return UNITY_END();
}
