/*
 * iqfoc_cycle_clear, interrupted ahead of each of its instructions by a valley that finds an overcurrent.
 *
 * A timer fires a fixed number of instructions after it is set. One nop less ahead of the clear moves the interrupt
 * by one instruction. If the fault came first, the drive is wholly cleared; otherwise it is tripped with the fault's
 * bit. From the first boundary that keeps the trip on, all later ones keep it. No peak after a kept trip opens the
 * gates. src/cycle.c is compiled with the optimisation of the image.
 */
#include "iqfoc/hal.h"
#include "mps2_an386.h"

#include <unity.h>

#define NOPS  240
#define TICKS 48 /* five instructions each */

struct iqfoc_hal {
    iqfoc_sample_t sample;
    iqfoc_command_t written;
};

static iqfoc_hal_t hal;
static iqfoc_cycle_t cycle;
static const iqfoc_cycle_config_t config = {.predictor = {IQ24_ONE, 0, 0},
                                            .safe_state = IQFOC_SAFE_GATES_OFF,
                                            .span_max = IQ24_ONE,
                                            .current_limit = IQ24_ONE,
                                            .trips = IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_DC_LINK,
                                            .time_unchecked = true};
static volatile uint32_t interrupted_at;

void timer0_handler(void);
void clear_after(iqfoc_cycle_t *object, uint32_t nops);
void fault_interrupt(uint32_t return_address);

void iqfoc_hal_read_valley(iqfoc_hal_t *h, iqfoc_sample_t *sample)
{
    *sample = h->sample;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *h, iqfoc_sample_t *sample)
{
    *sample = h->sample;
}

void iqfoc_hal_write(iqfoc_hal_t *h, const iqfoc_command_t *command)
{
    h->written = *command;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *h)
{
    (void)h;
    return 0;
}

/* Hands on the address that the interrupt returns to: the seventh word of what the core has stacked. */
__attribute__((naked)) void timer0_handler(void)
{
    __asm volatile("mrs r0, msp\n\tldr r0, [r0, #24]\n\tldr r1, =fault_interrupt\n\tbx r1\n\t.ltorg");
}

/* A number of nops, then the clear. */
__attribute__((naked, noinline)) void clear_after(iqfoc_cycle_t *object, uint32_t nops)
{
    (void)object;
    (void)nops;
    __asm volatile("push {r4, lr}\n\t"
                   "ldr r2, 2f\n\t"
                   "lsls r1, r1, #1\n\t"
                   "subs r2, r2, r1\n\t"
                   "bx r2\n\t"
                   ".rept 240\n\t"
                   "nop\n\t"
                   ".endr\n"
                   "1:\n\t"
                   "bl iqfoc_cycle_clear\n\t"
                   "pop {r4, pc}\n\t"
                   ".balign 4\n"
                   "2:\n\t"
                   ".word 1b + 1\n\t");
}

static void valley(iq24_t i)
{
    const iqfoc_sample_t s = {.i = {i, -i / 2, -i / 2}, .u_dc = IQ24_ONE};
    hal.sample = s;
    iqfoc_isr_valley(&cycle, &hal);
}

static void peak(void)
{
    const iqfoc_sample_t s = {.u_dc = IQ24_ONE, .instant = IQ24(0.5)};
    hal.sample = s;
    iqfoc_isr_peak(&cycle, &hal);
}

void fault_interrupt(uint32_t return_address)
{
    MPS2_TIMER0->intclear = 1;
    MPS2_TIMER0->ctrl = 0;
    interrupted_at = return_address;
    valley(IQ24(5.0));
}

void setUp(void)
{
}

void tearDown(void)
{
}

/* Clears a drive that tripped by its DC link; the fault comes when the timer says so. */
static void clear_interrupted(uint32_t nops)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    cycle.enabled = true;
    valley(0);
    peak();
    valley(0);
    iqfoc_cycle_set_status(&cycle, IQFOC_STATUS_DC_LINK);
    peak();
    TEST_ASSERT_TRUE(cycle.tripped && !hal.written.gates);
    interrupted_at = 0;
    MPS2_TIMER0->reload = UINT32_MAX;
    MPS2_TIMER0->value = TICKS;
    ARM_NVIC_ISER0 = UINT32_C(1) << MPS2_TIMER0_IRQ;
    MPS2_TIMER0->ctrl = MPS2_TIMER_CTRL_ENABLE | MPS2_TIMER_CTRL_INTERRUPT;
    clear_after(&cycle, nops);
    while (interrupted_at == 0) {
    }
}

static void test_every_boundary(void)
{
    const uint32_t begin = (uint32_t)(uintptr_t)&iqfoc_cycle_clear & ~UINT32_C(1);
    uint32_t inside = 0;
    uint32_t first = 0;
    bool kept = false;
    for (uint32_t nops = NOPS; nops-- > 0;) {
        clear_interrupted(nops);
        const bool tripped = cycle.tripped;
        TEST_ASSERT_EQUAL_HEX32(tripped ? IQFOC_STATUS_OVERCURRENT : 0, cycle.status);
        TEST_ASSERT_TRUE(tripped || !kept); /* later boundaries keep what an earlier one kept */
        peak();
        valley(0);
        peak();
        TEST_ASSERT_EQUAL(!tripped, hal.written.gates);
        if (interrupted_at >= begin && interrupted_at < begin + 512) {
            first = inside == 0 ? interrupted_at : first;
            inside++;
            kept = kept || tripped;
        }
    }
    TEST_ASSERT_EQUAL_HEX32(begin, first); /* the boundaries begin with the function's first instruction */
    TEST_ASSERT_GREATER_THAN_UINT32(12, inside);
    TEST_ASSERT_TRUE(kept);
    TEST_ASSERT_TRUE(cycle.status == IQFOC_STATUS_OVERCURRENT); /* and they end with its return */
    TEST_ASSERT_TRUE(interrupted_at < begin || interrupted_at >= begin + 512);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_boundary);
    return UNITY_END();
}
