/*
 * TIM1 of the STM32G474 as the carrier (board.h).
 */
#include "board.h"

/* t_DTS is one clock: 170 ticks a microsecond, rounded up. */
static uint32_t ticks_of(uint32_t ns)
{
    return (uint32_t)(((uint64_t)ns * (STM32G4_CLOCK_HZ / 1000000) + 999) / 1000);
}

/*
 * 29.6.20: 0xx: DTG; 10x: (64 + DTG[5:0]) 2; 110: (32 + DTG[4:0]) 8; 111: (32 + DTG[4:0]) 16.
 * Rounded up throughout.
 */
int32_t stm32g4_dead_time_code(uint32_t ns)
{
    if (ns > 5929) {
        return -1;
    }
    const uint32_t ticks = ticks_of(ns);
    if (ticks <= 127) {
        return (int32_t)ticks;
    }
    if (ticks <= 254) {
        return (int32_t)(0x80 | ((ticks + 1) / 2 - 64));
    }
    if (ticks <= 504) {
        return (int32_t)(0xC0 | ((ticks + 7) / 8 - 32));
    }
    return (int32_t)(0xE0 | ((ticks + 15) / 16 - 32));
}

/*
 * PWM mode 2 (29.6.8) makes a leg active while the counter is above its compare value: around the counter's
 * top, which is the carrier's peak. RCR = 1, written before the counter starts, lets the shadow registers act
 * at the underflow only, which is the valley (29.3.5): a command that comes late waits for the next valley.
 */
stm32g4_error_t stm32g4_carrier_start(const stm32g4_chip_t *chip, uint32_t half_ticks, uint32_t dead_time_ns)
{
    stm32g4_tim_t *tim = chip->tim1;
    const int32_t dead_time = stm32g4_dead_time_code(dead_time_ns);
    if (half_ticks < 100 || half_ticks > 65534) {
        return STM32G4_ERROR_CARRIER;
    }
    if (dead_time < 0) {
        return STM32G4_ERROR_DEAD_TIME;
    }
    stm32g4_write(&chip->rcc->APB2ENR, stm32g4_read(&chip->rcc->APB2ENR) | RCC_APB2ENR_TIM1EN);
    (void)stm32g4_read(&chip->rcc->APB2ENR);
    stm32g4_write(&tim->CR1, TIM_CR1_CMS_CENTRE_1 | TIM_CR1_ARPE | TIM_CR1_URS);
    stm32g4_write(&tim->CR2, TIM_CR2_MMS2_OC4_OC6);
    stm32g4_write(&tim->PSC, 0);
    stm32g4_write(&tim->ARR, half_ticks);
    stm32g4_write(&tim->RCR, 1);
    stm32g4_write(&tim->CCMR1,
                  TIM_CCMR_PWM_2_LOW | TIM_CCMR_PRELOAD_LOW | TIM_CCMR_PWM_2_HIGH | TIM_CCMR_PRELOAD_HIGH);
    stm32g4_write(&tim->CCMR2, TIM_CCMR_PWM_2_LOW | TIM_CCMR_PRELOAD_LOW | TIM_CCMR_PWM_2_HIGH);
    stm32g4_write(&tim->CCMR3, TIM_CCMR_PWM_2_HIGH);
    for (uint32_t leg = 0; leg < 3; leg++) {
        stm32g4_write(&tim->CCR[leg], half_ticks + 1); /* never reached: low sides only */
    }
    /* OC4REF rises a tick before the top, OC6REF falls a tick before zero: the two sampling instants. */
    stm32g4_write(&tim->CCR[3], half_ticks - 1);
    stm32g4_write(&tim->CCR6, 1);
    stm32g4_write(&tim->CCER, TIM_CCER_LEGS);
    /* OSSI and OSSR: with the outputs off the pins are driven to their idle level, low. */
    stm32g4_write(&tim->BDTR,
                  (uint32_t)dead_time | TIM_BDTR_LOCK_1 | TIM_BDTR_OSSI | TIM_BDTR_OSSR | TIM_BDTR_BKE);
    stm32g4_write(&tim->EGR, TIM_EGR_UG); /* 29.3.13: all shadow registers are loaded before the start */
    stm32g4_write(&tim->SR, 0);
    return STM32G4_OK;
}

void stm32g4_run(const stm32g4_chip_t *chip)
{
    stm32g4_write(&chip->nvic->ISER[0], UINT32_C(1) << STM32G4_ADC1_2_IRQ);
    stm32g4_write(&chip->tim1->CR1, stm32g4_read(&chip->tim1->CR1) | TIM_CR1_CEN);
}
