/*
 * Clock and carrier interrupts of the emulated Cortex-M4 (port/emulated/board.h).
 *
 * Valley and peak are two timers of one period, the second half a period behind the first.
 */
#include "board.h"

#include "mps2_an386.h"

#define VALLEY_BIT (UINT32_C(1) << MPS2_TIMER0_IRQ)
#define PEAK_BIT   (UINT32_C(1) << MPS2_TIMER1_IRQ)
/* Priorities 0x20 for the peak (interrupt 9), 0x40 for the valley (8). */
#define PRIORITIES UINT32_C(0x00002040)

/* Each defined here, and weak in startup.c. */
void timer0_handler(void);
void timer1_handler(void);

uint32_t board_ticks(void)
{
    if (MPS2_DUAL_TIMER->ctrl == 0x20) { /* as after reset: interrupt enabled, counter off */
        MPS2_DUAL_TIMER->load = UINT32_MAX;
    }
    MPS2_DUAL_TIMER->ctrl = MPS2_DUAL_TIMER_CTRL_ENABLE | MPS2_DUAL_TIMER_CTRL_32_BIT;
    return ~MPS2_DUAL_TIMER->value;
}

/* The first shot comes after `first` ticks, the others every `period`. */
static void timer_start(mps2_timer_t *timer, uint32_t first, uint32_t period)
{
    timer->intclear = 1;
    timer->reload = period - 1;
    timer->value = first;
    timer->ctrl = MPS2_TIMER_CTRL_ENABLE | MPS2_TIMER_CTRL_INTERRUPT;
}

uint32_t board_carrier_start(uint32_t half_ticks)
{
    ARM_NVIC_IPR2 = PRIORITIES;
    const uint32_t start = board_ticks() + half_ticks;
    timer_start(MPS2_TIMER0, half_ticks, 2 * half_ticks);
    timer_start(MPS2_TIMER1, 2 * half_ticks, 2 * half_ticks);
    ARM_NVIC_ICPR0 = VALLEY_BIT | PEAK_BIT;
    ARM_NVIC_ISER0 = VALLEY_BIT | PEAK_BIT;
    return start;
}

void board_carrier_stop(void)
{
    ARM_NVIC_ICER0 = VALLEY_BIT | PEAK_BIT;
    MPS2_TIMER0->ctrl = 0;
    MPS2_TIMER1->ctrl = 0;
}

uint32_t board_interrupts_off(void)
{
    uint32_t before;
    __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(before)::"memory");
    return before;
}

void board_interrupts_restore(uint32_t before)
{
    __asm volatile("msr primask, %0" ::"r"(before) : "memory");
}

void timer0_handler(void)
{
    MPS2_TIMER0->intclear = 1;
    board_valley_interrupt();
}

void timer1_handler(void)
{
    MPS2_TIMER1->intclear = 1;
    board_peak_interrupt();
}
