/*
 * The current reference: most torque per ampere, field weakening that holds the voltage at its limit, and the current
 * limits, against the formulas and against a machine in double precision.
 */
#include "iqfoc/reference.h"
#include "reference.h"

#include <stdbool.h>

#define DRAWS 400000
#define SEED  UINT64_C(8000)

void setUp(void)
{
}

void tearDown(void)
{
}

static double held(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/* The header's formulas. z: the integral after the step. */
static void formulas(const iqfoc_reference_config_t *c, double torque, double i_q_before, double z,
                     double *i_d, double *i_q)
{
    const double s = to_double(c->saliency);
    const double i_d0 = -s * i_q_before * i_q_before / (1.0 + sqrt(1.0 + s * s * i_q_before * i_q_before));
    *i_d = fmax(i_d0 + z, to_double(c->i_d_min));
    const double k = fmax(1.0 - s * *i_d / 2.0, 0.25);
    const double i_max = to_double(c->i_max);
    const double most = fmax(sqrt(fmax(i_max * i_max - *i_d * *i_d, 0.0)) + i_d0 + z - *i_d, 0.0);
    *i_q = held(s == 0.0 ? torque : torque / k, -most, most);
}

static iqfoc_reference_config_t random_config(uint64_t *seed, bool salient)
{
    iqfoc_reference_config_t c;
    c.i_max = random_iq24(seed, 0.2, 4.0);
    c.i_d_min = -iq24_mul_trunc(c.i_max, random_iq24(seed, 0.0, 1.0));
    c.saliency = salient ? to_iq24(uniform(seed, -10.9, 10.9) / to_double(c.i_max)) : 0;
    c.gain = random_iq24(seed, 0.0, 8.0);
    c.share = random_iq24(seed, 0.5, 1.125);
    return c;
}

static void test_step_is_the_formulas(void)
{
    uint64_t seed = SEED;
    worst i_d_error = {"i_d", 0.0};
    worst i_q_error = {"i_q", 0.0};
    double z_error = 0.0;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_reference_config_t c = random_config(&seed, n % 4 != 0);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_reference_check(&c));
        const double z_before = uniform(&seed, n % 2 == 0 ? -8.0 : -0.5, 0.0);
        iqfoc_reference_t r = {(iq24_acc_t)(z_before * 281474976710656.0),
                               iq24_mul_round(c.i_max, random_iq24(&seed, -1.0, 1.0))};
        const double i_q_before = to_double(r.i_q);
        const iqfoc_dq_t u = {random_iq24(&seed, -2.0, 2.0), random_iq24(&seed, -2.0, 2.0)};
        const iq24_t u_limit = random_iq24(&seed, 0.0, 1.5);
        const iq24_t torque = random_iq24(&seed, -8.0, 8.0);
        const iqfoc_dq_t i = iqfoc_reference_step(&r, &c, torque, u, u_limit);
        const double z = (double)r.weakening / 281474976710656.0;
        double i_d = 0.0;
        double i_q = 0.0;
        formulas(&c, to_double(torque), i_q_before, z, &i_d, &i_q);
        worst_add(&i_d_error, i.d, i_d);
        /* Where the circle leaves little, its root is steep: the error is one of the square. */
        const double rest = to_double(c.i_max) * to_double(c.i_max) - i_d * i_d;
        if (rest > 0.25) {
            worst_add(&i_q_error, i.q, i_q);
        }
        TEST_ASSERT_TRUE(i.d >= c.i_d_min);
        TEST_ASSERT_TRUE(hypot(to_double(i.d), to_double(i.q)) <= fmax(to_double(c.i_max), fabs(i_d)) + 4e-4);
        TEST_ASSERT_EQUAL_INT32(i.q, r.i_q);
        /* The integral, where neither end of it was met. */
        const double a = held(to_double(u.d), -1.5, 1.5);
        const double b = held(to_double(u.q), -1.5, 1.5);
        const double most = to_double(c.share) * to_double(u_limit);
        const double want = z_before + to_double(c.gain) * (most * most - a * a - b * b);
        if (z < 0.0 && want > -1.0 && to_double(c.i_max) > 1.5 && i_d > to_double(c.i_d_min)) {
            z_error = fmax(z_error, fabs(z - want) / to_double(c.gain) * 16777216.0);
        }
        TEST_ASSERT_TRUE(z <= 0.0 && z >= -12.0);
    }
    worst_check(&i_d_error, 3.0);
    worst_check(&i_q_error, 16.0);
    printf("  z: %.2f LSB per gain\n", z_error);
    TEST_ASSERT_TRUE(z_error <= 2.0 && z_error > 0.5);
}

/* The settled reference makes the torque asked for, and no shorter current makes it. */
static void test_most_torque_per_ampere(void)
{
    uint64_t seed = SEED + 1;
    for (int n = 0; n < 2000; n++) {
        iqfoc_reference_config_t c = {
            .i_max = IQ24(4.0), .i_d_min = IQ24(-4.0), .gain = 0, .share = IQ24_ONE};
        c.saliency = random_iq24(&seed, -1.2, 2.7);
        const double s = to_double(c.saliency);
        iqfoc_reference_t r = {0, 0};
        const iq24_t torque = random_iq24(&seed, -1.5, 1.5);
        const iqfoc_dq_t no_voltage = {0, 0};
        iqfoc_dq_t i = {0, 0};
        for (int k = 0; k < 60; k++) {
            i = iqfoc_reference_step(&r, &c, torque, no_voltage, IQ24_ONE);
        }
        const double i_d = to_double(i.d);
        const double i_q = to_double(i.q);
        TEST_ASSERT_DOUBLE_WITHIN(3e-6, to_double(torque), i_q * (1.0 - s * i_d / 2.0));
        for (double step = -0.01; step < 0.011; step += 0.02) {
            const double other_q = to_double(torque) / (1.0 - s * (i_d + step) / 2.0);
            TEST_ASSERT_TRUE(hypot(i_d + step, other_q) >= hypot(i_d, i_q) - 1e-7);
        }
    }
}

/* A machine in steady state, per unit: x and emf in voltage per current and voltage at a speed of 1. */
typedef struct machine {
    double r, x_d, x_q, emf;
} machine;

static iqfoc_dq_t voltage_of(const machine *m, double speed, iqfoc_dq_t i)
{
    const double d = m->r * to_double(i.d) - speed * m->x_q * to_double(i.q);
    const double q = m->r * to_double(i.q) + speed * (m->x_d * to_double(i.d) + m->emf);
    const iqfoc_dq_t u = {to_iq24(held(d, -16.0, 16.0)), to_iq24(held(q, -16.0, 16.0))};
    return u;
}

/*
 * Over the speed and back: below the voltage limit nothing is weakened, beyond it the voltage is what it may
 * be to 0.1 %, until the current has no room left; and at each speed it is the same up and down.
 */
static void weakens(double x_q_over_x_d, double torque)
{
    const machine m = {0.02, 0.26, 0.26 * x_q_over_x_d, 0.45};
    const double limit = 0.47;
    iqfoc_reference_config_t c = {
        .i_max = IQ24(1.3), .i_d_min = IQ24(-1.0), .gain = IQ24(0.05), .share = IQ24(0.98)};
    c.saliency = to_iq24(2.0 * (m.x_q - m.x_d) / m.emf);
    iqfoc_reference_t r = {0, 0};
    iqfoc_dq_t up[41];
    int weakened = 0;
    for (int way = 0; way < 2; way++) {
        for (int n = 0; n <= 40; n++) {
            const int at = way == 0 ? n : 40 - n;
            const double speed = 0.05 * at;
            iqfoc_dq_t i = {0, r.i_q};
            for (int k = 0; k < 4000; k++) {
                i = iqfoc_reference_step(&r, &c, to_iq24(torque), voltage_of(&m, speed, i), to_iq24(limit));
            }
            const iqfoc_dq_t u = voltage_of(&m, speed, i);
            const double length = hypot(to_double(u.d), to_double(u.q));
            TEST_ASSERT_TRUE(length < 0.98 * limit * 1.001);
            if (r.weakening < 0) {
                TEST_ASSERT_DOUBLE_WITHIN(0.001 * limit, 0.98 * limit, length);
                weakened += i.d > c.i_d_min ? 1 : 0;
            }
            TEST_ASSERT_TRUE(i.d >= c.i_d_min && hypot(to_double(i.d), to_double(i.q)) <= 1.3 + 1e-6);
            if (way == 0) {
                up[at] = i;
            } else {
                TEST_ASSERT_INT32_WITHIN(IQ24(1e-4), up[at].d, i.d);
                TEST_ASSERT_INT32_WITHIN(IQ24(1e-4), up[at].q, i.q);
            }
        }
    }
    TEST_ASSERT_TRUE(weakened > 4);
    /* At twice the speed at which the EMF alone takes the voltage, little of the torque is left, and some is. */
    TEST_ASSERT_TRUE(fabs(to_double(up[40].q)) < 0.9 * fabs(to_double(up[10].q)));
}

static void test_weakening_holds_the_voltage(void)
{
    weakens(1.0, 0.9);
    weakens(1.0, -0.9);
    weakens(1.6, 0.9);
}

static void test_check(void)
{
    const iqfoc_reference_config_t good =
        IQFOC_REFERENCE(100.0, 5.2e-3, 6.2e-3, 0.134, 2e-4, 14.85, 750.0, 2513.0, 350.0, 20.0, -10.0, 0.98);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_reference_check(&good));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 * 1e-3 * 14.85 / 0.134, to_double(good.saliency));
    const double x = 2513.0 * 5.2e-3 * 14.85 / 750.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100.0 * 2e-4 / (2.0 * 350.0 / 750.0 * x), to_double(good.gain));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_reference_check(NULL));
    iqfoc_reference_config_t c = good;
    c.i_max = IQ24(4.01);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_CURRENT_LIMIT, iqfoc_reference_check(&c));
    c = good;
    c.i_d_min = 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_CURRENT_LIMIT, iqfoc_reference_check(&c));
    c = good;
    c.saliency = IQ24(-100.0);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SALIENCY, iqfoc_reference_check(&c));
    c = good;
    c.gain = -1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_WEAKENING, iqfoc_reference_check(&c));
    c = good;
    c.share = IQ24(1.2);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_WEAKENING, iqfoc_reference_check(&c));
}

/* The limit that falls at once and rises slowly, and the jump of z that goes with it, against the formulas. */
static void test_link_is_the_formulas(void)
{
    uint64_t seed = SEED + 1;
    double low_error = 0.0;
    double z_error = 0.0;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_reference_config_t c = random_config(&seed, false);
        const double z_before = uniform(&seed, -8.0, 0.0);
        iqfoc_reference_t r = {(iq24_acc_t)(z_before * 281474976710656.0), 0};
        iqfoc_reference_link_t link = {random_iq24(&seed, 0.0, n % 2 == 0 ? 64.0 : 2.0),
                                       1 + random_iq24(&seed, 0.0, 1.49)};
        const double g = to_double(link.gain);
        const double before = to_double(link.low);
        const iqfoc_dq_t u = {random_iq24(&seed, -1.5, 1.5), random_iq24(&seed, -1.5, 1.5)};
        const iq24_t u_limit = random_iq24(&seed, 0.0, 1.5);
        const double limit = to_double(u_limit);
        const double low = limit < before ? limit : before + (limit - before) / 128.0;
        const double share = to_double(c.share);
        const double change = share * share * (low * low - before * before);
        const double left =
            share * share * low * low - to_double(u.d) * to_double(u.d) - to_double(u.q) * to_double(u.q);
        const double jump = change < 0.0 ? held(left, change, 0.0) : held(left, 0.0, change);
        const double z = held(z_before + g * jump, -12.0, 0.0);
        const iq24_t taken = iqfoc_reference_link(&r, &link, &c, u, u_limit);
        TEST_ASSERT_EQUAL_INT32(link.low, taken);
        low_error = fmax(low_error, fabs(to_double(link.low) - low));
        z_error = fmax(z_error, fabs((double)r.weakening / 281474976710656.0 - z) / fmax(g, 0.01));
    }
    printf("link: low %.2f LSB, z %.2f LSB per gain\n", low_error * 16777216.0, z_error * 16777216.0);
    TEST_ASSERT_TRUE(low_error * 16777216.0 <= 1.0);
    TEST_ASSERT_TRUE(z_error * 16777216.0 <= 8.0);
}

/* The first limit is taken as it is and moves nothing; a constant one is reached but for 127 LSB; a gain outside counts as the end. */
static void test_link_begins_and_rests(void)
{
    const iqfoc_reference_config_t c = {0, IQ24_ONE, -IQ24_ONE, IQ24(0.1), IQ24_ONE};
    iqfoc_reference_t r = {0, 0};
    iqfoc_reference_link_t link = IQFOC_REFERENCE_LINK(5.2e-3, 14.85, 565.0, 2513.0, 360.0);
    TEST_ASSERT_INT32_WITHIN(to_iq24(1e-3), to_iq24(565.0 * 565.0 / (14.85 * 2.0 * 360.0 * 2513.0 * 5.2e-3)),
                             link.gain);
    const iqfoc_dq_t u = {0, IQ24_ONE};
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5), iqfoc_reference_link(&r, &link, &c, u, IQ24(0.5)));
    TEST_ASSERT_TRUE(r.weakening == 0);
    for (int n = 0; n < 4000; n++) {
        (void)iqfoc_reference_link(&r, &link, &c, u, IQ24(0.75));
    }
    TEST_ASSERT_INT32_WITHIN(127, IQ24(0.75), link.low);
    TEST_ASSERT_TRUE(r.weakening == 0);
    const iq24_t gains[] = {IQ24(-1.0), IQ24(100.0)};
    const double jumps[] = {0.0, -12.0};
    for (int n = 0; n < 2; n++) {
        iqfoc_reference_link_t outside = {gains[n], IQ24(0.75)};
        r.weakening = 0;
        (void)iqfoc_reference_link(&r, &outside, &c, u, IQ24(0.5));
        TEST_ASSERT_EQUAL_DOUBLE(jumps[n], (double)r.weakening / 281474976710656.0);
    }
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_step_is_the_formulas);
    RUN_TEST(test_most_torque_per_ampere);
    RUN_TEST(test_weakening_holds_the_voltage);
    RUN_TEST(test_link_is_the_formulas);
    RUN_TEST(test_link_begins_and_rests);
    RUN_TEST(test_check);
    return UNITY_END();
}
