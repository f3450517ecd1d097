/*
 * STM32G474 for the porting checklist (rig_stm32g4.h): counter, shadow registers, converters, encoder.
 */
#include "rig_stm32g4.h"

#include "board.h"
#include "fake_stm32g4_bank.h"
#include "hal_stm32g4.h"

#include <math.h>

#define HALF 17000u

static const hal_stm32g4_board_t board = {
    .half_ticks = HALF,
    .i_offset_a = 2031,
    .i_offset_b = 2069,
    .i_per_count = IQ24(2.0 / 2048),
    .u_dc_per_count = IQ24(2.0 / 4096),
    .counts_per_turn = 4096,
    .pole_pairs = 3,
    .theta_offset = 0,
};
static iqfoc_hal_t hal;
static double current[3];
static double dc_link;
static double phase;       /* of the carrier period */
static uint64_t periods;   /* since the start */
static uint32_t active[3]; /* compare values behind the shadow registers */

static uint32_t converted(double value, double full_scale, double offset)
{
    return (uint32_t)lround(fmin(fmax(value / full_scale * 2048.0 + offset, 0.0), 4095.0));
}

/* The converters' trigger, if it is the one that the port set up: TRGO2 at valley and peak. */
static void sample(void)
{
    if ((fake_bank.adc1.JSQR & 0x1FC) == (8u << 2 | 1u << 7) && fake_bank.tim1.CR2 == TIM_CR2_MMS2_OC4_OC6) {
        fake_bank.adc1.JDR[0] = converted(current[0], 2.0, 2031.0);
        fake_bank.adc2.JDR[0] = converted(current[1], 2.0, 2069.0);
        fake_bank.adc1.JDR[1] = converted(dc_link, 1.0, 0.0);
    }
}

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
        sample();
    }
    if (phase < 0.5 && to >= 0.5) {
        if (fake_bank.tim1.RCR != 1) {
            for (int leg = 0; leg < 3; leg++) {
                active[leg] = fake_bank.tim1.CCR[leg];
            }
        }
        sample();
    }
    phase = to;
    const uint32_t ticks = (uint32_t)lround(phase * 2.0 * HALF);
    fake_bank.tim1.CNT = ticks <= HALF ? ticks : 2 * HALF - ticks;
    fake_bank.tim1.CR1 = (fake_bank.tim1.CR1 & ~TIM_CR1_DIR) | (ticks >= HALF ? TIM_CR1_DIR : 0);
    fake_bank.tim2.CNT = (uint32_t)(periods * 2 * HALF + ticks);
}

static void set_current(const double i_pu[3])
{
    for (int x = 0; x < 3; x++) {
        current[x] = i_pu[x];
    }
}

static void set_dc_link(double u_pu)
{
    dc_link = u_pu;
}

static void set_angle(double turns)
{
    const double shaft = turns / board.pole_pairs;
    const double counts = (shaft - floor(shaft)) * board.counts_per_turn;
    fake_bank.tim4.CNT = (uint32_t)lround(counts) % board.counts_per_turn;
}

/* PWM mode 2 (29.6.8). */
static bool leg_high(int leg)
{
    const uint32_t count = fake_bank.tim1.CNT;
    const bool down = (fake_bank.tim1.CR1 & TIM_CR1_DIR) != 0;
    return down ? count > active[leg] : count >= active[leg];
}

static bool outputs_on(void)
{
    return (fake_bank.tim1.BDTR & TIM_BDTR_MOE) != 0;
}

static uint32_t period_ticks(void)
{
    return 2 * HALF;
}

const port_rig *rig_stm32g4(void)
{
    static const port_rig rig = {
        .hal = &hal,
        .set_current = set_current,
        .set_dc_link = set_dc_link,
        .set_angle = set_angle,
        .go_to = go_to,
        .leg_high = leg_high,
        .outputs_on = outputs_on,
        .period_ticks = period_ticks,
        .current_step_pu = 2.0 / 2048,
        .angle_step = 3.0 / 4096,
    };
    return &rig;
}

const port_rig *rig_stm32g4_start(void)
{
    fake_reset();
    phase = 0.0;
    periods = 5;
    dc_link = 1.0;
    (void)stm32g4_carrier_start(&fake_chip, HALF, 1000);
    (void)stm32g4_encoder_start(&fake_chip, board.counts_per_turn);
    (void)stm32g4_converters_start(&fake_chip);
    hal_stm32g4_start(&hal, &fake_chip, &board);
    stm32g4_run(&fake_chip);
    go_to(0.0);
    return rig_stm32g4();
}
