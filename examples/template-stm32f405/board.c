/* Set-up of the STM32F405 (board.h). */
#include "board.h"

/* Reads of a register before a part that does not answer is given up: more than 10 ms. */
#define PATIENCE 400000

static bool comes(reg_t *reg, uint32_t mask, uint32_t value)
{
    for (uint32_t k = 0; k < PATIENCE; k++) {
        if ((reg_read(reg) & mask) == value) {
            return true;
        }
    }
    return false;
}

static void set(reg_t *reg, uint32_t bits)
{
    reg_write(reg, reg_read(reg) | bits);
}

static void replace(reg_t *reg, uint32_t mask, uint32_t bits)
{
    reg_write(reg, (reg_read(reg) & ~mask) | bits);
}

/* The flash's wait states come before the speed. */
bool board_clock_start(const stm32f405_chip_t *chip)
{
    stm32f405_rcc_t *rcc = chip->rcc;
    reg_write(&chip->flash->ACR, FLASH_ACR_5_WAITS);
    set(&rcc->CR, RCC_CR_HSION);
    if (!comes(&rcc->CR, RCC_CR_HSIRDY, RCC_CR_HSIRDY)) {
        return false;
    }
    reg_write(&rcc->PLLCFGR, RCC_PLLCFGR_168_MHZ);
    set(&rcc->CR, RCC_CR_PLLON);
    if (!comes(&rcc->CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) {
        return false;
    }
    reg_write(&rcc->CFGR, RCC_CFGR_PRESCALERS);
    reg_write(&rcc->CFGR, RCC_CFGR_PRESCALERS | RCC_CFGR_SW_PLL);
    return comes(&rcc->CFGR, RCC_CFGR_SWS_MASK, RCC_CFGR_SWS_PLL);
}

/*
 * 17.3.3: with RCR = 1 written before the counter starts, the update event comes at every overflow and at no
 * underflow: compare values act, and TRGO triggers the converters, at the top alone. 17.3.6: TRGO is the update.
 */
void board_carrier_start(const stm32f405_chip_t *chip, uint32_t half_ticks, uint32_t dead_ticks)
{
    stm32f405_tim_t *tim = chip->tim1;
    set(&chip->rcc->APB2ENR, RCC_APB2ENR_TIM1_ADCS);
    (void)reg_read(&chip->rcc->APB2ENR); /* two clocks until it is there */
    reg_write(&tim->CR1, TIM_CR1_CENTRE_1 | TIM_CR1_ARPE | TIM_CR1_URS);
    reg_write(&tim->CR2, TIM_CR2_MMS_UP);
    reg_write(&tim->PSC, 0);
    reg_write(&tim->ARR, half_ticks);
    reg_write(&tim->RCR, 1);
    reg_write(&tim->CCMR1, TIM_CCMR_BOTH);
    reg_write(&tim->CCMR2, TIM_CCMR_PWM_1);
    for (uint32_t leg = 0; leg < 3; leg++) {
        reg_write(&tim->CCR[leg], 0); /* low sides only */
    }
    reg_write(&tim->CCER, TIM_CCER_LEGS);
    reg_write(&tim->BDTR, (dead_ticks & UINT32_C(0x7F)) | TIM_BDTR_LOCK_1 | TIM_BDTR_OFF_LOW | TIM_BDTR_BKE);
    reg_write(&tim->EGR, TIM_EGR_UG);
    reg_write(&tim->SR, 0);
}

void board_encoder_start(const stm32f405_chip_t *chip, uint32_t counts_per_turn)
{
    set(&chip->rcc->APB1ENR, RCC_APB1ENR_TIM2_TIM4);
    (void)reg_read(&chip->rcc->APB1ENR);
    reg_write(&chip->tim4->CCMR1, TIM_CCMR1_INPUTS);
    reg_write(&chip->tim4->CCMR2, TIM_CCMR2_CAPTURE);
    reg_write(&chip->tim4->CCER, TIM_CCER_CC3E);
    reg_write(&chip->tim4->SMCR, TIM_SMCR_ENCODER);
    reg_write(&chip->tim4->ARR, counts_per_turn - 1);
    reg_write(&chip->tim4->CR1, TIM_CR1_CEN);
    reg_write(&chip->tim2->ARR, UINT32_MAX);
    reg_write(&chip->tim2->CR1, TIM_CR1_CEN);
}

void board_converters_start(const stm32f405_chip_t *chip)
{
    reg_write(&chip->adc_common->CCR, ADC_CCR_PCLK2_4);
    for (uint32_t x = 0; x < 3; x++) {
        stm32f405_adc_t *adc = chip->adc[x];
        reg_write(&adc->SMPR1, ADC_SMPR1_10_13);
        reg_write(&adc->JSQR, x == 0 ? ADC_JSQR_TWO(10, 13) : ADC_JSQR_ONE(10 + x));
        reg_write(&adc->CR1, x == 0 ? ADC_CR1_SCAN | ADC_CR1_JEOCIE : ADC_CR1_SCAN);
        reg_write(&adc->CR2, ADC_CR2_ADON); /* 3 us to come up: long over when the carrier starts */
        reg_write(&adc->CR2, ADC_CR2_ADON | ADC_CR2_JEXT_TIM1_TRGO);
    }
}

#define MODE_ALTERNATE 2
#define MODE_ANALOG    3

static void pin(stm32f405_gpio_t *port, uint32_t number, uint32_t mode, uint32_t function, uint32_t pull)
{
    replace(&port->PUPDR, UINT32_C(3) << (number * 2), pull << (number * 2));
    replace(&port->AFR[number / 8], UINT32_C(15) << (number % 8 * 4), function << (number % 8 * 4));
    replace(&port->MODER, UINT32_C(3) << (number * 2), mode << (number * 2));
}

/* Gates are pulled down (2) while nothing drives them; a break line that is torn off is a break. */
void board_pins_start(const stm32f405_chip_t *chip)
{
    set(&chip->rcc->AHB1ENR, RCC_AHB1ENR_GPIO_ABC);
    (void)reg_read(&chip->rcc->AHB1ENR);
    for (uint32_t number = 8; number <= 10; number++) {
        pin(chip->gpioa, number, MODE_ALTERNATE, 1, 2); /* TIM1_CH1 ... CH3 */
    }
    for (uint32_t number = 12; number <= 15; number++) {
        pin(chip->gpiob, number, MODE_ALTERNATE, 1, 2); /* TIM1_BKIN, CH1N ... CH3N */
    }
    for (uint32_t number = 6; number <= 8; number++) {
        pin(chip->gpiob, number, MODE_ALTERNATE, 2, 0); /* TIM4_CH1 ... CH3 */
    }
    for (uint32_t number = 0; number <= 3; number++) {
        pin(chip->gpioc, number, MODE_ANALOG, 0, 0);
    }
}

bool board_run(const stm32f405_chip_t *chip)
{
    stm32f405_tim_t *tim = chip->tim1;
    set(&tim->CR1, TIM_CR1_CEN);
    for (uint32_t event = 0; event < 2; event++) {
        reg_write(&tim->SR, ~TIM_SR_UIF);
        if (!comes(&tim->SR, TIM_SR_UIF, TIM_SR_UIF) || (reg_read(&tim->CR1) & TIM_CR1_DIR) == 0) {
            return false; /* after the top the counter goes down */
        }
    }
    reg_write(&chip->nvic->ISER[0], BIT(ADC_IRQ));
    return true;
}
