/*
 * The cycle under faults: whatever samples, times and orders it gets, with every combination of methods, its
 * duties lie within 0 and 1, its integrators within their limits, each fault shows in the status, and after
 * iqfoc_cycle_clear it controls as one that is new.
 *
 *     test_cycle_soak [CYCLES]        2,000,000 if not given
 */
#include "iqfoc/cycle_steps.h"

#include "cycle_fixture.h"

#include <stdio.h>
#include <stdlib.h>

static long cycles = 2000000;
static uint64_t state = 20161219;

/* splitmix64. */
static uint64_t draw(void)
{
    state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static bool one_in(uint64_t n)
{
    return draw() % n == 0;
}

static iq24_t within(iq24_t limit)
{
    return (iq24_t)((int64_t)(draw() % (2 * (uint64_t)limit + 1)) - limit);
}

static iqfoc_exact_law_t law;
static iqfoc_exact_law_t mean_law;
static iqfoc_salient_t salient;
static iqfoc_salient_t salient_mean;
static const iqfoc_flux_predictor_t flux = {.l_d = IQ24(0.515),
                                            .l_q = IQ24(0.515),
                                            .k_d = IQ24(1.9417),
                                            .k_q = IQ24(1.9417),
                                            .r = IQ24(0.015),
                                            .psi = IQ24(0.9)};
static const iqfoc_extension_t extension = {
    .i_offset = {IQ24(0.01), IQ24(-0.02), IQ24(0.01)},
    .i_gain_inverse = {IQ24(1.02), IQ24(0.98), IQ24_ONE},
    .theta_0 = IQ24(0.01),
    .theta_delay = IQ24(0.1),
    .k_u = IQ24(1.02),
    .v_dead = IQ24(0.02),
    .knee_inverse = IQ24(20.0),
    .saturation = IQ24(0.05),
};
static iqfoc_cycle_config_t sets[2];

static void make_sets(void)
{
    static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V);
    static const iqfoc_salient_machine_t machine =
        IQFOC_SALIENT_MACHINE(R_OHM, L_H, 1.3 * L_H, PSI_WB, T_S, I_B_A, U_DC_V);
    law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    mean_law = iqfoc_exact_mean(&winding, IQ24_ONE);
    iqfoc_salient_at_speed(&machine, IQ24(0.05), IQ24_ONE, &salient, &salient_mean);
    sets[0] = base_config;
    sets[0].trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_STALE | IQFOC_STATUS_LATE | IQFOC_STATUS_OVERCURRENT |
                    IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_DC_LINK | IQFOC_STATUS_OVERSPEED;
    sets[0].data.exact = &law;
    sets[0].data.exact_mean = &mean_law;
    sets[0].data.salient = &salient;
    sets[0].data.salient_mean = &salient_mean;
    sets[0].data.flux = &flux;
    sets[0].data.acting = &extension;
    sets[0].data.extension = &extension;
    sets[0].data.k_u_inverse = iqfoc_deadbeat_inverse(law.k_u_q26);
    sets[0].data.k_psi = sets[0].predictor.k_psi;
    sets[0].data.learning = IQ24(0.1);
    sets[1] = sets[0];
    sets[1].gains.kp_d /= 2;
    sets[1].predictor.k_u += sets[1].predictor.k_u / 4;
    sets[1].period_ticks = PERIOD + PERIOD / 4;
}

static iqfoc_methods_t draw_methods(void)
{
    iqfoc_methods_t m;
    do {
        m.model = (iqfoc_model_t)(draw() % 5);
        m.feedback = (iqfoc_feedback_t)(draw() % 5);
        m.control = (iqfoc_control_t)(draw() % 3);
        m.modulation = (iqfoc_modulation_t)(draw() % 3);
        m.extended = one_in(2);
    } while (iqfoc_cycle_check(m, &sets[0]) != IQFOC_OK);
    return m;
}

static iqfoc_sample_t healthy(iq24_t at)
{
    iqfoc_sample_t s = sample_at(at);
    const iq24_t a = within(IQ24(0.5));
    const iq24_t b = within(IQ24(0.5));
    s.i.a = a;
    s.i.b = b;
    s.i.c = -a - b;
    s.i_mean = s.i;
    s.theta = within(IQ24(0.5));
    s.speed = within(IQ24(0.1));
    s.u_dc = IQ24_ONE + within(IQ24(0.2));
    return s;
}

/* What must show for what was done to the sample. */
static uint32_t spoil(iqfoc_sample_t *s, uint32_t *now)
{
    static const iq24_t link[] = {0, -1, IQ24(-1.0), IQ24_MIN, IQ24(0.49), IQ24(1.51), IQ24_MAX};
    switch (draw() % 12) {
    case 0:
        s->clipped = true;
        return IQFOC_STATUS_SAMPLE_CLIPPED;
    case 1:
        s->u_dc = link[draw() % 7];
        return IQFOC_STATUS_DC_LINK;
    case 2:
        s->speed = one_in(2) ? IQ24(0.34) : IQ24_MIN + (iq24_t)(draw() % 1000);
        return IQFOC_STATUS_OVERSPEED;
    case 3:
        s->i.a = IQ24(15.9);
        s->i.b = IQ24(-15.9);
        s->i.c = 0;
        return IQFOC_STATUS_OVERCURRENT;
    case 4:
        *now = s->time + sets[0].stale_ticks + 1 + (uint32_t)(draw() % PERIOD);
        return IQFOC_STATUS_STALE;
    case 5:
        *now = s->time - 1 - (uint32_t)(draw() % PERIOD); /* a sample from the future */
        return IQFOC_STATUS_STALE;
    case 6:
        s->theta = (iq24_t)(draw() & UINT32_C(0x7FFFFFFF)); /* the angle jumps: no fault can be recognised */
        return 0;
    default:
        return 0;
    }
}

static void expect_sound(iqfoc_command_t command)
{
    const iqfoc_abc_t d = command.duties.high;
    if (!iq24_within(d.a, 0, IQ24_ONE) || !iq24_within(d.b, 0, IQ24_ONE) || !iq24_within(d.c, 0, IQ24_ONE) ||
        !iq24_within(command.duties.scale, 0, IQ24_ONE)) {
        TEST_FAIL_MESSAGE("a duty beyond 0 ... 1");
    }
    const iq24_acc_t limit = INT64_C(8) << 48;
    if (cycle.control.integral_d > limit || cycle.control.integral_d < -limit ||
        cycle.control.integral_q > limit || cycle.control.integral_q < -limit) {
        TEST_FAIL_MESSAGE("an integrator beyond 8");
    }
    if (!cycle.enabled || cycle.tripped) {
        if (command.gates || (d.a | d.b | d.c) != 0) {
            TEST_FAIL_MESSAGE("gates on although disabled or tripped");
        }
    }
}

static void expect_shown(uint32_t wanted, const char *where)
{
    if ((cycle.status & wanted) != wanted || (wanted != 0 && !cycle.tripped)) {
        TEST_FAIL_MESSAGE(where);
    }
}

/* One carrier period, spoilt now and then. Returns the command of the last peak. */
static void period(const iqfoc_methods_t m)
{
    const bool spoilt = one_in(16);
    iqfoc_sample_t s = healthy(0);
    uint32_t now = ticks + 5;
    uint32_t wanted = spoilt ? spoil(&s, &now) : 0;
    const bool doubled = cycle.phase == IQFOC_CYCLE_DUE_PEAK;
    iqfoc_cycle_valley_by(m, &cycle, &s, now);
    expect_shown(wanted | (doubled ? IQFOC_STATUS_MISSED : 0), "at a valley");
    ticks += cycle.config->period_ticks / 2;
    if (one_in(64)) {
        return; /* the peak is missed: the next valley will tell */
    }
    if (one_in(32)) {
        cycle.enabled = !cycle.enabled; /* in flight */
    }
    cycle.i_ref.d = within(IQ24(2.0));
    cycle.i_ref.q = within(IQ24(2.0));
    s = healthy(IQ24(0.5));
    now = ticks + 5;
    wanted = spoilt ? spoil(&s, &now) : 0;
    const iqfoc_command_t command = iqfoc_cycle_peak_by(m, &cycle, &s, IQ24(1.5), now);
    expect_shown(wanted, "at a peak");
    expect_sound(command);
    if (one_in(64)) {
        expect_sound(iqfoc_cycle_peak_by(m, &cycle, &s, IQ24(1.5), now)); /* a peak twice */
        expect_shown(IQFOC_STATUS_MISSED, "a second peak");
    }
    if (one_in(64)) {
        (void)iqfoc_cycle_in_time(&cycle, &s, ticks + cycle.config->deadline_ticks + 1);
        expect_shown(IQFOC_STATUS_LATE, "a late command");
    }
    ticks += cycle.config->period_ticks - cycle.config->period_ticks / 2;
}

/* After clear, with healthy samples: nothing trips, and the gates are on. */
static void expect_recovery(const iqfoc_methods_t m)
{
    iqfoc_cycle_clear(&cycle);
    cycle.enabled = true;
    cycle.i_ref.d = 0;
    cycle.i_ref.q = IQ24(0.2);
    for (int32_t n = 0; n < 4; n++) {
        iqfoc_sample_t s = sample_at(0);
        s.u_dc = IQ24_ONE;
        iqfoc_cycle_valley_by(m, &cycle, &s, ticks + 5);
        ticks += cycle.config->period_ticks / 2;
        s = sample_at(IQ24(0.5));
        const iqfoc_command_t command = iqfoc_cycle_peak_by(m, &cycle, &s, IQ24(1.5), ticks + 5);
        ticks += cycle.config->period_ticks - cycle.config->period_ticks / 2;
        expect_sound(command);
        if (!command.gates || cycle.tripped) {
            TEST_FAIL_MESSAGE("no recovery after clear");
        }
    }
}

static void test_faults(void)
{
    long recovered = 0;
    make_sets();
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &sets[0]));
    for (long done = 0; done < cycles;) {
        const iqfoc_methods_t m = draw_methods();
        for (int32_t n = 0; n < 100; n++, done++) {
            if (iqfoc_cycle_taken(&cycle) && one_in(16)) {
                const iqfoc_cycle_config_t *other = cycle.config == &sets[0] ? &sets[1] : &sets[0];
                TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_offer(&cycle, other));
            }
            period(m);
            if (cycle.tripped && one_in(4)) {
                expect_recovery(m);
                recovered++;
            }
        }
    }
    printf("  %ld cycles with faults, %ld recoveries\n", cycles, recovered);
    TEST_ASSERT_TRUE(recovered > cycles / 100);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        cycles = strtol(argv[1], NULL, 10);
        if (cycles < 100 || cycles > 1000000000) {
            fprintf(stderr, "%s: the number of cycles must be 100 ... 1000000000\n", argv[0]);
            return 2;
        }
    }
    UNITY_BEGIN();
    RUN_TEST(test_faults);
    return UNITY_END();
}
