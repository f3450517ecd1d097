/* Counter, shadow registers, shunts, converters and encoder of the STM32F405 (rig.h). */
#include "rig.h"

#include "board.h"
#include "drive.h"
#include "fake_bank.h"
#include "hal_stm32f405.h"

#include <math.h>

#define HALF 4200u

/* A current into the motor reads low; offsets are not what they should be, and known to the calibration. */
static const double zero_counts[3] = {2031.0, 2069.0, 2048.0};
static const hal_board_t right = {
    .half_ticks = HALF,
    .i_zero = 2048,
    .i_per_count = IQ24(-2.0 / 2048),
    .u_dc_per_count = IQ24(2.0 / 4096),
    .shunts = {IQ24(0.92)},
    .encoder = {.counts_per_turn = 4096, .pole_pairs = 7, .slip_max = 4},
    .tracker = IQFOC_TRACKER_GAINS(600.0, 5e-5, IQ24(0.3), 200),
};
static hal_board_t board;
static int planted;
static iqfoc_hal_t hal;
static double current[3];
static double dc_link;
static double phase;        /* of the carrier period */
static uint64_t periods;    /* since the start */
static uint32_t active[3];  /* compare values behind the shadow registers */
static double low_share[3]; /* for which each low side was on in the period that ends */

static uint32_t held(double counts)
{
    return (uint32_t)lround(fmin(fmax(counts, 0.0), 4095.0));
}

/* A shunt carries its phase's current while the low side is on; settled after 3 % of a period. */
static void sample(void)
{
    if (fake_bank.tim1.CR2 != TIM_CR2_MMS_UP) {
        return;
    }
    for (int x = 0; x < 3; x++) {
        stm32f405_adc_t *adc = &fake_bank.adc[x];
        const bool seen = low_share[x] / 2.0 > 0.03;
        const uint32_t got = held(zero_counts[x] - (seen ? current[x] * 1024.0 : 700.0));
        if (adc->CR2 == (ADC_CR2_ADON | ADC_CR2_JEXT_TIM1_TRGO)) {
            adc->JDR[0] = got;
        }
    }
    fake_bank.adc[0].JDR[1] = held(dc_link * 2048.0);
}

static void update(void)
{
    for (int leg = 0; leg < 3; leg++) {
        low_share[leg] = 1.0 - fmin((double)active[leg] / HALF, 1.0);
        active[leg] = fake_bank.tim1.CCR[leg];
    }
    sample();
}

/* The valley is the counter's top. DIR tells the way. */
static void go_to(double to)
{
    if (to < phase) {
        periods++;
        phase = 0.0;
        if (fake_update_at_top()) {
            update();
        }
    }
    if (phase < 0.5 && to >= 0.5 && fake_update_at_zero()) {
        update();
    }
    phase = to;
    const uint32_t ticks = (uint32_t)lround(phase * 2.0 * HALF);
    fake_bank.tim1.CNT = ticks <= HALF ? HALF - ticks : ticks - HALF;
    fake_bank.tim1.CR1 = (fake_bank.tim1.CR1 & ~TIM_CR1_DIR) | (ticks < HALF ? TIM_CR1_DIR : 0);
    fake_bank.tim2.CNT = (uint32_t)(periods * HALF + ticks / 2);
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
    const double shaft = turns / 7.0;
    fake_bank.tim4.CNT = (uint32_t)lround((shaft - floor(shaft)) * 4096.0) % 4096;
}

/* PWM mode 1 (17.4.7). */
static bool leg_high(int leg)
{
    return fake_bank.tim1.CNT < active[leg];
}

static bool outputs_on(void)
{
    return (fake_bank.tim1.BDTR & TIM_BDTR_MOE) != 0;
}

static uint32_t period_ticks(void)
{
    return HALF;
}

bool rig_plant(int number)
{
    planted = number;
    return number >= 0 && number <= 5;
}

static void plant(void)
{
    board = right;
    board.i_per_count = planted == 1 ? -board.i_per_count : board.i_per_count;
    board.u_dc_per_count = planted == 2 ? board.u_dc_per_count / 2 : board.u_dc_per_count;
    board.encoder.pole_pairs = planted == 3 ? 4 : board.encoder.pole_pairs;
    board.half_ticks = planted == 4 ? HALF * 2 : board.half_ticks;
}

const port_rig *rig_start(void)
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
        .angle_step = 7.0 / 4096,
        .one_trigger = true,
    };
    plant();
    fake_reset();
    phase = 0.0;
    periods = 5;
    dc_link = 1.0;
    for (int x = 0; x < 3; x++) {
        current[x] = 0.0;
        active[x] = 0;
    }
    board_carrier_start(&fake_chip, HALF, 84);
    board_encoder_start(&fake_chip, 4096);
    board_converters_start(&fake_chip);
    if (!hal_start(&hal, &fake_chip, &board) || !board_run(&fake_chip)) {
        return NULL;
    }
    fake_bank.tim1.RCR = planted == 5 ? 0 : fake_bank.tim1.RCR;
    /* What the calibration will find. */
    const iqfoc_abc_t offset = {(2031 - 2048) * board.i_per_count, (2069 - 2048) * board.i_per_count, 0};
    port_set_offset(&hal, offset);
    port_align(&hal, 0);
    go_to(0.0);
    return &rig;
}
