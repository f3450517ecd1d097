/*
 * The start-up of the STM32G474's port in the emulator: what link.ld puts into CCM SRAM is there before main, and the interrupt runs from
 * it. images.cmake links this with the port's own start-up code and link.ld, whose memories are moved to those of QEMU's mps2-an386.
 */
#include "chip.h"
#include "console.h"
#include "example_board.h"
#include "hal_stm32g4_inline.h"
#include "mps2_an386.h"

#define HALF_TICKS 17000
#define PERIODS    100

/* From link.ld. */
extern const uint32_t link_ccm_load[];
extern const uint32_t link_ccm_start[];
extern const uint32_t link_ccm_end[];

static const iqfoc_methods_t methods = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                                        IQFOC_CONTROL_PI, IQFOC_MODULATION_PWM, false};

static stm32g4_tim_t tim1;
static stm32g4_tim_t tim2;
static stm32g4_tim_t tim4;
static stm32g4_adc_t adc1;
static stm32g4_adc_t adc2;
STM32G4_CCM_CONST static const stm32g4_chip_t chip = {
    .tim1 = &tim1, .tim2 = &tim2, .tim4 = &tim4, .adc1 = &adc1, .adc2 = &adc2};
STM32G4_CCM_CONST static const hal_stm32g4_board_t board = STM32G4_EXAMPLE_BOARD(HALF_TICKS);

static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;
static uint32_t initialised = 0x5EED;
static volatile uint32_t interrupts;
static volatile uint32_t at; /* the program counter in the last interrupt */

void adc1_2_handler(void);

STM32G4_CCM void adc1_2_handler(void)
{
    uint32_t pc;
    __asm volatile("mov %0, pc" : "=r"(pc));
    at = pc;
    interrupts++;
    hal_stm32g4_interrupt(methods, &cycle, &hal);
}

static bool start(void)
{
    static iqfoc_cycle_config_t config = {
        .predictor = IQFOC_PREDICTOR(0.75, 5.2e-3, 0.134, 2e-4, IQFOC_I_BASE(10.5), 750.0),
        .gains = IQFOC_GAINS(1500.0, 0.75, 5.2e-3, 5.2e-3, 0.134, 2e-4, IQFOC_I_BASE(10.5), 750.0),
        .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
        .span_max = IQ24(0.96),
        .current_limit = IQ24(1.8),
        .period_ticks = 2 * HALF_TICKS,
        .tolerance_ticks = 100,
        .stale_ticks = HALF_TICKS / 2,
        .deadline_ticks = HALF_TICKS / 2,
        .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE,
    };
    hal_stm32g4_start(&hal, &chip, &board);
    if (iqfoc_cycle_init(&cycle, &config) != IQFOC_OK) {
        return false;
    }
    cycle.i_ref.q = IQ24(0.1);
    cycle.enabled = true;
    return true;
}

/* A valley or a peak of a shaft that stands still, without current, at the nominal DC link; the interrupt is pended by software. */
static void half_period(bool peak)
{
    tim2.CNT += HALF_TICKS;
    tim1.CR1 = peak ? TIM_CR1_DIR : 0;
    tim1.CNT = peak ? HALF_TICKS - 100 : 100;
    adc1.JDR[0] = 2048;
    adc2.JDR[0] = 2048;
    adc1.JDR[1] = 2560;
    *(volatile uint32_t *)0xE000E200 = UINT32_C(1) << STM32G4_ADC1_2_IRQ; /* NVIC_ISPR0 */
    __asm volatile("dsb\n\tisb" ::: "memory");
}

static void expect(bool good, const char *what)
{
    if (!good) {
        console_text(what);
        console_text("\n");
        console_exit(1);
    }
}

int main(void)
{
    const uint32_t words = (uint32_t)(((uintptr_t)link_ccm_end - (uintptr_t)link_ccm_start) / 4);
    expect(initialised == 0x5EED && interrupts == 0, "initialised data");
    expect(words > 200, "next to nothing is in CCM SRAM");
    for (uint32_t k = 0; k < words; k++) {
        expect(link_ccm_start[k] == link_ccm_load[k], "CCM SRAM is not what the flash holds");
    }
    expect(start(), "the cycle's start is refused");
    ARM_NVIC_ISER0 = UINT32_C(1) << STM32G4_ADC1_2_IRQ;
    for (uint32_t k = 0; k < PERIODS; k++) {
        half_period(false);
        half_period(true);
    }
    expect(interrupts == 2 * PERIODS, "interrupts");
    expect(at >= (uintptr_t)link_ccm_start && at < (uintptr_t)link_ccm_end,
           "the interrupt does not run from CCM SRAM");
    expect(!cycle.tripped && (tim1.BDTR & TIM_BDTR_MOE) != 0, "the drive does not run");
    expect(tim1.CCR[1] < tim1.CCR[0], "no voltage along q, which is towards phase B");
    console_text("ok\n");
    console_exit(0);
}
