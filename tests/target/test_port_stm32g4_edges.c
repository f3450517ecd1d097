/*
 * Edges on the STM32G474: both checklists of docs/porting.md on the bank of memory, the bits of the set-up, and what happens beyond the
 * port's limits.
 */
#include "fake_stm32g4_bank.h"
#include "rig_stm32g4_edges.h"

#include "unity.h"

#include <stddef.h>

#define PERIOD (2u * RIG_EDGES_HALF)
#define SPAN   (PERIOD / RIG_EDGES_SPANS)

static const port_rig *rig;

void setUp(void)
{
    rig_edges_latency = 0;
    rig = rig_stm32g4_edges_start();
}

void tearDown(void)
{
}

static void test_registers_lie_where_the_manual_puts_them(void)
{
    TEST_ASSERT_EQUAL(0x3DC, offsetof(stm32g4_tim_t, DCR));
    TEST_ASSERT_EQUAL(0x3E0, offsetof(stm32g4_tim_t, DMAR));
    TEST_ASSERT_EQUAL(0x08, offsetof(stm32g4_dma_t, CCR1));
    TEST_ASSERT_EQUAL(0x14, offsetof(stm32g4_dma_t, CMAR1));
    TEST_ASSERT_EQUAL(12, sizeof(hal_stm32g4_span_t));
    /* A burst goes from ARR to CCR4 without a gap. */
    TEST_ASSERT_EQUAL(offsetof(stm32g4_tim_t, ARR) + 5 * sizeof(stm32g4_reg_t),
                      offsetof(stm32g4_tim_t, CCR) + 3 * sizeof(stm32g4_reg_t));
}

static void test_set_up(void)
{
    const stm32g4_tim_t *tim = &fake_bank.tim1;
    TEST_ASSERT_FALSE_MESSAGE(fake_ever_set(&tim->BDTR, TIM_BDTR_MOE), "outputs on by set-up");
    TEST_ASSERT_EQUAL_HEX32(TIM_CR1_CEN | TIM_CR1_ARPE | TIM_CR1_URS, tim->CR1); /* upwards */
    TEST_ASSERT_EQUAL_HEX32(0x00700070, tim->CR2);                               /* MMS = MMS2 = 0111 */
    TEST_ASSERT_EQUAL_HEX32(0x00003838, tim->CCMR1); /* OC1M = OC2M = 0011, preload on */
    TEST_ASSERT_EQUAL_HEX32(0x00007838, tim->CCMR2); /* OC3M = 0011, OC4M = 0111, preload on */
    TEST_ASSERT_EQUAL_HEX32(0x00000555, tim->CCER);
    TEST_ASSERT_EQUAL_HEX32(0x0000050B, tim->DCR); /* six registers from number 11, ARR */
    TEST_ASSERT_EQUAL_HEX32(0x00000100, tim->DIER);
    TEST_ASSERT_EQUAL_HEX32(0x1D95, tim->BDTR);
    /* EN, DIR, CIRC, MINC, PSIZE = 10, MSIZE = 01, PL = 11. */
    TEST_ASSERT_EQUAL_HEX32(0x36B1, fake_bank.dma1.CCR1);
    TEST_ASSERT_EQUAL_UINT32(46, fake_bank.dmamux.C0CR);
    TEST_ASSERT_EQUAL_HEX32(5, fake_bank.rcc.AHB1ENR);
    /* Forced low before they toggle; loaded before the DMA is asked; all before the start. */
    const int32_t low = fake_first_write(&tim->CCMR1, 0x7070, 0x4040);
    const int32_t load = fake_last_write(&tim->EGR, TIM_EGR_UG, TIM_EGR_UG);
    const int32_t toggle = fake_last_write(&tim->CCMR1, 0x7070, 0x3030);
    const int32_t asks = fake_first_write(&tim->DIER, TIM_DIER_UDE, TIM_DIER_UDE);
    const int32_t dma = fake_first_write(&fake_bank.dma1.CCR1, DMA_CCR_EN, DMA_CCR_EN);
    const int32_t start = fake_first_write(&tim->CR1, TIM_CR1_CEN, TIM_CR1_CEN);
    TEST_ASSERT_TRUE(low >= 0 && low < load && load < toggle && load < asks);
    TEST_ASSERT_TRUE(toggle < start && asks < start && dma < start);
    TEST_ASSERT_TRUE(fake_last_write(&fake_bank.dma1.CNDTR1, 0, 0) < dma);
}

static void test_refused(void)
{
    hal_stm32g4_board_t board = *rig_edges_hal.board;
    static const uint32_t bad_spans[4] = {6, 9, 34, 16}; /* 16: spans of 312 ticks */
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL(STM32G4_ERROR_EDGES, hal_stm32g4_edges_start(&rig_edges_hal, &fake_chip, &board,
                                                                       &rig_edges, bad_spans[k], 1000));
    }
    board.half_ticks = 8 * 65535 / 2 + 1;
    TEST_ASSERT_EQUAL(STM32G4_ERROR_EDGES,
                      hal_stm32g4_edges_start(&rig_edges_hal, &fake_chip, &board, &rig_edges, 8, 1000));
    board.half_ticks = 17000;
    TEST_ASSERT_EQUAL(STM32G4_ERROR_DEAD_TIME,
                      hal_stm32g4_edges_start(&rig_edges_hal, &fake_chip, &board, &rig_edges, 8, 5930));
    TEST_ASSERT_EQUAL(STM32G4_OK,
                      hal_stm32g4_edges_start(&rig_edges_hal, &fake_chip, &board, &rig_edges, 32, 1000));
}

static void check_all(void)
{
    for (int k = 0; k < PORT_CHECK_EDGES_ITEMS; k++) {
        const char *what = port_check_edges_items[k].run(rig_stm32g4_edges_start);
        TEST_ASSERT_NULL_MESSAGE(what, what);
    }
}

static void test_every_line(void)
{
    TEST_ASSERT_EQUAL_INT(0, port_check_all(rig_stm32g4_edges_start, stdout));
    TEST_ASSERT_EQUAL_INT(0, port_check_edges(rig_stm32g4_edges_start, stdout));
}

/* When the burst comes within its span is of no matter. */
static void test_latency_of_the_dma(void)
{
    rig_edges_latency = SPAN - 100;
    check_all();
}

static const iqfoc_edges_t low = {PERIOD, {{-1, 0, {0}}, {-1, 0, {0}}, {-1, 0, {0}}}};

/* Where leg a changes in the coming cycle. */
static int changes(uint32_t at[8])
{
    int n = 0;
    rig->go_to(0.9999);
    bool was = rig->leg_high(0);
    for (uint32_t t = 0; t < PERIOD; t++) {
        rig->go_to((t + 0.5) / PERIOD);
        if (rig->leg_high(0) != was && n < 8) {
            at[n++] = t;
        }
        was = rig->leg_high(0);
    }
    return n;
}

static void write_at(double phase, const iqfoc_edges_t *edges)
{
    rig->go_to(phase);
    iqfoc_hal_write_edges(&rig_edges_hal, edges);
}

/* Nearer than a span: the second edge moves to the next one; at the cycle's end, to the next cycle if it is still asked for. */
static void test_edges_that_are_too_near(void)
{
    uint32_t at[8];
    const iqfoc_edges_t near = {
        PERIOD, {{-1, 4, {SPAN + 7, SPAN + 9, SPAN + 20, 4 * SPAN}}, {-1, 0, {0}}, {-1, 0, {0}}}};
    write_at(0.3, &low);
    write_at(0.2, &near);
    TEST_ASSERT_EQUAL_INT(4, changes(at));
    TEST_ASSERT_EQUAL_UINT32(SPAN + 7, at[0]);
    TEST_ASSERT_EQUAL_UINT32(2 * SPAN + 1, at[1]);
    TEST_ASSERT_EQUAL_UINT32(3 * SPAN + 1, at[2]);
    TEST_ASSERT_EQUAL_UINT32(4 * SPAN + 1, at[3]);
    const iqfoc_edges_t late = {PERIOD, {{-1, 2, {9 * SPAN + 7, 9 * SPAN + 8}}, {-1, 0, {0}}, {-1, 0, {0}}}};
    write_at(0.2, &late);
    rig->go_to(0.99);
    write_at(0.2, &low);
    TEST_ASSERT_TRUE(rig->leg_high(0) == false);
    rig->go_to(0.9999);
    TEST_ASSERT_TRUE(rig->leg_high(0));
    TEST_ASSERT_EQUAL_INT(1, changes(at));
    TEST_ASSERT_EQUAL_UINT32(1, at[0]);
}

/* Four spans ahead of the valley is early enough, three are not: nothing changes then, and the levels stay known. */
static void test_deadline_of_a_write(void)
{
    uint32_t at[8];
    const iqfoc_edges_t one = {PERIOD, {{-1, 1, {2000}}, {-1, 0, {0}}, {-1, 0, {0}}}};
    write_at(0.3, &low);
    write_at(0.69, &one);
    TEST_ASSERT_EQUAL_INT(1, changes(at));
    rig->go_to(0.3);
    TEST_ASSERT_TRUE(rig->leg_high(0));
    write_at(0.71, &low);
    TEST_ASSERT_EQUAL_INT(0, changes(at));
    TEST_ASSERT_TRUE(rig->leg_high(0) && rig->outputs_on());
    write_at(0.5, &low);
    TEST_ASSERT_EQUAL_INT(1, changes(at));
    TEST_ASSERT_FALSE(hal_stm32g4_broken(&rig_edges_hal));
}

/* Also gates off in the last spans: the edges that are there play behind the safe output. */
static void test_late_safe_output(void)
{
    uint32_t at[8];
    const iqfoc_command_t safe = {{{0, 0, 0}, IQ24_ONE}, false};
    const iqfoc_edges_t one = {PERIOD, {{-1, 1, {2000}}, {-1, 0, {0}}, {-1, 0, {0}}}};
    write_at(0.3, &low);
    write_at(0.3, &one);
    rig->go_to(0.95);
    iqfoc_hal_write(&rig_edges_hal, &safe);
    TEST_ASSERT_FALSE(rig->outputs_on());
    TEST_ASSERT_EQUAL_INT(1, changes(at));
    TEST_ASSERT_EQUAL_INT(1, changes(at)); /* low again at its valley */
    TEST_ASSERT_EQUAL_UINT32(1, at[0]);
    TEST_ASSERT_EQUAL_INT(0, changes(at));
    write_at(0.3, &one);
    TEST_ASSERT_TRUE(rig->outputs_on());
    TEST_ASSERT_EQUAL_INT(1, changes(at));
    TEST_ASSERT_EQUAL_UINT32(2000 + (2000 % SPAN == 0), at[0]);
}

/* Without a call for a cycle or more the levels are not known: off, low, until they are. */
static void test_lost_levels(void)
{
    for (int cycles = 2; cycles <= 5; cycles++) {
        const iqfoc_edges_t one = {PERIOD, {{-1, 1, {2000}}, {1, 1, {1000}}, {-1, 0, {0}}}};
        rig = rig_stm32g4_edges_start();
        write_at(0.3, &low);
        write_at(0.3, &one);
        rig_edges_followed = false;
        for (int n = 0; n < cycles; n++) {
            rig->go_to(0.99);
            rig->go_to(0.25);
        }
        rig_edges_followed = true;
        write_at(0.4, &low);
        TEST_ASSERT_TRUE(hal_stm32g4_broken(&rig_edges_hal));
        TEST_ASSERT_FALSE(rig->outputs_on());
        rig->go_to(0.5);
        TEST_ASSERT_FALSE(rig->leg_high(0) || rig->leg_high(1) || rig->leg_high(2));
        hal_stm32g4_clear_break(&rig_edges_hal);
        TEST_ASSERT_TRUE_MESSAGE(hal_stm32g4_broken(&rig_edges_hal), "old edges are still on their way");
        for (int n = 0; n < 3; n++) {
            rig->go_to(0.9);
            write_at(0.3, &low);
            TEST_ASSERT_FALSE(rig->outputs_on());
        }
        hal_stm32g4_clear_break(&rig_edges_hal);
        TEST_ASSERT_FALSE(hal_stm32g4_broken(&rig_edges_hal));
        uint32_t at[8];
        write_at(0.5, &one);
        TEST_ASSERT_TRUE(rig->outputs_on());
        TEST_ASSERT_EQUAL_INT(1, changes(at));
        TEST_ASSERT_EQUAL_UINT32(2001, at[0]); /* first tick of a span */
        TEST_ASSERT_TRUE(rig->leg_high(0) && !rig->leg_high(1));
    }
}

/* A DMA that stops leaves its last values in the timer. */
static void test_dma_that_stops(void)
{
    const iqfoc_edges_t one = {PERIOD, {{-1, 1, {2000}}, {1, 1, {1000}}, {-1, 0, {0}}}};
    write_at(0.3, &low);
    write_at(0.4, &one);
    rig->go_to(0.45);
    fake_bank.dma1.CCR1 &= ~DMA_CCR_EN;
    for (int n = 0; n < 2; n++) {
        write_at(0.1, &low);
        write_at(0.6, &low);
    }
    TEST_ASSERT_TRUE(hal_stm32g4_broken(&rig_edges_hal));
    TEST_ASSERT_FALSE(rig->outputs_on());
}

/* The break line has cleared MOE: edges do not bring it back, and the levels stay known. */
static void test_break(void)
{
    const iqfoc_edges_t high = {PERIOD, {{1, 0, {0}}, {-1, 0, {0}}, {1, 0, {0}}}};
    write_at(0.3, &low);
    fake_bank.tim1.SR |= TIM_SR_BIF;
    fake_bank.tim1.BDTR &= ~TIM_BDTR_MOE;
    write_at(0.2, &high);
    TEST_ASSERT_FALSE(rig->outputs_on());
    TEST_ASSERT_TRUE(hal_stm32g4_broken(&rig_edges_hal));
    hal_stm32g4_clear_break(&rig_edges_hal);
    write_at(0.1, &high);
    TEST_ASSERT_TRUE(rig->outputs_on() && rig->leg_high(0) && !rig->leg_high(1));
}

static void test_length_that_does_not_fit(void)
{
    const iqfoc_edges_t bad = {RIG_EDGES_SPANS * HAL_SPAN_TICKS - 1, {{1, 0, {0}}, {1, 0, {0}}, {1, 0, {0}}}};
    write_at(0.3, &low);
    write_at(0.3, &bad);
    TEST_ASSERT_FALSE(rig->outputs_on());
    rig->go_to(0.1);
    TEST_ASSERT_FALSE(rig->leg_high(0));
}

static void test_valley_or_peak(void)
{
    iqfoc_sample_t sample;
    rig_edges_latency = 60;
    for (int n = 0; n < 6; n++) {
        for (int k = 0; k < 8; k++) {
            rig->go_to(0.015 + 0.05 * k);
            TEST_ASSERT_TRUE(hal_stm32g4_edges_at_valley(&rig_edges_hal));
        }
        for (int k = 0; k < 8; k++) {
            rig->go_to(0.515 + 0.05 * k);
            TEST_ASSERT_FALSE(hal_stm32g4_edges_at_valley(&rig_edges_hal));
        }
        iqfoc_hal_read_peak(&rig_edges_hal, &sample);
        TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 2, sample.instant);
    }
}

/* port_check.c calls this one (test_port_stm32g4.c). */
void planted_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample);
void planted_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    iqfoc_hal_read_valley(hal, sample);
}

/* ---- Mistakes: what the checklist says of a port that is wrong ---- */

static port_rig planted;
static const port_rig *real;

static bool other_leg(int leg)
{
    return real->leg_high(leg == 0 ? 1 : leg == 1 ? 0 : 2);
}

static bool other_sense(int leg)
{
    return !real->leg_high(leg);
}

static bool always_on(void)
{
    return true;
}

static int plant;

static const port_rig *start_planted(void)
{
    real = rig_stm32g4_edges_start();
    planted = *real;
    planted.leg_high = plant == 0 ? other_leg : plant == 1 ? other_sense : planted.leg_high;
    planted.outputs_on = plant == 2 ? always_on : planted.outputs_on;
    if (plant == 3) {
        fake_bank.tim1.CCMR1 = 0x7838; /* leg b in PWM mode */
    } else if (plant == 4) {
        fake_bank.tim1.DCR = 0x040B; /* five registers */
    } else if (plant == 5) {
        fake_bank.dma1.CCR1 &= ~DMA_CCR_CIRC;
    } else if (plant == 6) {
        fake_bank.dmamux.C0CR = 45;
    }
    return &planted;
}

static void test_planted_mistakes_fail(void)
{
    for (plant = 0; plant <= 6; plant++) {
        TEST_ASSERT_TRUE(port_check_edges(start_planted, stdout) > 0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_registers_lie_where_the_manual_puts_them);
    RUN_TEST(test_set_up);
    RUN_TEST(test_refused);
    RUN_TEST(test_every_line);
    RUN_TEST(test_latency_of_the_dma);
    RUN_TEST(test_edges_that_are_too_near);
    RUN_TEST(test_deadline_of_a_write);
    RUN_TEST(test_late_safe_output);
    RUN_TEST(test_lost_levels);
    RUN_TEST(test_dma_that_stops);
    RUN_TEST(test_break);
    RUN_TEST(test_length_that_does_not_fit);
    RUN_TEST(test_valley_or_peak);
    RUN_TEST(test_planted_mistakes_fail);
    return UNITY_END();
}
