/*
 * The search of finite_set.h to the last bit: one hash over the states chosen, of equal costs the first, and over how
 * many currents are predicted on the way. Currents of a few LSB show each rounding. test_finite_set.c searches all
 * sequences in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/finite_set.h"

#include <stddef.h>

#define DRAWS 6000

void setUp(void)
{
}

void tearDown(void)
{
}

typedef struct problem {
    iqfoc_finite_set_t set;
    iqfoc_ab_t i;
    int state_now;
    iqfoc_dq_t i_ref;
    iq24_t theta, speed, u_dc;
} problem;

static problem any_problem(uint64_t *seed, int n)
{
    iqfoc_exact_winding_t winding;
    winding.rho_q30 = bits_random(seed, 0, 1 << 28);
    winding.k_u_q26 = bits_random(seed, 1 << 22, 1 << 28);
    winding.k_psi_q27 = n % 3 == 0 ? 0 : bits_random(seed, 0, 1 << 28);
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    problem p;
    p.speed = random_iq24(seed, -0.3, 0.3);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(p.speed);
    const double reach = n % 3 == 0 ? 6e-7 : n % 3 == 1 ? 1.5 : 14.0;
    p.set.model = iqfoc_exact_at_speed(&law, p.speed);
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

static int32_t chosen(const problem *p, uint32_t *nodes)
{
    return iqfoc_finite_set_choose(&p->set, p->i, p->state_now, p->i_ref, p->theta, p->speed, p->u_dc, nodes);
}

static void the_search(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    uint32_t nodes = 7;
    for (int n = 0; n < DRAWS; n++) {
        const problem p = any_problem(&seed, n);
        const int32_t state = chosen(&p, &nodes);
        TEST_ASSERT_EQUAL_INT32(state, chosen(&p, NULL));
        digest_add(&digest, state);
        digest_add(&digest, (int32_t)nodes);
    }
    bits_golden(UINT64_C(0x5b3dd560be9ff1b9), digest);
}

static void voltages(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < 8 * DRAWS; n++) {
        const iq24_t u_dc = bits_random(&seed, -32 * IQ24_ONE, 32 * IQ24_ONE);
        const iqfoc_ab_t u = iqfoc_finite_set_voltage(n % 8, u_dc);
        bits_add(&digest, &u, sizeof u);
    }
    bits_golden(UINT64_C(0x5702cbfc6799c7fe), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_search);
    RUN_TEST(voltages);
    return UNITY_END();
}
