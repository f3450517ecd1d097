/*
 * The library's HAL on the STM32G474.
 */
#ifndef PORT_STM32G4_HAL_STM32G4_H
#define PORT_STM32G4_HAL_STM32G4_H

#include "iqfoc/hal.h"

#include "stm32g474.h"

/* Valleys over which the speed is taken from the encoder: a power of two. */
#define HAL_SPEED_SPAN 16

/* What differs from board to board; all of it measured or read off a schematic. */
typedef struct hal_stm32g4_board {
    uint32_t half_ticks;      /* clocks from valley to peak, as given to stm32g4_carrier_start */
    int32_t i_offset_a;       /* converter counts at no current of the sensor in phase A: about 2048 */
    int32_t i_offset_b;       /* and of the one in phase B: no two sensors are alike */
    iq24_t i_per_count;       /* per-unit current of one count, |x| <= 2^18; negative: sensors turned round */
    iq24_t u_dc_per_count;    /* per-unit DC-link voltage of one count, 0 < x <= 2^18 */
    uint32_t counts_per_turn; /* encoder edges in a turn of the shaft */
    uint32_t pole_pairs;      /* 1 ... 64 */
    iq24_t theta_offset;      /* electrical angle at encoder count 0, turns */
} hal_stm32g4_board_t;

struct iqfoc_hal {
    const stm32g4_chip_t *chip;
    const hal_stm32g4_board_t *board;
    uint64_t turns_per_count; /* electrical, Q40 */
    /* Q24, rounded down: short by at most 2 half_ticks / 2^24 of itself, 0.2 % at 5 kHz. */
    iq24_t cycles_per_tick;
    uint32_t counts[HAL_SPEED_SPAN];
    uint32_t next;                   /* where in `counts` the next valley's count goes */
    uint32_t seen;                   /* how many are there, up to HAL_SPEED_SPAN */
    iq24_t speed;                    /* electrical speed, turns per control cycle */
    struct hal_stm32g4_edges *edges; /* NULL: the plain carrier (hal_stm32g4_edges.h) */
};

void hal_stm32g4_start(iqfoc_hal_t *hal, const stm32g4_chip_t *chip, const hal_stm32g4_board_t *board);

/* True if the converters last answered to the valley: the counter runs upwards from it. */
static inline bool hal_stm32g4_at_valley(const iqfoc_hal_t *hal)
{
    return (stm32g4_read(&hal->chip->tim1->CR1) & TIM_CR1_DIR) == 0;
}

/* True after the break input stopped the outputs. They stay off until hal_stm32g4_clear_break. */
bool hal_stm32g4_broken(const iqfoc_hal_t *hal);
void hal_stm32g4_clear_break(iqfoc_hal_t *hal);

#endif
