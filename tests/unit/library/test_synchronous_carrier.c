/*
 * Synchronous carrier (include/iqfoc/synchronous_carrier.h): one step and the scaled set against the header's lines in double, the lock at
 * each number of periods, the levels' hysteresis, limits and refusals, and the sets as the cycle takes them.
 */
#include "iqfoc/params.h"
#include "iqfoc/synchronous_carrier.h"
#include "reference.h"

#include <complex.h>

#define SEED  UINT64_C(34021)
#define DRAWS 400000
#define TICKS 10000

/* Where a quotient saturates. */
static const double ratio_max = 2147483647.0 / 16777216.0;

static const iqfoc_synchronous_level_t usual_levels[] = {{0, 0, 0},
                                                         {21, IQ24(1.0 / 21.0), IQ24(0.95 / 21.0)},
                                                         {15, IQ24(1.0 / 15.0), IQ24(0.95 / 15.0)},
                                                         {9, IQ24(1.0 / 9.0), IQ24(0.95 / 9.0)}};
static const iqfoc_synchronous_config_t usual = {usual_levels, 4,        TICKS,       TICKS / 2,
                                                 4 * TICKS,    IQ24_ONE, IQ24(0.125), IQ24(0.25)};
static const iqfoc_cycle_config_t base = {
    .predictor = IQFOC_PREDICTOR(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0),
    .gains = IQFOC_GAINS(1000.0, 0.75, 5.2e-3, 5.2e-3, 0.134, 1e-4, 14.849, 565.0),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .span_max = IQ24_ONE,
    .current_limit = IQ24(4.0),
    .period_ticks = TICKS,
    .tolerance_ticks = TICKS / 10,
    .stale_ticks = TICKS / 4,
    .deadline_ticks = TICKS / 2};

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

static uint32_t random_ticks(uint64_t *seed, uint32_t low, uint32_t high)
{
    return (uint32_t)lround(low * pow((double)high / low, uniform(seed, 0.0, 1.0)));
}

static int32_t random_periods(uint64_t *seed)
{
    return 9 + 6 * (int32_t)(random_bits(seed) % 16);
}

static void test_step(void)
{
    uint64_t seed = SEED;
    double worst_e = 0.0;
    double worst_share = 0.0;
    int32_t free_ones = 0;
    int32_t at_limit = 0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const iqfoc_synchronous_level_t level = {random_periods(&seed), 0, 0};
        const uint32_t limit = IQFOC_SYNCHRONOUS_TICKS_MAX;
        const iqfoc_synchronous_config_t config = {&level,
                                                   1,
                                                   random_ticks(&seed, 1, limit),
                                                   1,
                                                   limit,
                                                   1 + random_iq24(&seed, 0.0, 0.99),
                                                   1 + random_iq24(&seed, 0.0, 0.24),
                                                   random_iq24(&seed, -127.0, 127.0)};
        iqfoc_synchronous_carrier_t c;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&c, &config));
        c.ticks = random_ticks(&seed, 1, limit);
        const double before = c.ticks;
        const iq24_t angle = random_iq24(&seed, -127.0, 127.0);
        const iq24_t speed = to_iq24((n % 2 == 0 ? 1.0 : -1.0) / 3.0 * pow(10.0, uniform(&seed, -4.0, 0.0)));
        const double length = iqfoc_synchronous_carrier_step(&c, angle, speed);

        const double way = speed < 0 ? -1.0 : 1.0;
        const double place = level.periods * (to_double(angle) + to_double(speed)) - to_double(config.phase);
        const double e = place - floor(place + 0.5);
        worst_e = fmax(worst_e, fabs(to_double(c.error) - way * e));
        const double most = to_double(config.share_max);
        const double change = held(to_double(config.gain) * way * e, -most, most);
        const double ratio = fmin((1.0 - change) / (level.periods * fabs(to_double(speed))), ratio_max);
        const double want = held(before * ratio, 1.0, limit);
        free_ones += want < limit && want > 1.0 ? 1 : 0;
        at_limit += fabs(change) == most ? 1 : 0;
        const double bound = 0.5 + before / 33554432.0 + want / 16777216.0;
        worst_share = fmax(worst_share, fabs(length - want) / bound);
    }
    printf("  seed %llu: e %.1e, length %.3f of its bound; %d within its limits, %d corrected by the most\n",
           (unsigned long long)SEED, worst_e, worst_share, free_ones, at_limit);
    TEST_ASSERT_TRUE(worst_e == 0.0);
    TEST_ASSERT_TRUE(worst_share <= 1.0 && worst_share >= 0.5);
    TEST_ASSERT_TRUE(free_ones > DRAWS / 2);
    TEST_ASSERT_TRUE(at_limit > DRAWS / 4 && at_limit < DRAWS * 3 / 4);
}

/* A rotor at constant speed, turns per tick, and the carrier's valleys on it. */
typedef struct run {
    iqfoc_synchronous_carrier_t carrier;
    uint32_t ticks; /* of the cycle that begins */
    double angle;
} run;

static void advance(run *r, double speed)
{
    const iq24_t angle = to_iq24(r->angle - floor(r->angle));
    const uint32_t next = iqfoc_synchronous_carrier_step(&r->carrier, angle, to_iq24(speed * r->ticks));
    r->angle += speed * r->ticks;
    r->ticks = next;
}

/* At each number of periods, in both directions, from any angle: locked after six periods; then N valleys a turn at their angles. */
static void test_lock(void)
{
    uint64_t seed = SEED;
    double worst_angle = 0.0;
    for (int32_t n = 0; n < 4000; n++) {
        const iqfoc_synchronous_level_t level = {random_periods(&seed), 0, 0};
        iqfoc_synchronous_config_t config = usual;
        config.level = &level;
        config.levels = 1;
        config.phase = random_iq24(&seed, -2.0, 2.0);
        const double speed = (n % 2 == 0 ? 1.0 : -1.0) / (uniform(&seed, 0.8, 3.0) * TICKS * level.periods);
        run r = {.ticks = TICKS, .angle = uniform(&seed, -3.0, 3.0)};
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&r.carrier, &config));
        for (int32_t k = 0; k < 7; k++) {
            advance(&r, speed);
        }
        const double begin = r.angle;
        for (int32_t k = 0; k < 10 * level.periods; k++) {
            const double place = level.periods * r.angle - to_double(config.phase);
            worst_angle = fmax(worst_angle, fabs(place - round(place)));
            advance(&r, speed);
        }
        TEST_ASSERT_TRUE(fabs(fabs(r.angle - begin) - 10.0) * level.periods <= 1e-3);
    }
    printf("  valleys off their angles by %.1e periods at most\n", worst_angle);
    TEST_ASSERT_TRUE(worst_angle <= 1.5e-4 && worst_angle >= 1e-5);
}

/* A gain below 1 leaves that share of the error; a correction is at most share_max; a reversed rotor has the reversed error. */
static void test_correction(void)
{
    iqfoc_synchronous_level_t level = {9, 0, 0};
    iqfoc_synchronous_config_t config = {&level, 1, TICKS, 1, 4 * TICKS, IQ24(0.5), IQ24(0.25), 0};
    iqfoc_synchronous_carrier_t c;
    for (int32_t way = -1; way <= 1; way += 2) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&c, &config));
        const iq24_t speed = way * IQ24(1.0 / 9.0);
        const iq24_t ahead = way * IQ24(0.2 / 9.0);
        TEST_ASSERT_UINT32_WITHIN(1, TICKS * 9 / 10, iqfoc_synchronous_carrier_step(&c, ahead, speed));
        TEST_ASSERT_INT32_WITHIN(20, IQ24(0.2), c.error);
    }
    config.gain = IQ24_ONE;
    config.share_max = IQ24(0.125);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&c, &config));
    TEST_ASSERT_UINT32_WITHIN(1, TICKS * 7 / 8,
                              iqfoc_synchronous_carrier_step(&c, IQ24(0.4 / 9.0), IQ24(1.0 / 9.0)));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&c, &config));
    TEST_ASSERT_UINT32_WITHIN(1, TICKS * 9 / 8,
                              iqfoc_synchronous_carrier_step(&c, IQ24(-0.4 / 9.0), IQ24(1.0 / 9.0)));
    TEST_ASSERT_EQUAL_UINT32(4 * TICKS, iqfoc_synchronous_carrier_step(&c, 0, 0));
    TEST_ASSERT_EQUAL_INT32(0, c.speed);
    config.ticks_max = TICKS + 1;
    config.ticks_min = TICKS - 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&c, &config));
    TEST_ASSERT_EQUAL_UINT32(TICKS - 1, iqfoc_synchronous_carrier_step(&c, 0, IQ24_MAX));
    TEST_ASSERT_EQUAL_UINT32(TICKS + 1, iqfoc_synchronous_carrier_step(&c, 0, IQ24(-0.01)));
    c.ticks = TICKS;
    (void)iqfoc_synchronous_carrier_step(&c, 0, IQ24(0.4));
    TEST_ASSERT_EQUAL_INT32(IQFOC_ROTOR_SPEED_MAX, c.speed);
    c.ticks = TICKS;
    (void)iqfoc_synchronous_carrier_step(&c, 0, IQ24_MIN);
    TEST_ASSERT_EQUAL_INT32(IQFOC_ROTOR_SPEED_MAX, c.speed);
}

/* The speed at which a level changes, turns per TICKS, in a slow sweep. */
static void test_hysteresis(void)
{
    for (int32_t way = -1; way <= 1; way += 2) {
        run r = {.ticks = TICKS};
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&r.carrier, &usual));
        int32_t changes = 0;
        double speed = 0.03;
        for (int32_t k = 0; k < 40000; k++) {
            const int32_t level = r.carrier.level;
            const bool rising = k < 20000;
            const double before = speed;
            speed += rising ? 5e-6 : -5e-6;
            advance(&r, way * speed / TICKS);
            TEST_ASSERT_INT32_WITHIN(64, to_iq24(speed), r.carrier.speed);
            if (r.carrier.level != level) {
                const iqfoc_synchronous_level_t *l = &usual_levels[rising ? r.carrier.level : level];
                TEST_ASSERT_EQUAL_INT32(rising ? level + 1 : level - 1, r.carrier.level);
                TEST_ASSERT_TRUE(fabs((rising ? before : speed) - to_double(rising ? l->on : l->off)) <=
                                 6e-6);
                changes++;
            }
            if (r.carrier.level == 0) {
                TEST_ASSERT_EQUAL_UINT32(TICKS, r.ticks);
                TEST_ASSERT_EQUAL_INT32(0, r.carrier.error);
            }
        }
        TEST_ASSERT_EQUAL_INT32(6, changes);
    }
}

/* On the borders to the bit, and one level a call. */
static void test_borders(void)
{
    iqfoc_synchronous_carrier_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&c, &usual));
    for (int32_t n = 1; n < 4; n++) {
        c.ticks = TICKS;
        (void)iqfoc_synchronous_carrier_step(&c, 0, usual_levels[n].on - 1);
        TEST_ASSERT_EQUAL_INT32(n - 1, c.level);
        c.ticks = TICKS;
        (void)iqfoc_synchronous_carrier_step(&c, 0, -usual_levels[n].on);
        TEST_ASSERT_EQUAL_INT32(n, c.level);
        c.ticks = TICKS;
        (void)iqfoc_synchronous_carrier_step(&c, 0, usual_levels[n].off);
        TEST_ASSERT_EQUAL_INT32(n, c.level);
    }
    (void)iqfoc_synchronous_carrier_step(&c, 0, IQ24(0.3));
    TEST_ASSERT_EQUAL_INT32(3, c.level);
    for (int32_t n = 2; n >= -1; n--) {
        c.ticks = TICKS;
        (void)iqfoc_synchronous_carrier_step(&c, 0, usual_levels[1].off - 1);
        TEST_ASSERT_EQUAL_INT32(n < 0 ? 0 : n, c.level);
    }
}

static void test_refused(void)
{
    iqfoc_synchronous_carrier_t c = {.ticks = 77};
    iqfoc_synchronous_config_t config = usual;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_synchronous_carrier_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_synchronous_carrier_init(&c, NULL));
    config.level = NULL;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_synchronous_carrier_init(&c, &config));
#define REFUSED(field, value)                                                                                \
    do {                                                                                                     \
        config = usual;                                                                                      \
        config.field = (value);                                                                              \
        TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_CARRIER, iqfoc_synchronous_carrier_init(&c, &config));             \
    } while (0)
#define TAKEN(field, value)                                                                                  \
    do {                                                                                                     \
        iqfoc_synchronous_carrier_t other;                                                                   \
        config = usual;                                                                                      \
        config.field = (value);                                                                              \
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&other, &config));                    \
    } while (0)
    REFUSED(levels, 0);
    TAKEN(levels, 1);
    REFUSED(levels, IQFOC_SYNCHRONOUS_LEVELS_MAX + 1);
    REFUSED(ticks_min, 0);
    TAKEN(ticks_min, 1);
    TAKEN(ticks_min, TICKS);
    REFUSED(ticks_min, TICKS + 1);
    REFUSED(ticks_max, TICKS - 1);
    TAKEN(ticks_max, TICKS);
    TAKEN(ticks_max, IQFOC_SYNCHRONOUS_TICKS_MAX);
    REFUSED(ticks_max, IQFOC_SYNCHRONOUS_TICKS_MAX + 1);
    REFUSED(gain, 0);
    TAKEN(gain, 1);
    REFUSED(gain, IQ24_ONE + 1);
    REFUSED(share_max, 0);
    TAKEN(share_max, 1);
    TAKEN(share_max, IQ24(0.25));
    REFUSED(share_max, IQ24(0.25) + 1);
    static const struct {
        iqfoc_synchronous_level_t level[3];
        iqfoc_error_t error;
    } cases[] = {
        {{{0, 0, 0}, {99, IQ24(0.1), 0}, {15, IQ24(0.1), IQ24(0.1) - 1}}, IQFOC_OK},
        {{{9, 0, 0}, {0, IQ24_ONE, 0}, {0, IQ24_ONE, 0}}, IQFOC_OK},
        {{{6, 0, 0}, {9, IQ24(0.1), 0}, {15, IQ24(0.1), 0}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {12, IQ24(0.1), 0}, {15, IQ24(0.1), 0}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {7, IQ24(0.1), 0}, {15, IQ24(0.1), 0}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), 0}, {105, IQ24(0.1), 0}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), 0}, {3, IQ24(0.1), 0}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), IQ24(0.1)}, {15, IQ24(0.2), IQ24(0.1)}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), IQ24(0.05)}, {15, IQ24(0.1) - 1, IQ24(0.05)}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), IQ24(0.05)}, {15, IQ24(0.2), IQ24(0.05) - 1}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), -1}, {15, IQ24(0.2), 0}}, IQFOC_ERROR_CARRIER},
        {{{0, 0, 0}, {9, IQ24(0.1), 0}, {15, IQ24_ONE + 1, 0}}, IQFOC_ERROR_CARRIER},
    };
    for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        iqfoc_synchronous_carrier_t other;
        config = usual;
        config.level = cases[n].level;
        config.levels = 3;
        TEST_ASSERT_EQUAL_INT(cases[n].error, iqfoc_synchronous_carrier_init(&other, &config));
    }
    TEST_ASSERT_EQUAL_UINT32(77, c.ticks);
}

static double worst_parameter;

static void check_parameter(iq24_t got, iq24_t from, double factor, double low, double high)
{
    const double want = held(to_double(from) * fmin(factor, ratio_max), low, high);
    const double off = fabs(to_double(got) - want) * 16777216.0;
    worst_parameter = fmax(worst_parameter, off / (1.0 + 0.5 * to_double(from)));
}

static double worst_time;

static void check_time(uint32_t got, uint32_t from, double factor, double high)
{
    const double want = fmin(from * fmin(factor, ratio_max), high);
    worst_time = fmax(worst_time, fabs(got - want) / (0.5 + from / 33554432.0));
}

static void test_set(void)
{
    uint64_t seed = SEED;
    const double lsb = 1.0 / 16777216.0;
    for (int32_t n = 0; n < DRAWS; n++) {
        iqfoc_cycle_config_t from = base;
        from.predictor.k_u = 1 + random_iq24(&seed, 0.0, 15.9);
        from.predictor.k_r = random_iq24(&seed, 0.0, 1.0);
        from.gains.ki_d = random_iq24(&seed, 0.0, 32.0);
        from.gains.ki_q = random_iq24(&seed, 0.0, 0.1);
        from.gains.anti_windup = random_iq24(&seed, 0.0, 1.0);
        from.gains.x_d = random_iq24(&seed, 0.0, 96.0);
        from.gains.x_q = random_iq24(&seed, 0.0, 1.0);
        from.gains.emf = random_iq24(&seed, 0.0, 96.0);
        from.period_ticks = random_ticks(&seed, 1, IQFOC_SYNCHRONOUS_TICKS_MAX);
        from.tolerance_ticks = (uint32_t)(random_bits(&seed) & 0x7effffff);
        from.stale_ticks = (uint32_t)(random_bits(&seed) & UINT32_MAX);
        from.deadline_ticks = random_ticks(&seed, 1, UINT32_MAX);
        const uint32_t ticks = random_ticks(&seed, 1, IQFOC_SYNCHRONOUS_TICKS_MAX);
        iqfoc_cycle_config_t to;
        iqfoc_synchronous_carrier_set(&from, ticks, &to);
        const double longer = (double)ticks / from.period_ticks;
        check_parameter(to.predictor.k_u, from.predictor.k_u, longer, lsb, 16.0);
        check_parameter(to.predictor.k_r, from.predictor.k_r, longer, 0.0, 1.0);
        check_parameter(to.gains.ki_d, from.gains.ki_d, longer, 0.0, 32.0);
        check_parameter(to.gains.ki_q, from.gains.ki_q, longer, 0.0, 32.0);
        check_parameter(to.gains.anti_windup, from.gains.anti_windup, longer, 0.0, 1.0);
        check_parameter(to.gains.x_d, from.gains.x_d, 1.0 / longer, 0.0, 96.0);
        check_parameter(to.gains.x_q, from.gains.x_q, 1.0 / longer, 0.0, 96.0);
        check_parameter(to.gains.emf, from.gains.emf, 1.0 / longer, 0.0, 96.0);
        check_time(to.tolerance_ticks, from.tolerance_ticks, longer, (double)INT32_MAX - ticks);
        check_time(to.stale_ticks, from.stale_ticks, longer, INT32_MAX);
        check_time(to.deadline_ticks, from.deadline_ticks, longer, INT32_MAX);
        TEST_ASSERT_EQUAL_UINT32(ticks, to.period_ticks);
        iqfoc_cycle_t cycle;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &to));
    }
    printf("  parameters %.3f, times %.3f of their bounds\n", worst_parameter, worst_time);
    TEST_ASSERT_TRUE(worst_parameter <= 1.0 && worst_parameter >= 0.5);
    TEST_ASSERT_TRUE(worst_time <= 1.0 && worst_time >= 0.5);
    iqfoc_cycle_config_t same;
    iqfoc_synchronous_carrier_set(&base, TICKS, &same);
    TEST_ASSERT_EQUAL_MEMORY(&base.gains, &same.gains, sizeof same.gains);
    TEST_ASSERT_EQUAL_INT32(base.predictor.k_psi, same.predictor.k_psi);
    TEST_ASSERT_EQUAL_INT(base.feedback, same.feedback);
    iqfoc_synchronous_carrier_set(&base, 0, &same);
    TEST_ASSERT_EQUAL_UINT32(1, same.period_ticks);
    iqfoc_synchronous_carrier_set(&base, UINT32_MAX, &same);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_SYNCHRONOUS_TICKS_MAX, same.period_ticks);
}

/* Mean of a flux that moves straight from one vector to the other, each seen from the rotor, which turns by phi: by Simpson's rule. */
static double complex mean_of_line(double complex from, double complex to, double phi)
{
    enum { PARTS = 32 };
    double complex sum = 0.0;
    for (int k = 0; k <= PARTS; k++) {
        const double t = (double)k / PARTS;
        const double weight = k == 0 || k == PARTS ? 1.0 : k % 2 != 0 ? 4.0 : 2.0;
        sum += weight * (from + t * (to * cexp(I * phi) - from)) * cexp(-I * phi * t);
    }
    return sum / (3.0 * PARTS);
}

/* Voltage, integrators and mean against the header's lines in double; a period that stays changes nothing. */
static void test_flux(void)
{
    uint64_t seed = SEED;
    worst u = {"u_dq", 0.0};
    worst integral = {"integrators", 0.0};
    worst off = {"mean_off times x", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        iqfoc_cycle_config_t old = base;
        iqfoc_cycle_config_t new = base;
        old.period_ticks = random_ticks(&seed, 1000, 4000);
        new.period_ticks = n % 100 == 0 ? old.period_ticks : random_ticks(&seed, 1000, 4000);
        new.gains.x_d = random_iq24(&seed, 0.0, 8.0);
        new.gains.x_q = random_iq24(&seed, 0.0, 8.0);
        new.gains.emf = random_iq24(&seed, 0.0, 8.0);
        iqfoc_cycle_t cycle = {.config = &old, .next = &new};
        cycle.rotor.speed = random_iq24(&seed, -0.33, 0.33);
        const iqfoc_dq_t i_ref = {random_iq24(&seed, -2.0, 2.0), random_iq24(&seed, -2.0, 2.0)};
        const iqfoc_dq_t u_dq = {random_iq24(&seed, -2.0, 2.0), random_iq24(&seed, -2.0, 2.0)};
        const iq24_t from = random_iq24(&seed, -2.0, 2.0);
        cycle.i_ref = i_ref;
        cycle.u_dq = u_dq;
        cycle.control.integral_d = iq24_acc_mul(from, IQ24_ONE);
        cycle.control.integral_q = iq24_acc_mul(-from, IQ24_ONE);
        iqfoc_synchronous_carrier_t carrier = {0};
        iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);

        const double limit = to_double(IQFOC_ROTOR_SPEED_MAX);
        const double speed = to_double(cycle.rotor.speed);
        const double h_old = TWO_PI / 2.0 * speed;
        const double h_new = TWO_PI / 2.0 * held(speed * new.period_ticks / old.period_ticks, -limit, limit);
        const double s_old = sin(h_old) / h_old;
        const double s_new = sin(h_new) / h_new;
        const double step = (1.0 / (s_new * s_new) - 1.0 / (s_old * s_old)) / TWO_PI;
        const double d = step * (to_double(new.gains.x_d) * to_double(i_ref.d) + to_double(new.gains.emf));
        const double q = step * to_double(new.gains.x_q) * to_double(i_ref.q);
        const double more = s_old / s_new - 1.0;
        worst_add(&u, cycle.u_dq.d, to_double(u_dq.d) * (1.0 + more) + d * cos(h_new) + q * sin(h_new));
        worst_add(&u, cycle.u_dq.q, to_double(u_dq.q) * (1.0 + more) + q * cos(h_new) - d * sin(h_new));
        worst_add(&integral, iq24_acc_round(cycle.control.integral_d),
                  to_double(from) + more * to_double(u_dq.d));
        worst_add(&integral, iq24_acc_round(cycle.control.integral_q),
                  -to_double(from) + more * to_double(u_dq.q));
        const double x_d = to_double(new.gains.x_d);
        const double x_q = to_double(new.gains.x_q);
        const double complex psi = fabs(step) > 0.0 ? (d + I * q) / step : 0.0;
        const double complex mean =
            mean_of_line(psi / (s_old * s_old), psi / (s_new * s_new), 2.0 * h_new) - psi;
        if (fabs(creal(mean)) < x_d && fabs(cimag(mean)) < x_q) { /* else held to 1 */
            worst_add(&off, 0, to_double(carrier.mean_off_next.d) * x_d - creal(mean));
            worst_add(&off, 0, to_double(carrier.mean_off_next.q) * x_q - cimag(mean));
        }
        TEST_ASSERT_TRUE(iq24_within(carrier.mean_off_next.d, -IQ24_ONE, IQ24_ONE));
        if (new.period_ticks == old.period_ticks) {
            TEST_ASSERT_EQUAL_MEMORY(&u_dq, &cycle.u_dq, sizeof u_dq);
            TEST_ASSERT_EQUAL_INT32(0, carrier.mean_off_next.d);
        }
    }
    worst_check(&u, 25.0);
    worst_check(&integral, 5.0);
    worst_check(&off, 150.0);
}

/* The controller's answer to a mean that is off: that of the library's own controller to this error. The next step forgets it. */
static void test_answer_is_taken_back(void)
{
    uint64_t seed = SEED;
    worst u = {"u_dq", 0.0};
    worst integral = {"integrators", 0.0};
    for (int32_t n = 0; n < DRAWS / 10; n++) {
        iqfoc_cycle_config_t set = base;
        set.gains.kp_d = random_iq24(&seed, 0.0, 1.0);
        set.gains.kp_q = random_iq24(&seed, 0.0, 1.0);
        set.gains.ki_d = random_iq24(&seed, 0.0, 1.0);
        set.gains.ki_q = random_iq24(&seed, 0.0, 1.0);
        set.gains.x_d = random_iq24(&seed, 0.0, 8.0);
        set.gains.x_q = random_iq24(&seed, 0.0, 8.0);
        iqfoc_cycle_t cycle = {.config = &set, .next = &set};
        iqfoc_cycle_t seen = cycle;
        iqfoc_synchronous_carrier_t carrier;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&carrier, &usual));
        const iqfoc_dq_t off = {random_iq24(&seed, -1.0, 1.0), random_iq24(&seed, -1.0, 1.0)};
        const iqfoc_dq_t none = {0, 0};
        carrier.mean_off_next = off;
        cycle.rotor.speed = random_iq24(&seed, -0.33, 0.33);
        (void)iqfoc_synchronous_carrier_step(&carrier, 0, cycle.rotor.speed);
        cycle.u_dq = iqfoc_current_control_voltage(&cycle.control, &set.gains, none, off, cycle.rotor.speed);
        seen.u_dq = iqfoc_current_control_voltage(&seen.control, &set.gains, none, none, cycle.rotor.speed);
        iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);
        worst_add(&u, cycle.u_dq.d, to_double(seen.u_dq.d));
        worst_add(&u, cycle.u_dq.q, to_double(seen.u_dq.q));
        worst_add(&integral, iq24_acc_round(cycle.control.integral_d), 0.0);
        worst_add(&integral, iq24_acc_round(cycle.control.integral_q), 0.0);
        (void)iqfoc_synchronous_carrier_step(&carrier, 0, cycle.rotor.speed);
        TEST_ASSERT_TRUE(carrier.mean_off.d == 0 && carrier.mean_off.q == 0);
    }
    worst_check(&u, 3.0);
    TEST_ASSERT_TRUE(integral.lsb == 0.0);
}

/* Run-up and back with the cycle: each valley has the set of the length that the port loaded, with no cycle missed. */
/* The flux in d is held to +-128, whatever x_d, i_ref and the EMF are. */
static void test_most_flux(void)
{
    iqfoc_cycle_config_t new = base;
    new.period_ticks = 2 * base.period_ticks;
    new.gains.x_d = IQ24(96.0);
    new.gains.emf = 0;
    iqfoc_cycle_t cycle = {.config = &base, .next = &new};
    iqfoc_synchronous_carrier_t carrier = {0};
    cycle.rotor.speed = IQ24(0.1);
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        const iqfoc_dq_t none = {0, 0};
        cycle.u_dq = none;
        cycle.i_ref.d = sign * IQ24(1.2); /* 115.2 */
        iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);
        const double by_less = to_double(cycle.u_dq.d);
        cycle.u_dq = none;
        cycle.i_ref.d = sign * IQ24(2.0); /* 192 */
        iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 128.0 / 115.2, to_double(cycle.u_dq.d) / by_less);
    }
}

static void test_offered(void)
{
    static iqfoc_cycle_config_t set[3];
    iqfoc_cycle_t cycle;
    run r = {.ticks = TICKS};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&r.carrier, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &base));
    cycle.enabled = true;
    uint32_t time = 0;
    int32_t highest = 0;
    for (uint32_t k = 0; k < 6000; k++) {
        const double speed = 0.16 * sin(TWO_PI * k / 6000.0) / TICKS;
        const uint32_t ticks = r.ticks;
        iqfoc_sample_t sample = {.theta = to_iq24(r.angle - floor(r.angle)),
                                 .speed = to_iq24(speed * ticks),
                                 .u_dc = IQ24_ONE,
                                 .time = time};
        advance(&r, speed);
        iqfoc_synchronous_carrier_set(&base, r.ticks, &set[k % 3]);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_offer(&cycle, &set[k % 3]));
        (void)iqfoc_cycle_valley(&cycle, &sample, time);
        TEST_ASSERT_EQUAL_UINT32(ticks, cycle.config->period_ticks);
        TEST_ASSERT_EQUAL_UINT32(r.ticks, iqfoc_cycle_next_ticks(&cycle));
        time += ticks / 2;
        sample.time = time;
        sample.instant = IQ24(0.5);
        (void)iqfoc_cycle_peak(&cycle, &sample, IQ24(1.5), time);
        time += ticks - ticks / 2;
        highest = iq24_max(highest, r.carrier.level);
    }
    TEST_ASSERT_EQUAL_INT32(3, highest);
    TEST_ASSERT_EQUAL_INT32(0, r.carrier.level);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status & (IQFOC_STATUS_MISSED | IQFOC_STATUS_STALE));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_step);
    RUN_TEST(test_lock);
    RUN_TEST(test_correction);
    RUN_TEST(test_hysteresis);
    RUN_TEST(test_borders);
    RUN_TEST(test_refused);
    RUN_TEST(test_set);
    RUN_TEST(test_flux);
    RUN_TEST(test_answer_is_taken_back);
    RUN_TEST(test_most_flux);
    RUN_TEST(test_offered);
    return UNITY_END();
}
