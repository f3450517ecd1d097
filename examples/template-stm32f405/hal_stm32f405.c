/* HAL of the STM32F405 (hal_stm32f405.h). */
#include "hal_stm32f405.h"

/* A converter nearer than this to an end of its range was clipped. */
#define CLIP_MARGIN 8
#define COUNT_MAX   4095

bool hal_start(iqfoc_hal_t *hal, const stm32f405_chip_t *chip, const hal_board_t *board)
{
    const iqfoc_abc_t none = {0, 0, 0};
    hal->chip = chip;
    hal->board = board;
    hal->i_offset = none;
    hal->i_predicted = none;
    hal->written = none;
    hal->in_force = none;
    hal->count = 0;
    return iqfoc_shunts_check(&board->shunts) == IQFOC_OK &&
           iqfoc_encoder_init(&hal->encoder, &board->encoder) == IQFOC_OK &&
           iqfoc_tracker_init(&hal->tracker, &board->tracker) == IQFOC_OK;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    return reg_read(&hal->chip->tim2->CNT);
}

/*
 * Ticks of TIM1 since the valley, its top: on the way down the distance from the top, on the way up that much more
 * than half. DIR and CNT are two reads: again until DIR did not change in between.
 */
static uint32_t since_valley(const iqfoc_hal_t *hal)
{
    stm32f405_tim_t *tim = hal->chip->tim1;
    uint32_t down;
    uint32_t count;
    do {
        down = reg_read(&tim->CR1) & TIM_CR1_DIR;
        count = reg_read(&tim->CNT) & 0xFFFF;
    } while ((reg_read(&tim->CR1) & TIM_CR1_DIR) != down);
    return down != 0 ? hal->board->half_ticks - count : hal->board->half_ticks + count;
}

static bool near_an_end(int32_t count)
{
    return count < CLIP_MARGIN || count > COUNT_MAX - CLIP_MARGIN;
}

/*
 * Angle and speed at the valley from an encoder that is read now, `at` cycles after it. The index comes first: it
 * may move the reference.
 */
static void read_angle(iqfoc_hal_t *hal, iq24_t at)
{
    stm32f405_tim_t *tim = hal->chip->tim4;
    if ((reg_read(&tim->SR) & TIM_SR_CC3IF) != 0) {
        (void)iqfoc_encoder_index(&hal->encoder,
                                  reg_read(&tim->CCR[2]) & 0xFFFF); /* reading clears the flag */
    }
    hal->count = reg_read(&tim->CNT) & 0xFFFF;
    iqfoc_tracker_step(&hal->tracker, iqfoc_encoder_theta(&hal->encoder, hal->count), at, true);
    hal->sample.theta = iqfoc_tracker_theta(&hal->tracker, 0);
    hal->sample.speed = iqfoc_tracker_speed(&hal->tracker);
}

/*
 * Range: |count - zero| < 2^12 and |i_per_count| <= 2^18: below 2^30; the offset is within 1, 2^24. Duties in force:
 * those that were written before this valley.
 */
static void read_currents(iqfoc_hal_t *hal)
{
    const hal_board_t *board = hal->board;
    int32_t count[3];
    bool clipped = false;
    const uint32_t usable = iqfoc_shunts_usable(&board->shunts, hal->in_force);
    for (uint32_t x = 0; x < 3; x++) {
        count[x] = (int32_t)(reg_read(&hal->chip->adc[x]->JDR[0]) & 0xFFF);
        clipped = clipped || ((usable & BIT(x)) != 0 && near_an_end(count[x]));
    }
    const iqfoc_abc_t i = {(count[0] - board->i_zero) * board->i_per_count - hal->i_offset.a,
                           (count[1] - board->i_zero) * board->i_per_count - hal->i_offset.b,
                           (count[2] - board->i_zero) * board->i_per_count - hal->i_offset.c};
    hal->sample.i = iqfoc_shunts_read(&board->shunts, i, hal->in_force, hal->i_predicted).i;
    hal->sample.clipped = clipped;
    hal->sample.u_dc = (int32_t)(reg_read(&hal->chip->adc[0]->JDR[1]) & 0xFFF) * board->u_dc_per_count;
}

/* TIM1 counts at twice the rate of TIM2. */
void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = iqfoc_hal_now(hal);
    const uint32_t elapsed = since_valley(hal);
    read_angle(hal, (iq24_t)(elapsed * ((uint32_t)IQ24_ONE / (2 * hal->board->half_ticks))));
    read_currents(hal);
    hal->sample.i_mean = hal->sample.i;
    hal->sample.has_mean = false;
    hal->sample.instant = 0;
    hal->sample.time = now - elapsed / 2;
    /* What is sampled at the next valley was made by the duties that act from this one on. */
    hal->in_force = hal->written;
    *sample = hal->sample;
}

/* There is one trigger a period: the peak's sample is the valley's, and says so by its `at`. */
void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    *sample = hal->sample;
}

/* High for the share `duty` around the counter's zero; always, where the compare value is never reached. */
static uint32_t compare_of(iq24_t duty, uint32_t half_ticks)
{
    const uint32_t high = (uint32_t)(((uint64_t)(uint32_t)duty * half_ticks + (1 << 23)) >> 24);
    return high >= half_ticks ? half_ticks + 1 : high;
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    stm32f405_tim_t *tim = hal->chip->tim1;
    const uint32_t half = hal->board->half_ticks;
    if (!command->gates) {
        reg_write(&tim->BDTR, reg_read(&tim->BDTR) & ~TIM_BDTR_MOE);
    }
    hal->written = iqfoc_shunts_make_room(&hal->board->shunts, command->duties.high);
    reg_write(&tim->CCR[0], compare_of(hal->written.a, half));
    reg_write(&tim->CCR[1], compare_of(hal->written.b, half));
    reg_write(&tim->CCR[2], compare_of(hal->written.c, half));
    if (command->gates && !hal_broken(hal)) {
        reg_write(&tim->BDTR, reg_read(&tim->BDTR) | TIM_BDTR_MOE);
    }
}

bool hal_broken(const iqfoc_hal_t *hal)
{
    return (reg_read(&hal->chip->tim1->SR) & TIM_SR_BIF) != 0;
}

/* PB12, active low. */
bool hal_break_active(const iqfoc_hal_t *hal)
{
    return (reg_read(&hal->chip->gpiob->IDR) & BIT(12)) == 0;
}

/* Flags of SR are cleared by writing 0 and left alone by writing 1. */
void hal_clear_break(iqfoc_hal_t *hal)
{
    reg_write(&hal->chip->tim1->SR, ~TIM_SR_BIF);
}
