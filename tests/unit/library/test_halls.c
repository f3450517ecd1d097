/*
 * Hall sensors: every transition, speeds over the whole range in both directions, misplaced sensors, run-up and
 * reversal, and all faults.
 */
#include "iqfoc/halls.h"
#include "reference.h"

#include <stddef.h>

static const iqfoc_halls_config_t usual = IQFOC_HALLS(20000);

void setUp(void)
{
}

void tearDown(void)
{
}

/* Sensor bits at an angle, whose borders are where `config` says. */
static uint32_t bits_at(const iqfoc_halls_config_t *config, double turns)
{
    static const uint32_t order[6] = {1, 3, 2, 6, 4, 5};
    for (uint32_t k = 0; k < 6; k++) {
        const double from = to_double(config->border[k]);
        const double to = to_double(config->border[(k + 1) % 6]);
        const double on = turns - from - floor(turns - from);
        const double wide = to - from - floor(to - from);
        if (on < wide) {
            return order[k];
        }
    }
    return 7;
}

/* A shaft: its angle at time t (cycles) is theta(t). The capture is found by bisection. */
typedef struct shaft {
    const iqfoc_halls_config_t *config;
    double start, speed, acceleration;
} shaft_t;

static double angle(const shaft_t *s, double t)
{
    return s->start + s->speed * t + s->acceleration * t * t / 2.0;
}

static void step(iqfoc_halls_t *h, const shaft_t *s, int32_t k)
{
    const uint32_t now = bits_at(s->config, angle(s, k));
    double low = k - 1.0;
    double high = k;
    for (int32_t n = 0; n < 30; n++) {
        const double mid = 0.5 * (low + high);
        if (bits_at(s->config, angle(s, mid)) == now) {
            high = mid;
        } else {
            low = mid;
        }
    }
    iqfoc_halls_step(h, now, (uint32_t)lround(256.0 * (k - high)));
}

static double off(const iqfoc_halls_t *h, double turns)
{
    return fabs(remainder(to_double(h->theta) - turns, 1.0));
}

static void begin(iqfoc_halls_t *h, const iqfoc_halls_config_t *config)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_halls_init(h, config));
    TEST_ASSERT_EQUAL_INT32(-1, h->sector);
}

/* From 1/7000 to 1/7 turn a cycle, where a sector is just more than a cycle; both ways. */
static void test_steady_speeds(void)
{
    double worst_speed = 0.0;
    double worst_angle = 0.0;
    for (double cycles = 7.0; cycles < 7000.0; cycles *= 1.13) {
        for (int32_t way = -1; way <= 1; way += 2) {
            const shaft_t s = {&usual, 0.37, way / cycles, 0.0};
            iqfoc_halls_t h;
            begin(&h, &usual);
            for (int32_t k = 0; k < (int32_t)(3.0 * cycles); k++) {
                step(&h, &s, k);
                TEST_ASSERT_TRUE(off(&h, angle(&s, k)) <= 1.0 / 12.0 + 0.001);
                if (k > (int32_t)(1.6 * cycles)) {
                    /* The captures' step, 1/256 cycle, in a whole turn; and in the time since a border. */
                    const double rounding = 0.6 * cycles / 16777216.0;
                    const double speed_off = fabs(to_double(h.speed) * way * cycles - 1.0);
                    worst_speed = fmax(worst_speed, (speed_off - rounding) * cycles * 256.0);
                    const double lsb =
                        (cycles / 12.0 + 3.0) / 16777216.0; /* the speed's half LSB over a sector */
                    worst_angle = fmax(worst_angle, (off(&h, angle(&s, k)) - lsb) * cycles * 256.0);
                }
            }
            TEST_ASSERT_EQUAL_UINT32(0, h.faults);
        }
    }
    printf("  speed off by %.2f steps of the capture in a turn, angle by %.2f\n", worst_speed, worst_angle);
    /* Where a border is overdue the speed is a sector's: two steps of it are twelve of a turn's. */
    TEST_ASSERT_TRUE(worst_speed <= 13.5);
    TEST_ASSERT_TRUE(worst_angle <= 1.0);
}

/* Misplaced sensors: with their places configured as good as exact ones; without, the speed is right after one turn. */
static void test_misplaced_sensors(void)
{
    iqfoc_halls_config_t moved = usual;
    moved.border[1] += IQ24(0.03);
    moved.border[2] -= IQ24(0.025);
    moved.border[5] += IQ24(0.04);
    for (int32_t told = 0; told < 2; told++) {
        const shaft_t s = {&moved, 0.0, 1.0 / 333.0, 0.0};
        iqfoc_halls_t h;
        begin(&h, told ? &moved : &usual);
        for (int32_t k = 0; k < 1500; k++) {
            step(&h, &s, k);
            if (k > 900) {
                TEST_ASSERT_TRUE(off(&h, angle(&s, k)) <= (told ? 0.0001 : 0.045));
            }
        }
        if (told) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-5 / 333.0, 1.0 / 333.0, to_double(h.speed));
        }
    }
}

static void test_run_up_and_standstill(void)
{
    const shaft_t up = {&usual, 0.01, 0.0, 2e-6};
    iqfoc_halls_t h;
    begin(&h, &usual);
    double angle_off = 0.0;
    for (int32_t k = 0; k < 20000; k++) {
        step(&h, &up, k);
        if (k > 3000) {
            angle_off = fmax(angle_off, off(&h, angle(&up, k)));
        }
        TEST_ASSERT_TRUE(off(&h, angle(&up, k)) < 0.17);
    }
    TEST_ASSERT_TRUE(angle_off < 0.02);
    TEST_ASSERT_DOUBLE_WITHIN(0.04 * 0.1, 0.04, to_double(h.speed));
    /* It stops dead: the angle stays in its sector, the speed falls as 1/t, and is 0 after stall_cycles. */
    const double stop = angle(&up, 20000);
    const uint32_t bits = bits_at(&usual, stop);
    for (int32_t k = 1; k < 20100; k++) {
        iqfoc_halls_step(&h, bits, 0);
        TEST_ASSERT_TRUE(off(&h, stop) <= 1.0 / 6.0 + 1e-6);
        TEST_ASSERT_TRUE(k < 10 || to_double(h.speed) <= 1.0 / 6.0 / (k - 8));
    }
    TEST_ASSERT_EQUAL_INT32(0, h.speed);
    TEST_ASSERT_TRUE(off(&h, stop) <= 1.0 / 12.0 + 1e-6);
    /* And starts again, the other way. */
    const shaft_t down = {&usual, stop, 0.0, -2e-6};
    for (int32_t k = 0; k < 5000; k++) {
        step(&h, &down, k);
        TEST_ASSERT_TRUE(h.speed <= 0 && off(&h, angle(&down, k)) < 0.17);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.001, -0.01, to_double(h.speed));
    TEST_ASSERT_EQUAL_UINT32(0, h.faults);
}

/* To and fro over one border: no speed, never a fault. */
static void test_swinging(void)
{
    iqfoc_halls_t h;
    begin(&h, &usual);
    for (int32_t k = 0; k < 100; k++) {
        iqfoc_halls_step(&h, k % 10 < 5 ? 1 : 3, 128);
        TEST_ASSERT_EQUAL_INT32(0, h.speed);
        TEST_ASSERT_TRUE(off(&h, 1.0 / 12.0) <= 1.0 / 12.0 + 1e-6);
    }
    TEST_ASSERT_EQUAL_UINT32(0, h.faults);
}

/* All 6 x 8 transitions. */
static void test_faults(void)
{
    static const uint32_t order[6] = {1, 3, 2, 6, 4, 5};
    for (uint32_t from = 0; from < 6; from++) {
        for (uint32_t bits = 0; bits < 8; bits++) {
            iqfoc_halls_t h;
            begin(&h, &usual);
            iqfoc_halls_step(&h, order[from] | 8, 0); /* other bits do not count */
            TEST_ASSERT_TRUE(off(&h, from / 6.0) < 1e-6);
            iqfoc_halls_step(&h, bits, 0);
            const bool next =
                bits == order[(from + 1) % 6] || bits == order[(from + 5) % 6] || bits == order[from];
            const uint32_t want = bits == 0 || bits == 7 ? IQFOC_HALLS_INVALID
                                  : next                 ? 0
                                                         : IQFOC_HALLS_SKIPPED;
            TEST_ASSERT_EQUAL_UINT32(want, h.faults);
        }
    }
    iqfoc_halls_t h;
    begin(&h, &usual);
    iqfoc_halls_step(&h, 7, 0); /* from the start on */
    TEST_ASSERT_EQUAL_UINT32(IQFOC_HALLS_INVALID, h.faults);
    TEST_ASSERT_EQUAL_INT32(0, h.theta);
}

/* Any bits at any age: angle and speed stay within their ranges. */
static void test_anything(void)
{
    const iqfoc_halls_config_t longest = IQFOC_HALLS(1 << 20);
    uint64_t seed = UINT64_C(77);
    iqfoc_halls_t h;
    begin(&h, &longest);
    for (int32_t n = 0; n < 300000; n++) {
        const uint64_t draw = random_bits(&seed);
        const uint32_t age = draw % 5 == 0 ? UINT32_MAX : (uint32_t)(draw >> 8 & 511);
        static const uint32_t order[6] = {1, 3, 2, 6, 4, 5};
        iqfoc_halls_step(&h, n % 1000 < 500 ? order[n % 6] : (uint32_t)(draw >> 20 & 7), age);
        TEST_ASSERT_TRUE(h.speed >= -IQFOC_ROTOR_SPEED_MAX && h.speed <= IQFOC_ROTOR_SPEED_MAX);
        TEST_ASSERT_TRUE(h.theta >= -IQ24_ONE && h.theta <= IQ24_ONE);
    }
    /* The longest span and then the fastest. */
    begin(&h, &longest);
    for (int32_t k = 0; k < 3; k++) {
        for (int32_t n = 0; n < (1 << 20) - 2; n++) {
            iqfoc_halls_step(&h, k == 0 ? 1 : k == 1 ? 3 : 2, 256);
        }
    }
    iqfoc_halls_step(&h, 6, 0);
    TEST_ASSERT_INT32_WITHIN(2, IQ24_ONE / 6 / (1 << 20), h.speed);
}

static void refused(iqfoc_halls_config_t config, iqfoc_error_t want)
{
    iqfoc_halls_t h = {.count = 3};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_halls_init(&h, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 3, h.count);
}

static void test_limits(void)
{
    iqfoc_halls_t h;
    iqfoc_halls_config_t config = usual;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_halls_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_halls_init(&h, NULL));
    for (uint32_t k = 0; k < 6; k++) {
        for (int32_t way = -1; way <= 1; way += 2) {
            config = usual;
            config.border[k] += way * (IQ24_ONE / 24 - 8);
            refused(config, IQFOC_OK);
            config.border[k] += way * 16;
            refused(config, IQFOC_ERROR_HALLS);
        }
    }
    const iqfoc_halls_config_t nominal = IQFOC_HALLS(1);
    for (int32_t k = 0; k < 6; k++) {
        TEST_ASSERT_EQUAL_INT32((2 * k - 1) * (double)IQ24_ONE / 12.0 + (k > 0 ? 0.5 : -0.5),
                                nominal.border[k]);
    }
    config = usual;
    config.stall_cycles = 0;
    refused(config, IQFOC_ERROR_HALLS);
    config.stall_cycles = 1;
    refused(config, IQFOC_OK);
    config.stall_cycles = 1 << 20;
    refused(config, IQFOC_OK);
    config.stall_cycles = (1 << 20) + 1;
    refused(config, IQFOC_ERROR_HALLS);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_steady_speeds);
    RUN_TEST(test_misplaced_sensors);
    RUN_TEST(test_run_up_and_standstill);
    RUN_TEST(test_swinging);
    RUN_TEST(test_faults);
    RUN_TEST(test_anything);
    RUN_TEST(test_limits);
    return UNITY_END();
}
