/*
 * Interrupt handlers: the bodies of hal.h with a port that gives any sample, and the STM32G474's port with registers
 * that read any possible value.
 */
#include "any_drive.h"

#include "first_drive.h"
#include "hal_stm32g4_inline.h"

static stm32g4_tim_t tim1;
static stm32g4_tim_t tim2;
static stm32g4_tim_t tim4;
static stm32g4_adc_t adc1;
static stm32g4_adc_t adc2;
static uint32_t carrier_top; /* of TIM1's count */
static uint32_t encoder_top; /* of TIM4's */

/* Converters have 12 bits; timers count up to their reload values. */
uint32_t stm32g4_read(stm32g4_reg_t *reg)
{
    if (reg == &adc1.JDR[0] || reg == &adc1.JDR[1] || reg == &adc2.JDR[0]) {
        return any_count(0, 4095);
    }
    if (reg == &tim1.CNT) {
        return any_count(0, carrier_top);
    }
    if (reg == &tim4.CNT) {
        return any_count(0, encoder_top);
    }
    return any_count(0, UINT32_MAX);
}

void stm32g4_write(stm32g4_reg_t *reg, uint32_t value)
{
    (void)reg;
    (void)value;
}

static void run_stm32g4(uint32_t half_ticks, uint32_t counts_per_turn)
{
    const stm32g4_chip_t chip = {.tim1 = &tim1, .tim2 = &tim2, .tim4 = &tim4, .adc1 = &adc1, .adc2 = &adc2};
    const hal_stm32g4_board_t board = {half_ticks,
                                       any_within(0, 4095),
                                       any_within(0, 4095),
                                       any_within(-(1 << 18), 1 << 18),
                                       any_within(1, 1 << 18),
                                       counts_per_turn,
                                       any_count(1, 64),
                                       any()};
    iqfoc_hal_t hal;
    iqfoc_sample_t sample;
    carrier_top = half_ticks;
    encoder_top = counts_per_turn - 1;
    hal_stm32g4_start(&hal, &chip, &board);
    while (any_bool()) {
        const iqfoc_command_t command = {{any_abc(0, IQ24_ONE), IQ24_ONE}, any_bool()};
        hal_stm32g4_read_valley(&hal, &sample);
        hal_stm32g4_read_peak(&hal, &sample);
        hal_stm32g4_write(&hal, &command);
        (void)hal_stm32g4_broken(&hal);
        hal_stm32g4_clear_break(&hal);
    }
}

/* STM32G474's HAL: any registers, any board within hal_stm32g4.h with half periods of 100 and 65534 ticks and encoders of 4
 * and 65536 counts. */
void prove_stm32g4(void)
{
    static const uint32_t half_ticks[2] = {100, 65534};
    static const uint32_t counts[2] = {4, 65536};
    for (uint32_t k = 0; k < 2; k++) {
        for (uint32_t n = 0; n < 2; n++) {
            run_stm32g4(half_ticks[k], counts[n]);
        }
    }
}
