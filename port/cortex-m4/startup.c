/*
 * Start-up of the emulated Cortex-M4: vector table, initialised data, main.
 */
#include "console.h"
#include "cortex_m_start.h"

/* A program that uses a timer defines its handler; else an interrupt that nobody expects ends the run. */
void timer0_handler(void) __attribute__((weak, alias("unexpected_handler")));
void timer1_handler(void) __attribute__((weak, alias("unexpected_handler")));

CORTEX_M_VECTORS(
    32, [0] = unexpected_handler, [1] = unexpected_handler, [8] = timer0_handler, [9] = timer1_handler);

/* Exit status of a fault: distinct from a test's own failures. */
#define STATUS_FAULT 99

void unexpected_handler(void)
{
    uint32_t exception;
    __asm volatile("mrs %0, ipsr" : "=r"(exception));
    console_text("\nunexpected exception ");
    console_unsigned(exception);
    console_text("\n");
    console_exit(STATUS_FAULT);
}

void reset_handler(void)
{
    cortex_m_start_memory();
    console_exit(main());
}
