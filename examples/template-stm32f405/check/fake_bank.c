/* The bank of memory (fake_bank.h). */
#include "fake_bank.h"

#include <string.h>

fake_bank_t fake_bank;

const stm32f405_chip_t fake_chip = {
    .flash = &fake_bank.flash,
    .rcc = &fake_bank.rcc,
    .gpioa = &fake_bank.gpioa,
    .gpiob = &fake_bank.gpiob,
    .gpioc = &fake_bank.gpioc,
    .tim1 = &fake_bank.tim1,
    .tim2 = &fake_bank.tim2,
    .tim4 = &fake_bank.tim4,
    .adc = {&fake_bank.adc[0], &fake_bank.adc[1], &fake_bank.adc[2]},
    .adc_common = &fake_bank.adc_common,
    .nvic = &fake_bank.nvic,
};

void fake_reset(void)
{
    memset(&fake_bank, 0, sizeof fake_bank);
    fake_bank.rcc.CR = RCC_CR_HSION | RCC_CR_HSIRDY;
    fake_bank.gpiob.IDR = BIT(12); /* no break */
}

bool fake_update_at_top(void)
{
    return (fake_bank.tim1.RCR & 1) == 0 || fake_bank.rcr_before_start;
}

bool fake_update_at_zero(void)
{
    return (fake_bank.tim1.RCR & 1) == 0 || !fake_bank.rcr_before_start;
}

/* The first event that can come after UIF was cleared: up from zero the top is first, if there is one there. */
static void let_an_event_come(void)
{
    fake_bank.tim1.SR |= TIM_SR_UIF;
    if (fake_update_at_top()) {
        fake_bank.tim1.CR1 |= TIM_CR1_DIR;
    } else {
        fake_bank.tim1.CR1 &= ~TIM_CR1_DIR;
    }
}

static bool is_timer(reg_t *reg, reg_t *tim1, reg_t *tim4)
{
    return reg == tim1 || reg == tim4;
}

void reg_write(reg_t *reg, uint32_t value)
{
    if (is_timer(reg, &fake_bank.tim1.SR, &fake_bank.tim4.SR)) {
        *reg &= value; /* cleared by writing 0 */
        return;
    }
    *reg = value;
    if (reg == &fake_bank.rcc.CR && (value & RCC_CR_PLLON) != 0) {
        *reg |= RCC_CR_PLLRDY;
    } else if (reg == &fake_bank.rcc.CFGR) {
        *reg = (value & ~RCC_CFGR_SWS_MASK) | (value & 3) << 2;
    } else if (reg == &fake_bank.tim1.EGR) {
        *reg = 0;
    } else if (reg == &fake_bank.tim1.RCR) {
        fake_bank.rcr_before_start = !fake_bank.running;
    } else if (reg == &fake_bank.tim1.CR1) {
        fake_bank.running = fake_bank.running || (value & TIM_CR1_CEN) != 0;
    }
}

uint32_t reg_read(reg_t *reg)
{
    const uint32_t value = *reg;
    if (reg == &fake_bank.tim1.SR && fake_bank.running && (value & TIM_SR_UIF) == 0) {
        let_an_event_come();
    } else if (reg == &fake_bank.tim4.CCR[2]) {
        fake_bank.tim4.SR &= ~TIM_SR_CC3IF; /* reading the capture clears its flag */
    }
    return value;
}
