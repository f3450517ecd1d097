/*
 * The HAL of the F28004x and F2837xD inline, and the two interrupts that are made of it: the compiler then
 * sees through from the registers to the duties, and a handler in RAM has all of it there.
 *
 * Samples are taken by the converters at the instants that the carrier sets, into results of their own for
 * valley and peak. The encoder is read here, and moved back to the instant at the measured speed.
 */
#ifndef PORT_C2000_HAL_C2000_INLINE_H
#define PORT_C2000_HAL_C2000_INLINE_H

#include "hal_c2000.h"

/* A converter nearer than this to an end of its range was clipped. */
#define HAL_CLIP_MARGIN 8
#define HAL_COUNT_MAX   4095

/*
 * Writes of a trip or its clearing before it is given up. One may be missed where the time base has half the
 * core's clock.
 */
#define HAL_TRIP_WRITES 8

/* Both outputs of a leg low, at once. False if the flag did not come. Unprotected. */
static inline bool c2000_trip(c2000_reg_t *epwm)
{
    for (uint32_t k = 0; k < HAL_TRIP_WRITES; k++) {
        c2000_write(epwm + EPWM_TZFRC, TZ_OST);
        if ((c2000_read(epwm + EPWM_TZFLG) & TZ_OST) != 0) {
            return true;
        }
    }
    return false;
}

/* Lets them on again, unless the break line is still active: the flag then stays. Unprotected. */
static inline void c2000_release(c2000_reg_t *epwm)
{
    for (uint32_t k = 0; k < HAL_TRIP_WRITES && (c2000_read(epwm + EPWM_TZFLG) & TZ_OST) != 0; k++) {
        c2000_write(epwm + EPWM_TZCLR, TZ_OST);
    }
}

/* The timer counts down. */
static inline uint32_t hal_c2000_now(const iqfoc_hal_t *hal)
{
    return UINT32_MAX - c2000_read_long(hal->chip->timer + TIMER_TIM);
}

/*
 * Ticks of the carrier since the last valley, 0 ... two half periods. Direction and count are two reads: the
 * second is repeated until the first did not change in between.
 */
static inline uint32_t hal_c2000_since_valley(const iqfoc_hal_t *hal)
{
    c2000_reg_t *epwm = hal->chip->epwm[0];
    uint16_t before;
    uint32_t count;
    do {
        before = c2000_read(epwm + EPWM_TBSTS) & TBSTS_COUNTS_UP;
        count = c2000_read(epwm + EPWM_TBCTR);
    } while ((c2000_read(epwm + EPWM_TBSTS) & TBSTS_COUNTS_UP) != before);
    return before != 0 ? count : 2 * hal->board->half_ticks - count;
}

/* Counts of a whole number of shaft turns do not matter: modulo, and the shorter way round. */
static inline int32_t hal_c2000_counts_between(uint32_t from, uint32_t to, uint32_t per_turn)
{
    const uint32_t forward = to >= from ? to - from : to + per_turn - from;
    return forward > per_turn / 2 ? (int32_t)forward - (int32_t)per_turn : (int32_t)forward;
}

/* Range: |counts| <= 2^16 and turns_per_count <= 2^46/4 keep the product below 2^61. */
static inline iq24_t hal_c2000_speed_of(const iqfoc_hal_t *hal, int32_t counts)
{
    return iq24_wrap(iq24_asr64((int64_t)counts * (int64_t)hal->turns_per_count, 16));
}

/*
 * Speed from the counts of the last HAL_SPEED_SPAN valleys. It must be below half a shaft turn in that span.
 */
static inline void hal_c2000_speed_follow(iqfoc_hal_t *hal, uint32_t count)
{
    uint32_t *const oldest = &hal->counts[hal->next];
    if (hal->seen == HAL_SPEED_SPAN) {
        const int32_t moved = hal_c2000_counts_between(*oldest, count, hal->board->counts_per_turn);
        hal->speed = hal_c2000_speed_of(hal, moved) / HAL_SPEED_SPAN;
    } else {
        hal->seen++;
    }
    *oldest = count;
    hal->next = (hal->next + 1) % HAL_SPEED_SPAN;
}

static inline bool hal_c2000_near_an_end(int32_t count)
{
    return count < HAL_CLIP_MARGIN || count > HAL_COUNT_MAX - HAL_CLIP_MARGIN;
}

/*
 * first: the first of the instant's conversions. elapsed: ticks since the instant. Range: |count - offset| <
 * 2^12 and i_per_count <= 2^18: below 2^30, and with i_zero below 2^31.
 */
static inline void hal_c2000_sample_fill(iqfoc_hal_t *hal, iqfoc_sample_t *sample, uint32_t first,
                                         uint32_t now, uint32_t elapsed, uint32_t encoder)
{
    const hal_c2000_board_t *board = hal->board;
    const c2000_chip_t *chip = hal->chip;
    const int32_t count_a = (int32_t)c2000_read(chip->adc_result[0] + ADC_RESULT(first));
    const int32_t count_u = (int32_t)c2000_read(chip->adc_result[0] + ADC_RESULT(first + 1));
    const int32_t count_b = (int32_t)c2000_read(chip->adc_result[1] + ADC_RESULT(first));
    const iq24_t since = (iq24_t)elapsed * hal->cycles_per_tick;
    const iq24_t theta = iq24_add_wrap(hal_c2000_speed_of(hal, (int32_t)encoder), hal->theta_offset);
    sample->i.a = (count_a - board->i_offset_a) * board->i_per_count - hal->i_zero.a;
    sample->i.b = (count_b - board->i_offset_b) * board->i_per_count - hal->i_zero.b;
    sample->i.c = -(sample->i.a + sample->i.b);
    sample->has_mean = false;
    sample->u_dc = count_u * board->u_dc_per_count;
    sample->speed = hal->speed;
    sample->theta = iq24_sub_wrap(theta, iq24_mul_round(hal->speed, since));
    sample->time = now - elapsed * chip->family->clocks_per_tick;
    sample->clipped = hal_c2000_near_an_end(count_a) || hal_c2000_near_an_end(count_b);
}

static inline void hal_c2000_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = hal_c2000_now(hal);
    const uint32_t elapsed = hal_c2000_since_valley(hal);
    const uint32_t encoder = c2000_read_long(hal->chip->eqep + EQEP_QPOSCNT);
    hal_c2000_speed_follow(hal, encoder);
    sample->instant = 0;
    hal_c2000_sample_fill(hal, sample, 0, now, elapsed, encoder);
}

static inline void hal_c2000_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t now = hal_c2000_now(hal);
    const uint32_t half = hal->board->half_ticks;
    const uint32_t after_valley = hal_c2000_since_valley(hal);
    /* Past the next valley the count starts again. */
    const uint32_t elapsed = after_valley >= half ? after_valley - half : after_valley + half;
    const uint32_t encoder = c2000_read_long(hal->chip->eqep + EQEP_QPOSCNT);
    sample->instant = IQ24_ONE / 2;
    hal_c2000_sample_fill(hal, sample, 2, now, elapsed, encoder);
}

/*
 * Compare value of a duty: high for the share `duty` of the way to the period. At the period's value both
 * events fall together and the clearing one counts: duty 0. A value that is loaded at zero must be 1 or more
 * (ePWM, "up-down-count mode"): at duty 1 the high side is off for two ticks and the dead time in each
 * period.
 */
static inline uint16_t hal_c2000_compare_of(iq24_t duty, uint32_t half_ticks)
{
    const uint32_t high = (uint32_t)(((uint64_t)(uint32_t)duty * half_ticks + (UINT32_C(1) << 23)) >> 24);
    return (uint16_t)(high >= half_ticks ? 1 : half_ticks - high);
}

/*
 * A trip that no command asked for. The flags of the sources alone do not tell: one was seen to stay 0
 * (TZOSTFLG, F2837xD).
 */
static inline bool hal_c2000_tripped_by_itself(const iqfoc_hal_t *hal)
{
    uint16_t flags = 0;
    uint16_t sources = 0;
    for (uint32_t leg = 0; leg < 3; leg++) {
        flags |= c2000_read(hal->chip->epwm[leg] + EPWM_TZFLG);
        sources |= c2000_read(hal->chip->epwm[leg] + EPWM_TZOSTFLG);
    }
    return (hal->released && (flags & TZ_OST) != 0) || (sources & TZOST_SOURCES) != 0;
}

/* Compare values of all legs, then one write that lets them act together at the next valley. */
static inline void hal_c2000_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    const c2000_chip_t *chip = hal->chip;
    const uint32_t half = hal->board->half_ticks;
    hal->broken = hal->broken || hal_c2000_tripped_by_itself(hal);
    const bool gates = command->gates && !hal->broken;
    c2000_unprotect();
    for (uint32_t leg = 0; leg < 3 && !gates; leg++) {
        (void)c2000_trip(chip->epwm[leg]);
    }
    c2000_write(chip->epwm[0] + EPWM_CMPA, hal_c2000_compare_of(command->duties.high.a, half));
    c2000_write(chip->epwm[1] + EPWM_CMPA, hal_c2000_compare_of(command->duties.high.b, half));
    c2000_write(chip->epwm[2] + EPWM_CMPA, hal_c2000_compare_of(command->duties.high.c, half));
    c2000_write(chip->epwm[0] + EPWM_GLDCTL2, GLDCTL2_LOAD);
    for (uint32_t leg = 0; leg < 3 && gates && !hal->released; leg++) {
        c2000_release(chip->epwm[leg]);
    }
    c2000_protect();
    hal->released = gates;
}

/* At the end of a handler: the converter's flag, then the group's. */
static inline void hal_c2000_acknowledge(iqfoc_hal_t *hal, uint16_t flag, uint16_t group)
{
    c2000_write(hal->chip->adc[0] + ADC_INTFLGCLR, flag);
    c2000_write(hal->chip->pie + PIE_ACK, group);
}

/*
 * The interrupt of ADCA1, all of it: the valley's samples are there. methods: a constant. As
 * iqfoc_isr_valley_by.
 */
IQFOC_STEP void hal_c2000_valley(const iqfoc_methods_t methods, iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = hal_c2000_now(hal);
    hal_c2000_read_valley(hal, &sample);
    if (iqfoc_cycle_valley_by(methods, cycle, &sample, now)) {
        const iqfoc_command_t safe = iqfoc_cycle_safe(cycle->config);
        iqfoc_hal_write(hal, &safe); /* out of line: a trip is rare */
    }
    hal_c2000_acknowledge(hal, INTFLG_1, PIE_GROUP(PIE_GROUP_VALLEY));
}

/* The interrupt of ADCA2: the peak's samples are there. As iqfoc_isr_peak_by. */
IQFOC_STEP void hal_c2000_peak(const iqfoc_methods_t methods, iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = hal_c2000_now(hal);
    hal_c2000_read_peak(hal, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak_by(methods, cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    const uint32_t done = hal_c2000_now(hal);
    if (!iqfoc_cycle_in_time_inline(cycle, sample.time, done) && !iqfoc_cycle_in_time(cycle, &sample, done) &&
        cycle->tripped) {
        command = iqfoc_cycle_safe(cycle->config);
    }
    hal_c2000_write(hal, &command);
    hal_c2000_acknowledge(hal, INTFLG_2, PIE_GROUP(PIE_GROUP_PEAK));
}

#endif
