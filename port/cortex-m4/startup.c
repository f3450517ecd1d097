/*
 * Start-up of the emulated Cortex-M4: vector table, initialised data, main.
 */
#include "console.h"

#include <stdint.h>

/* From link.ld; only their addresses mean something. */
extern uint32_t link_stack_top;
extern uint32_t link_data_load;
extern uint32_t link_data_start;
extern uint32_t link_data_end;
extern uint32_t link_bss_start;
extern uint32_t link_bss_end;

int main(void);
void reset_handler(void);

/* A program that uses a timer defines its handler; else an interrupt that nobody expects ends the run. */
void unexpected_handler(void);
void timer0_handler(void) __attribute__((weak, alias("unexpected_handler")));
void timer1_handler(void) __attribute__((weak, alias("unexpected_handler")));

typedef struct vector_table {
    uint32_t *stack_top;
    void (*exception[15])(void); /* Reset ... SysTick */
    void (*interrupt[32])(void);
} vector_table_t;

static const vector_table_t vectors __attribute__((section(".vectors"), used)) = {
    .stack_top = &link_stack_top,
    .exception = {reset_handler, unexpected_handler, unexpected_handler, unexpected_handler,
                  unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,
                  unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,
                  unexpected_handler, unexpected_handler, unexpected_handler},
    .interrupt =
        {[0] = unexpected_handler, [1] = unexpected_handler, [8] = timer0_handler, [9] = timer1_handler},
};

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
    const uint32_t *from = &link_data_load;
    for (uint32_t *to = &link_data_start; to < &link_data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = &link_bss_start; to < &link_bss_end;) {
        *to++ = 0;
    }
    console_exit(main());
}
