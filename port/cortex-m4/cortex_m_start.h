/*
 * Start-up of a Cortex-M, for the startup.c of a chip: the memory that link.ld lays out, and the vector table up to the chip's interrupts.
 */
#ifndef PORT_CORTEX_M_START_H
#define PORT_CORTEX_M_START_H

#include <stdint.h>

/* From link.ld; only their addresses mean something. */
extern uint32_t link_stack_top;
extern uint32_t link_data_load;
extern uint32_t link_data_start;
extern uint32_t link_data_end;
extern uint32_t link_bss_start;
extern uint32_t link_bss_end;

int main(void);

/* Defined in startup.c. */
void reset_handler(void);
void unexpected_handler(void);

/* A table with this many interrupts; the position is the number. Those left out are never enabled. */
#define CORTEX_M_VECTORS(count, ...)                                                                         \
    static const struct {                                                                                    \
        uint32_t *stack_top;                                                                                 \
        void (*exception[15])(void); /* Reset ... SysTick */                                                 \
        void (*interrupt[count])(void);                                                                      \
    } vectors __attribute__((section(".vectors"), used)) = {                                                 \
        .stack_top = &link_stack_top,                                                                        \
        .exception = {reset_handler, unexpected_handler, unexpected_handler, unexpected_handler,             \
                      unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,        \
                      unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,        \
                      unexpected_handler, unexpected_handler, unexpected_handler},                           \
        .interrupt = {__VA_ARGS__},                                                                          \
    }

/* volatile: a call of memcpy, which gcc makes of such a loop, may be one of a function that is not copied yet. */
static inline void cortex_m_start_copy(volatile uint32_t *to, const volatile uint32_t *end,
                                       const uint32_t *from)
{
    while (to < end) {
        *to++ = *from++;
    }
}

/* Initialised data, and zero for the rest. */
static inline void cortex_m_start_memory(void)
{
    cortex_m_start_copy(&link_data_start, &link_data_end, &link_data_load);
    for (volatile uint32_t *to = &link_bss_start; to < &link_bss_end;) {
        *to++ = 0;
    }
}

#endif
