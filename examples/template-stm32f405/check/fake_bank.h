/*
 * A bank of memory in place of the STM32F405's registers. It answers as the chip does where a sequence waits.
 */
#ifndef FAKE_BANK_H
#define FAKE_BANK_H

#include "stm32f405.h"

#include <stdbool.h>

typedef struct fake_bank {
    stm32f405_flash_t flash;
    stm32f405_rcc_t rcc;
    stm32f405_gpio_t gpioa, gpiob, gpioc;
    stm32f405_tim_t tim1, tim2, tim4;
    stm32f405_adc_t adc[3];
    stm32f405_adc_common_t adc_common;
    stm32f405_nvic_t nvic;
    bool rcr_before_start; /* was RCR written before the counter was started? */
    bool running;
} fake_bank_t;

extern fake_bank_t fake_bank;
extern const stm32f405_chip_t fake_chip;

void fake_reset(void);

/* 17.3.3: is there an update event at the counter's top, is there one at its zero? */
bool fake_update_at_top(void);
bool fake_update_at_zero(void);

#endif
