/*
 * A ripple of the DC link that no column shows: each cycle then errs along what its own voltage does, by a share that swings
 * with one frequency at every speed.
 *
 * What a cycle's voltage does to its end current is taken from the model, row by row; the error along it, as a share, and
 * across it are two series. A line in the first that is certain, is no order of a run's speed, is of about one size wherever it
 * should be seen, has no counterpart in the second, and reduces the error by enough of the residual beyond the noise, is the link's.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_LINK_RIPPLE_H
#define SIM_HOST_DIAGNOSE_MEASURE_LINK_RIPPLE_H

#include "diagnose/identify/rows.h"

/*
 * What the line takes of the squared error over what it leaves beyond the noise, at least. Below the first it is a line of something
 * else, which the voltage shares a part of. The second is for a drive without any cause: nothing but a ripple takes as much.
 */
#define LINK_RIPPLE_LEAST 0.05
#define LINK_RIPPLE_ALONE 2.5

/*
 * Looks for it by a drive that predicts the recording else, but for a noise of floor_A rms. If there is one, and it takes at least
 * `of_rest`, the rows get the voltage that acted, each piece of the recording by its own size and phase; what they were is kept where
 * the motor file does not know it. The last argument: number of corrected rows. False: out of memory.
 */
bool measure_link_ripple(diagnose_rows *r, const averaged_drive *drive, double floor_A, double of_rest,
                         const motor *file, size_t *corrected);

#endif
