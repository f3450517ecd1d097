/*
 * iqfoc's HAL on the STM32F405, with three low-side shunts, an encoder with index, and one trigger a period: at the
 * valley. What of it is the same on any chip is in iqfoc: shunts, encoder, tracker.
 */
#ifndef HAL_STM32F405_H
#define HAL_STM32F405_H

#include "stm32f405.h"

#include "iqfoc/encoder.h"
#include "iqfoc/hal.h"
#include "iqfoc/shunts.h"
#include "iqfoc/tracker.h"

/* What differs from board to board; measured, or read off a schematic. */
typedef struct hal_board {
    uint32_t half_ticks; /* of TIM1 from valley to peak: 100 ... 65534 */
    int32_t i_zero;      /* converter counts at no current, nominal: what is left is calibrated */
    iq24_t
        i_per_count; /* per-unit current of a count, |x| <= 2^18; negative if a current into the motor reads low */
    iq24_t u_dc_per_count; /* per-unit DC link of a count, 0 < x <= 2^18 */
    iqfoc_shunts_t shunts;
    iqfoc_encoder_config_t encoder;
    iqfoc_tracker_config_t tracker;
} hal_board_t;

struct iqfoc_hal {
    const stm32f405_chip_t *chip;
    const hal_board_t *board;
    iqfoc_encoder_t encoder;
    iqfoc_tracker_t tracker;
    iqfoc_abc_t i_offset;    /* subtracted: 0 until it is calibrated */
    iqfoc_abc_t i_predicted; /* for shunts that cannot be read: the cycle's prediction for the next valley */
    iqfoc_abc_t written;     /* duties that act from the next valley on */
    iqfoc_abc_t in_force;    /* and those that act in the cycle that runs */
    uint32_t count;          /* the encoder's, at the last read */
    iqfoc_sample_t sample;   /* of the last valley */
};

/* False if the board's values do not fit. */
bool hal_start(iqfoc_hal_t *hal, const stm32f405_chip_t *chip, const hal_board_t *board);

/* The break input: did it stop the outputs, is it still active, let them come on again. */
bool hal_broken(const iqfoc_hal_t *hal);
bool hal_break_active(const iqfoc_hal_t *hal);
void hal_clear_break(iqfoc_hal_t *hal);

#endif
