/*
 * examples/template-f280049c on the bank of memory: main and the interrupt as they are, with the chip and the
 * core's functions of this file. The states behind it are tested with the plant
 * (tests/unit/library/test_template_drive.c).
 */
#include "fake_c2000_bank.h"
#include "rig_c2000.h"
#include "target.h"

#include "unity.h"

#include <setjmp.h>

#define HALF (C2000_TICK_HZ / PWM_HZ / 2)

int template_main(void);

static jmp_buf back;
static const port_rig *rig;
static uint16_t groups_on;    /* of the core's interrupts that are on */
static uint32_t periods_left; /* until the test goes on */
static uint32_t periods_on;   /* in which the outputs were on after the handler */

void c2000_interrupts_on(uint16_t groups)
{
    groups_on = (uint16_t)(groups_on | groups);
}

/* A period passes, with the valley's interrupt if it is on at the core, the PIE and the converter. */
void c2000_idle(void)
{
    if (rig == NULL) {
        rig = rig_c2000_attach(&hal, HALF);
        rig->set_dc_link(0.9);
    }
    fake_forget();
    rig->go_to(0.99);
    rig->go_to(0.02);
    if ((groups_on & 1) != 0 && (fake_bank.pie[PIE_IER(1)] & PIE_IER_ADCA1) != 0 &&
        (fake_bank.pie[PIE_CTRL] & PIE_ON) != 0) {
        valley_handler();
    }
    periods_on += rig->outputs_on() ? 1 : 0;
    periods_left--;
    if (periods_left == 0) {
        longjmp(back, 1);
    }
}

static bool outputs_on(void)
{
    return rig != NULL && rig->outputs_on();
}

/* From reset, for a number of periods; main does not return. */
static void power_on(uint32_t periods)
{
    static const fake_plant_t none = {0};
    fake_plant = none;
    fake_reset();
    rig = NULL;
    groups_on = 0;
    periods_left = periods;
    periods_on = 0;
    if (setjmp(back) == 0) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, template_main(), "main returned");
    }
}

/* So many more periods. */
static void pass(uint32_t periods)
{
    periods_left = periods;
    if (setjmp(back) == 0) {
        for (;;) {
            c2000_idle();
        }
    }
}

void setUp(void)
{
}

void tearDown(void)
{
    may_run = false; /* for the next power-on; the first has what is printed */
    TEST_ASSERT_EQUAL_UINT32(0, fake_lost());
}

/* A second: no gate, and what the sensors read is there to look at. */
static void test_safe_as_printed(void)
{
    power_on(PWM_HZ);
    TEST_ASSERT_EQUAL_UINT32(0, periods_on);
    TEST_ASSERT_EQUAL_INT32(0, drive.i_wanted.q);
    TEST_ASSERT_EQUAL_INT32(DRIVE_CALIBRATES, drive.state);
    TEST_ASSERT_INT32_WITHIN(IQ24(0.01), IQ24(0.9 * 2048 * 52.8 / 4096 / U_DC_V), seen.u_dc);
    /* The break line is connected before the gates. */
    TEST_ASSERT_EQUAL_HEX16(12, fake_bank.input_xbar[XBAR_INPUT1]);
}

/* Offsets first, outputs off; then the alignment. */
static void test_runs_when_it_is_let(void)
{
    power_on(100);
    may_run = true;
    pass(PWM_HZ / 20);
    TEST_ASSERT_EQUAL_UINT32(0, periods_on);
    pass(2000);
    TEST_ASSERT_EQUAL_INT32(DRIVE_ALIGNS, drive.state);
    TEST_ASSERT_TRUE(outputs_on());
    TEST_ASSERT_EQUAL_HEX32(0, drive.why);
    /* The rig's sensors read 2031 and 2069 at no current: what is left is gone. */
    TEST_ASSERT_INT32_WITHIN(IQ24(0.002), 0, hal.i_zero.a - (2031 - 2048) * hal.board->i_per_count);
    TEST_ASSERT_INT32_WITHIN(IQ24(0.002), 0, hal.i_zero.b - (2069 - 2048) * hal.board->i_per_count);
}

static void test_break_line(void)
{
    power_on(100);
    may_run = true;
    pass(PWM_HZ / 20 + 2000);
    TEST_ASSERT_TRUE(outputs_on());
    fake_trip_by(1);
    TEST_ASSERT_FALSE(outputs_on());
    periods_on = 0;
    pass(1000);
    TEST_ASSERT_EQUAL_UINT32(0, periods_on);
    TEST_ASSERT_EQUAL_INT32(DRIVE_IS_OFF, drive.state); /* the first run: no restart by itself */
    TEST_ASSERT_TRUE((drive.why & IQFOC_STATUS_BREAK) != 0);
}

/* The handler of any other interrupt is at the vector of ADCA2, which is not enabled. */
static void test_vectors(void)
{
    power_on(10);
    TEST_ASSERT_EQUAL_HEX32(C2000_ADDRESS(valley_handler),
                            fake_long(fake_bank.pie_vectors, PIE_VECTOR_ADCA1));
    TEST_ASSERT_EQUAL_HEX32(C2000_ADDRESS(unexpected_handler),
                            fake_long(fake_bank.pie_vectors, PIE_VECTOR_ADCA2));
    TEST_ASSERT_EQUAL_HEX16(1, groups_on);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_safe_as_printed);
    RUN_TEST(test_runs_when_it_is_let);
    RUN_TEST(test_break_line);
    RUN_TEST(test_vectors);
    return UNITY_END();
}
