/*
 * The one trap handler of the emulated RV32: the machine timer is the program's, all else ends the run.
 */
#include "trap.h"

#include "console.h"
#include "virt.h"

/* Exit status of a fault: distinct from a test's own failures. */
#define STATUS_FAULT 99

static void unexpected(uint32_t cause)
{
    uint32_t where;
    __asm volatile("csrr %0, mepc" : "=r"(where));
    console_text("\nunexpected trap ");
    console_unsigned(cause);
    console_text(" at ");
    console_hex64(where);
    console_text("\n");
    console_exit(STATUS_FAULT);
}

__attribute__((weak)) void timer_handler(void)
{
    unexpected(RISCV_MCAUSE_TIMER);
}

__attribute__((interrupt("machine"), aligned(4))) void trap_handler(void)
{
    uint32_t cause;
    __asm volatile("csrr %0, mcause" : "=r"(cause));
    if (cause == RISCV_MCAUSE_TIMER) {
        timer_handler();
    } else {
        unexpected(cause);
    }
}
