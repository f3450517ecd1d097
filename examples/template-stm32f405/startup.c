/*
 * Start-up of the STM32F405: vector table, initialised data, main.
 */
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
void unexpected_handler(void);
void adc_handler(void);

/* 82 interrupts (RM0090 12.2); the position is the number. Those left out are never enabled. */
typedef struct vector_table {
    uint32_t *stack_top;
    void (*exception[15])(void); /* Reset ... SysTick */
    void (*interrupt[82])(void);
} vector_table_t;

static const vector_table_t vectors __attribute__((section(".vectors"), used)) = {
    .stack_top = &link_stack_top,
    .exception = {reset_handler, unexpected_handler, unexpected_handler, unexpected_handler,
                  unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,
                  unexpected_handler, unexpected_handler, unexpected_handler, unexpected_handler,
                  unexpected_handler, unexpected_handler, unexpected_handler},
    .interrupt = {[18] = adc_handler},
};

/* TIM1 BDTR at 0x40010044: outputs off before anything else, then stay here. */
void unexpected_handler(void)
{
    volatile uint32_t *const bdtr = (volatile uint32_t *)0x40010044;
    *bdtr &= ~(UINT32_C(1) << 15);
    for (;;) {
    }
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
    (void)main();
    unexpected_handler();
}
