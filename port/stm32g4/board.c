/*
 * Clock and pins of the STM32G474 (board.h).
 */
#include "board.h"

#include <stdbool.h>

/* Reads of a register before a part that does not answer is given up: some 10 ms at 16 MHz. */
#define PATIENCE 20000

/* Loops that pass 20 us at 170 MHz, three clocks at least each. */
#define SETTLE_LOOPS 1200

static bool comes(stm32g4_reg_t *reg, uint32_t mask, uint32_t value)
{
    for (uint32_t k = 0; k < PATIENCE; k++) {
        if ((stm32g4_read(reg) & mask) == value) {
            return true;
        }
    }
    return false;
}

static void set(stm32g4_reg_t *reg, uint32_t bits)
{
    stm32g4_write(reg, stm32g4_read(reg) | bits);
}

static void replace(stm32g4_reg_t *reg, uint32_t mask, uint32_t bits)
{
    stm32g4_write(reg, (stm32g4_read(reg) & ~mask) | bits);
}

/* Reading a register that nothing else waits for takes at least three clocks. */
static void settle(stm32g4_reg_t *reg)
{
    for (uint32_t k = 0; k < SETTLE_LOOPS; k++) {
        (void)stm32g4_read(reg);
    }
}

/*
 * 6.1.5 and 7.2: above 150 MHz the core supply is in boost mode and the flash at four wait states before the
 * switch, and the bus runs at half speed for at least a microsecond around it.
 */
stm32g4_error_t stm32g4_clock_start(const stm32g4_chip_t *chip)
{
    stm32g4_rcc_t *rcc = chip->rcc;
    set(&rcc->APB1ENR1, RCC_APB1ENR1_PWREN);
    (void)stm32g4_read(&rcc->APB1ENR1); /* 7.2.17: the clock is there two cycles later */
    replace(&chip->pwr->CR5, PWR_CR5_R1MODE, 0);
    replace(&chip->flash->ACR, FLASH_ACR_LATENCY_MASK,
            FLASH_ACR_LATENCY_4 | FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN);
    if (!comes(&chip->flash->ACR, FLASH_ACR_LATENCY_MASK, FLASH_ACR_LATENCY_4)) {
        return STM32G4_ERROR_CLOCK;
    }
    set(&rcc->CR, RCC_CR_HSION);
    if (!comes(&rcc->CR, RCC_CR_HSIRDY, RCC_CR_HSIRDY)) {
        return STM32G4_ERROR_CLOCK;
    }
    stm32g4_write(&rcc->PLLCFGR, RCC_PLLCFGR_SRC_HSI | RCC_PLLCFGR_M(4) | RCC_PLLCFGR_N(85) |
                                     RCC_PLLCFGR_R_DIV_2 | RCC_PLLCFGR_REN);
    set(&rcc->CR, RCC_CR_PLLON);
    if (!comes(&rcc->CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) {
        return STM32G4_ERROR_CLOCK;
    }
    replace(&rcc->CFGR, RCC_CFGR_HPRE_MASK, RCC_CFGR_HPRE_DIV_2);
    replace(&rcc->CFGR, RCC_CFGR_SW_MASK, RCC_CFGR_SW_PLL);
    if (!comes(&rcc->CFGR, RCC_CFGR_SWS_MASK, RCC_CFGR_SWS_PLL)) {
        return STM32G4_ERROR_CLOCK;
    }
    settle(&rcc->CFGR);
    replace(&rcc->CFGR, RCC_CFGR_HPRE_MASK, 0);
    return STM32G4_OK;
}

#define MODE_ALTERNATE 2
#define MODE_ANALOG    3

static void pin(stm32g4_gpio_t *port, uint32_t number, uint32_t mode, uint32_t function)
{
    replace(&port->AFR[number / 8], UINT32_C(15) << (number % 8 * 4), function << (number % 8 * 4));
    replace(&port->MODER, UINT32_C(3) << (number * 2), mode << (number * 2));
}

/* A gate driver's input falls to low by the pull-down while nothing drives the pin. */
static void gate(stm32g4_gpio_t *port, uint32_t number, uint32_t function)
{
    replace(&port->PUPDR, UINT32_C(3) << (number * 2), UINT32_C(2) << (number * 2));
    replace(&port->OSPEEDR, UINT32_C(3) << (number * 2), UINT32_C(2) << (number * 2));
    pin(port, number, MODE_ALTERNATE, function);
}

void stm32g4_pins_start(const stm32g4_chip_t *chip)
{
    set(&chip->rcc->AHB2ENR, RCC_AHB2ENR_GPIOAEN | RCC_AHB2ENR_GPIOBEN | RCC_AHB2ENR_GPIOCEN);
    (void)stm32g4_read(&chip->rcc->AHB2ENR);
    for (uint32_t number = 8; number <= 10; number++) {
        gate(chip->gpioa, number, 6); /* TIM1_CH1, CH2, CH3 */
    }
    gate(chip->gpiob, 13, 6); /* TIM1_CH1N */
    gate(chip->gpiob, 14, 6); /* TIM1_CH2N */
    gate(chip->gpiob, 15, 4); /* TIM1_CH3N: its function has another number on this pin */
    replace(&chip->gpiob->PUPDR, UINT32_C(3) << 24, UINT32_C(2) << 24); /* a break line torn off is a break */
    pin(chip->gpiob, 12, MODE_ALTERNATE, 6);                            /* TIM1_BKIN */
    pin(chip->gpiob, 6, MODE_ALTERNATE, 2);                             /* TIM4_CH1 */
    pin(chip->gpiob, 7, MODE_ALTERNATE, 2);                             /* TIM4_CH2 */
    for (uint32_t number = 0; number <= 2; number++) {
        pin(chip->gpioc, number, MODE_ANALOG, 0);
    }
}

stm32g4_error_t stm32g4_encoder_start(const stm32g4_chip_t *chip, uint32_t counts_per_turn)
{
    if (counts_per_turn < 4 || counts_per_turn > 65536) {
        return STM32G4_ERROR_ENCODER;
    }
    set(&chip->rcc->APB1ENR1, RCC_APB1ENR1_TIM2EN | RCC_APB1ENR1_TIM4EN);
    (void)stm32g4_read(&chip->rcc->APB1ENR1);
    stm32g4_write(&chip->tim4->CCMR1, TIM_CCMR1_INPUTS | TIM_CCMR1_FILTERS);
    stm32g4_write(&chip->tim4->SMCR, TIM_SMCR_ENCODER_X4);
    stm32g4_write(&chip->tim4->ARR, counts_per_turn - 1);
    stm32g4_write(&chip->tim4->CR1, TIM_CR1_CEN);
    stm32g4_write(&chip->tim2->ARR, UINT32_MAX);
    stm32g4_write(&chip->tim2->CR1, TIM_CR1_CEN);
    return STM32G4_OK;
}

/*
 * Phase A and the DC link on ADC1, phase B on ADC2: PC0, PC2, PC1 are channels 6, 8, 7. A and B
 * are sampled together.
 */
static stm32g4_error_t converter_start(stm32g4_adc_t *adc)
{
    stm32g4_write(&adc->CR, 0);               /* out of deep power-down */
    stm32g4_write(&adc->CR, ADC_CR_ADVREGEN); /* 21.4.6: its regulator needs 20 us */
    settle(&adc->CR);
    stm32g4_write(&adc->CR, ADC_CR_ADVREGEN | ADC_CR_ADCAL);
    if (!comes(&adc->CR, ADC_CR_ADCAL, 0)) {
        return STM32G4_ERROR_CONVERTER;
    }
    settle(&adc->CR); /* 21.4.8: at least four converter clocks between calibration and start */
    stm32g4_write(&adc->ISR, ADC_ISR_ADRDY);
    stm32g4_write(&adc->CR, ADC_CR_ADVREGEN | ADC_CR_ADEN);
    return comes(&adc->ISR, ADC_ISR_ADRDY, ADC_ISR_ADRDY) ? STM32G4_OK : STM32G4_ERROR_CONVERTER;
}

stm32g4_error_t stm32g4_converters_start(const stm32g4_chip_t *chip)
{
    set(&chip->rcc->AHB2ENR, RCC_AHB2ENR_ADC12EN);
    (void)stm32g4_read(&chip->rcc->AHB2ENR);
    stm32g4_write(&chip->adc12->CCR, ADC_CCR_CKMODE_HCLK_4); /* 42.5 MHz */
    if (converter_start(chip->adc1) != STM32G4_OK || converter_start(chip->adc2) != STM32G4_OK) {
        return STM32G4_ERROR_CONVERTER;
    }
    const uint32_t trigger = ADC_JSQR_TIM1_TRGO2 | ADC_JSQR_RISING;
    stm32g4_write(&chip->adc1->CFGR, ADC_CFGR_JQDIS);
    stm32g4_write(&chip->adc2->CFGR, ADC_CFGR_JQDIS);
    stm32g4_write(&chip->adc1->SMPR1, ADC_SMPR_6_5(6) | ADC_SMPR_6_5(8));
    stm32g4_write(&chip->adc2->SMPR1, ADC_SMPR_6_5(7));
    stm32g4_write(&chip->adc1->JSQR, ADC_JSQR_LENGTH(2) | trigger | ADC_JSQR_FIRST(6) | ADC_JSQR_SECOND(8));
    stm32g4_write(&chip->adc2->JSQR, ADC_JSQR_LENGTH(1) | trigger | ADC_JSQR_FIRST(7));
    stm32g4_write(&chip->adc1->IER, ADC_IER_JEOSIE);
    stm32g4_write(&chip->adc2->CR, ADC_CR_ADVREGEN | ADC_CR_ADEN | ADC_CR_JADSTART);
    stm32g4_write(&chip->adc1->CR, ADC_CR_ADVREGEN | ADC_CR_ADEN | ADC_CR_JADSTART);
    return STM32G4_OK;
}
