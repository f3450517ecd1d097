/*
 * Start-up of the STM32F405: vector table, initialised data, main.
 */
#include "cortex_m_start.h"

void adc_handler(void);

CORTEX_M_VECTORS(82, [18] = adc_handler); /* RM0090 12.2 */

/* TIM1 BDTR: outputs off before anything else, then stay here. */
void unexpected_handler(void)
{
    volatile uint32_t *const bdtr = (volatile uint32_t *)0x40010044;
    *bdtr &= ~(UINT32_C(1) << 15);
    for (;;) {
    }
}

void reset_handler(void)
{
    cortex_m_start_memory();
    (void)main();
    unexpected_handler();
}
