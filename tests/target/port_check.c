/*
 * The porting checklist as assertions (port_check.h).
 */
#include "port_check.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>

static double pu(iq24_t x)
{
    return x / 16777216.0;
}

/* The handler of the next valley, `late` cycles after it. */
static iqfoc_sample_t valley(const port_rig *rig, double late)
{
    iqfoc_sample_t sample;
    rig->go_to(0.99);
    rig->go_to(late);
    iqfoc_hal_read_valley(rig->hal, &sample);
    return sample;
}

/* The handler of this period's peak. */
static iqfoc_sample_t peak(const port_rig *rig, double late)
{
    iqfoc_sample_t sample;
    rig->go_to(0.5 + late);
    iqfoc_hal_read_peak(rig->hal, &sample);
    return sample;
}

static void check_currents(const iqfoc_sample_t *sample, const double i_pu[3], double step, const char *where)
{
    const double got[3] = {pu(sample->i.a), pu(sample->i.b), pu(sample->i.c)};
    for (int x = 0; x < 3; x++) {
        char text[128];
        (void)snprintf(text, sizeof text, "%s: phase %c reads %.4f, true %.4f: scaling, sign or order", where,
                       "ABC"[x], got[x], i_pu[x]);
        TEST_ASSERT_TRUE_MESSAGE(fabs(got[x] - i_pu[x]) <= 2.0 * step, text);
    }
}

void port_check_current_scaling_signs_and_order(const port_rig *rig)
{
    static const double sets[4][3] = {
        {0.6, -0.3, -0.3}, {-0.3, 0.6, -0.3}, {-0.3, -0.3, 0.6}, {-0.8, 0.5, 0.3}};
    for (int k = 0; k < 4; k++) {
        rig->set_current(sets[k]);
        const iqfoc_sample_t at_valley = valley(rig, 0.01);
        const iqfoc_sample_t at_peak = peak(rig, 0.01);
        check_currents(&at_valley, sets[k], rig->current_step_pu, "valley");
        check_currents(&at_peak, sets[k], rig->current_step_pu, "peak");
        TEST_ASSERT_FALSE_MESSAGE(at_valley.clipped || at_peak.clipped, "clipped well within the range");
    }
    const double none[3] = {0.0, 0.0, 0.0};
    rig->set_current(none);
    const iqfoc_sample_t still = valley(rig, 0.01);
    check_currents(&still, none, rig->current_step_pu, "no current");
    const double beyond[3] = {100.0, -50.0, -50.0};
    rig->set_current(beyond);
    const iqfoc_sample_t clipped = peak(rig, 0.01);
    TEST_ASSERT_TRUE_MESSAGE(clipped.clipped, "a converter at its end is not reported");
    rig->set_current(none);
}

void port_check_dc_link(const port_rig *rig)
{
    const double links[3] = {0.8, 1.0, 1.2};
    for (int k = 0; k < 3; k++) {
        rig->set_dc_link(links[k]);
        const iqfoc_sample_t sample = valley(rig, 0.01);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.002, links[k], pu(sample.u_dc), "scaling of the DC link");
    }
}

/* A shaft that turns evenly: the angle is that of the sampling instant although it is read later. */
void port_check_angle_and_speed(const port_rig *rig)
{
    const double speeds[2] = {0.03, -0.03}; /* turns per cycle */
    for (int way = 0; way < 2; way++) {
        double angle = 0.4;
        iqfoc_sample_t sample = {.theta = 0};
        for (int k = 0; k < 100; k++) {
            const double late = 0.05;
            rig->go_to(0.99);
            rig->set_angle(angle + speeds[way] * late); /* where the shaft is when the handler reads it */
            sample = valley(rig, late);
            angle += speeds[way];
        }
        angle -= speeds[way];
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1 * fabs(speeds[way]), speeds[way], pu(sample.turns),
                                          "speed: scaling or direction (A -> B -> C is positive)");
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2.0 * rig->angle_step, 0.0,
                                          remainder(pu(sample.theta) - angle, 1.0),
                                          "angle: offset, scaling, or not of the sampling instant");
    }
}

/* `at` and `time` are those of the instant, however late the handler comes. */
void port_check_sampling_instant(const port_rig *rig)
{
    const uint32_t period = rig->period_ticks();
    uint32_t last = 0;
    for (int k = 0; k < 20; k++) {
        const double late = 0.02 * k;
        const iqfoc_sample_t at_valley = valley(rig, late);
        const uint32_t now = iqfoc_hal_now(rig->hal);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(0, at_valley.at, "`at` of the valley");
        TEST_ASSERT_UINT32_WITHIN_MESSAGE(period / 200, (uint32_t)lround(late * period), now - at_valley.time,
                                          "`time` is not that of the valley");
        if (k > 0) {
            TEST_ASSERT_UINT32_WITHIN_MESSAGE(period / 200, period, at_valley.time - last,
                                              "valleys a period apart");
        }
        last = at_valley.time;
        const iqfoc_sample_t at_peak = peak(rig, late);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(IQ24_ONE / 2, at_peak.at, "`at` of the peak");
        TEST_ASSERT_UINT32_WITHIN_MESSAGE(period / 200, period / 2, at_peak.time - at_valley.time,
                                          "`time` is not that of the peak");
    }
}

static iqfoc_command_t command_of(double a, double b, double c)
{
    const iqfoc_command_t command = {{{IQ24_ONE, IQ24_ONE, IQ24_ONE}, IQ24_ONE}, true};
    iqfoc_command_t made = command;
    made.duties.high.a = (iq24_t)lround(a * IQ24_ONE);
    made.duties.high.b = (iq24_t)lround(b * IQ24_ONE);
    made.duties.high.c = (iq24_t)lround(c * IQ24_ONE);
    return made;
}

/* The share of the coming period for which each leg is high; it begins at the valley. */
static void watch_period(const port_rig *rig, double share[3])
{
    const int steps = 2000;
    int high[3] = {0, 0, 0};
    for (int k = 0; k < steps; k++) {
        rig->go_to((k + 0.5) / steps);
        for (int leg = 0; leg < 3; leg++) {
            high[leg] += rig->leg_high(leg) ? 1 : 0;
        }
    }
    for (int leg = 0; leg < 3; leg++) {
        share[leg] = (double)high[leg] / steps;
    }
}

void port_check_update_instant(const port_rig *rig)
{
    const iqfoc_command_t before = command_of(0.2, 0.2, 0.2);
    const iqfoc_command_t after = command_of(0.8, 0.8, 0.8);
    rig->go_to(0.6);
    iqfoc_hal_write(rig->hal, &before);
    rig->go_to(0.0);
    rig->go_to(0.55);
    TEST_ASSERT_TRUE_MESSAGE(rig->leg_high(0), "a leg is not high around the peak");
    iqfoc_hal_write(rig->hal, &after);
    /* 0.2 of a period is 0.4 ... 0.6; 0.8 would be 0.1 ... 0.9. */
    for (double phase = 0.62; phase < 0.99; phase += 0.01) {
        rig->go_to(phase);
        TEST_ASSERT_FALSE_MESSAGE(rig->leg_high(0) || rig->leg_high(1) || rig->leg_high(2),
                                  "a command acts before the next valley");
    }
    double share[3];
    watch_period(rig, share);
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.002, 0.8, share[leg],
                                          "a command does not act from the next valley");
    }
    /* A command that comes too late for its valley waits for the next: it must not act at the peak. */
    rig->go_to(0.05);
    iqfoc_hal_write(rig->hal, &before);
    rig->go_to(0.85);
    TEST_ASSERT_TRUE_MESSAGE(rig->leg_high(0), "a late command acts in the middle of a period");
}

void port_check_duties_and_order(const port_rig *rig)
{
    static const double sets[3][3] = {{0.1, 0.5, 0.9}, {0.7, 0.3, 0.0}, {1.0, 0.25, 0.6}};
    for (int k = 0; k < 3; k++) {
        const iqfoc_command_t command = command_of(sets[k][0], sets[k][1], sets[k][2]);
        double share[3];
        rig->go_to(0.6);
        iqfoc_hal_write(rig->hal, &command);
        rig->go_to(0.99);
        watch_period(rig, share);
        for (int leg = 0; leg < 3; leg++) {
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.002, sets[k][leg], share[leg],
                                              "duty: scaling, sense or order of legs");
        }
    }
}

void port_check_gates(const port_rig *rig)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5);
    iqfoc_command_t off = command_of(0.0, 0.0, 0.0);
    off.gates = false;
    rig->go_to(0.6);
    iqfoc_hal_write(rig->hal, &on);
    rig->go_to(0.1);
    TEST_ASSERT_TRUE_MESSAGE(rig->outputs_on(), "gates do not come on");
    iqfoc_hal_write(rig->hal, &off);
    TEST_ASSERT_FALSE_MESSAGE(rig->outputs_on(), "gates off must act at once, not at the valley");
}
