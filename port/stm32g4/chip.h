/*
 * Where the peripherals of the STM32G474 are (RM0440 2.2.2).
 */
#ifndef PORT_STM32G4_CHIP_H
#define PORT_STM32G4_CHIP_H

#include "stm32g474.h"

#define STM32G4_CHIP                                                                                         \
    {                                                                                                        \
        .flash = (stm32g4_flash_t *)0x40022000, .pwr = (stm32g4_pwr_t *)0x40007000,                          \
        .rcc = (stm32g4_rcc_t *)0x40021000, .gpioa = (stm32g4_gpio_t *)0x48000000,                           \
        .gpiob = (stm32g4_gpio_t *)0x48000400, .gpioc = (stm32g4_gpio_t *)0x48000800,                        \
        .tim1 = (stm32g4_tim_t *)0x40012C00, .tim2 = (stm32g4_tim_t *)0x40000000,                            \
        .tim4 = (stm32g4_tim_t *)0x40000800, .adc1 = (stm32g4_adc_t *)0x50000000,                            \
        .adc2 = (stm32g4_adc_t *)0x50000100, .adc12 = (stm32g4_adc_common_t *)0x50000300,                    \
        .nvic = (stm32g4_nvic_t *)0xE000E100, .dma1 = (stm32g4_dma_t *)0x40020000,                           \
        .dmamux = (stm32g4_dmamux_t *)0x40020800                                                             \
    }

#endif
