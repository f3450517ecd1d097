/*
 * HAL of the STM32G474 (hal_stm32g4.h).
 *
 * Samples are taken by the converters at the instants that the timer sets; when the handler gets to read them
 * only shows in `now - time`. The encoder has no such trigger: it is read here, and moved back to the instant
 * at the measured speed.
 */
#include "hal_stm32g4.h"

#include "board.h"

#include <stddef.h>

/* A converter nearer than this to an end of its range was clipped. */
#define CLIP_MARGIN 8
#define COUNT_MAX   4095

void hal_stm32g4_start(iqfoc_hal_t *hal, const stm32g4_chip_t *chip, const hal_stm32g4_board_t *board)
{
    const iqfoc_hal_t fresh = {
        .chip = chip,
        .board = board,
        .turns_per_count = ((uint64_t)board->pole_pairs << 40) / board->counts_per_turn,
        .cycles_per_tick = IQ24_ONE / (iq24_t)(2 * board->half_ticks),
    };
    *hal = fresh;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    return stm32g4_read(&hal->chip->tim2->CNT);
}

bool hal_stm32g4_at_valley(const iqfoc_hal_t *hal)
{
    return (stm32g4_read(&hal->chip->tim1->CR1) & TIM_CR1_DIR) == 0;
}

/*
 * Ticks since the last valley, 0 ... two half periods. DIR and CNT are two reads: the second is repeated
 * until the first did not change in between.
 */
static uint32_t since_valley(const iqfoc_hal_t *hal)
{
    stm32g4_tim_t *tim = hal->chip->tim1;
    uint32_t before;
    uint32_t count;
    do {
        before = stm32g4_read(&tim->CR1) & TIM_CR1_DIR;
        count = stm32g4_read(&tim->CNT) & 0xFFFF;
    } while ((stm32g4_read(&tim->CR1) & TIM_CR1_DIR) != before);
    return before == 0 ? count : 2 * hal->board->half_ticks - count;
}

/* Counts of a whole number of shaft turns do not matter: modulo, and the shorter way round. */
static int32_t counts_between(uint32_t from, uint32_t to, uint32_t per_turn)
{
    const uint32_t forward = to >= from ? to - from : to + per_turn - from;
    return forward > per_turn / 2 ? (int32_t)forward - (int32_t)per_turn : (int32_t)forward;
}

/* Range: |counts| <= 2^15 and turns_per_count <= 2^46/4 keep the product below 2^60. */
static iq24_t turns_of(const iqfoc_hal_t *hal, int32_t counts)
{
    return iq24_wrap(iq24_asr64((int64_t)counts * (int64_t)hal->turns_per_count, 16));
}

/*
 * Speed from the counts of the last HAL_SPEED_SPAN valleys. It must be below half a shaft turn in that span:
 * 1,900 revolutions a second at 60,000 cycles a second.
 */
static void speed_follow(iqfoc_hal_t *hal, uint32_t count)
{
    if (hal->seen == HAL_SPEED_SPAN) {
        const int32_t moved = counts_between(hal->counts[hal->next], count, hal->board->counts_per_turn);
        hal->turns = turns_of(hal, moved) / HAL_SPEED_SPAN;
    } else {
        hal->seen++;
    }
    hal->counts[hal->next] = count;
    hal->next = (hal->next + 1) % HAL_SPEED_SPAN;
}

static bool near_an_end(int32_t count)
{
    return count < CLIP_MARGIN || count > COUNT_MAX - CLIP_MARGIN;
}

/*
 * elapsed: ticks since the instant of the sample. Range: |count - offset| < 2^12 and i_per_count <= 2^18:
 * below 2^30.
 */
static void sample_fill(iqfoc_hal_t *hal, iqfoc_sample_t *sample, uint32_t now, uint32_t elapsed,
                        uint32_t encoder)
{
    const hal_stm32g4_board_t *board = hal->board;
    const int32_t count_a = (int32_t)stm32g4_read(&hal->chip->adc1->JDR[0]);
    const int32_t count_u = (int32_t)stm32g4_read(&hal->chip->adc1->JDR[1]);
    const int32_t count_b = (int32_t)stm32g4_read(&hal->chip->adc2->JDR[0]);
    const iq24_t since = (iq24_t)elapsed * hal->cycles_per_tick;
    const iq24_t theta = iq24_add_wrap(turns_of(hal, (int32_t)encoder), board->theta_offset);
    sample->i.a = (count_a - board->i_offset_a) * board->i_per_count;
    sample->i.b = (count_b - board->i_offset_b) * board->i_per_count;
    sample->i.c = -(sample->i.a + sample->i.b);
    sample->i_mean = sample->i;
    sample->has_mean = false;
    sample->u_dc = count_u * board->u_dc_per_count;
    sample->turns = hal->turns;
    sample->theta = iq24_sub_wrap(theta, iq24_mul_round(hal->turns, since));
    sample->time = now - elapsed;
    sample->clipped = near_an_end(count_a) || near_an_end(count_b);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = iqfoc_hal_now(hal);
    const uint32_t elapsed = since_valley(hal);
    const uint32_t encoder = stm32g4_read(&hal->chip->tim4->CNT) & 0xFFFF;
    speed_follow(hal, encoder);
    sample->at = 0;
    sample_fill(hal, sample, now, elapsed, encoder);
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = iqfoc_hal_now(hal);
    const uint32_t half = hal->board->half_ticks;
    const uint32_t after_valley = since_valley(hal);
    /* Past the next valley the count starts again. */
    const uint32_t elapsed = after_valley >= half ? after_valley - half : after_valley + half;
    const uint32_t encoder = stm32g4_read(&hal->chip->tim4->CNT) & 0xFFFF;
    sample->at = IQ24_ONE / 2;
    sample_fill(hal, sample, now, elapsed, encoder);
}

/* Compare value of a duty: high for the share `duty` of the way to the top. Never reached for duty 0. */
static uint32_t compare_of(iq24_t duty, uint32_t half_ticks)
{
    const uint32_t high = (uint32_t)(((uint64_t)(uint32_t)duty * half_ticks + (1 << 23)) >> 24);
    return high == 0 ? half_ticks + 1 : half_ticks - high;
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    stm32g4_tim_t *tim = hal->chip->tim1;
    const uint32_t half = hal->board->half_ticks;
    if (!command->gates) {
        stm32g4_write(&tim->BDTR, stm32g4_read(&tim->BDTR) & ~TIM_BDTR_MOE);
    }
    stm32g4_write(&tim->CCR[0], compare_of(command->duties.high.a, half));
    stm32g4_write(&tim->CCR[1], compare_of(command->duties.high.b, half));
    stm32g4_write(&tim->CCR[2], compare_of(command->duties.high.c, half));
    if (command->gates && !hal_stm32g4_broken(hal)) {
        stm32g4_write(&tim->BDTR, stm32g4_read(&tim->BDTR) | TIM_BDTR_MOE);
    }
}

bool hal_stm32g4_broken(const iqfoc_hal_t *hal)
{
    return (stm32g4_read(&hal->chip->tim1->SR) & TIM_SR_BIF) != 0;
}

/* Flags of SR are cleared by writing 0 and left alone by writing 1 (29.6.5). */
void hal_stm32g4_clear_break(iqfoc_hal_t *hal)
{
    stm32g4_write(&hal->chip->tim1->SR, ~TIM_SR_BIF);
}
