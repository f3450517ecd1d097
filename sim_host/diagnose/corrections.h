/*
 * Corrections of single rows, before the search and after its first round: missed updates, speed lag, sensor faults, DC-link ripple, and
 * the choice of the modulator.
 */
#ifndef SIM_HOST_DIAGNOSE_CORRECTIONS_H
#define SIM_HOST_DIAGNOSE_CORRECTIONS_H

#include "session.h"

/* Corrections that the columns show without a model; w->frame is set. False: out of memory. */
bool corrections_by_columns(session *w);

/*
 * Chooses the modulator of a recording without duties: the effect of a dead time depends on it. *changed: the search must be repeated.
 * False: out of memory.
 */
bool corrections_by_modulator(session *w, bool *changed);

/*
 * Corrections of rows that the drive found so far shows, except those made before. *corrected: number of rows; if any, the search must be
 * repeated. False: out of memory.
 */
bool corrections_by_rows(session *w, size_t *corrected);

/*
 * Corrects the rows for a ripple of the DC link that explains most of the motor file's error. At one speed a search can do the same by a
 * drive that is wrong throughout. False: out of memory.
 */
bool corrections_by_link(session *w);

/* Takes back the corrections that the model's error led to: missed updates and DC-link ripple. False: there is none. */
bool corrections_take_back(diagnose_rows *r);

/* Whether the rows were corrected for a cause. */
bool corrections_of(const diagnose_rows *r, cause_id cause);

#endif
