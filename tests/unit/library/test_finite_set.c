/*
 * Finite-control-set control (include/iqfoc/finite_set.h) against a search of all sequences in double
 * precision, written without its shortcuts.
 */
#include "iqfoc/finite_set.h"
#include "reference.h"

#include "iqfoc/modulation.h"

#include <complex.h>

void setUp(void)
{
}

void tearDown(void)
{
}

enum { TRIES = 3000 / IQFOC_TEST_STRIDE };

/* a e^{j angle}, a complex number from two. (C11's CMPLX is missing in clang 14.) */
static double complex turned(double turns)
{
    return cos(TWO_PI * turns) + sin(TWO_PI * turns) * I;
}

static double complex voltage(int state, double u_dc)
{
    const double complex axis = turned(1.0 / 3.0);
    return 2.0 / 3.0 * u_dc * ((state & 1) + ((state >> 1) & 1) * axis + ((state >> 2) & 1) * axis * axis);
}

/* One problem, as the function gets it. */
typedef struct problem {
    iqfoc_finite_set_t set;
    iqfoc_ab_t i;
    int32_t state_now;
    iqfoc_dq_t i_ref;
    iq24_t theta, speed, u_dc;
} problem;

static double complex step(const problem *p, double complex i, int state, int interval)
{
    const double complex mid = turned(to_double(p->theta) + (interval + 0.5) * to_double(p->speed));
    const double complex w = ldexp(p->set.model.w_real_q26, -26) + I * ldexp(p->set.model.w_imag_q26, -26);
    return ldexp(p->set.model.stays_q26, -26) * i +
           ldexp(p->set.model.k_u_q26, -26) * voltage(state, to_double(p->u_dc)) - I * w * mid;
}

static int changed(int from, int to)
{
    const int x = from ^ to;
    return (x & 1) + ((x >> 1) & 1) + ((x >> 2) & 1);
}

/* Least cost of a continuation that begins with `first` (or with any, if it is negative). */
static double least(const problem *p, double complex i, int before, int interval, int first)
{
    double best = INFINITY;
    for (int s = 0; s < 8; s++) {
        if (first >= 0 && s != first) {
            continue;
        }
        const double complex next = step(p, i, s, interval);
        const double complex target = (to_double(p->set.reference.gain) * to_double(p->i_ref.d) +
                                       to_double(p->set.reference.magnet_pu) +
                                       I * to_double(p->set.reference.gain) * to_double(p->i_ref.q)) *
                                      turned(to_double(p->theta) + (interval + 1.0) * to_double(p->speed));
        double cost =
            creal((target - next) * conj(target - next)) + to_double(p->set.weight) * changed(before, s);
        if (interval < p->set.horizon) {
            cost += least(p, next, s, interval + 1, -1);
        }
        best = fmin(best, cost);
    }
    return best;
}

static problem random_problem(uint64_t *seed, int horizon)
{
    const iqfoc_exact_winding_t winding = {random_iq24(seed, 0.0, 0.2) * 64, random_iq24(seed, 0.02, 4.0) * 4,
                                           random_iq24(seed, 0.0, 3.0) * 8};
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    problem p;
    p.speed = random_iq24(seed, -0.2, 0.2) & ~1;
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(p.speed);
    p.set.model = iqfoc_exact_at_speed(&law, p.speed);
    p.set.reference = iqfoc_valley_reference_at(&rotor, winding.k_psi_q27 / 8);
    p.set.weight = random_iq24(seed, 0.0, 0.1);
    p.set.horizon = horizon;
    p.i.alpha = random_iq24(seed, -2.0, 2.0);
    p.i.beta = random_iq24(seed, -2.0, 2.0);
    p.i_ref.d = random_iq24(seed, -1.0, 1.0);
    p.i_ref.q = random_iq24(seed, -1.0, 1.0);
    p.state_now = (int32_t)(random_bits(seed) % 8);
    p.theta = random_iq24(seed, -0.5, 0.5);
    p.u_dc = random_iq24(seed, 0.5, 1.5);
    return p;
}

static int32_t choose(const problem *p, uint32_t *nodes)
{
    return iqfoc_finite_set_choose(&p->set, p->i, p->state_now, p->i_ref, p->theta, p->speed, p->u_dc, nodes);
}

/* Another state than the reference's is right only where both cost the same to within the roundings. */
static void the_chosen_state_begins_a_best_sequence(void)
{
    uint64_t seed = 1;
    for (int horizon = 1; horizon <= IQFOC_FINITE_SET_HORIZON; horizon++) {
        double most = 0.0;
        uint32_t nodes = 0;
        const int tries = horizon == 3 ? TRIES / 10 : TRIES;
        for (int n = 0; n < tries; n++) {
            const problem p = random_problem(&seed, horizon);
            const int32_t chosen = choose(&p, &nodes);
            const double complex i_next =
                step(&p, to_double(p.i.alpha) + I * to_double(p.i.beta), p.state_now, 0);
            const double best = least(&p, i_next, p.state_now, 1, -1);
            const double of_chosen = least(&p, i_next, p.state_now, 1, chosen);
            most = fmax(most, of_chosen - best);
        }
        printf("  horizon %d: worse than the best by %.1e at most, %.1f nodes\n", horizon, most,
               (double)nodes / tries);
        TEST_ASSERT_TRUE(most < 1e-5); /* 20 LSB of current at an error of 4 */
        const uint32_t all = horizon == 1 ? 8 : horizon == 2 ? 72 : 584;
        TEST_ASSERT_TRUE(nodes >= 8 * (uint32_t)tries && nodes <= all * (uint32_t)tries);
        TEST_ASSERT_TRUE(horizon == 1 || nodes < 2 * all / 3 * (uint32_t)tries);
    }
}

static void the_voltages_are_the_inverters(void)
{
    for (int s = 0; s < 8; s++) {
        const iqfoc_ab_t u = iqfoc_finite_set_voltage(s, IQ24(1.25));
        const double complex want = voltage(s, 1.25);
        TEST_ASSERT_TRUE(fabs((double)u.alpha - 16777216.0 * creal(want)) <= 0.7);
        TEST_ASSERT_TRUE(fabs((double)u.beta - 16777216.0 * cimag(want)) <= 0.7);
    }
}

/* A weight that nothing outweighs keeps every leg where it is; a little one prefers the nearer of both zero
 * states. */
static void switching_is_weighed(void)
{
    uint64_t seed = 2;
    for (int n = 0; n < 500; n++) {
        problem p = random_problem(&seed, 1 + n % 3);
        p.set.model.k_u_q26 = INT32_C(1) << 20;
        p.set.weight = IQ24_ONE;
        TEST_ASSERT_EQUAL_INT32(p.state_now, choose(&p, NULL));
    }
    problem p = random_problem(&seed, 1);
    const iqfoc_dq_t none = {0, 0};
    const iqfoc_ab_t no_current = {0, 0};
    p.speed = 0;
    p.i = no_current;
    p.i_ref = none;
    p.set.reference.magnet_pu = 0;
    p.set.model.w_real_q26 = 0;
    p.set.model.w_imag_q26 = 0;
    p.set.model.k_u_q26 = INT32_C(1) << 26;
    p.set.weight = 1;
    p.state_now = 7;
    TEST_ASSERT_EQUAL_INT32(7, choose(&p, NULL));
    p.state_now = 0;
    TEST_ASSERT_EQUAL_INT32(0, choose(&p, NULL));
}

static void a_horizon_outside_is_the_nearest(void)
{
    uint64_t seed = 3;
    for (int n = 0; n < 300; n++) {
        problem p = random_problem(&seed, 1);
        const int32_t one = choose(&p, NULL);
        p.set.horizon = -5;
        TEST_ASSERT_EQUAL_INT32(one, choose(&p, NULL));
        p.set.horizon = 3;
        const int32_t three = choose(&p, NULL);
        p.set.horizon = 100;
        TEST_ASSERT_EQUAL_INT32(three, choose(&p, NULL));
    }
}

/* The corners of every range, under the sanitizers too. */
static void extremes_are_held(void)
{
    const iqfoc_exact_winding_t winding = {0, INT32_C(1) << 30, INT32_C(1) << 30};
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    for (int corner = 0; corner < 32; corner++) {
        problem p;
        p.speed = corner & 1 ? IQFOC_ROTOR_SPEED_MAX : -IQFOC_ROTOR_SPEED_MAX;
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(p.speed);
        p.set.model = iqfoc_exact_at_speed(&law, p.speed);
        p.set.reference = iqfoc_valley_reference_at(&rotor, IQ24(8.0));
        p.set.weight = IQ24_ONE;
        p.set.horizon = 3;
        p.i.alpha = corner & 2 ? IQ24(15.0) : IQ24(-15.0);
        p.i.beta = corner & 4 ? IQ24(15.0) : IQ24(-15.0);
        p.i_ref.d = corner & 8 ? IQ24(20.0) : IQ24(-20.0);
        p.i_ref.q = corner & 16 ? IQ24(20.0) : IQ24(-20.0);
        p.state_now = corner % 8;
        p.theta = corner & 2 ? IQ24_MAX : IQ24_MIN;
        p.u_dc = IQ24(2.0);
        uint32_t nodes = 0;
        const int32_t state = choose(&p, &nodes);
        TEST_ASSERT_TRUE(state >= 0 && state < 8);
        TEST_ASSERT_TRUE(nodes >= 24 && nodes <= 584);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_chosen_state_begins_a_best_sequence);
    RUN_TEST(the_voltages_are_the_inverters);
    RUN_TEST(switching_is_weighed);
    RUN_TEST(a_horizon_outside_is_the_nearest);
    RUN_TEST(extremes_are_held);
    return UNITY_END();
}
