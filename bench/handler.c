/*
 * The STM32G4 example's interrupt, with memory in place of the chip's registers (bench/handler.h).
 */
#include "handler.h"

#include "example_board.h"
#include "hal_stm32g4_inline.h"
#include "kernels.h"

#define HALF_TICKS 17000
/* From valley or peak to the handler: interrupt latency and the converters' time. */
#define LATENCY 100

static const iqfoc_methods_t methods = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                                        IQFOC_CONTROL_PI, IQFOC_MODULATION_PWM, false};

static stm32g4_tim_t tim1;
static stm32g4_tim_t tim2;
static stm32g4_tim_t tim4;
static stm32g4_adc_t adc1;
static stm32g4_adc_t adc2;
static const stm32g4_chip_t chip = {
    .tim1 = &tim1, .tim2 = &tim2, .tim4 = &tim4, .adc1 = &adc1, .adc2 = &adc2};

static const hal_stm32g4_board_t board = STM32G4_EXAMPLE_BOARD(HALF_TICKS);

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;
static uint32_t encoder;

void bench_handler_start(const iqfoc_cycle_config_t *as)
{
    config = *as;
    config.period_ticks = 2 * HALF_TICKS;
    config.tolerance_ticks = 100;
    config.stale_ticks = HALF_TICKS / 2;
    config.deadline_ticks = HALF_TICKS / 2;
    hal_stm32g4_start(&hal, &chip, &board);
    (void)iqfoc_cycle_init(&cycle, &config);
    cycle.enabled = true;
    tim2.CNT = 0;
    encoder = 0;
}

static uint32_t counts_of(iq24_t i)
{
    return (uint32_t)(2048 + i / board.i_per_count);
}

void bench_handler_set(const bench_input_t *input, bool peak)
{
    /* The shaft covers a third of the electrical angle, in 4096 counts a turn; half of it to each instant. */
    encoder = (encoder + 4096 + (uint32_t)(input->sample.speed / 3 / 8192)) % 4096;
    tim2.CNT = tim2.CNT + HALF_TICKS;
    tim1.CR1 = peak ? TIM_CR1_DIR : 0;
    tim1.CNT = peak ? HALF_TICKS - LATENCY : LATENCY;
    tim4.CNT = encoder;
    adc1.JDR[0] = counts_of(input->sample.i.a);
    adc2.JDR[0] = counts_of(input->sample.i.b);
    adc1.JDR[1] = (uint32_t)(input->sample.u_dc / board.u_dc_per_count);
    cycle.i_ref = input->i_ref;
}

BENCH_APART void bench_handler(void)
{
    hal_stm32g4_interrupt(methods, &cycle, &hal);
}

uint32_t bench_handler_status(void)
{
    return cycle.status;
}
