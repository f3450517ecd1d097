/*
 * What the recording cannot tell apart, and what to record so that it could.
 */
#ifndef SIM_HOST_DIAGNOSE_CONFUSION_H
#define SIM_HOST_DIAGNOSE_CONFUSION_H

#include "certainty.h"
#include "diagnose_result.h"
#include "search.h"

/*
 * Whether `other` could take the place of `member` of the state's set, with all others refitted, at a cost
 * that the noise (times `inflation`) would hide. `own_cost` is the cost of the set as it is.
 */
bool confusion_of(const search_view *view, const fit_state *s, double own_cost, hypothesis_id member,
                  hypothesis_id other, double inflation);

/*
 * For each named cause: the hypotheses that could take its place, with all others refitted, at a cost that
 * the noise (times `inflation`) would hide. `member` lists the set's hypotheses in the order of d->cause.
 */
void confusion_find(diagnosis *d, const search_view *view, const fit_state *s, const hypothesis_id *member,
                    hypothesis_set possible, double inflation);

/* One or two sentences: the experiment that would separate what is confused, or show what is unexplained.
 * `set` is what was fitted, effects without a name among it. */
void confusion_advise(diagnosis *d, const diagnose_rows *r, hypothesis_set set);

#endif
