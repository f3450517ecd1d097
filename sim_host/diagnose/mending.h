/*
 * What the rows are mended of, ahead of the search and after its first round (identify/mended.h).
 */
#ifndef SIM_HOST_DIAGNOSE_MENDING_H
#define SIM_HOST_DIAGNOSE_MENDING_H

#include "choose/session.h"

#include <stdio.h>

/* What the columns tell by themselves; w->frame is set. False: out of memory. */
bool mending_by_columns(session *w, const motor *file, hypothesis_set skip, FILE *trace);

/* Without duties a dead time depends on which modulator made them: chosen beside the dead time that the session has found.
 * *changed: all is to be searched again. False: out of memory. */
bool mending_by_modulator(session *w, FILE *trace, bool *changed);

/* What the rows tell one by one beside the drive that the session has found, but for what they were mended of before. *mended:
 * how many rows; then all is to be searched again. False: out of memory. */
bool mending_by_rows(session *w, const motor *file, hypothesis_set skip, FILE *trace, size_t *mended);

/* Whether the rows were mended of a cause. */
bool mending_of(const diagnose_rows *r, cause_id cause);

#endif
