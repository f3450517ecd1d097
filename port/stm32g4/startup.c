/*
 * Start-up of the STM32G474: vector table, code of the CCM SRAM, initialised data, main.
 */
#include "cortex_m_start.h"

/* From link.ld. */
extern uint32_t link_ccm_load;
extern uint32_t link_ccm_start;
extern uint32_t link_ccm_end;

void adc1_2_handler(void);

CORTEX_M_VECTORS(102, [18] = adc1_2_handler); /* RM0440 14.3 */

/* TIM1 BDTR: outputs off before anything else, then stay here. */
void unexpected_handler(void)
{
    volatile uint32_t *const bdtr = (volatile uint32_t *)0x40012C44;
    *bdtr &= ~(UINT32_C(1) << 15);
    for (;;) {
    }
}

void reset_handler(void)
{
    cortex_m_start_copy(&link_ccm_start, &link_ccm_end, &link_ccm_load);
    cortex_m_start_memory();
    (void)main();
    unexpected_handler();
}
