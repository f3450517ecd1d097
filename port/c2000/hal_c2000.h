/*
 * The library's HAL on the F28004x and F2837xD.
 */
#ifndef PORT_C2000_HAL_C2000_H
#define PORT_C2000_HAL_C2000_H

#include "iqfoc/hal.h"

#include "c2000.h"

/* Valleys over which the speed is taken from the encoder: a power of two. */
#define HAL_SPEED_SPAN 16

/* What differs from board to board; all of it measured or read off a schematic. */
typedef struct hal_c2000_board {
    uint32_t half_ticks;      /* of 10 ns from valley to peak, as given to c2000_carrier_start */
    int32_t i_offset_a;       /* converter counts at no current of the sensor in phase A: about 2048 */
    int32_t i_offset_b;       /* and of the one in phase B */
    iq24_t i_per_count;       /* per-unit current of one count, |x| <= 2^18; negative: sensors turned round */
    iq24_t u_dc_per_count;    /* per-unit DC-link voltage of one count, 0 < x <= 2^18 */
    uint32_t counts_per_turn; /* encoder edges in a turn of the shaft */
    uint32_t pole_pairs;      /* 1 ... 64 */
    iq24_t theta_offset;      /* electrical angle at encoder count 0, turns */
} hal_c2000_board_t;

struct iqfoc_hal {
    const c2000_chip_t *chip;
    const hal_c2000_board_t *board;
    uint64_t turns_per_count; /* electrical, Q40 */
    /* Q24, rounded down: short by at most 2 half_ticks / 2^24 of itself, 0.1 % at 5 kHz. */
    iq24_t cycles_per_tick;
    uint32_t counts[HAL_SPEED_SPAN];
    uint32_t next;       /* where in `counts` the next valley's count goes */
    uint32_t seen;       /* how many are there, up to HAL_SPEED_SPAN */
    iq24_t speed;        /* electrical speed, turns per control cycle */
    iq24_t theta_offset; /* electrical angle at encoder count 0, turns: the board's until hal_c2000_align */
    iqfoc_abc_t i_zero;  /* subtracted from the currents: 0 until hal_c2000_set_offset */
    bool released;       /* the last command let the outputs on */
    bool broken;         /* a trip that no command asked for stopped them */
};

/* After c2000_carrier_start: the outputs are tripped. */
void hal_c2000_start(iqfoc_hal_t *hal, const c2000_chip_t *chip, const hal_c2000_board_t *board);

/* From now on the currents are less by these, per unit, |x| <= 1: what the sensors read at no current. */
void hal_c2000_set_offset(iqfoc_hal_t *hal, iqfoc_abc_t offset);

/*
 * At the last valley that was read the electrical angle was theta, in turns. Call it at standstill or slow
 * speed.
 */
void hal_c2000_align(iqfoc_hal_t *hal, iq24_t theta);

/* True after both signals of the encoder changed at once: counts may be lost. */
bool hal_c2000_encoder_faulty(const iqfoc_hal_t *hal);

/*
 * True after the break line, a lost clock or a halted core stopped the outputs: from the next command on.
 * They stay off until hal_c2000_clear_break.
 */
bool hal_c2000_broken(const iqfoc_hal_t *hal);
void hal_c2000_clear_break(iqfoc_hal_t *hal);

#endif
