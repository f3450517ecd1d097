/* The phases of self-commissioning (include/iqfoc/commission.h), each by its own functions. Private to src/. */
#ifndef IQFOC_SRC_COMMISSION_PHASES_H
#define IQFOC_SRC_COMMISSION_PHASES_H

#include "iqfoc/commission.h"

/* First voltage of SEEK's square wave, and its least step. The smallest inductance then grows the current by 1/8 h/4 a step. */
#define COMMISSION_SEEK_STEP IQ24(0.001953125)

/* ---- commission.c: what all phases use ---- */

/* Begins a phase that measures blocks after `wait` cycles. */
void commission_enter(iqfoc_commission_t *c, iqfoc_commission_phase_t phase, uint32_t wait);

/* Begins a block. */
void commission_clear(iqfoc_commission_t *c);

/* The result with its systematic share; ends the run if the value is out of low ... high. */
iqfoc_commission_value_t commission_taken(iqfoc_commission_t *c, iqfoc_commission_value_t found, iq24_t share,
                                          iq24_t low, iq24_t high);

/* ---- commission_steady.c: means at a constant current. Each takes one cycle; i and u in the frame of the current control ---- */

void commission_offset(iqfoc_commission_t *c, const iqfoc_sample_t *sample);
void commission_staircase(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u);
void commission_spin(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u);

/* i_d of the staircase: i_align (2 + level)/5. */
iq24_t commission_level(const iqfoc_commission_t *c);

/* ---- commission_wave.c: the response to a square wave of voltage. Each takes one cycle; i: along the wave ---- */

void commission_seek(iqfoc_commission_t *c, iq24_t i);
void commission_pulses(iqfoc_commission_t *c, iq24_t i, iq24_t across);

/* Half a period of the square wave: 2^n cycles. */
uint32_t commission_half_log2(const iqfoc_commission_t *c);

/* The wave's voltage of the next cycle. */
iq24_t commission_wave(iqfoc_commission_t *c);

#endif
