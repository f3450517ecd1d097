/*
 * The STM32G474's HAL inline, and the interrupt that is made of it: the compiler then sees through from the
 * registers to the duties, and a sample need not go through memory.
 *
 * Samples are taken by the converters at the instants that the timer sets; when the handler gets to read them
 * only shows in `now - time`. The encoder has no such trigger: it is read here, and moved back to the instant
 * at the measured speed.
 */
#ifndef PORT_STM32G4_HAL_STM32G4_INLINE_H
#define PORT_STM32G4_HAL_STM32G4_INLINE_H

#include "hal_stm32g4.h"

/* A converter nearer than this to an end of its range was clipped. */
#define HAL_CLIP_MARGIN 8
#define HAL_COUNT_MAX   4095

static inline void hal_stm32g4_fresh(iqfoc_hal_t *hal, const stm32g4_chip_t *chip,
                                     const hal_stm32g4_board_t *board)
{
    const iqfoc_hal_t fresh = {
        .chip = chip,
        .board = board,
        .turns_per_count = ((uint64_t)board->pole_pairs << 40) / board->counts_per_turn,
        .cycles_per_tick = IQ24_ONE / (iq24_t)(2 * board->half_ticks),
    };
    *hal = fresh;
}

static inline uint32_t hal_stm32g4_now(const iqfoc_hal_t *hal)
{
    return stm32g4_read(&hal->chip->tim2->CNT);
}

/*
 * Ticks since the last valley, 0 ... two half periods. DIR and CNT are two reads: the second is repeated
 * until the first did not change in between.
 */
static inline uint32_t hal_stm32g4_since_valley(const iqfoc_hal_t *hal)
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
static inline int32_t hal_stm32g4_counts_between(uint32_t from, uint32_t to, uint32_t per_turn)
{
    const uint32_t forward = to >= from ? to - from : to + per_turn - from;
    /*@ assert encoder: forward < per_turn; */
    return forward > per_turn / 2 ? (int32_t)forward - (int32_t)per_turn : (int32_t)forward;
}

/* Range: |counts| <= 2^15 and turns_per_count <= 2^46/4 keep the product below 2^60. */
static inline iq24_t hal_stm32g4_speed_of(const iqfoc_hal_t *hal, int32_t counts)
{
    return iq24_wrap(iq24_asr64((int64_t)counts * (int64_t)hal->turns_per_count, 16));
}

/*
 * Speed from the counts of the last HAL_SPEED_SPAN valleys. It must be below half a shaft turn in that span:
 * 1,900 revolutions a second at 60,000 cycles a second.
 */
static inline void hal_stm32g4_speed_follow(iqfoc_hal_t *hal, uint32_t count)
{
    uint32_t *const oldest = &hal->counts[hal->next];
    if (hal->seen == HAL_SPEED_SPAN) {
        const int32_t moved = hal_stm32g4_counts_between(*oldest, count, hal->board->counts_per_turn);
        hal->speed = hal_stm32g4_speed_of(hal, moved) / HAL_SPEED_SPAN;
    } else {
        hal->seen++;
    }
    *oldest = count;
    hal->next = (hal->next + 1) % HAL_SPEED_SPAN;
}

static inline bool hal_stm32g4_near_an_end(int32_t count)
{
    return count < HAL_CLIP_MARGIN || count > HAL_COUNT_MAX - HAL_CLIP_MARGIN;
}

/*
 * elapsed: ticks since the instant of the sample. Range: |count - offset| < 2^12 and i_per_count <= 2^18:
 * below 2^30.
 */
static inline void hal_stm32g4_sample_fill(iqfoc_hal_t *hal, iqfoc_sample_t *sample, uint32_t now,
                                           uint32_t elapsed, uint32_t encoder)
{
    const hal_stm32g4_board_t *board = hal->board;
    const int32_t count_a = (int32_t)stm32g4_read(&hal->chip->adc1->JDR[0]);
    const int32_t count_u = (int32_t)stm32g4_read(&hal->chip->adc1->JDR[1]);
    const int32_t count_b = (int32_t)stm32g4_read(&hal->chip->adc2->JDR[0]);
    const iq24_t since = (iq24_t)elapsed * hal->cycles_per_tick;
    const iq24_t theta = iq24_add_wrap(hal_stm32g4_speed_of(hal, (int32_t)encoder), board->theta_offset);
    sample->i.a = (count_a - board->i_offset_a) * board->i_per_count;
    sample->i.b = (count_b - board->i_offset_b) * board->i_per_count;
    sample->i.c = -(sample->i.a + sample->i.b);
    sample->has_mean = false;
    sample->u_dc = count_u * board->u_dc_per_count;
    sample->speed = hal->speed;
    sample->theta = iq24_sub_wrap(theta, iq24_mul_round(hal->speed, since));
    sample->time = now - elapsed;
    sample->clipped = hal_stm32g4_near_an_end(count_a) || hal_stm32g4_near_an_end(count_b);
}

static inline void hal_stm32g4_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = hal_stm32g4_now(hal);
    const uint32_t elapsed = hal_stm32g4_since_valley(hal);
    const uint32_t encoder = stm32g4_read(&hal->chip->tim4->CNT) & 0xFFFF;
    hal_stm32g4_speed_follow(hal, encoder);
    sample->instant = 0;
    hal_stm32g4_sample_fill(hal, sample, now, elapsed, encoder);
}

static inline void hal_stm32g4_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = hal_stm32g4_now(hal);
    const uint32_t half = hal->board->half_ticks;
    const uint32_t after_valley = hal_stm32g4_since_valley(hal);
    /* Past the next valley the count starts again. */
    const uint32_t elapsed = after_valley >= half ? after_valley - half : after_valley + half;
    const uint32_t encoder = stm32g4_read(&hal->chip->tim4->CNT) & 0xFFFF;
    sample->instant = IQ24_ONE / 2;
    hal_stm32g4_sample_fill(hal, sample, now, elapsed, encoder);
}

/* Compare value of a duty: high for the share `duty` of the way to the top. Never reached for duty 0. */
static inline uint32_t hal_stm32g4_compare_of(iq24_t duty, uint32_t half_ticks)
{
    const uint32_t high = (uint32_t)(((uint64_t)(uint32_t)duty * half_ticks + (1 << 23)) >> 24);
    return high == 0 ? half_ticks + 1 : half_ticks - high;
}

static inline void hal_stm32g4_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    stm32g4_tim_t *tim = hal->chip->tim1;
    const uint32_t half = hal->board->half_ticks;
    if (!command->gates) {
        stm32g4_write(&tim->BDTR, stm32g4_read(&tim->BDTR) & ~TIM_BDTR_MOE);
    }
    stm32g4_write(&tim->CCR[0], hal_stm32g4_compare_of(command->duties.high.a, half));
    stm32g4_write(&tim->CCR[1], hal_stm32g4_compare_of(command->duties.high.b, half));
    stm32g4_write(&tim->CCR[2], hal_stm32g4_compare_of(command->duties.high.c, half));
    if (command->gates && (stm32g4_read(&tim->SR) & TIM_SR_BIF) == 0) {
        stm32g4_write(&tim->BDTR, stm32g4_read(&tim->BDTR) | TIM_BDTR_MOE);
    }
}

/*
 * The interrupt of the converters, all of it: both have sampled, at the valley or at the peak, whichever the
 * counter comes from. methods: a constant. As iqfoc_isr_valley_by and iqfoc_isr_peak_by.
 */
IQFOC_STEP void hal_stm32g4_interrupt(const iqfoc_methods_t methods, iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    stm32g4_write(&hal->chip->adc1->ISR, ADC_ISR_JEOS);
    const uint32_t now = hal_stm32g4_now(hal);
    if (hal_stm32g4_at_valley(hal)) {
        hal_stm32g4_read_valley(hal, &sample);
        if (iqfoc_cycle_valley_by(methods, cycle, &sample, now)) {
            const iqfoc_command_t safe = iqfoc_cycle_safe(cycle->config);
            iqfoc_hal_write(hal, &safe); /* out of line: a trip is rare */
        }
        return;
    }
    hal_stm32g4_read_peak(hal, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak_by(methods, cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    const uint32_t done = hal_stm32g4_now(hal);
    if (!iqfoc_cycle_in_time_inline(cycle, sample.time, done) && !iqfoc_cycle_in_time(cycle, &sample, done) &&
        cycle->tripped) {
        command = iqfoc_cycle_safe(cycle->config);
    }
    hal_stm32g4_write(hal, &command);
}

#endif
