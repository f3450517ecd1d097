/*
 * STM32G474 for the porting checklist (rig_stm32g4.h): counter, shadow registers, converters, encoder.
 */
#include "rig_stm32g4.h"

#include "board.h"
#include "fake_stm32g4_bank.h"
#include "hal_stm32g4.h"
#include "rig_stm32g4_sensors.h"

#include <math.h>

#define HALF 17000u

static iqfoc_hal_t hal;
static double phase;       /* of the carrier period */
static uint64_t periods;   /* since the start */
static uint32_t active[3]; /* compare values behind the shadow registers */

/* What the counter would show; DIR tells the way. 29.3.5: with RCR = 1 the update event is at the underflow
 * only. */
static void go_to(double to)
{
    if (to < phase) {
        periods++;
        phase = 0.0;
        for (int leg = 0; leg < 3; leg++) {
            active[leg] = fake_bank.tim1.CCR[leg];
        }
        rig_sensors_sample(TIM_CR2_MMS2_OC4_OC6);
    }
    if (phase < 0.5 && to >= 0.5) {
        if (fake_bank.tim1.RCR != 1) {
            for (int leg = 0; leg < 3; leg++) {
                active[leg] = fake_bank.tim1.CCR[leg];
            }
        }
        rig_sensors_sample(TIM_CR2_MMS2_OC4_OC6);
    }
    phase = to;
    const uint32_t ticks = (uint32_t)lround(phase * 2.0 * HALF);
    fake_bank.tim1.CNT = ticks <= HALF ? ticks : 2 * HALF - ticks;
    fake_bank.tim1.CR1 = (fake_bank.tim1.CR1 & ~TIM_CR1_DIR) | (ticks >= HALF ? TIM_CR1_DIR : 0);
    fake_bank.tim2.CNT = (uint32_t)(periods * 2 * HALF + ticks);
}

/* PWM mode 2 (29.6.8). */
static bool leg_high(int leg)
{
    const uint32_t count = fake_bank.tim1.CNT;
    const bool down = (fake_bank.tim1.CR1 & TIM_CR1_DIR) != 0;
    return down ? count > active[leg] : count >= active[leg];
}

static uint32_t period_ticks(void)
{
    return 2 * HALF;
}

const port_rig *rig_stm32g4(void)
{
    static port_rig rig;
    rig = rig_sensors;
    rig.hal = &hal;
    rig.go_to = go_to;
    rig.leg_high = leg_high;
    rig.period_ticks = period_ticks;
    return &rig;
}

const port_rig *rig_stm32g4_start(void)
{
    const hal_stm32g4_board_t *board = rig_sensors_start(HALF);
    fake_reset();
    phase = 0.0;
    periods = 5;
    (void)stm32g4_carrier_start(&fake_chip, HALF, 1000);
    (void)stm32g4_encoder_start(&fake_chip, board->counts_per_turn);
    (void)stm32g4_converters_start(&fake_chip);
    hal_stm32g4_start(&hal, &fake_chip, board);
    stm32g4_run(&fake_chip);
    go_to(0.0);
    return rig_stm32g4();
}
