/*
 * Bank of memory in place of the STM32G474 (fake_stm32g4_bank.h).
 */
#include "fake_stm32g4_bank.h"

#include <string.h>

fake_bank_t fake_bank;
stm32g4_reg_t *fake_dead;

const stm32g4_chip_t fake_chip = {
    .flash = &fake_bank.flash,
    .pwr = &fake_bank.pwr,
    .rcc = &fake_bank.rcc,
    .gpioa = &fake_bank.gpioa,
    .gpiob = &fake_bank.gpiob,
    .gpioc = &fake_bank.gpioc,
    .tim1 = &fake_bank.tim1,
    .tim2 = &fake_bank.tim2,
    .tim4 = &fake_bank.tim4,
    .adc1 = &fake_bank.adc1,
    .adc2 = &fake_bank.adc2,
    .adc12 = &fake_bank.adc12,
    .nvic = &fake_bank.nvic,
    .dma1 = &fake_bank.dma1,
    .dmamux = &fake_bank.dmamux,
};

void fake_reset(void)
{
    const fake_bank_t none = {0};
    memcpy(&fake_bank, &none, sizeof none);
    fake_bank.rcc.CR = RCC_CR_HSION | RCC_CR_HSIRDY;
    fake_bank.pwr.CR5 = PWR_CR5_R1MODE;
    fake_bank.gpioa.MODER = 0xABFFFFFF;
    fake_bank.gpiob.MODER = 0xFFFFFEBF;
    fake_bank.gpioc.MODER = 0xFFFFFFFF;
    fake_bank.tim1.ARR = 0xFFFF;
    fake_bank.adc1.CR = ADC_CR_DEEPPWD;
    fake_bank.adc2.CR = ADC_CR_DEEPPWD;
    fake_dead = NULL;
    fake_writes_begin();
}

/* What a converter makes of a write to its control register. */
static void converter_answer(stm32g4_adc_t *adc, uint32_t value)
{
    if ((value & ADC_CR_ADCAL) != 0 && (value & ADC_CR_DEEPPWD) == 0 && (value & ADC_CR_ADVREGEN) != 0) {
        adc->CR &= ~ADC_CR_ADCAL;
    }
    if ((value & ADC_CR_ADEN) != 0) {
        adc->ISR |= ADC_ISR_ADRDY;
    }
}

static void answer(stm32g4_reg_t *reg, uint32_t value)
{
    stm32g4_rcc_t *rcc = &fake_bank.rcc;
    if (reg == &rcc->CR && (value & RCC_CR_PLLON) != 0) {
        rcc->CR |= RCC_CR_PLLRDY;
    } else if (reg == &rcc->CFGR) {
        rcc->CFGR = (rcc->CFGR & ~RCC_CFGR_SWS_MASK) | (value & RCC_CFGR_SW_MASK) << 2;
    } else if (reg == &fake_bank.tim1.EGR) {
        fake_bank.tim1.EGR = 0;
    } else if (reg == &fake_bank.adc1.CR) {
        converter_answer(&fake_bank.adc1, value);
    } else if (reg == &fake_bank.adc2.CR) {
        converter_answer(&fake_bank.adc2, value);
    }
}

void stm32g4_write(stm32g4_reg_t *reg, uint32_t value)
{
    fake_writes_note(reg, value);
    if (reg == &fake_bank.adc1.ISR || reg == &fake_bank.adc2.ISR) {
        *reg &= ~value; /* cleared by writing 1 */
    } else if (reg == &fake_bank.tim1.SR) {
        *reg &= value; /* cleared by writing 0 */
    } else {
        *reg = value;
    }
    if (reg != fake_dead) {
        answer(reg, value);
    }
}

uint32_t stm32g4_read(stm32g4_reg_t *reg)
{
    fake_writes_read();
    return *reg;
}
