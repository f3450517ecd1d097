/*
 * A drive without an angle sensor (include/iqfoc/sensorless.h): the library's cycle, start and observer on the machine of
 * switched_machine.h, from standstill to 5 periods per turn and back, the changes of the source, and a lost lock.
 */
#include "iqfoc/params.h"
#include "iqfoc/sensorless.h"
#include "switched_machine.h"

#include <stddef.h>

/* EMF 0.45 of the link at 5 periods per turn, l i 0.6 of the magnet's flux and r i 0.03 of the link at the rated current. */
#define R_OHM  0.9
#define L_H    6.48e-4
#define PSI_WB 0.0108
#define T_S    1e-4
#define I_B_A  10.0
#define U_DC_V 300.0
#define PERIOD 10000U

/* Speed that the rated torque gives in a period, turns per period. */
#define GAIN_OF_TORQUE 1e-4

static const iqfoc_cycle_config_t usual = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .gains = IQFOC_GAINS(2000.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(1.0),
    .current_limit = IQ24(4.0),
    .period_ticks = PERIOD,
    .tolerance_ticks = PERIOD / 10,
    .stale_ticks = PERIOD / 4,
    .deadline_ticks = PERIOD / 3,
    .trips = IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_MISSED,
};

static const iqfoc_observer_config_t observer_config =
    IQFOC_OBSERVER_CONFIG(R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V, 1600.0, IQ24(0.01));

static const iqfoc_start_config_t start_config = {.i_align = IQ24(0.6),
                                                  .ramp_cycles = 1500,
                                                  .hold_cycles = 3000,
                                                  .turns_end = IQ24(0.03),
                                                  .run_up_cycles = 6000};

/* 0.5 us of 100 us, and the knee of test_sensorless.c. */
static const iqfoc_extension_t losses = {.i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE},
                                         .k_u = IQ24_ONE,
                                         .v_dead = IQ24(0.005),
                                         .knee_inverse = IQ24(1.0 / 0.15)};

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static iqfoc_sensorless_t drive;
static switched_machine m;
static double duty[3];
static double off;    /* angle of the observer minus the machine's, degrees */
static double torque; /* over the rated torque, at the last valley */
static bool turns_freely;
static uint32_t ticks;

void setUp(void)
{
    config = usual;
    ticks = UINT32_MAX - 3 * PERIOD;
    m = (switched_machine){.r = 0.03,
                           .l_d = 0.216,
                           .l_q = 0.216,
                           .psi_f = 0.36,
                           .dead = 0.005,
                           .noise = 0.005,
                           .step = 4.0 / 4096.0,
                           .theta = 0.37,
                           .seed = 3};
    m.psi = switched_flux(&m, 0.0, m.theta);
    duty[0] = duty[1] = duty[2] = 0.5;
    turns_freely = true;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_sensorless_init(&drive, &observer_config, &start_config, &losses));
    cycle.enabled = true;
}

void tearDown(void)
{
}

static iqfoc_sample_t sample_of(iq24_t at)
{
    const double complex i = switched_sample(&m);
    const iqfoc_sample_t s = {
        .i = {to_iq24(phase_of(i, 0)), to_iq24(phase_of(i, 1)), to_iq24(phase_of(i, 2))},
        .theta = to_iq24(m.theta),
        .turns = to_iq24(m.turns),
        .u_dc = IQ24_ONE,
        .at = at,
        .time = ticks};
    return s;
}

/* A period: `i_q` is the reference of a drive that runs on the angle of a sensor or of the observer. */
static void period(double i_q)
{
    iqfoc_sample_t valley = sample_of(0);
    torque = cimag(conj(m.psi) * switched_current(&m, m.psi, m.theta)) / m.psi_f;
    if (turns_freely) {
        const double drag = 10.0 * fmax(-0.02, fmin(0.02, m.turns)); /* at most 0.2 of the rated torque */
        m.turns += GAIN_OF_TORQUE * (torque - drag);
    }
    iqfoc_sensorless_valley(&drive, &cycle, &valley);
    off = 360.0 * remainder(drive.observer.theta_q32 / 4294967296.0 - m.theta, 1.0);
    if (drive.source == IQFOC_ANGLE_OBSERVED || drive.source == IQFOC_ANGLE_MEASURED) {
        const iqfoc_dq_t i_ref = {0, to_iq24(i_q)};
        cycle.i_ref = i_ref;
    }
    (void)iqfoc_cycle_valley(&cycle, &valley, ticks + 10);
    ticks += PERIOD / 2;
    switched_half(&m, duty, true);
    iqfoc_sample_t peak = sample_of(IQ24(0.5));
    iqfoc_sensorless_peak(&drive, &peak);
    const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &peak, IQ24(1.5), ticks + 10);
    ticks += PERIOD / 2;
    switched_half(&m, duty, false);
    duty[0] = to_double(command.duties.high.a);
    duty[1] = to_double(command.duties.high.b);
    duty[2] = to_double(command.duties.high.c);
}

static double speed_control(double turns)
{
    return fmax(-1.0, fmin(1.0, 40.0 * (turns - to_double(iqfoc_observer_turns(&drive.observer)))));
}

static void test_from_standstill_to_top_speed_and_back(void)
{
    iqfoc_sensorless_start(&drive);
    int begun = 0;
    double before = 0.0;
    while (drive.source != IQFOC_ANGLE_OBSERVED && begun < 30000) {
        before = torque;
        period(0.0);
        begun++;
    }
    printf("  observed after %d periods, angle %.1f degrees off, torque %.3f and %.3f\n", begun, off, before,
           torque);
    TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_OBSERVED, drive.source);
    TEST_ASSERT_TRUE(fabs(off) <= 10.0);
    double most = 0.0;
    for (int k = 0; k < 12000; k++) {
        period(speed_control(k < 6000 ? 0.2 : 0.03));
        TEST_ASSERT_TRUE(drive.observer.locked);
        most = k > 300 ? fmax(most, fabs(off)) : most;
        if (k == 5999) {
            TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, m.turns);
        }
    }
    printf("  to SFFR 5 and back: angle at most %.2f degrees off\n", most);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.03, m.turns);
    TEST_ASSERT_TRUE(most <= 4.0 && most > 0.5);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

/* On the sensor and back, at constant speed and the rated current. */
static void test_change_of_source_makes_no_step(void)
{
    turns_freely = false;
    m.turns = 0.1;
    for (int k = 0; k < 500; k++) {
        period(1.0);
        TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_MEASURED, drive.source);
    }
    TEST_ASSERT_TRUE(drive.observer.locked);
    TEST_ASSERT_TRUE(fabs(to_double(drive.difference)) <= 0.003);
    for (int n = 0; n < 4; n++) {
        iqfoc_sensorless_use(&drive, n % 2 == 0);
        double most = 0.0;
        for (int k = 0; k < 200; k++) {
            period(1.0);
            most = fmax(most, fabs(torque - 1.0));
            TEST_ASSERT_EQUAL_INT(n % 2 == 0 ? IQFOC_ANGLE_OBSERVED : IQFOC_ANGLE_MEASURED, drive.source);
        }
        printf("  %s: torque within %.3f\n", n % 2 == 0 ? "observed" : "measured", most);
        TEST_ASSERT_TRUE(most <= 0.06 && most > 0.0);
    }
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

/* The gates go on at any angle, with a speed up to 50 % off. */
static void test_catches_a_turning_machine(void)
{
    uint64_t seed = 5;
    int longest = 0;
    double most = 0.0;
    for (int n = 0; n < 40; n++) {
        setUp();
        turns_freely = false;
        m.turns = (n % 2 == 0 ? 1.0 : -1.0) * uniform(&seed, 0.03, 0.15);
        m.theta = uniform(&seed, 0.0, 1.0);
        m.psi = switched_flux(&m, 0.0, m.theta);
        iqfoc_sensorless_catch(&drive, to_iq24(m.turns * uniform(&seed, 0.5, 1.5)));
        int cycles = 0;
        while (drive.source != IQFOC_ANGLE_OBSERVED && cycles < 400) {
            period(0.0);
            most = fmax(most, cabs(switched_current(&m, m.psi, m.theta)));
            cycles++;
        }
        longest = cycles > longest ? cycles : longest;
        for (int k = 0; k < 100; k++) {
            period(0.0);
        }
        TEST_ASSERT_TRUE(drive.observer.locked && fabs(off) <= 3.0);
        TEST_ASSERT_EQUAL_UINT32(0, cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    }
    printf("  caught after at most %d periods, current at most %.2f of the rated\n", longest, most);
    TEST_ASSERT_TRUE(longest <= 150 && most <= 4.0);
}

static void test_lost_lock_sets_the_status(void)
{
    for (int trips = 0; trips < 2; trips++) {
        setUp();
        config.trips |= trips != 0 ? IQFOC_STATUS_ANGLE_LOST : 0U;
        turns_freely = false;
        m.turns = 0.1;
        iqfoc_sensorless_use(&drive, true);
        for (int k = 0; k < 300; k++) {
            period(0.3);
        }
        TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_OBSERVED, drive.source);
        TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
        m.psi_f *= 0.6; /* a magnet that is lost */
        for (int k = 0; k < 300 && !cycle.tripped; k++) {
            period(0.3);
        }
        TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_ANGLE_LOST, cycle.status & IQFOC_STATUS_ANGLE_LOST);
        TEST_ASSERT_EQUAL_INT(trips, cycle.tripped);
        if (trips == 0) {
            TEST_ASSERT_TRUE((drive.observer.status & IQFOC_OBSERVER_LOST_FLUX) != 0);
        }
    }
}

/* Gates off: no voltage is known, and the observer waits at the angle of the source. */
static void test_waits_while_the_gates_are_off(void)
{
    turns_freely = false;
    m.turns = 0.05;
    cycle.enabled = false;
    iqfoc_sensorless_use(&drive, false);
    for (int k = 0; k < 20; k++) {
        iqfoc_sample_t valley = sample_of(0);
        const iqfoc_sample_t before = valley;
        iqfoc_sensorless_valley(&drive, &cycle, &valley);
        TEST_ASSERT_EQUAL_INT32(before.theta, valley.theta);
        TEST_ASSERT_EQUAL_INT32(before.turns, valley.turns);
        TEST_ASSERT_TRUE(drive.observer.locked);
        TEST_ASSERT_EQUAL_UINT32(0, drive.on);
        m.theta += m.turns - floor(m.theta + m.turns);
    }
}

static void test_refuses_what_its_parts_refuse(void)
{
    iqfoc_observer_config_t no_magnet = observer_config;
    iqfoc_start_config_t no_current = start_config;
    no_magnet.k1 = 0;
    no_current.i_align = 0;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_sensorless_init(NULL, &observer_config, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_sensorless_init(&drive, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, iqfoc_sensorless_init(&drive, &no_magnet, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_START,
                          iqfoc_sensorless_init(&drive, &observer_config, &no_current, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_sensorless_init(&drive, &observer_config, NULL, NULL));
}

static double lost_of(const iqfoc_extension_t *x, double i)
{
    return to_double(x->v_dead) * fmax(-1.0, fmin(1.0, i * to_double(x->knee_inverse)));
}

static double complex acting_of(const iqfoc_extension_t *x, double complex u, double complex i)
{
    double lost[3];
    for (int k = 0; k < 3; k++) {
        lost[k] = lost_of(x, phase_of(i, k));
    }
    return to_double(x->k_u) * u - vector_of(lost);
}

/* The mean of both halves, and the bound that sensorless.h states, in LSB. */
static void test_voltage_that_acts(void)
{
    uint64_t seed = 31;
    for (int n = 0; n < 300000; n++) {
        const double reach = n % 2 == 0 ? 15.9 : 0.5;
        const iqfoc_extension_t x = {.k_u = random_iq24(&seed, 0.5, 2.0),
                                     .v_dead = random_iq24(&seed, -0.25, 0.25),
                                     .knee_inverse = random_iq24(&seed, 0.0, 127.0)};
        const iqfoc_ab_t u = random_ab_in_square(&seed, n % 3 == 0 ? 16.0 : 1.0);
        iqfoc_ab_t i[3];
        double complex exact[3];
        for (int k = 0; k < 3; k++) {
            i[k] = random_ab_in_square(&seed, reach);
            exact[k] = complex_of_ab(i[k]);
        }
        const double complex mean = 0.5 * (acting_of(&x, complex_of_ab(u), 0.5 * (exact[0] + exact[1])) +
                                           acting_of(&x, complex_of_ab(u), 0.5 * (exact[1] + exact[2])));
        const double complex wrong = complex_of_ab(iqfoc_sensorless_acting(&x, u, i[0], i[1], i[2])) - mean;
        const double slope = fabs(to_double(x.v_dead)) * to_double(x.knee_inverse);
        TEST_ASSERT_DOUBLE_WITHIN((2.6 + slope) / 16777216.0, 0.0,
                                  fmax(fabs(creal(wrong)), fabs(cimag(wrong))));
        TEST_ASSERT_EQUAL_INT32(u.beta, iqfoc_sensorless_acting(NULL, u, i[0], i[1], i[2]).beta);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_from_standstill_to_top_speed_and_back);
    RUN_TEST(test_change_of_source_makes_no_step);
    RUN_TEST(test_catches_a_turning_machine);
    RUN_TEST(test_lost_lock_sets_the_status);
    RUN_TEST(test_waits_while_the_gates_are_off);
    RUN_TEST(test_voltage_that_acts);
    RUN_TEST(test_refuses_what_its_parts_refuse);
    return UNITY_END();
}
