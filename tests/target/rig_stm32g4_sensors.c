/* Converters and encoder of the STM32G474's rigs (rig_stm32g4_sensors.h). */
#include "rig_stm32g4_sensors.h"

#include "fake_stm32g4_bank.h"

#include <math.h>

static hal_stm32g4_board_t board = {
    .i_offset_a = 2031,
    .i_offset_b = 2069,
    .i_per_count = IQ24(2.0 / 2048),
    .u_dc_per_count = IQ24(2.0 / 4096),
    .counts_per_turn = 4096,
    .pole_pairs = 3,
    .theta_offset = 0,
};
static double current[3];
static double dc_link;

const hal_stm32g4_board_t *rig_sensors_start(uint32_t half_ticks)
{
    board.half_ticks = half_ticks;
    dc_link = 1.0;
    return &board;
}

static uint32_t converted(double value, double full_scale, double offset)
{
    return (uint32_t)lround(fmin(fmax(value / full_scale * 2048.0 + offset, 0.0), 4095.0));
}

void rig_sensors_sample(uint32_t trgo2)
{
    if ((fake_bank.adc1.JSQR & 0x1FC) == (8u << 2 | 1u << 7) && (fake_bank.tim1.CR2 & 0xF00000) == trgo2) {
        fake_bank.adc1.JDR[0] = converted(current[0], 2.0, 2031.0);
        fake_bank.adc2.JDR[0] = converted(current[1], 2.0, 2069.0);
        fake_bank.adc1.JDR[1] = converted(dc_link, 1.0, 0.0);
    }
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

static bool outputs_on(void)
{
    return (fake_bank.tim1.BDTR & TIM_BDTR_MOE) != 0;
}

const port_rig rig_sensors = {.set_current = set_current,
                              .set_dc_link = set_dc_link,
                              .set_angle = set_angle,
                              .outputs_on = outputs_on,
                              .current_step_pu = 2.0 / 2048,
                              .angle_step = 3.0 / 4096};
