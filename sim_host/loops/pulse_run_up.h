/*
 * A drive through all pulse modes and back: carrier, synchronous carrier, patterns of 9, 7 and 5 pulses, six-step. The library's fixed
 * point (iqfoc/pulse_mode.h) controls a switching machine without saliency, whose current is solved exactly from edge to edge.
 *
 * Currents are shares of the rated peak. Without saliency i_q is the torque. The speed that selects the mode has noise.
 */
#ifndef SIM_HOST_LOOPS_PULSE_RUN_UP_H
#define SIM_HOST_LOOPS_PULSE_RUN_UP_H

#include "data/motor.h"
#include "patterns/patterns.h"

#include "iqfoc/pulse_mode.h"

#include <stdint.h>

enum {
    PULSE_DRIVES = 2,
    PULSE_TABLES = 3,
    PULSE_LEVELS = 2 + PULSE_TABLES, /* of pulse_mode.h: carrier, tables, six-step */
    PULSE_POINTS = 1000,
    PULSE_TRACE = 4000
};

/* Space vectors with a fixed carrier, with so many periods a turn; patterns with so many pulses; six-step. */
typedef enum pulse_run_mode {
    PULSE_FIXED,
    PULSE_CARRIER_21,
    PULSE_CARRIER_15,
    PULSE_CARRIER_9,
    PULSE_PATTERN_9,
    PULSE_PATTERN_7,
    PULSE_PATTERN_5,
    PULSE_SIX_STEP,
    PULSE_RUN_MODES
} pulse_run_mode;

extern const char *const pulse_run_mode_text[PULSE_RUN_MODES];
/* Pulses of a leg in a turn; 0: not fixed. */
extern const int pulse_run_mode_pulses[PULSE_RUN_MODES];

typedef struct pulse_drive {
    const char *key, *text;
    motor m;                                                  /* f_pwm_Hz: of the fixed carrier */
    iqfoc_feedback_t feedback;                                /* the mean that the carrier controls */
    double pattern_s;                                         /* control cycle of the patterns */
    double high_Hz;                                           /* at the top */
    double on_Hz[PULSE_LEVELS - 1], off_Hz[PULSE_LEVELS - 1]; /* of 9, 7, 5 pulses and six-step */
} pulse_drive;

typedef enum pulse_drive_id { PULSE_DRIVE_2019, PULSE_DRIVE_400_KW } pulse_drive_id;

pulse_drive pulse_drive_of(pulse_drive_id id);

/* The firmware's tables, which fit any machine without saliency. */
typedef struct pulse_tables {
    iqfoc_pattern_row_t row[PULSE_TABLES][PATTERNS_ROWS];
    iqfoc_pattern_t of[PULSE_TABLES];
} pulse_tables;

bool pulse_tables_find(pulse_tables *t, error *e);

typedef struct pulse_case {
    double low_Hz; /* at both ends */
    double ramp_s; /* from there to the top */
    double i_q;
    bool ripple;     /* of the link: +-PULSE_RIPPLE */
    double way;      /* of rotation: 1 or -1 */
    double angle;    /* of the rotor at the start, turns */
    double early_Hz; /* the level is that of a speed so much higher */
} pulse_case;

#define PULSE_RIPPLE 0.01
#define PULSE_LINEAR 0.99  /* index up to which the patterns are used */
#define PULSE_RETURN 0.985 /* index below which six-step ends */
#define PULSE_LEAST  0.05  /* time between two edges of a leg: control cycles of the patterns */

/* What is within a turn of an instant. */
typedef enum pulse_event {
    PULSE_EVENT_CARRIER,
    PULSE_EVENT_TO_PATTERN,
    PULSE_EVENT_TO_CARRIER,
    PULSE_EVENT_PATTERNS,
    PULSE_EVENT_TO_SIX_STEP,
    PULSE_EVENT_FROM_SIX_STEP,
    PULSE_EVENT_JUMP,
    PULSE_EVENT_TOP,
    PULSE_EVENTS
} pulse_event;

/* Whole turns in one mode, at least one turn after it began. */
typedef struct pulse_point {
    double hz;
    pulse_run_mode mode;
    bool up;
    double distortion; /* share of the rated current, rms */
    double
        space_vectors; /* the same by carrier_ripple, with as many pulses a turn at this voltage; NAN: not possible */
    double pulses;       /* of a leg, a turn */
    double switching_Hz; /* pulses of a leg a second */
} pulse_point;

/* The largest torque error within some milliseconds, percent of the rated torque, with its sign. */
typedef struct pulse_error {
    double hz, percent;
    bool up;
} pulse_error;

/* A mode in the run; NAN where a value is not defined. */
typedef struct pulse_row {
    int visits_up, visits_down;
    double from_Hz, to_Hz;            /* on the way up */
    double down_to_Hz;                /* left there on the way down */
    double switching_Hz;              /* the largest of its points */
    double distortion, space_vectors; /* rms of its points that have both; of all if none has */
    double torque_percent;            /* largest error of the rated torque */
} pulse_row;

typedef struct pulse_run_up {
    pulse_point point[PULSE_POINTS];
    int points;
    pulse_error trace[PULSE_TRACE];
    int traced;
    pulse_row mode[PULSE_RUN_MODES];
    double worst_percent[PULSE_EVENTS]; /* torque error, of the rated torque */
    double shortest_s;                  /* time between two edges of a leg */
    int highest, changes, last;         /* levels of pulse_mode.h */
    uint32_t status;                    /* of the cycle at the end */
    long refused; /* calls that the library refused, and voltages of a hand-over that were too long */
} pulse_run_up;

/* The mean torque about an instant, less the reference. */
typedef struct pulse_torque {
    double percent; /* of the rated torque */
    double turn_s;
    pulse_run_mode mode;
} pulse_torque;

#define PULSE_TORQUE_S 5e-5 /* from one to the next */

/* False with *e set if the firmware's parameters do not fit, or memory runs out. */
bool pulse_run_up_run(const pulse_drive *p, const pulse_tables *t, const pulse_case *c, pulse_run_up *result,
                      error *e);

/* The torque of the same run, at most `capacity` instants from the same one on in each run; returns their number, -1 with *e set. */
long pulse_run_up_torque(const pulse_drive *p, const pulse_tables *t, const pulse_case *c,
                         pulse_torque *torque, long capacity, error *e);

#endif
