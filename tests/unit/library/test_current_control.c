/*
 * PI current control: each step against double precision, decoupling, limits and back-calculation.
 */
#include "iqfoc/current_control.h"
#include "reference.h"

#include <stdbool.h>

#define DRAWS 300000
#define SEED  UINT64_C(271828)

void setUp(void)
{
}

void tearDown(void)
{
}

static const double limit = 8.0;

static double acc_to_double(iq24_acc_t x)
{
    return (double)x / 281474976710656.0;
}

/* How near to the limit that it passed a held value comes: 2^-16. */
static const double hold_error = 1.0 / 65536.0;

static double held(double u)
{
    return fmax(-limit, fmin(limit, u));
}

/* Whether a value that should have been `want` was held as it should be. */
static bool held_right(double got, double want)
{
    return got >= -limit && got < limit && fabs(got - held(want)) <= hold_error;
}

/* The error of a value within the limits; one beyond them must be held. */
static void held_add(worst *w, iq24_t got, double want)
{
    if (fabs(want) < limit) {
        worst_add(w, got, want);
    } else {
        TEST_ASSERT_TRUE(held_right(to_double(got), want));
    }
}

/* The same for an integrator: its error, 0 where it was held. */
static double integral_off(iq24_acc_t got, double want)
{
    if (fabs(want) < limit) {
        return fabs(acc_to_double(got) - want);
    }
    TEST_ASSERT_TRUE(held_right(acc_to_double(got), want));
    return 0.0;
}

static iqfoc_dq_t random_dq(uint64_t *seed, double reach)
{
    const iqfoc_dq_t v = {random_iq24(seed, -reach, reach), random_iq24(seed, -reach, reach)};
    return v;
}

static void test_a_step_is_its_formula(void)
{
    uint64_t seed = SEED;
    worst voltage = {"voltage", 0.0};
    double integral_error = 0.0;
    double largest_share = 0.0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const bool extreme = n % 4 == 0;
        const double gain = extreme ? 32.0 : 3.0;
        const double reactance = extreme ? 96.0 : 6.0;
        const iqfoc_current_control_gains_t g = {
            random_iq24(&seed, 0.0, gain),      random_iq24(&seed, 0.0, gain),
            random_iq24(&seed, 0.0, gain),      random_iq24(&seed, 0.0, gain),
            random_iq24(&seed, 0.0, 1.0),       random_iq24(&seed, 0.0, reactance),
            random_iq24(&seed, 0.0, reactance), random_iq24(&seed, 0.0, reactance)};
        const iqfoc_dq_t start = random_dq(&seed, n % 3 == 0 ? limit : 0.5);
        iqfoc_current_control_t control = {iq24_acc_mul(start.d, IQ24_ONE) + 12345,
                                           iq24_acc_mul(start.q, IQ24_ONE)};
        const iqfoc_current_control_t before = control;
        const iqfoc_dq_t ref = random_dq(&seed, extreme ? 32.0 : 1.0);
        const iqfoc_dq_t i = random_dq(&seed, extreme ? 32.0 : 1.0);
        const iq24_t speed = random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0);
        const iqfoc_dq_t u = iqfoc_current_control_step(&control, &g, ref, i);
        const double e_d = to_double(ref.d) - to_double(i.d);
        const double e_q = to_double(ref.q) - to_double(i.q);
        const double I_d = acc_to_double(before.integral_d);
        const double I_q = acc_to_double(before.integral_q);
        held_add(&voltage, u.d, to_double(g.kp_d) * e_d + I_d);
        held_add(&voltage, u.q, to_double(g.kp_q) * e_q + I_q);
        integral_error =
            fmax(integral_error, integral_off(control.integral_d, I_d + to_double(g.ki_d) * e_d));
        integral_error =
            fmax(integral_error, integral_off(control.integral_q, I_q + to_double(g.ki_q) * e_q));

        const iqfoc_dq_t apart = iqfoc_current_control_decoupling(&g, i, speed);
        const double x = to_double(speed);
        worst decoupling = {"", 0.0};
        held_add(&decoupling, apart.d, -x * to_double(g.x_q) * to_double(i.q));
        held_add(&decoupling, apart.q, x * (to_double(g.x_d) * to_double(i.d) + to_double(g.emf)));
        const double bound = 1.5 + 0.5 * fmax(fabs(to_double(i.d)), fabs(to_double(i.q)));
        largest_share = fmax(largest_share, decoupling.lsb / bound);
    }
    worst_check(&voltage, 1.0);
    printf("  decoupling: %.2f of the stated bound; integrator %.1e\n", largest_share, integral_error);
    TEST_ASSERT_TRUE(largest_share <= 1.0 && largest_share > 0.5);
    TEST_ASSERT_TRUE(integral_error < 1e-13); /* exact; the reference's own rounding */
}

static void test_back_calculation(void)
{
    const iqfoc_current_control_gains_t g = {IQ24_ONE, IQ24_ONE, IQ24(0.1), IQ24(0.1), IQ24(0.25), 0, 0, 0};
    iqfoc_current_control_t control = {iq24_acc_mul(IQ24(0.5), IQ24_ONE), iq24_acc_mul(IQ24(-0.5), IQ24_ONE)};
    const iqfoc_current_control_t before = control;
    const iqfoc_dq_t u = {IQ24(1.0), IQ24(-2.0)};
    iqfoc_current_control_limited(&control, &g, u, IQ24_ONE);
    TEST_ASSERT_EQUAL_INT64(before.integral_d, control.integral_d);
    TEST_ASSERT_EQUAL_INT64(before.integral_q, control.integral_q);
    iqfoc_current_control_limited(&control, &g, u, IQ24(0.6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.5 - 0.25 * 0.4, acc_to_double(control.integral_d));
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, -0.5 + 0.25 * 0.4 * 2.0, acc_to_double(control.integral_q));
    /* An integrator at its end stays there. */
    const iqfoc_dq_t huge = {IQ24(-16.0), IQ24(16.0)};
    for (int32_t n = 0; n < 50; n++) {
        iqfoc_current_control_limited(&control, &g, huge, 0);
    }
    TEST_ASSERT_TRUE(acc_to_double(control.integral_d) < limit);
    TEST_ASSERT_TRUE(acc_to_double(control.integral_d) >= limit - hold_error);
    TEST_ASSERT_TRUE(acc_to_double(control.integral_q) >= -limit);
    TEST_ASSERT_TRUE(acc_to_double(control.integral_q) <= -limit + hold_error);
}

/* Preset, a step without an error asks for the voltage that was given, whatever speed and current. */
static void test_preset_goes_on(void)
{
    uint64_t seed = SEED;
    worst voltage = {"the voltage after a preset", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        iqfoc_current_control_gains_t g = {IQ24(3.0), IQ24(2.0), IQ24(0.1), IQ24(0.2), 0, 0, 0, 0};
        g.x_d = random_iq24(&seed, 0.0, 6.0);
        g.x_q = random_iq24(&seed, 0.0, 6.0);
        g.emf = random_iq24(&seed, 0.0, 6.0);
        const iqfoc_dq_t i = random_dq(&seed, 2.0);
        const iqfoc_dq_t u = random_dq(&seed, 1.5);
        const iq24_t speed = random_iq24(&seed, -0.33, 0.33);
        iqfoc_current_control_t control = {0, 0};
        iqfoc_current_control_preset(&control, &g, u, i, speed);
        const iqfoc_dq_t next = iqfoc_current_control_voltage(&control, &g, i, i, speed);
        worst_add(&voltage, next.d, to_double(u.d));
        worst_add(&voltage, next.q, to_double(u.q));
    }
    worst_check(&voltage, 3.0);
    /* What does not fit is held. */
    iqfoc_current_control_gains_t g = {0, 0, 0, 0, 0, IQ24(96.0), IQ24(96.0), IQ24(96.0)};
    const iqfoc_dq_t i = {IQ24(-32.0), IQ24(32.0)};
    const iqfoc_dq_t u = {IQ24(8.0), IQ24(-8.0)};
    iqfoc_current_control_t control = {0, 0};
    iqfoc_current_control_preset(&control, &g, u, i, IQ24(-0.33));
    TEST_ASSERT_TRUE(held_right(acc_to_double(control.integral_d), 0.0));
    TEST_ASSERT_TRUE(held_right(acc_to_double(control.integral_q), -16.0));
}

static void test_no_error_is_too_small_to_be_integrated(void)
{
    const iqfoc_current_control_gains_t g = {0, 0, IQ24(0.001), IQ24(0.001), 0, 0, 0, 0};
    iqfoc_current_control_t control = {0, 0};
    const iqfoc_dq_t ref = {1, -1};
    const iqfoc_dq_t none = {0, 0};
    for (int32_t n = 0; n < 5000; n++) {
        (void)iqfoc_current_control_step(&control, &g, ref, none);
    }
    TEST_ASSERT_INT32_WITHIN(1, 5, iq24_acc_trunc(control.integral_d));
    TEST_ASSERT_INT32_WITHIN(1, -5, iq24_acc_trunc(control.integral_q));
}

/*
 * A first-order winding behind a limited voltage: the step back must not wait for the integrator to unwind.
 */
static double overshoot_after_saturation(iq24_t anti_windup)
{
    const iqfoc_current_control_gains_t g = {IQ24(0.5),   IQ24(0.5), IQ24(0.1), IQ24(0.1),
                                             anti_windup, 0,         0,         0};
    iqfoc_current_control_t control = {0, 0};
    double i = 0.0;
    double largest = 0.0;
    for (int32_t n = 0; n < 400; n++) {
        const iqfoc_dq_t ref = {0, n < 200 ? IQ24(4.0) : IQ24(0.5)};
        const iqfoc_dq_t now = {0, to_iq24(i)};
        const iqfoc_dq_t u = iqfoc_current_control_step(&control, &g, ref, now);
        const double wanted = fabs(to_double(u.q));
        const double scale = wanted > 0.3 ? 0.3 / wanted : 1.0;
        iqfoc_current_control_limited(&control, &g, u, to_iq24(scale));
        i += 0.5 * to_double(u.q) * scale - 0.1 * i;
        if (n > 215) {
            largest = fmax(largest, i - 0.5);
        }
    }
    return largest;
}

static void test_anti_windup_matters(void)
{
    const double without = overshoot_after_saturation(0);
    const double with = overshoot_after_saturation(IQ24(0.5));
    printf("  left above the reference 15 cycles after a limited step: %.3f without, %.3f with\n", without,
           with);
    TEST_ASSERT_TRUE(without > 0.5);
    TEST_ASSERT_TRUE(with < 0.1);
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_a_step_is_its_formula);
    RUN_TEST(test_back_calculation);
    RUN_TEST(test_preset_goes_on);
    RUN_TEST(test_no_error_is_too_small_to_be_integrated);
    RUN_TEST(test_anti_windup_matters);
    return UNITY_END();
}
