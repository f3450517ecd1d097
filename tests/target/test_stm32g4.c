/*
 * The STM32G474's port on the host: every bit that the timing needs, and the order in which it is set.
 *
 * What this cannot show is that the chip does what RM0440 says; the port has not run on silicon.
 */
#include "board.h"
#include "fake_stm32g4_bank.h"
#include "hal_stm32g4.h"

#include "unity.h"

#include <math.h>
#include <stddef.h>

#define HALF 17000u /* 5 kHz at 170 MHz */

static const hal_stm32g4_board_t board = {
    .half_ticks = HALF,
    .i_offset_a = 2040,
    .i_offset_b = 2061,
    .i_per_count = IQ24(2.0 / 2048),
    .u_dc_per_count = IQ24(2.0 / 4096),
    .counts_per_turn = 4096,
    .pole_pairs = 3,
    .theta_offset = IQ24(0.125),
};
static iqfoc_hal_t hal;

void setUp(void)
{
    fake_reset();
    hal_stm32g4_start(&hal, &fake_chip, &board);
}

void tearDown(void)
{
}

/* Offsets are RM0440's: 29.6, and the register maps of the other chapters. */
static void test_registers_lie_where_the_manual_puts_them(void)
{
    TEST_ASSERT_EQUAL(0x80, offsetof(stm32g4_pwr_t, CR5));
    TEST_ASSERT_EQUAL(0x4C, offsetof(stm32g4_rcc_t, AHB2ENR));
    TEST_ASSERT_EQUAL(0x58, offsetof(stm32g4_rcc_t, APB1ENR1));
    TEST_ASSERT_EQUAL(0x60, offsetof(stm32g4_rcc_t, APB2ENR));
    TEST_ASSERT_EQUAL(0x20, offsetof(stm32g4_gpio_t, AFR));
    TEST_ASSERT_EQUAL(0x20, offsetof(stm32g4_tim_t, CCER));
    TEST_ASSERT_EQUAL(0x30, offsetof(stm32g4_tim_t, RCR));
    TEST_ASSERT_EQUAL(0x34, offsetof(stm32g4_tim_t, CCR));
    TEST_ASSERT_EQUAL(0x44, offsetof(stm32g4_tim_t, BDTR));
    TEST_ASSERT_EQUAL(0x50, offsetof(stm32g4_tim_t, CCMR3));
    TEST_ASSERT_EQUAL(0x14, offsetof(stm32g4_adc_t, SMPR1));
    TEST_ASSERT_EQUAL(0x4C, offsetof(stm32g4_adc_t, JSQR));
    TEST_ASSERT_EQUAL(0x80, offsetof(stm32g4_adc_t, JDR));
    TEST_ASSERT_EQUAL(0x08, offsetof(stm32g4_adc_common_t, CCR));
}

static void test_clock_sequence(void)
{
    TEST_ASSERT_EQUAL(STM32G4_OK, stm32g4_clock_start(&fake_chip));
    stm32g4_rcc_t *rcc = &fake_bank.rcc;
    const int32_t power = fake_first_write(&rcc->APB1ENR1, RCC_APB1ENR1_PWREN, RCC_APB1ENR1_PWREN);
    const int32_t boost = fake_first_write(&fake_bank.pwr.CR5, PWR_CR5_R1MODE, 0);
    const int32_t flash = fake_first_write(&fake_bank.flash.ACR, FLASH_ACR_LATENCY_MASK, FLASH_ACR_LATENCY_4);
    const int32_t pll = fake_first_write(&rcc->CR, RCC_CR_PLLON, RCC_CR_PLLON);
    const int32_t slow = fake_first_write(&rcc->CFGR, RCC_CFGR_HPRE_MASK, RCC_CFGR_HPRE_DIV_2);
    const int32_t change = fake_first_write(&rcc->CFGR, RCC_CFGR_SW_MASK, RCC_CFGR_SW_PLL);
    const int32_t fast = fake_last_write(&rcc->CFGR, RCC_CFGR_HPRE_MASK, 0);
    TEST_ASSERT_TRUE(power >= 0 && power < boost && boost < change);
    TEST_ASSERT_TRUE(flash >= 0 && flash < change && pll >= 0 && pll < change);
    TEST_ASSERT_TRUE(slow < change && change < fast);
    /* At half speed a read takes at least 3 clocks of 85 MHz: a microsecond is 29 of them. */
    TEST_ASSERT_TRUE(fake_reads_between(change, fast) >= 29);
    /* 16 MHz / M * N / R = 170 MHz: M - 1, N and R's code in their fields. */
    TEST_ASSERT_EQUAL_HEX32(0x01005532, rcc->PLLCFGR);
}

static void test_silent_parts_are_errors(void)
{
    fake_dead = &fake_bank.rcc.CR;
    TEST_ASSERT_EQUAL(STM32G4_ERROR_CLOCK, stm32g4_clock_start(&fake_chip));
    TEST_ASSERT_EQUAL(-1, fake_first_write(&fake_bank.rcc.CFGR, RCC_CFGR_SW_MASK, RCC_CFGR_SW_PLL));
    fake_reset();
    fake_dead = &fake_bank.rcc.CFGR;
    TEST_ASSERT_EQUAL(STM32G4_ERROR_CLOCK, stm32g4_clock_start(&fake_chip));
    fake_reset();
    fake_dead = &fake_bank.adc2.CR;
    TEST_ASSERT_EQUAL(STM32G4_ERROR_CONVERTER, stm32g4_converters_start(&fake_chip));
    TEST_ASSERT_EQUAL(STM32G4_ERROR_CARRIER, stm32g4_carrier_start(&fake_chip, 65535, 1000));
    TEST_ASSERT_EQUAL(STM32G4_ERROR_CARRIER, stm32g4_carrier_start(&fake_chip, 99, 1000));
    TEST_ASSERT_EQUAL(STM32G4_ERROR_DEAD_TIME, stm32g4_carrier_start(&fake_chip, HALF, 5930));
    TEST_ASSERT_EQUAL(STM32G4_ERROR_ENCODER, stm32g4_encoder_start(&fake_chip, 3));
    TEST_ASSERT_EQUAL(STM32G4_ERROR_ENCODER, stm32g4_encoder_start(&fake_chip, 65537));
}

/* Dead time in clocks of a code, in the manual's words (29.6.20). */
static uint32_t dead_time_of(uint32_t code)
{
    if (code < 0x80) {
        return code;
    }
    if (code < 0xC0) {
        return (64 + (code & 63)) * 2;
    }
    return (32 + (code & 31)) * (code < 0xE0 ? 8u : 16u);
}

static void test_dead_time_is_the_shortest_that_is_long_enough(void)
{
    for (uint32_t ns = 0; ns <= 5929; ns++) {
        const int32_t code = stm32g4_dead_time_code(ns);
        TEST_ASSERT_TRUE(code >= 0 && code <= 255);
        TEST_ASSERT_TRUE(dead_time_of((uint32_t)code) * 1000.0 / 170.0 >= ns - 1e-9);
        if (code > 0) {
            TEST_ASSERT_TRUE(dead_time_of((uint32_t)code - 1) * 1000.0 / 170.0 < ns);
        }
    }
    TEST_ASSERT_EQUAL(-1, stm32g4_dead_time_code(5930));
}

static void test_carrier(void)
{
    stm32g4_tim_t *tim = &fake_bank.tim1;
    TEST_ASSERT_EQUAL(STM32G4_OK, stm32g4_carrier_start(&fake_chip, HALF, 1000));
    TEST_ASSERT_FALSE_MESSAGE(fake_ever_set(&tim->CR1, TIM_CR1_CEN), "runs before its start");
    TEST_ASSERT_FALSE_MESSAGE(fake_ever_set(&tim->BDTR, TIM_BDTR_MOE), "outputs on by set-up");
    stm32g4_run(&fake_chip);
    const int32_t start = fake_first_write(&tim->CR1, TIM_CR1_CEN, TIM_CR1_CEN);
    const int32_t repetition = fake_last_write(&tim->RCR, UINT32_MAX, 1);
    const int32_t load = fake_last_write(&tim->EGR, TIM_EGR_UG, TIM_EGR_UG);
    /* 29.3.5: RCR = 1 written before the start makes the shadow registers act at the underflow. */
    TEST_ASSERT_TRUE(repetition >= 0 && repetition < load && load < start);
    TEST_ASSERT_TRUE(fake_last_write(&tim->ARR, UINT32_MAX, HALF) < load);

    TEST_ASSERT_EQUAL_HEX32(TIM_CR1_CEN | TIM_CR1_ARPE | TIM_CR1_URS | 1u << 5, tim->CR1);
    TEST_ASSERT_EQUAL_HEX32(0x00D00000, tim->CR2);   /* MMS2 = 1101 */
    TEST_ASSERT_EQUAL_HEX32(0x00007878, tim->CCMR1); /* OC1M = OC2M = 0111, preload on */
    TEST_ASSERT_EQUAL_HEX32(0x00007078, tim->CCMR2); /* OC3M = OC4M = 0111, preload on for the leg */
    TEST_ASSERT_EQUAL_HEX32(0x00007000, tim->CCMR3); /* OC6M = 0111 */
    TEST_ASSERT_EQUAL_HEX32(0x00000555, tim->CCER);  /* three pairs, active high */
    TEST_ASSERT_EQUAL_UINT32(HALF - 1, tim->CCR[3]);
    TEST_ASSERT_EQUAL_UINT32(1, tim->CCR6);
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_TRUE(tim->CCR[leg] > HALF);
    }
    /* 1000 ns are 170 clocks: (64 + 21) * 2. OSSI, OSSR, break on, lock level 1. */
    TEST_ASSERT_EQUAL_HEX32(0x1D95, tim->BDTR);
    TEST_ASSERT_EQUAL_HEX32(1u << 18, fake_bank.nvic.ISER[0]);
}

static void test_converters(void)
{
    TEST_ASSERT_EQUAL(STM32G4_OK, stm32g4_converters_start(&fake_chip));
    stm32g4_adc_t *const adcs[2] = {&fake_bank.adc1, &fake_bank.adc2};
    for (int k = 0; k < 2; k++) {
        stm32g4_reg_t *cr = &adcs[k]->CR;
        const int32_t regulator = fake_first_write(cr, ADC_CR_ADVREGEN | ADC_CR_DEEPPWD, ADC_CR_ADVREGEN);
        const int32_t calibration = fake_first_write(cr, ADC_CR_ADCAL, ADC_CR_ADCAL);
        const int32_t enable = fake_first_write(cr, ADC_CR_ADEN, ADC_CR_ADEN);
        const int32_t start = fake_first_write(cr, ADC_CR_JADSTART, ADC_CR_JADSTART);
        const int32_t sequence = fake_last_write(&adcs[k]->JSQR, 0, 0);
        TEST_ASSERT_TRUE(regulator >= 0 && regulator < calibration && calibration < enable && enable < start);
        TEST_ASSERT_TRUE(fake_reads_between(regulator, calibration) >= 20 * 170 / 3);
        TEST_ASSERT_TRUE(sequence > enable && sequence < start);
        /* Trigger 8 (TIM1_TRGO2), rising edge. */
        TEST_ASSERT_EQUAL_HEX32(8u << 2 | 1u << 7, adcs[k]->JSQR & 0x1FC);
    }
    TEST_ASSERT_EQUAL_HEX32(6u << 9 | 8u << 15 | 1u, fake_bank.adc1.JSQR & ~0x1FCu); /* two: A, DC link */
    TEST_ASSERT_EQUAL_HEX32(7u << 9, fake_bank.adc2.JSQR & ~0x1FCu);                 /* one: B */
    TEST_ASSERT_EQUAL_HEX32(ADC_IER_JEOSIE, fake_bank.adc1.IER);
    TEST_ASSERT_EQUAL_HEX32(0, fake_bank.adc2.IER);
}

static void test_pins(void)
{
    stm32g4_pins_start(&fake_chip);
    TEST_ASSERT_EQUAL_HEX32(0x00000666, fake_bank.gpioa.AFR[1]); /* PA8 PA9 PA10: AF6 */
    TEST_ASSERT_EQUAL_HEX32(0x46660000, fake_bank.gpiob.AFR[1]); /* PB12 ... PB14: AF6, PB15: AF4 */
    TEST_ASSERT_EQUAL_HEX32(0x22000000, fake_bank.gpiob.AFR[0]); /* PB6 PB7: AF2 */
    TEST_ASSERT_EQUAL_HEX32(0x2A0000, fake_bank.gpioa.MODER & 0x3F0000);
    TEST_ASSERT_EQUAL_HEX32(0xAA00A000, fake_bank.gpiob.MODER & 0xFF00F000);
    TEST_ASSERT_EQUAL_HEX32(0x3F, fake_bank.gpioc.MODER & 0x3F);
    TEST_ASSERT_EQUAL_HEX32(0xAA000000, fake_bank.gpiob.PUPDR & 0xFF000000);
}

static iqfoc_command_t command_of(double a, double b, double c, bool gates)
{
    const iqfoc_command_t command = {
        .duties = {{(iq24_t)lround(a * IQ24_ONE), (iq24_t)lround(b * IQ24_ONE), (iq24_t)lround(c * IQ24_ONE)},
                   IQ24_ONE},
        .gates = gates};
    return command;
}

/* High from CCR on the way up to CCR on the way down (PWM mode 2): 2 (ARR - CCR) of 2 ARR clocks. */
static void test_duties(void)
{
    fake_bank.tim1.BDTR = 0x1D95;
    for (int k = 0; k <= 1000; k++) {
        const double duty = k / 1000.0;
        const iqfoc_command_t command = command_of(duty, 1.0 - duty, 0.5, true);
        fake_reset();
        iqfoc_hal_write(&hal, &command);
        const uint32_t compare = fake_bank.tim1.CCR[0];
        const double made = compare > HALF ? 0.0 : (double)(HALF - compare) / HALF;
        TEST_ASSERT_DOUBLE_WITHIN(0.5 / HALF + 1e-7, duty, made);
        TEST_ASSERT_EQUAL_UINT32(HALF / 2, fake_bank.tim1.CCR[2]);
    }
    TEST_ASSERT_EQUAL_UINT32(0, fake_bank.tim1.CCR[0]);
    TEST_ASSERT_TRUE(fake_bank.tim1.CCR[1] > HALF);
}

static void test_gates(void)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5, true);
    const iqfoc_command_t off = command_of(0.0, 0.0, 0.0, false);
    stm32g4_tim_t *tim = &fake_bank.tim1;
    tim->BDTR = 0x1D95;
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_EQUAL_HEX32(0x9D95, tim->BDTR);
    /* On only after the compare values are there, off before. */
    TEST_ASSERT_TRUE(fake_last_write(&tim->CCR[2], 0, 0) <
                     fake_last_write(&tim->BDTR, TIM_BDTR_MOE, TIM_BDTR_MOE));
    iqfoc_hal_write(&hal, &off);
    TEST_ASSERT_EQUAL_HEX32(0x1D95, tim->BDTR);
    TEST_ASSERT_TRUE(fake_last_write(&tim->BDTR, TIM_BDTR_MOE, 0) < fake_last_write(&tim->CCR[0], 0, 0));
    /* A break: hardware has cleared MOE, and no command may bring it back by itself. */
    tim->SR = TIM_SR_BIF | 1;
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_EQUAL_HEX32(0x1D95, tim->BDTR);
    hal_stm32g4_clear_break(&hal);
    TEST_ASSERT_EQUAL_HEX32(1, tim->SR);
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_EQUAL_HEX32(0x9D95, tim->BDTR);
}

static void instant(uint32_t count, bool down, uint32_t now, uint32_t encoder)
{
    fake_bank.tim1.CNT = count;
    fake_bank.tim1.CR1 = TIM_CR1_CEN | (down ? TIM_CR1_DIR : 0);
    fake_bank.tim2.CNT = now;
    fake_bank.tim4.CNT = encoder;
}

/* Sampling instant: the counter's way since valley or peak, in all four quarters. */
static void test_sampling_instant(void)
{
    iqfoc_sample_t sample;
    instant(300, false, 1000000, 0);
    TEST_ASSERT_TRUE(hal_stm32g4_at_valley(&hal));
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_EQUAL_UINT32(1000000 - 300, sample.time);
    TEST_ASSERT_EQUAL_INT32(0, sample.instant);
    instant(HALF - 200, true, 100, 0);
    TEST_ASSERT_FALSE(hal_stm32g4_at_valley(&hal));
    iqfoc_hal_read_valley(&hal, &sample); /* late, past the peak */
    TEST_ASSERT_EQUAL_UINT32(100u - (HALF + 200), sample.time);
    iqfoc_hal_read_peak(&hal, &sample);
    TEST_ASSERT_EQUAL_UINT32(100u - 200, sample.time);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 2, sample.instant);
    instant(150, false, 0, 0);
    iqfoc_hal_read_peak(&hal, &sample); /* late, past the valley */
    TEST_ASSERT_EQUAL_UINT32(0u - (HALF + 150), sample.time);
}

static void test_scaling_signs_and_clipping(void)
{
    iqfoc_sample_t sample;
    instant(0, false, 0, 0);
    fake_bank.adc1.JDR[0] = 2040 + 1024;
    fake_bank.adc2.JDR[0] = 2061 - 512;
    fake_bank.adc1.JDR[1] = 2048;
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_EQUAL_INT32(IQ24(1.0), sample.i.a);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), sample.i.b);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), sample.i.c);
    TEST_ASSERT_EQUAL_INT32(IQ24(1.0), sample.u_dc);
    TEST_ASSERT_FALSE(sample.clipped);
    fake_bank.adc2.JDR[0] = 4;
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_TRUE(sample.clipped);
    fake_bank.adc2.JDR[0] = 4090;
    iqfoc_hal_read_peak(&hal, &sample);
    TEST_ASSERT_TRUE(sample.clipped);
}

/* Both ways through the encoder's end: speed, and the angle moved back to the instant of sampling. */
static void test_angle_and_speed(void)
{
    const double per_valley[2] = {37.0, -37.0}; /* encoder counts a cycle */
    for (int way = 0; way < 2; way++) {
        hal_stm32g4_start(&hal, &fake_chip, &board);
        iqfoc_sample_t sample;
        double count = 100.0;
        for (int k = 0; k < 200; k++) {
            /* The handler is 1700 clocks late: 0.05 cycles. */
            const double seen = count + per_valley[way] * 0.05;
            instant(1700, false, 0, (uint32_t)lround(fmod(seen + 40960.0, 4096.0)) % 4096);
            iqfoc_hal_read_valley(&hal, &sample);
            count += per_valley[way];
        }
        count -= per_valley[way];
        const double speed = per_valley[way] * 3.0 / 4096.0;
        TEST_ASSERT_DOUBLE_WITHIN(3.0 / 4096.0 / HAL_SPEED_SPAN, speed, sample.speed / 16777216.0);
        const double theta = count * 3.0 / 4096.0 + 0.125;
        TEST_ASSERT_DOUBLE_WITHIN(1.5 * 3.0 / 4096.0, 0.0, remainder(sample.theta / 16777216.0 - theta, 1.0));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_registers_lie_where_the_manual_puts_them);
    RUN_TEST(test_clock_sequence);
    RUN_TEST(test_silent_parts_are_errors);
    RUN_TEST(test_dead_time_is_the_shortest_that_is_long_enough);
    RUN_TEST(test_carrier);
    RUN_TEST(test_converters);
    RUN_TEST(test_pins);
    RUN_TEST(test_duties);
    RUN_TEST(test_gates);
    RUN_TEST(test_sampling_instant);
    RUN_TEST(test_scaling_signs_and_clipping);
    RUN_TEST(test_angle_and_speed);
    return UNITY_END();
}
