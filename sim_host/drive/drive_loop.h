/*
 * The one loop of firmware and switching-level drive: `iqfoc simulate`, the studies of closed loops and the
 * emulated processor run it, span by span. A span is the time between two commands of the firmware:
 *
 *     a control cycle of PWM    duties, in force from valley to valley; samples at its valley (start) and its
 *                               peak (middle); the answer to the peak is in force from the next valley, as
 *                               in the 2019 paper, Figs 3 to 5
 *     half a period of PWM      two updates a carrier period: duties, in force for a half; a sample at its
 *                               start, which both calls of the firmware get; the answer is in force in the
 *                               next half
 *     a cycle of a pattern      edges of the legs, in force from valley to valley, with samples as in a cycle of PWM
 *     an interval of six-step   one inverter state for any time; one sample, at its end, with the phases'
 *                               means over it; the answer is in force at once
 *
 * Who wants more than a span's row hangs a watch on the loop.
 */
#ifndef SIM_HOST_DRIVE_DRIVE_LOOP_H
#define SIM_HOST_DRIVE_DRIVE_LOOP_H

#include "firmware.h"

#include "hal_host.h"

/* One span as it was. */
typedef struct drive_row {
    long run;             /* of a scenario; the caller's */
    plant_samples valley; /* what the sensors delivered; not written by an interval */
    plant_samples peak;   /* of an interval: at its end */
    double duty[3];       /* in force during the span; of an interval 0 or 1 */
    plant_means truth;    /* true means over the span, and how long it was */
    drive_answer answer;  /* in force after it */
} drive_row;

/* Looks at the plant between the samples: at the end of each of `points` equal parts of a span. Under PWM an
 * even number, as the peak is one of them. */
typedef struct drive_watch {
    void *context;
    int points; /* 0: no looking */
    void (*point)(void *context, const plant *now);
} drive_watch;

typedef struct drive_loop {
    const drive_firmware *firmware;
    per_unit base;
    plant drive;
    double duty[3];    /* in force from the next span on */
    double interval_s; /* of that span; 0: a control cycle, or a half */
    bool by_edges;     /* the legs switch in it at: */
    iqfoc_pattern_edges_t edges[3];
    int edge[3]; /* the next one of each leg */
    bool halves; /* control cycles are halves of a carrier period: the motor's f_pwm is twice the carrier's */
    bool falling;          /* the next half begins at the peak */
    pwm_updates updates;   /* of a control cycle of several PWM periods (drive_loop_update) */
    double duty_before[3]; /* the command of the span before */
    double in_force[3];    /* what the gates got last */
    drive_watch watch;
} drive_loop;

/* c must have passed plant_config_check. The first span is a control cycle without voltage. */
void drive_loop_begin(drive_loop *l, const motor *m, const plant_config *c, const drive_firmware *firmware);

/* A control cycle is so many PWM periods from now on, each puts the command out again, and the currents are measured that way. */
void drive_loop_update(drive_loop *l, const pwm_updates *updates);

/* What the next span is to be. */
void drive_loop_put(drive_loop *l, const drive_answer *answer);

/* One span with these references (per unit). False with *e set if the firmware is gone. */
bool drive_loop_span(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e);

/*
 * The same in its parts, for who advances l->drive himself: the span's start; its sample, which a control cycle takes at
 * its middle and an interval at its end; its end, the state of l->drive when `close` is called.
 */
bool drive_loop_open(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e);
bool drive_loop_sample(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e);
void drive_loop_close(drive_loop *l, drive_row *row);

#endif
