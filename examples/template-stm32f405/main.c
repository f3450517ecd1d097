/*
 * The first drive on an STM32F405: set up, and then all in the one interrupt.
 */
#include "board.h"
#include "drive.h"
#include "hal_stm32f405.h"

#define HALF_TICKS (BOARD_CLOCK_HZ / PWM_HZ / 2)

static const stm32f405_chip_t chip = {
    .flash = (stm32f405_flash_t *)0x40023C00,
    .rcc = (stm32f405_rcc_t *)0x40023800,
    .gpioa = (stm32f405_gpio_t *)0x40020000,
    .gpiob = (stm32f405_gpio_t *)0x40020400,
    .gpioc = (stm32f405_gpio_t *)0x40020800,
    .tim1 = (stm32f405_tim_t *)0x40010000,
    .tim2 = (stm32f405_tim_t *)0x40000000,
    .tim4 = (stm32f405_tim_t *)0x40000800,
    .adc = {(stm32f405_adc_t *)0x40012000, (stm32f405_adc_t *)0x40012100, (stm32f405_adc_t *)0x40012200},
    .adc_common = (stm32f405_adc_common_t *)0x40012300,
    .nvic = (stm32f405_nvic_t *)0xE000E100,
};

/*
 * Shunts of 1 mohm with a gain of 20: 3.3 V are 82.5 A from one third to the other, a count 40.3 mA; a current into the
 * motor comes up through the shunt and reads low. DC link 1 to 16: 52.8 V. 1024 lines. Dead time 500 ns, 1 us to settle,
 * half of 0.7 us to sample: duties to 1 - 2 * 1.85 us/50 us.
 */
static const hal_board_t board = {
    .half_ticks = HALF_TICKS,
    .i_zero = 2048,
    .i_per_count = IQ24(-3.3 / 4096.0 / 20.0 / 1e-3 / I_BASE_A),
    .u_dc_per_count = IQ24(3.3 / 4096.0 * 16.0 / U_DC_V),
    .shunts = {IQ24(0.92)},
    .encoder = {.counts_per_turn = 4096, .pole_pairs = POLE_PAIRS, .slip_max = 4},
    .tracker = IQFOC_TRACKER_GAINS(600.0, T_S, IQ24(0.2), PWM_HZ / 100),
};

static drive_t drive;
static iqfoc_hal_t hal;

void adc_handler(void);

void adc_handler(void)
{
    reg_write(&chip.adc[0]->SR, ~ADC_SR_JEOC);
    drive_interrupt(&drive, &hal);
}

int main(void)
{
    if (!board_clock_start(&chip) || !hal_start(&hal, &chip, &board) || !drive_begin(&drive, BOARD_TICK_HZ)) {
        return 1;
    }
    drive.i_wanted.q = IQ24(0.1); /* once it is aligned */
    board_carrier_start(&chip, HALF_TICKS, BOARD_CLOCK_HZ / 2000000);
    board_encoder_start(&chip, board.encoder.counts_per_turn);
    board_converters_start(&chip);
    board_pins_start(&chip); /* last: no pin drives a gate before the timer holds it low */
    if (!board_run(&chip)) {
        return 1;
    }
    for (;;) {
        __asm volatile("wfi");
    }
}
