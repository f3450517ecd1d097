/*
 * Low-side shunts with one trigger a period, a break with restart, a lost phase and a lost sensor, against the
 * switching plant.
 */
#include "around_drive.h"

#include "iqfoc/restart.h"
#include "iqfoc/shunts.h"
#include "iqfoc/supervision.h"
#include "iqfoc/transform.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static around_drive d;

void setUp(void)
{
}

void tearDown(void)
{
}

static plant_config given_speed(double u_dc_V, double turns_per_cycle)
{
    plant_config truth = around_plant(u_dc_V);
    truth.shaft.mode = PLANT_SHAFT_GIVEN;
    truth.shaft.omega_e_start_rad_s = VEC_TWO_PI * turns_per_cycle / truth.T_s;
    return truth;
}

/* What the three shunts show: the phase current where the low side was on long enough up to the valley. */
static iqfoc_abc_t shunt_samples(iqfoc_abc_t i, const double duty[3], double duty_max)
{
    i.a = duty[0] > duty_max ? IQ24(3.0) : i.a;
    i.b = duty[1] > duty_max ? IQ24(-2.0) : i.b;
    i.c = duty[2] > duty_max ? IQ24(1.0) : i.c;
    return i;
}

static iqfoc_abc_t duties_of(const double duty[3])
{
    const iqfoc_abc_t duties = {iq24_from_double(duty[0]), iq24_from_double(duty[1]),
                                iq24_from_double(duty[2])};
    return duties;
}

/*
 * Both handlers from one interrupt at the valley, as with one converter trigger a period: the peak's sample is
 * the valley's. Returns how many cycles had fewer than two shunts.
 */
static long run_on_shunts(bool shunts_only, bool room, double span_max, double *off_A)
{
    const iqfoc_shunts_t shunts = {IQ24(0.85)};
    const plant_config truth = given_speed(150.0, 0.016);
    double square = 0.0;
    long lacking = 0;
    double before[3] = {0.0, 0.0, 0.0}; /* duties of the period that ends at the valley */
    around_begin(&d, &truth);
    d.config.span_max = iq24_from_double(span_max);
    d.config.deadline_ticks = d.config.period_ticks;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_shunts_check(&shunts));
    d.cycle.enabled = true;
    d.cycle.i_ref.q = IQ24(0.3);
    for (int32_t k = 0; k < 4000; k++) {
        iqfoc_sample_t sample = around_valley(&d);
        if (shunts_only) {
            const iqfoc_abc_t predicted = iqfoc_clarke_inverse(d.cycle.i_next);
            const iqfoc_abc_t seen = shunt_samples(sample.i, before, 0.85 + 1e-6);
            const iqfoc_shunts_currents_t got =
                iqfoc_shunts_read(&shunts, seen, duties_of(before), predicted);
            sample.i = got.i;
            lacking += k > 500 && !got.measured;
        }
        around_valley_handler(&d, &sample);
        (void)around_peak(&d);
        memcpy(before, d.duty, sizeof before);
        around_peak_handler(&d, &sample);
        if (room) {
            const iqfoc_abc_t moved = iqfoc_shunts_make_room(&shunts, duties_of(d.duty));
            d.duty[0] = iq24_to_double(moved.a);
            d.duty[1] = iq24_to_double(moved.b);
            d.duty[2] = iq24_to_double(moved.c);
        }
        const double off = hypot(d.mean_dq_A[0], d.mean_dq_A[1] - 0.3 * d.base.I_A);
        square += k > 1000 ? off * off / 3000.0 : 0.0;
    }
    TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    *off_A = sqrt(square);
    return lacking;
}

static void test_shunts(void)
{
    double all_A;
    double room_A;
    double none_A;
    (void)run_on_shunts(false, false, 0.85, &all_A);
    const long with_room = run_on_shunts(true, true, 0.85, &room_A);
    const long without = run_on_shunts(true, false, 0.85, &none_A);
    printf("  current off by %.3f A with three sensors, %.3f A with shunts; centred duties lack two in %ld "
           "of 3500 cycles: %.3f A\n",
           all_A, room_A, without, none_A);
    TEST_ASSERT_EQUAL_INT64(0, with_room);
    TEST_ASSERT_TRUE(without > 20);
    TEST_ASSERT_TRUE(room_A < 2.0 * all_A);
}

/* A cycle whose samples pass `change`; supervised, and restarted as the state machine says. */
typedef struct watch {
    iqfoc_supervision_t supervision;
    iqfoc_restart_t restart;
    long tries;
} watch_t;

static const iqfoc_supervision_config_t supervised = {IQ24(0.1), IQ24(0.125), 12, 3, IQ24(0.2), 5};
static const iqfoc_restart_config_t restarts = {IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_BREAK, 50, 2, 1000};

static void watch_begin(watch_t *w)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&w->supervision, &supervised));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&w->restart, &restarts));
    w->tries = 0;
    d.cycle.enabled = true;
    d.cycle.i_ref.q = IQ24(0.3);
}

/* broken: the break line is active, the gates are off whatever the firmware says. */
static void watched_cycle(watch_t *w, bool broken)
{
    iqfoc_sample_t sample = around_valley(&d);
    const uint32_t own = iqfoc_supervision_step(&w->supervision, sample.i, sample.speed, d.cycle.enabled);
    const bool running = w->restart.action == IQFOC_RESTART_RUN || w->restart.action == IQFOC_RESTART_TRY;
    const uint32_t trips = running && d.cycle.tripped ? d.cycle.status & d.config.trips : 0;
    switch (iqfoc_restart_step(&w->restart, own | trips | (broken ? IQFOC_STATUS_BREAK : 0))) {
    case IQFOC_RESTART_TRY:
        iqfoc_cycle_clear(&d.cycle);
        d.cycle.enabled = true;
        w->tries++;
        break;
    case IQFOC_RESTART_RUN:
        break;
    case IQFOC_RESTART_WAIT:
    case IQFOC_RESTART_LATCHED:
    default:
        d.cycle.enabled = false;
        break;
    }
    around_valley_handler(&d, &sample);
    sample = around_peak(&d);
    around_peak_handler(&d, &sample);
}

static void test_break_and_restart(void)
{
    const plant_config truth = given_speed(300.0, 0.01);
    watch_t w;
    around_begin(&d, &truth);
    watch_begin(&w);
    for (int32_t k = 0; k < 1500; k++) {
        /* A short break at 500; the trip of a current that is too large at 800. */
        d.config.current_limit = k == 800 ? IQ24(0.05) : IQ24(4.0);
        watched_cycle(&w, k >= 500 && k < 520);
        if (k >= 505 && k < 565) {
            TEST_ASSERT_FALSE(d.hal.command.gates);
        }
    }
    TEST_ASSERT_EQUAL_INT64(2, w.tries);
    TEST_ASSERT_EQUAL_INT(IQFOC_RESTART_RUN, w.restart.action);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_BREAK | IQFOC_STATUS_OVERCURRENT, w.restart.faults);
    TEST_ASSERT_TRUE(d.hal.command.gates);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.3 * d.base.I_A, d.mean_dq_A[1]);
    /* A third time within 1000 cycles is once too often. */
    watched_cycle(&w, true);
    TEST_ASSERT_EQUAL_INT(IQFOC_RESTART_LATCHED, w.restart.action);
    for (int32_t k = 0; k < 200; k++) {
        watched_cycle(&w, false);
        TEST_ASSERT_FALSE(d.hal.command.gates);
    }
    iqfoc_restart_acknowledge(&w.restart);
    for (int32_t k = 0; k < 300; k++) {
        watched_cycle(&w, false);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.3 * d.base.I_A, d.mean_dq_A[1]);
}

/* Each phase torn off, each of three sensors dead, at a crawl and at a low ratio: the right bit, the right one. */
static void test_lost_phase_and_sensor(void)
{
    static const double speeds[] = {0.002, 0.05};
    for (int32_t n = 0; n < 12; n++) {
        const int32_t x = n % 3;
        const bool sensor = n >= 6;
        plant_config truth = given_speed(300.0, speeds[n / 3 % 2]);
        watch_t w;
        if (sensor) {
            truth.sensors.current_gain[x] = 0.0;
        } else {
            truth.machine.dR_ohm[x] = 2e4;
        }
        around_begin(&d, &truth);
        watch_begin(&w);
        int32_t k = 0;
        while (k < 3000 && w.supervision.status == 0) {
            watched_cycle(&w, false);
            k++;
        }
        printf("  %s %c at %.3f turns a cycle: found after %d cycles\n", sensor ? "sensor" : "phase ",
               "ABC"[x], speeds[n / 3 % 2], (int)k);
        TEST_ASSERT_EQUAL_UINT32(sensor ? IQFOC_STATUS_LOST_CURRENT_SENSOR : IQFOC_STATUS_LOST_PHASE,
                                 w.supervision.status);
        TEST_ASSERT_TRUE(sensor || w.supervision.phase == UINT32_C(1) << x);
        watched_cycle(&w, false);
        TEST_ASSERT_EQUAL_INT(IQFOC_RESTART_LATCHED, w.restart.action);
        TEST_ASSERT_FALSE(d.hal.command.gates);
    }
    /* Nothing lost: nothing said, over a torque step. */
    const plant_config truth = given_speed(300.0, 0.02);
    watch_t w;
    around_begin(&d, &truth);
    watch_begin(&w);
    for (int32_t k = 0; k < 3000; k++) {
        d.cycle.i_ref.q = k < 1500 ? IQ24(0.8) : IQ24(-0.8);
        watched_cycle(&w, false);
        TEST_ASSERT_EQUAL_UINT32(0, w.supervision.status);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_shunts);
    RUN_TEST(test_break_and_restart);
    RUN_TEST(test_lost_phase_and_sensor);
    return UNITY_END();
}
