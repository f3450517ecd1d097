/*
 * Clock and carrier interrupts of the emulated RV32 (port/emulated/board.h).
 *
 * There is one machine timer: it is set to valley and peak in turn. The core has no interrupt priorities, so
 * the valley's handler runs with interrupts on again, and the peak's with interrupts off.
 */
#include "board.h"

#include "trap.h"
#include "virt.h"

#include <stdbool.h>

static uint32_t half_period;
static uint32_t next_low; /* the next event; only differences count */
static bool next_is_valley;

static uint64_t ticks64(void)
{
    uint32_t high;
    uint32_t low;
    do {
        high = VIRT_MTIME_HIGH;
        low = VIRT_MTIME_LOW;
    } while (high != VIRT_MTIME_HIGH);
    return (uint64_t)high << 32 | low;
}

uint32_t board_ticks(void)
{
    return VIRT_MTIME_LOW;
}

/* The 64-bit moment nearest to now whose low word is `low`. Written so that no value in between is due. */
static void compare_set(uint32_t low)
{
    const uint64_t now = ticks64();
    const uint64_t at = (uint64_t)((int64_t)now + (int32_t)(low - (uint32_t)now));
    VIRT_MTIMECMP_HIGH = UINT32_MAX;
    VIRT_MTIMECMP_LOW = (uint32_t)at;
    VIRT_MTIMECMP_HIGH = (uint32_t)(at >> 32);
}

uint32_t board_carrier_start(uint32_t half_ticks)
{
    const uint32_t start = board_ticks() + half_ticks;
    half_period = half_ticks;
    next_low = start;
    next_is_valley = true;
    compare_set(start);
    __asm volatile("csrs mie, %0" ::"r"(RISCV_MIE_MTIE) : "memory");
    board_interrupts_restore(RISCV_MSTATUS_MIE);
    return start;
}

void board_carrier_stop(void)
{
    __asm volatile("csrc mie, %0" ::"r"(RISCV_MIE_MTIE) : "memory");
}

uint32_t board_interrupts_off(void)
{
    uint32_t before;
    __asm volatile("csrrc %0, mstatus, %1" : "=r"(before) : "r"(RISCV_MSTATUS_MIE) : "memory");
    return before & RISCV_MSTATUS_MIE;
}

void board_interrupts_restore(uint32_t before)
{
    __asm volatile("csrs mstatus, %0" ::"r"(before) : "memory");
}

/*
 * Events that came and went while interrupts were held back are lost but for the last two: a controller keeps
 * one pending valley and one pending peak.
 */
static void skip_lost_events(void)
{
    const uint32_t now = board_ticks();
    while ((int32_t)(now - next_low) >= (int32_t)(2 * half_period)) {
        next_low += 2 * half_period;
    }
}

void timer_handler(void)
{
    skip_lost_events();
    const bool valley = next_is_valley;
    next_is_valley = !valley;
    next_low += half_period;
    compare_set(next_low);
    if (!valley) {
        board_peak_interrupt();
        return;
    }
    /* A trap taken inside would overwrite where this one returns to. */
    uint32_t mepc;
    uint32_t mstatus;
    __asm volatile("csrr %0, mepc" : "=r"(mepc));
    __asm volatile("csrr %0, mstatus" : "=r"(mstatus));
    board_interrupts_restore(RISCV_MSTATUS_MIE);
    board_valley_interrupt();
    (void)board_interrupts_off();
    __asm volatile("csrw mepc, %0" ::"r"(mepc));
    __asm volatile("csrw mstatus, %0" ::"r"(mstatus));
}
