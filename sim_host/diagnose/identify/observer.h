/*
 * One block of a recording against the averaged drive: prediction with a constant-gain observer.
 *
 *     x^(k+1) = advance(x^(k) + gain * (sensed y(k) - x^(k))),      innovation = y(k) - measure(x^(k))
 *
 * gain = 1 is one-cycle prediction from the measured current; gain = 0 is the free run. In between lies the
 * Kalman filter's steady state, and with that gain the innovation is white when the model is right: then
 * least squares on innovations is maximum likelihood (the prediction-error method), and noise on the measured
 * current, which enters both sides of a one-cycle prediction and would bias R, L and the dead time, does no
 * harm: the regressor is the filtered current.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_OBSERVER_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_OBSERVER_H

#include "rows.h"

enum {
    OBSERVER_START = 3,  /* rows at a block's start that rest on a current of one or two samples: left out */
    OBSERVER_OUTPUTS = 3 /* alpha, beta, and the mean of three sensors */
};

/*
 * Writes OBSERVER_OUTPUTS innovations per row of the block; zeros at the start and at outliers, where the
 * observer starts anew. With `gate` > 0 rows whose innovation exceeds gate (A, length) are marked as outliers
 * on the way. `seen` (may be NULL): 1 for each row that has an innovation.
 */
void observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                    const row_block *block, double gain, double gate, double *innovation,
                    unsigned char *seen);

/* Where a drive went in one row's cycle, and how far it would have gone from beside: d to / d from, columns by alpha and beta. */
typedef struct observer_step {
    vec_ab from_A, to_A;
    vec_ab by_alpha, by_beta;
} observer_step;

/* The cycles of a block's rows: one a row. */
void observer_cycles(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                     const row_block *block, averaged_cycle *cycle);

/* The innovations without a gate, through cycles that are there: of this drive or of one whose cycles are alike. */
void observer_through(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                      const row_block *block, double gain, double *innovation);

/* The same, and the way: one step a row. */
void observer_way(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                  const row_block *block, double gain, double *innovation, observer_step *way);

/*
 * The same of a drive that differs from the way's by a little, and by its sensors or its gain alone: it goes beside that one. (That
 * the iron remembers true currents by these sensors is left out: up to 0.4 % of a column.)
 */
void observer_beside(diagnose_rows *r, const averaged_drive *drive, const row_block *block, double gain,
                     const observer_step *way, double *innovation);

/* Error of the one-cycle prediction into each row from the recorded row before it (gain 1), two numbers per
 * row; zero for the first. */
void observer_one_cycle(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                        size_t first, size_t count, vec_ab *wrong);

/* The free run from the recorded current of the first row: what the sensors would show. */
void observer_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       size_t first, size_t count, vec_ab *current);

#endif
