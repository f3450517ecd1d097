/*
 * Runs the averaged drive along one block of a recording: an observer with a constant gain.
 *
 *     x^(k+1) = advance(x^(k) + gain * (sensed y(k) - x^(k))),      innovation = y(k) - measure(x^(k))
 *
 * gain = 1 is one-cycle prediction from the measured current, and gain = 0 is the open-loop simulation. Between them is the gain of
 * the Kalman filter's steady state. With that gain the innovation is white if the model is right, and least squares on innovations is
 * maximum likelihood (the prediction-error method).
 *
 * Noise of the measured current is on both sides of a one-cycle prediction and would bias R, L and the dead time. Here the regressor
 * is the filtered current, so that noise does no harm.
 *
 * A compensation acts by the sign of a current, and drives the current away from zero: a run that decides it by its own current may
 * stay on the wrong side, and a small change of a parameter may turn it. If a wrong sign changes more than noise does
 * (averaged_drive.sign_is_doubted), the recorded current decides. Where that is so small that noise may have turned it, the next row's
 * innovation along that phase is not counted, and the run takes the recorded current there.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_OBSERVER_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_OBSERVER_H

#include "rows.h"

enum {
    OBSERVER_START = 3,   /* first rows after a start, without innovation: they rest on one or two samples */
    OBSERVER_OUTPUTS = 3, /* alpha, beta, and the mean of three sensors */
    OBSERVER_SIGN_KNOWN =
        4 /* in deviations of a phase's noise: a current's sign is as good as known from there on */
};

/*
 * Whether noise may have turned the sign that decides a compensation of this drive in a cycle that begins with this current. The cycle's
 * error says nothing then.
 */
bool observer_sign_is_unsure(const diagnose_rows *r, const averaged_drive *drive, missing_phase missing,
                             vec_ab i);

/*
 * Writes OBSERVER_OUTPUTS innovations per row of the block; zeros at the start and at outliers, after which the observer starts
 * again. With `gate` > 0, a row whose innovation is longer than the gate (A) is marked as an outlier. `seen` (may be NULL): the share of
 * each row's innovation that is counted, 0 if it has none.
 */
void observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                    const row_block *block, double gain, double gate, double *innovation, double *seen);

/*
 * The run of a drive through one row's cycle: true current at its start and end, and the derivatives of the end by the start (columns
 * by alpha and beta).
 */
typedef struct observer_step {
    vec_ab from_A, to_A;
    vec_ab by_alpha, by_beta;
} observer_step;

/* The cycles of a block's rows, one per row. `same_rotor`: those of a drive whose rotor is at the same places, or NULL. */
void observer_cycles(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                     const row_block *block, const averaged_cycle *same_rotor, averaged_cycle *cycle);

/* The innovations without a gate, from given cycles: of this drive, or of one whose cycles are equal. */
void observer_through(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                      const row_block *block, double gain, double *innovation);

/* The same, and the run: one step per row. */
void observer_way(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                  const row_block *block, double gain, double *innovation, observer_step *way);

/*
 * The innovations of a drive that differs from that of the run `way` through these cycles by a small change of its sensors or its gain
 * only. They are linearised about that run. Neglected is that the iron remembers true currents, which follow from these sensors: up to 0.4 % of a
 * column.
 */
void observer_beside(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                     const row_block *block, double gain, const observer_step *way, double *innovation);

/* Error of the one-cycle prediction (gain 1) into each row, from the recorded row before it, in A. Zero for the first row. */
void observer_one_cycle(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                        size_t first, size_t count, vec_ab *wrong);

/* Open-loop simulation from the recorded current of the first row: the current that the sensors would show. */
void observer_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       size_t first, size_t count, vec_ab *current);

#endif
