/*
 * Speed control (include/iqfoc/speed_control.h): one step against the lines of the header in double, the poles, the dip of a load step,
 * limits without wind-up, and any state and input.
 */
#include "iqfoc/speed_control.h"
#include "reference.h"

#include <stdlib.h>

#define SEED  UINT64_C(60451)
#define DRAWS 400000
#define T_S   2e-4
#define W     40.0
#define N     5
#define PAIRS 3
#define PSI   0.134
#define I_B   IQFOC_I_BASE(10.5)
#define J     2e-3

static const double q32 = 4294967296.0;
static const double q48 = 281474976710656.0;
static const double limit_turns = IQFOC_ROTOR_SPEED_MAX / 16777216.0;

static const iqfoc_speed_control_config_t usual =
    IQFOC_SPEED_CONTROL(W, J, PAIRS, PSI, T_S, I_B, 4000.0, 20.0, N);

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

static iqfoc_speed_control_config_t any_config(uint64_t *seed)
{
    iqfoc_speed_control_config_t c;
    const double kp = pow(10.0, uniform(seed, -3.0, 4.5));
    c.kp_q16 = (int32_t)(65536.0 * kp);
    c.share = random_iq24(seed, 0.0, uniform(seed, 0.0, 1.0));
    c.ramp_q32 = 1 + (int32_t)(q32 * 0.25 * pow(10.0, uniform(seed, -8.0, -0.01)));
    c.i_max = 1 + random_iq24(seed, 0.0, 3.99);
    c.i_ramp = (iq24_t)((double)c.i_max * uniform(seed, 0.0, 1.0));
    c.cycles = 1;
    return c;
}

/* Set-point, integral and result of one step in double, from the same state. */
typedef struct step_result {
    double set_point, integral, i_q;
    bool limited;
} step_result;

static step_result in_double(const iqfoc_speed_control_t *c, double target, double speed, double limit)
{
    const double kp = c->config->kp_q16 / 65536.0;
    const double ramp = c->config->ramp_q32 / q32;
    const double before = c->set_point_q32 / q32;
    const double integral = (double)c->integral / q48;
    const double moved = held(target - before, -ramp, ramp);
    const double forward =
        fabs(target - before) >= ramp ? copysign(fmin(to_double(c->config->i_ramp), limit), moved) : 0.0;
    const double wanted = kp * held(before + moved - speed, -0.5, 0.5) + integral + forward;
    const double i_q = held(wanted, -limit, limit);
    const bool limited = i_q != wanted;
    const double share = to_double(c->config->share);
    const step_result r = {
        limited ? held(speed + held((i_q - integral - forward) / kp, -0.5, 0.5), -limit_turns, limit_turns)
                : before + moved,
        integral + share * (i_q - integral - forward), i_q, limited};
    return r;
}

static void test_step(void)
{
    uint64_t seed = SEED;
    worst i_q = {"i_q", 0.0};
    double integral = 0.0;
    double free_set_point = 0.0;
    double limited_set_point = 0.0;
    int32_t limited = 0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const iqfoc_speed_control_config_t config = any_config(&seed);
        iqfoc_speed_control_t c;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &config));
        const double kp = config.kp_q16 / 65536.0;
        const iq24_t target = random_iq24(&seed, -0.33, 0.33);
        const iq24_t speed = random_iq24(&seed, -0.33, 0.33);
        c.set_point_q32 =
            (int32_t)(q32 * held(to_double(speed) + uniform(&seed, -0.5, 0.5) / kp, -0.33, 0.33));
        c.integral = (iq24_acc_t)(q48 * uniform(&seed, -1.0, 1.0));
        const iq24_t limit = random_iq24(&seed, 0.0, to_double(config.i_max));
        const step_result want = in_double(&c, to_double(target), to_double(speed), to_double(limit));
        worst_add(&i_q, iqfoc_speed_control_step(&c, target, speed, limit), want.i_q);
        TEST_ASSERT_EQUAL_INT32(c.i_q, iq24_clamp(c.i_q, -limit, limit));
        integral = fmax(integral, fabs((double)c.integral / q48 - want.integral) * 16777216.0);
        const double off = fabs(c.set_point_q32 - q32 * want.set_point);
        if (want.limited) {
            limited++;
            limited_set_point = fmax(limited_set_point, (off - 0.5) * kp / 256.0);
        } else {
            free_set_point = fmax(free_set_point, off);
        }
    }
    printf("  seed %llu: I %.3f LSB, set-point %.3f of 2^-32, in a limit %.3f LSB over kp beyond half of "
           "one; %d of %d in a limit\n",
           (unsigned long long)SEED, integral, free_set_point, limited_set_point, limited, DRAWS);
    worst_check(&i_q, 0.51);
    TEST_ASSERT_TRUE(integral <= 0.51 && integral >= 0.3);
    TEST_ASSERT_TRUE(free_set_point <= 0.01);
    TEST_ASSERT_TRUE(limited_set_point <= 0.51 && limited_set_point >= 0.3);
    TEST_ASSERT_TRUE(limited > DRAWS / 4 && limited < DRAWS * 3 / 4);
}

/* The macros' formulas, and the order of their values. */
static void test_initialiser(void)
{
    const double a = 1.5 * PAIRS * PAIRS * PSI * I_B * T_S * T_S / (TWO_PI * J);
    const double p = 1.0 / (1.0 + W * N * T_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0 * (1.0 - p) / (a * N), usual.kp_q16 / 65536.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, (1.0 - p) / 2.0, to_double(usual.share));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4000.0 / 60.0 * PAIRS * T_S * T_S * N, usual.ramp_q32 / q32);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 4000.0 / 60.0 * PAIRS * T_S * T_S / a, to_double(usual.i_ramp));
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 20.0 / I_B, to_double(usual.i_max));
    TEST_ASSERT_EQUAL_UINT32(N, usual.cycles);
}

/* A shaft in double, whose current follows at once. */
typedef struct shaft {
    double speed, load, acceleration;
} shaft;

static void turn(shaft *s, double i_q)
{
    s->speed += s->acceleration * (i_q - s->load);
}

static shaft shaft_of(double inertia)
{
    const shaft s = {0.05, 0.0, IQFOC_RAW_SPEED_ACCELERATION(inertia, PAIRS, PSI, I_B, T_S)};
    return s;
}

/*
 * Two poles at p: with x_k the speed's error at step k after a step of the load, x_k/p^k is a polynomial of first degree, and its second
 * difference is 0. The dip is a di/(e w T) at 1/w.
 */
static void test_poles_and_dip(void)
{
    const double p = IQFOC_RAW_SPEED_POLE(W, T_S, N);
    const double step = 0.25;
    shaft s = shaft_of(J);
    iqfoc_speed_control_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &usual));
    iqfoc_speed_control_start(&c, to_iq24(s.speed), 0);
    s.load = step;
    double x[300];
    double most = 0.0;
    int32_t at = 0;
    for (int32_t k = 0; k < 300; k++) {
        x[k] = (s.speed - 0.05) / pow(p, k);
        if (0.05 - s.speed > most) {
            most = 0.05 - s.speed;
            at = k;
        }
        for (int32_t m = 0; m < N; m++) {
            turn(&s, to_double(iqfoc_speed_control_step(&c, IQ24(0.05), to_iq24(s.speed), IQ24(4.0))));
        }
    }
    for (int32_t k = 3; k < 60; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-4 * fabs(x[k]) + 1e-6, 0.0, x[k] - 2.0 * x[k - 1] + x[k - 2]);
    }
    const double want = s.acceleration * step / (exp(1.0) * W * T_S) * (1.0 + 1.5 * W * N * T_S);
    printf("  dip %.3g turns per cycle after %d steps; formula %.3g after %.1f\n", most, at, want,
           1.0 / (W * T_S * N));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * want, want, most);
    TEST_ASSERT_INT_WITHIN(2, (int32_t)lround(1.0 / (W * T_S * N)), at);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, s.speed);
}

/*
 * A run-up: with the torque that the ramp needs the speed follows it; with a shaft three times as heavy, or a third of the current, it
 * arrives as the current lets it, and does not overshoot more than without a limit.
 */
static void test_run_up(void)
{
    static const struct {
        double inertia, limit, overshoot;
    } runs[] = {{J, 4.0, 1e-4}, {3.0 * J, 0.12, 0.02}, {J, 0.03, 0.02}, {0.3 * J, 4.0, 0.02}};
    for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
        shaft s = shaft_of(runs[r].inertia);
        s.speed = 0.0;
        iqfoc_speed_control_t c;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &usual));
        const double target = 0.2;
        double most = 0.0;
        int32_t arrived = -1;
        for (int32_t k = 0; k < 400000; k++) {
            const double i = to_double(
                iqfoc_speed_control_step(&c, to_iq24(target), to_iq24(s.speed), to_iq24(runs[r].limit)));
            turn(&s, i);
            most = fmax(most, s.speed);
            if (arrived < 0 && s.speed > 0.98 * target) {
                arrived = k;
            }
            TEST_ASSERT_TRUE(fabs(i) <= runs[r].limit + 1e-6);
        }
        const double by_ramp = target / (usual.ramp_q32 / q32) * N;
        const double by_current = target / (runs[r].limit * s.acceleration);
        const double soonest = 0.98 * fmax(by_ramp, by_current);
        printf("  inertia %.1f times, limit %.2f: %d cycles, %.0f at the soonest; overshoot %.2f %%\n",
               runs[r].inertia / J, runs[r].limit, arrived, soonest, 100.0 * (most / target - 1.0));
        TEST_ASSERT_TRUE(arrived >= 0 && arrived >= soonest - 2 * N);
        TEST_ASSERT_TRUE(arrived <= 1.05 * soonest);
        TEST_ASSERT_TRUE(most <= target * (1.0 + runs[r].overshoot));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, target, s.speed);
    }
}

/* A load that stops the drive, for long, leaves nothing: when it has gone, the speed comes back without overshoot. */
static void test_stall_leaves_nothing(void)
{
    shaft s = shaft_of(J);
    iqfoc_speed_control_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &usual));
    iqfoc_speed_control_start(&c, to_iq24(s.speed), 0);
    double most = 0.0;
    for (int32_t k = 0; k < 200000; k++) {
        s.load = k < 100000 ? 2.0 : 0.0;
        const iq24_t i = iqfoc_speed_control_step(&c, IQ24(0.05), to_iq24(s.speed), IQ24(1.0));
        turn(&s, to_double(i));
        s.speed = fmax(s.speed, 0.0); /* the load holds it */
        most = fmax(most, k < 100000 ? 0.0 : s.speed);
        TEST_ASSERT_TRUE(k < 1000 || k >= 100000 || i == IQ24_ONE);
    }
    printf("  after the stall: at most %.5f turns per cycle of 0.05\n", most);
    TEST_ASSERT_TRUE(most <= 0.05 * 1.02);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, s.speed);
}

/* The result changes every `cycles` calls, and the first call after a start makes a step. */
static void test_rate_and_start(void)
{
    iqfoc_speed_control_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &usual));
    TEST_ASSERT_EQUAL_INT64(0, c.integral | c.set_point_q32 | c.i_q);
    for (int32_t way = -1; way <= 1; way += 2) {
        iqfoc_speed_control_start(&c, way * IQ24(0.1), way * IQ24(0.7));
        /* At the speed that it was taken over at, the current goes on. */
        TEST_ASSERT_EQUAL_INT32(way * IQ24(0.7),
                                iqfoc_speed_control_step(&c, way * IQ24(0.1), way * IQ24(0.1), IQ24(4.0)));
        int32_t changes = 0;
        iq24_t before = c.i_q;
        for (int32_t k = 0; k < 20 * N - 1; k++) {
            const iq24_t now = iqfoc_speed_control_step(&c, way * IQ24(0.1), way * IQ24(0.1001), IQ24(4.0));
            changes += now != before;
            TEST_ASSERT_TRUE(now == before || (k + 1) % N == 0);
            before = now;
        }
        TEST_ASSERT_EQUAL_INT32(19, changes);
    }
    iqfoc_speed_control_start(&c, IQ24_MIN, IQ24_MAX);
    TEST_ASSERT_EQUAL_INT32(-256 * IQFOC_ROTOR_SPEED_MAX, c.set_point_q32);
    TEST_ASSERT_EQUAL_INT32(usual.i_max, c.i_q);
    TEST_ASSERT_EQUAL_INT64((iq24_acc_t)usual.i_max * IQ24_ONE, c.integral);
}

/* Any sequence of inputs, extremes among them: the state stays within what the header says. */
static void test_any_input(void)
{
    static const iq24_t extremes[] = {
        IQ24_MIN, IQ24_MIN + 1, -IQFOC_ROTOR_SPEED_MAX, -1, 0, 1, IQFOC_ROTOR_SPEED_MAX, IQ24_MAX};
    uint64_t seed = SEED + 1;
    double most = 0.0;
    for (int32_t run = 0; run < 2000; run++) {
        iqfoc_speed_control_config_t config = any_config(&seed);
        if (run % 3 == 0) {
            config.share = IQ24_ONE;
        }
        if (run % 7 == 0) {
            config.i_max = IQ24(4.0);
            config.i_ramp = config.i_max;
            config.kp_q16 = run % 2 == 0 ? 1 : INT32_MAX;
        }
        iqfoc_speed_control_t c;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &config));
        for (int32_t k = 0; k < 200; k++) {
            iq24_t in[3];
            for (int32_t x = 0; x < 3; x++) {
                const uint64_t bits = random_bits(&seed);
                in[x] = bits % 2 == 0 ? extremes[bits / 2 % 8] : random_iq24(&seed, -0.3, 0.3);
            }
            const iq24_t i_q = iqfoc_speed_control_step(&c, in[0], in[1], in[2]);
            TEST_ASSERT_TRUE(iq24_within(i_q, -config.i_max, config.i_max));
            TEST_ASSERT_TRUE(
                iq24_within(c.set_point_q32, -256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX));
            most = fmax(most, fabs((double)c.integral / q48));
        }
    }
    printf("  |I| at most %.7f\n", most);
    TEST_ASSERT_TRUE(most <= 8.0 + 1.0 / 16777216.0 && most > 7.0);
}

static void refused(iqfoc_speed_control_config_t config)
{
    iqfoc_speed_control_t c = {NULL, 1, 2, 3, 4};
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SPEED_CONTROL, iqfoc_speed_control_init(&c, &config));
    TEST_ASSERT_NULL(c.config);
    TEST_ASSERT_EQUAL_INT64(1, c.integral);
}

static void test_refused(void)
{
    iqfoc_speed_control_t c;
    const iqfoc_speed_control_config_t least = {1, 0, 1, 0, 1, 1};
    const iqfoc_speed_control_config_t most = {INT32_MAX, IQ24_ONE,  1 << 30,
                                               IQ24(4.0), IQ24(4.0), UINT32_MAX};
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_speed_control_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_speed_control_init(&c, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &least));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&c, &most));
    refused((iqfoc_speed_control_config_t){0, 0, 1, 0, 1, 1});
    refused((iqfoc_speed_control_config_t){1, -1, 1, 0, 1, 1});
    refused((iqfoc_speed_control_config_t){1, IQ24_ONE + 1, 1, 0, 1, 1});
    refused((iqfoc_speed_control_config_t){1, 0, 0, 0, 1, 1});
    refused((iqfoc_speed_control_config_t){1, 0, (1 << 30) + 1, 0, 1, 1});
    refused((iqfoc_speed_control_config_t){1, 0, 1, -1, 1, 1});
    refused((iqfoc_speed_control_config_t){1, 0, 1, 2, 1, 1});
    refused((iqfoc_speed_control_config_t){1, 0, 1, 0, 0, 1});
    refused((iqfoc_speed_control_config_t){1, 0, 1, 0, IQ24(4.0) + 1, 1});
    refused((iqfoc_speed_control_config_t){1, 0, 1, 0, 1, 0});
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_step);
    RUN_TEST(test_initialiser);
    RUN_TEST(test_poles_and_dip);
    RUN_TEST(test_run_up);
    RUN_TEST(test_stall_leaves_nothing);
    RUN_TEST(test_rate_and_start);
    RUN_TEST(test_any_input);
    RUN_TEST(test_refused);
    return UNITY_END();
}
