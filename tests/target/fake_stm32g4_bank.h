/*
 * The test's side of the bank of memory (fake_stm32g4.h).
 */
#ifndef TESTS_TARGET_FAKE_STM32G4_BANK_H
#define TESTS_TARGET_FAKE_STM32G4_BANK_H

#include "fake_writes.h"
#include "stm32g474.h"

typedef struct fake_bank {
    stm32g4_flash_t flash;
    stm32g4_pwr_t pwr;
    stm32g4_rcc_t rcc;
    stm32g4_gpio_t gpioa;
    stm32g4_gpio_t gpiob;
    stm32g4_gpio_t gpioc;
    stm32g4_tim_t tim1;
    stm32g4_tim_t tim2;
    stm32g4_tim_t tim4;
    stm32g4_adc_t adc1;
    stm32g4_adc_t adc2;
    stm32g4_adc_common_t adc12;
    stm32g4_nvic_t nvic;
    stm32g4_dma_t dma1;
    stm32g4_dmamux_t dmamux;
} fake_bank_t;

extern fake_bank_t fake_bank;
extern const stm32g4_chip_t fake_chip;

/* Reset values, and a part that does not answer if `dead` points to one of its registers. */
void fake_reset(void);
extern stm32g4_reg_t *fake_dead;

#endif
