/*
 * Overmodulation: the nearest point of the hexagon, a fundamental equal to the requested one up to six-step, and
 * duties that depend continuously on the voltage alone.
 */
#include "iqfoc/overmodulation.h"
#include "reference.h"

#include <stdbool.h>
#include <string.h>

#define DRAWS  400000
#define SEED   UINT64_C(577350)
#define CIRCLE 0.57735026918962576
#define SIDES  0.60899778104422938 /* U(2/3) */

static const double pi = 3.14159265358979323846;

void setUp(void)
{
}

void tearDown(void)
{
}

typedef struct legs {
    double of[3];
} legs;

static void phases(double alpha, double beta, double x[3])
{
    x[0] = alpha;
    x[1] = -alpha / 2.0 + sqrt(3.0) / 2.0 * beta;
    x[2] = -alpha / 2.0 - sqrt(3.0) / 2.0 * beta;
}

/* The nearest point of the hexagon by another way than cutting duties: by projection onto each of its sides. */
static void nearest_point(double *alpha, double *beta)
{
    double best = INFINITY;
    const double a = *alpha;
    const double b = *beta;
    double x[3];
    phases(a, b, x);
    if (fmax(fmax(x[0], x[1]), x[2]) - fmin(fmin(x[0], x[1]), x[2]) <= 1.0) {
        return;
    }
    for (int side = 0; side < 6; side++) {
        const double n = (side + 0.5) * pi / 3.0; /* the side's normal */
        const double along = fmax(-1.0 / 3.0, fmin(1.0 / 3.0, -a * sin(n) + b * cos(n)));
        const double p = CIRCLE * cos(n) - along * sin(n);
        const double q = CIRCLE * sin(n) + along * cos(n);
        if (hypot(p - a, q - b) < best) {
            best = hypot(p - a, q - b);
            *alpha = p;
            *beta = q;
        }
    }
}

static legs duties_of(double alpha, double beta)
{
    double x[3];
    legs d;
    nearest_point(&alpha, &beta);
    phases(alpha, beta, x);
    const double high = fmax(fmax(x[0], x[1]), x[2]);
    const double low = fmin(fmin(x[0], x[1]), x[2]);
    for (int n = 0; n < 3; n++) {
        d.of[n] = x[n] + 0.5 - (high + low) / 2.0;
    }
    return d;
}

static iqfoc_ab_t random_vector(uint64_t *seed, double reach)
{
    const double angle = uniform(seed, 0.0, 2.0 * pi);
    const double length = uniform(seed, 0.0, reach);
    const iqfoc_ab_t u = {to_iq24(length * cos(angle)), to_iq24(length * sin(angle))};
    return u;
}

static void test_nearest_is_the_nearest(void)
{
    uint64_t seed = SEED;
    double largest = 0.0;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_ab_t u = random_vector(&seed, n % 4 == 0 ? 32.0 : 1.2);
        const iq24_t inverse = random_iq24(&seed, 0.5, 2.0);
        const iqfoc_duties_t d = iqfoc_modulate_nearest(u, inverse);
        const double alpha = to_double(u.alpha) * to_double(inverse);
        const double beta = to_double(u.beta) * to_double(inverse);
        const legs want = duties_of(alpha, beta);
        worst duty = {"", 0.0};
        worst_add(&duty, d.high.a, want.of[0]);
        worst_add(&duty, d.high.b, want.of[1]);
        worst_add(&duty, d.high.c, want.of[2]);
        largest = fmax(largest, duty.lsb / (3.0 + hypot(alpha, beta)));
        const iqfoc_duties_t kept = iqfoc_modulate(u, inverse, IQ24_ONE);
        TEST_ASSERT_EQUAL_INT32(kept.scale, d.scale);
        if (kept.scale == IQ24_ONE) {
            TEST_ASSERT_EQUAL_INT(0, memcmp(&kept, &d, sizeof d));
        }
    }
    printf("  nearest: %.2f of the stated bound\n", largest);
    TEST_ASSERT_TRUE(largest <= 1.0 && largest > 0.4);
}

static void test_voltage_of_duties(void)
{
    uint64_t seed = SEED + 1;
    worst error = {"voltage of duties", 0.0};
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_abc_t d = {random_iq24(&seed, 0.0, 1.0), random_iq24(&seed, 0.0, 1.0),
                               random_iq24(&seed, 0.0, 1.0)};
        const iq24_t u_dc = random_iq24(&seed, 0.0, 2.0);
        const iqfoc_ab_t u = iqfoc_modulated_voltage(d, u_dc);
        worst_add(&error, u.alpha,
                  (2.0 * to_double(d.a) - to_double(d.b) - to_double(d.c)) / 3.0 * to_double(u_dc));
        worst_add(&error, u.beta, (to_double(d.b) - to_double(d.c)) / sqrt(3.0) * to_double(u_dc));
    }
    worst_check(&error, 1.9);
}

/* The header's U(M), and by bisection its inverse. */
static double fundamental_of(double M)
{
    if (M <= CIRCLE) {
        return M;
    }
    if (M <= 2.0 / 3.0) {
        const double d = acos(CIRCLE / M);
        return M * (1.0 - 3.0 / pi * (d - sin(2.0 * d) / 2.0));
    }
    const double d = asin(1.0 / (3.0 * M));
    return (d / sin(d) + cos(d)) / pi;
}

static double limit_of(double speed)
{
    const double h = pi * fabs(speed);
    const double limit = h == 0.0 ? 2.0 / pi : (h / sin(h) + cos(h)) / pi;
    return fmin(fmax(limit, SIDES), fundamental_of(8.0));
}

/* Every speed. At the limit a leg goes from end to end in just one cycle. */
static void test_limit_at_every_speed(void)
{
    worst error = {"limit", 0.0};
    for (int32_t speed = -IQFOC_ROTOR_SPEED_MAX; speed <= IQFOC_ROTOR_SPEED_MAX;
         speed += 7 * IQFOC_TEST_STRIDE) {
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
        worst_add(&error, iqfoc_overmodulation_limit(&rotor), limit_of(to_double(speed)));
    }
    worst_check(&error, 1.3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, CIRCLE, fundamental_of(CIRCLE * (1.0 + 1e-13)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, SIDES, fundamental_of(2.0 / 3.0 + 1e-10));
    TEST_ASSERT_INT32_WITHIN(1, to_iq24(SIDES), IQFOC_OVERMODULATION_SIDES);
    TEST_ASSERT_INT32_WITHIN(1, to_iq24(fundamental_of(8.0)), IQFOC_OVERMODULATION_MOST);
}

static iqfoc_duties_t settled(double length, double angle, iq24_t limit)
{
    iqfoc_overmodulation_t state = {to_iq24(fmax(length, CIRCLE))};
    const iqfoc_ab_t u = {to_iq24(length * cos(angle)), to_iq24(length * sin(angle))};
    return iqfoc_overmodulate(&state, u, IQ24_ONE, limit);
}

/* The first harmonic of the vector over a turn, in double, of what the legs make. */
static double fundamental(double length, iq24_t limit)
{
    const int points = 6000;
    double sum = 0.0;
    for (int n = 0; n < points; n++) {
        const double angle = 2.0 * pi * (n + 0.5) / points;
        const iqfoc_duties_t d = settled(length, angle, limit);
        const iqfoc_ab_t u = iqfoc_modulated_voltage(d.high, IQ24_ONE);
        sum += to_double(u.alpha) * cos(angle) + to_double(u.beta) * sin(angle);
    }
    return sum / points;
}

static void test_fundamental_is_what_was_asked_for(void)
{
    double largest = 0.0;
    for (double length = 0.1; length < 0.6364; length += length < 0.57 ? 0.05 : 0.0007) {
        const double error = fundamental(length, IQFOC_OVERMODULATION_MOST) - length;
        largest = fmax(largest, fabs(error));
    }
    printf("  fundamental within %.2e of u_dc\n", largest);
    TEST_ASSERT_TRUE(largest < 3e-4 && largest > 1e-5);
    /* The formula at the top is that of six-step: 2/pi but for 2e-4. */
    TEST_ASSERT_DOUBLE_WITHIN(3e-4, 2.0 / pi, fundamental(0.6364, IQFOC_OVERMODULATION_MOST));
    TEST_ASSERT_DOUBLE_WITHIN(3e-4, 2.0 / pi, fundamental(2.0, IQFOC_OVERMODULATION_MOST));
}

/*
 * The duties against the law: within 20 LSB of what lengths 4 LSB shorter to 4 LSB longer give. The polynomial
 * that stands for the inverse of U(M) below U(2/3) is the library's own choice and so is part of the law here:
 * what it costs is what the test above measures.
 */
static double shortness_of(double m)
{
    const double y = sqrt(2.0 - pi * m);
    if (m <= CIRCLE) {
        return 1.0;
    }
    if (m < SIDES) {
        const double t = fmin(fmax((0.431509717 - y) * 7.302986654, 0.0), 1.0);
        const double bow = -0.07625095 + t * (-0.0775615 + t * (0.18461749 - t * 0.24900165));
        return 1.0 - t * (0.086503328 + (1.0 - t) * bow);
    }
    double low = 2.0 / 3.0;
    double high = 9.0;
    for (int n = 0; n < 60; n++) {
        const double mid = (low + high) / 2.0;
        *(fundamental_of(mid) < m ? &low : &high) = mid;
    }
    return m / low;
}

static double held(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

static double length_to_make(double asked, double before, double limit, double *slow)
{
    before = fmax(before, CIRCLE);
    *slow = before + (fmax(asked, CIRCLE) - before) / 8.0;
    const double beyond = 32.0 * fmin(*slow - CIRCLE, 1.0 / 32.0);
    const double near = 8.0 * held(asked - (CIRCLE - 0.125), 0.0, 0.125);
    return fmin(asked + held(beyond * near * held(*slow - asked, -1.0, 1.0), -0.0625, 0.0625), limit);
}

static void test_duties_follow_the_law(void)
{
    uint64_t seed = SEED + 2;
    double largest = 0.0;
    worst follow = {"length", 0.0};
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_ab_t u = random_vector(&seed, n % 8 == 0 ? 32.0 : 0.9);
        const iq24_t inverse = random_iq24(&seed, 0.5, 2.0);
        const iq24_t limit = random_iq24(&seed, CIRCLE, 0.6364);
        iqfoc_overmodulation_t state = {random_iq24(&seed, 0.0, n % 2 == 0 ? 0.7 : 8.0)};
        const double alpha = to_double(u.alpha) * to_double(inverse);
        const double beta = to_double(u.beta) * to_double(inverse);
        const double length = hypot(alpha, beta);
        double slow = 0.0;
        const double m = length_to_make(fmin(length, 8.0), to_double(state.length), to_double(limit), &slow);
        const bool linear = length < CIRCLE - 1e-6 && state.length <= IQFOC_OVERMODULATION_CIRCLE;
        const iqfoc_duties_t d = iqfoc_overmodulate(&state, u, inverse, limit);
        const iq24_t got[3] = {d.high.a, d.high.b, d.high.c};
        const double off = 4.0 / 16777216.0;
        const double less = fmax(m - off, 0.0) / shortness_of(m - off) / fmax(length, 1e-9);
        const double more = (m + off) / shortness_of(m + off) / fmax(length, 1e-9);
        const legs from = duties_of(less * alpha, less * beta);
        const legs to = duties_of(more * alpha, more * beta);
        for (int x = 0; x < 3; x++) {
            const double low = fmin(from.of[x], to.of[x]) * 16777216.0;
            const double high = fmax(from.of[x], to.of[x]) * 16777216.0;
            largest = fmax(largest, fmax(low - (double)got[x], (double)got[x] - high));
        }
        if (!linear) {
            worst_add(&follow, state.length, slow);
        }
        const double allowed = to_double(limit) * 33.0 / 32.0;
        const double scale = fmin(1.0, allowed / fmax(fmin(length, 8.0), 1e-9));
        TEST_ASSERT_INT32_WITHIN(16, to_iq24(scale), d.scale);
    }
    printf("  duties: %.1f LSB outside of what 4 LSB of the length make\n", largest);
    TEST_ASSERT_TRUE(largest <= 20.0 && largest > 5.0);
    TEST_ASSERT_TRUE(follow.lsb <= 3.0);
}

/* Everything within the stated range and its corners: legs in [0, 1]; within the circle the linear duties. */
static void test_duties_in_range(void)
{
    uint64_t seed = SEED + 3;
    const iq24_t inverses[] = {1, IQ24(0.5), IQ24_ONE, IQ24(2.0)};
    const iq24_t limits[] = {IQFOC_OVERMODULATION_CIRCLE, IQFOC_OVERMODULATION_SIDES,
                             IQFOC_OVERMODULATION_MOST};
    const double lengths[] = {0.0,   6e-8,  0.2887, 0.5773, 0.57735, 0.5774,
                              0.609, 0.636, 0.64,   1.0,    8.0,     31.99};
    for (int n = 0; n < 2000000; n++) {
        const double length = lengths[n % 12];
        const double angle = n % 3 == 0 ? pi / 6.0 * (double)(n % 13) : uniform(&seed, 0.0, 2.0 * pi);
        const iqfoc_ab_t u = {to_iq24(length * cos(angle)), to_iq24(length * sin(angle))};
        const iq24_t inverse = inverses[n / 12 % 4];
        iqfoc_overmodulation_t state = {n % 5 == 0 ? 0 : random_iq24(&seed, 0.0, 8.0)};
        const bool at_rest = state.length <= IQFOC_OVERMODULATION_CIRCLE;
        const iqfoc_duties_t d = iqfoc_overmodulate(&state, u, inverse, limits[n / 48 % 3]);
        const iq24_t high = iq24_max(iq24_max(d.high.a, d.high.b), d.high.c);
        const iq24_t low = iq24_min(iq24_min(d.high.a, d.high.b), d.high.c);
        if (low < 0 || high > IQ24_ONE || d.scale <= 0 || d.scale > IQ24_ONE || state.length < 0) {
            TEST_FAIL_MESSAGE("a duty, the scale or the length out of its range");
        }
        if (at_rest && length * to_double(inverse) < 0.577) {
            const iqfoc_duties_t linear = iqfoc_modulate(u, inverse, IQ24_ONE);
            TEST_ASSERT_EQUAL_INT(0, memcmp(&linear, &d, sizeof d));
        }
    }
}

/*
 * At the limit the legs are in six-step, but in the cycles in which an edge falls: there the duty is the share
 * of the cycle after the edge, that is the edge's mean. The sine that stands for that ramp is less than 0.25 %
 * of the link off it at 12.5 cycles a turn.
 */
static void test_the_limit_is_six_step_with_right_volt_seconds(void)
{
    const double speed = 0.08;
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(to_iq24(speed));
    double largest = 0.0;
    int whole = 0;
    for (int n = 0; n < 5000; n++) {
        const double angle = 2.0 * pi * n / 5000.0;
        const iqfoc_duties_t d = settled(0.7, angle, iqfoc_overmodulation_limit(&rotor));
        const iq24_t got[3] = {d.high.a, d.high.b, d.high.c};
        for (int x = 0; x < 3; x++) {
            /* Leg x is high while cos(angle - x 120 degrees) > 0. */
            double from_rise = fmod(angle - x * 2.0 * pi / 3.0 + pi / 2.0 + 4.0 * pi, 2.0 * pi);
            from_rise = from_rise > 1.5 * pi ? from_rise - 2.0 * pi : from_rise;
            const double edge = from_rise < pi / 2.0 ? from_rise : pi - from_rise;
            const double want = held(0.5 + edge / (2.0 * pi * speed), 0.0, 1.0);
            largest = fmax(largest, fabs(to_double(got[x]) - want));
            whole += got[x] == 0 || got[x] == IQ24_ONE ? 1 : 0;
        }
    }
    printf("  six-step's edges within %.4f\n", largest);
    TEST_ASSERT_TRUE(largest < 0.0025 && largest > 1e-5);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0 - 2.0 * speed, whole / 15000.0);
}

/* Up and down again: the same duties at the same voltage, and never a jump. */
static void test_no_hysteresis_and_no_jump(void)
{
    const int steps = 200000;
    static iqfoc_duties_t up[200001];
    const iq24_t limit = iqfoc_overmodulation_limit(&(iqfoc_rotor_t){.s1 = IQ24_ONE});
    iqfoc_overmodulation_t state = {0};
    int32_t jump = 0;
    int32_t differ = 0;
    for (int way = 0; way < 2; way++) {
        iqfoc_duties_t before = {{0, 0, 0}, 0};
        for (int n = 0; n <= steps; n++) {
            const int at = way == 0 ? n : steps - n;
            const double length = 0.5 + 0.16 * at / steps;
            /* From the middle of a side to its end, so that all legs move. */
            const iqfoc_ab_t u = {to_iq24(length * cos(0.15)), to_iq24(length * sin(0.15))};
            const iqfoc_duties_t d = iqfoc_overmodulate(&state, u, IQ24_ONE, limit);
            if (n > 0) {
                jump = iq24_max(jump, iq24_abs_sat(d.high.a - before.high.a));
                jump = iq24_max(jump, iq24_abs_sat(d.high.b - before.high.b));
            }
            if (way == 0) {
                up[at] = d;
            } else {
                differ = iq24_max(differ, iq24_abs_sat(d.high.b - up[at].high.b));
            }
            before = d;
        }
    }
    printf("  largest step %d LSB, up against down %d LSB\n", (int)jump, (int)differ);
    /* The length follows eight cycles behind: 8 steps of 13 LSB, times the slope of M(U), 12 at its steepest
     * below U(2/3) and rising beyond. */
    TEST_ASSERT_TRUE(jump < 20000);
    TEST_ASSERT_TRUE(differ < 20000);
}

/* A steady harmonic of the length is taken out of it beyond the circle, and left alone within. */
static void test_harmonics_do_not_reach_the_limit(void)
{
    iqfoc_overmodulation_t state = {0};
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(IQ24(0.08));
    const iq24_t limit = iqfoc_overmodulation_limit(&rotor);
    for (int n = 0; n < 400; n++) {
        const double length = to_double(limit) + (n % 2 == 0 ? 0.03 : -0.03) - 0.004;
        const iqfoc_ab_t u = {to_iq24(length), 0};
        const iqfoc_duties_t d = iqfoc_overmodulate(&state, u, IQ24_ONE, limit);
        if (n > 100) {
            TEST_ASSERT_INT32_WITHIN(IQ24(0.005), to_iq24(to_double(limit) - 0.004), state.length);
            TEST_ASSERT_TRUE(d.scale > IQ24(0.98));
        }
    }
    /* A real fall of the voltage is followed at once, but for 1/16. */
    const iqfoc_ab_t low = {IQ24(0.2), 0};
    const iqfoc_ab_t none = {0, 0};
    const iqfoc_duties_t d = iqfoc_overmodulate(&state, low, IQ24_ONE, limit);
    TEST_ASSERT_INT32_WITHIN(4, IQ24(0.2), iqfoc_modulated_voltage(d.high, IQ24_ONE).alpha);
    const iqfoc_duties_t nothing = iqfoc_overmodulate(&state, none, IQ24_ONE, limit);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 2, nothing.high.a);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 2, nothing.high.b);
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_nearest_is_the_nearest);
    RUN_TEST(test_voltage_of_duties);
    RUN_TEST(test_limit_at_every_speed);
    RUN_TEST(test_fundamental_is_what_was_asked_for);
    RUN_TEST(test_duties_follow_the_law);
    RUN_TEST(test_duties_in_range);
    RUN_TEST(test_the_limit_is_six_step_with_right_volt_seconds);
    RUN_TEST(test_no_hysteresis_and_no_jump);
    RUN_TEST(test_harmonics_do_not_reach_the_limit);
    return UNITY_END();
}
