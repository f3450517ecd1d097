/*
 * Pulse modes: the hand-over from a carrier to pulse patterns and to six-step, and back, for drives with few switchings per turn
 * (docs/patterns.md). For non-salient machines.
 *
 * Level 0 is the carrier, fixed or synchronous (synchronous_carrier.h). Each further level is a table of pattern_control.h. The last one
 * may be iqfoc_pattern_six_step. The speed selects the level, with a hysteresis; a limit of the modulation index may be added:
 *
 *     up:    speed >= on   and  index >= index_on       of the level above, one level at a time
 *     down:  speed < off   or   index < index_off       of the present level
 *
 * A hand-over needs a valley at which both modulators have nearly the same flux. After a whole turn, the first valley within 1.2 of the least
 * distance is taken. This limit then rises by 1.5 % with each valley. To a pattern, the distance is the error that its first edges leave,
 * as iqfoc_pattern_control_change has it. To the carrier, it is that of h, whose d component counts half.
 *
 *     carrier to pattern:   e = psi* - psi      trajectory of the pattern less the flux at the next valley: moves the first edges
 *     pattern to carrier:   h = psi - psi_v     the flux at the next valley less that of the carrier: the first voltage is less by h/T
 *
 * In the interrupt of each valley:
 *
 *     iqfoc_pulse_mode_step(&mode, &control, turns, index);
 *     carrier:   iqfoc_cycle_valley and the calls of synchronous_carrier.h
 *                iqfoc_pulse_mode_resume(&control, &cycle);                           at the first valley after a pattern only
 *                if (iqfoc_pulse_mode_to_pattern(&mode, &control, &cycle, high, u_dc, edges)) ...      edges act from the next valley on
 *     pattern:   iqfoc_pattern_control_aim
 *                if (iqfoc_pulse_mode_to_carrier(&mode, &control, &cycle, &set, i, theta, u_dc, edges, &duties)) ...       duties do
 *                else ...                                                             edges do, as after iqfoc_pattern_control_step
 *
 * The caller owns the state; one context at a time may call its functions.
 */
#ifndef IQFOC_PULSE_MODE_H
#define IQFOC_PULSE_MODE_H

#include "cycle.h"
#include "pattern_control.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_PULSE_LEVELS_MAX 8

/* Largest control cycle of the patterns, ticks. */
#define IQFOC_PULSE_TICKS_MAX UINT32_C(16777215)

/* Six-step as a pattern: one pulse per turn. */
extern const iqfoc_pattern_t iqfoc_pattern_six_step;

/* Speeds: magnitude, turns per control cycle of the patterns. */
typedef struct iqfoc_pulse_level {
    const iqfoc_pattern_t *table; /* level 0: NULL, the carrier */
    iq24_t on;  /* from the level before, at this speed and above: 1/128 ... 1/8; level 0: not used */
    iq24_t off; /* back to the level before, below this speed: 0 ... on, on excluded; level 0: not used */
    iq24_t index_on;  /* and at this index and above: 0 ... 2; 0: by the speed alone */
    iq24_t index_off; /* back also below this index: 0 ... index_on */
} iqfoc_pulse_level_t;

/* Fixed while it runs. */
typedef struct iqfoc_pulse_config {
    const iqfoc_pulse_level_t *level; /* `on` and `off` do not fall from level to level */
    int32_t levels;                   /* 2 ... IQFOC_PULSE_LEVELS_MAX */
    uint32_t period_ticks;            /* control cycle of the patterns: 1 ... IQFOC_PULSE_TICKS_MAX */
} iqfoc_pulse_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_pulse_mode {
    const iqfoc_pulse_config_t *config;
    int32_t level;          /* that acts: 0 ... levels - 1 */
    int32_t wanted;         /* the same, or one next to it during a hand-over */
    iq24_t speed;           /* of the last step, held to +-1/8 */
    iq24_t waited;          /* movement since a hand-over from or to the carrier began: turns, 0 ... 3 */
    iq24_acc_t nearest_q48; /* square of the least distance since then */
} iqfoc_pulse_mode_t;

/*
 * Checks the configuration and starts with level 0. config, its levels and tables must outlive the object. IQFOC_ERROR_NULL: a pointer is
 * missing, that of a table included; IQFOC_ERROR_PULSE_MODE: a value is out of its range; IQFOC_ERROR_PATTERN: iqfoc_pattern_init
 * refuses a table. Call it ahead of the first interrupt.
 */
iqfoc_error_t iqfoc_pulse_mode_init(iqfoc_pulse_mode_t *mode, const iqfoc_pulse_config_t *config);

/*
 * At each valley, ahead of the other functions: the wanted level. It starts and ends a change between tables, by
 * iqfoc_pattern_control_change. Exact.
 *
 * speed: the rotor's movement in a control cycle of the patterns, any. index: of the voltage that the drive needs without weakening, any;
 * not used if no level has index_on.
 */
void iqfoc_pulse_mode_step(iqfoc_pulse_mode_t *mode, iqfoc_pattern_control_t *control, iq24_t speed,
                           iq24_t index);

/*
 * Carrier to pattern, at each valley after iqfoc_cycle_valley. Returns true if `edges` act from the next valley on, with control cycles of
 * `period_ticks`. The duties of the peak are then not used. While no pattern is wanted, it does nothing.
 *
 * control: from iqfoc_pattern_control_init; its disturbance voltage stays as it was. cycle: in steady operation, with a predicted i_next,
 * |component| <= 8, and |i_ref| <= 8. high: the duties of the cycle that begins, 0 ... 1. u_dc: 0.5 ... 1.5. edges: legs a, b, c.
 *
 * Errors as iqfoc_pattern_control_aim and iqfoc_pattern_control_step, and that of cycle->i_next.
 */
bool iqfoc_pulse_mode_to_pattern(iqfoc_pulse_mode_t *mode, iqfoc_pattern_control_t *control,
                                 const iqfoc_cycle_t *cycle, iqfoc_abc_t high, iq24_t u_dc,
                                 iqfoc_pattern_edges_t edges[3]);

/*
 * Pattern to carrier, at each valley in place of iqfoc_pattern_control_step. Returns true if `duties` act from the next valley on, for one
 * period of `set`; otherwise `edges` act. It waits until each leg that is high may fall at the valley, too.
 *
 *     u_dq = (R i_ref - v + decoupling(i_ref))/s1 - (x (i - i_ref/s1^2) - emf (1/s1^2 - 1))/(2 pi) e^(-j phi/2)
 *
 * i on the right: rotor frame, at the next valley. phi, s1: of the period (valley_reference.h). u_dq is held to +-8 a component.
 *
 * set: parameters for the first period, from iqfoc_synchronous_carrier_set; cycle->offered becomes it. i, theta, u_dc, edges: as
 * iqfoc_pattern_control_step. |i_ref| <= 8. duties.scale < 1: the voltage was too long.
 *
 * Largest error of 200000 drawn with |i| <= 2, x <= 8 and emf <= 8, against the formula in double: 25 LSB.
 */
bool iqfoc_pulse_mode_to_carrier(iqfoc_pulse_mode_t *mode, iqfoc_pattern_control_t *control,
                                 iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *set, iqfoc_ab_t i,
                                 iq24_t theta, iq24_t u_dc, iqfoc_pattern_edges_t edges[3],
                                 iqfoc_duties_t *duties);

/*
 * At the first valley of the carrier after a pattern, after iqfoc_cycle_valley: replaces the voltage of the PI controller by the steady one
 * (R i_ref - v + decoupling(i_ref))/s1, and sets the integrators to it. The first voltage has already corrected the flux that the
 * controller sees as an error. The functions at the valley control the voltage for all means but IQFOC_FEEDBACK_CORRECTED_MEAN.
 *
 * Largest error of those 200000 drawn: 3 LSB.
 */
void iqfoc_pulse_mode_resume(const iqfoc_pattern_control_t *control, iqfoc_cycle_t *cycle);

#ifdef __cplusplus
}
#endif

#endif
