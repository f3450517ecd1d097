/*
 * What the recording cannot tell apart.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_CONFUSION_H
#define SIM_HOST_DIAGNOSE_WEIGH_CONFUSION_H

#include "certainty.h"
#include "diagnose/result.h"
#include "evidence.h"

/*
 * Whether `other` could take the place of `member` of the state's set, with all others refitted, at a cost
 * that the noise (times `inflation`) would hide. `own_cost` is the cost of the set as it is.
 */
bool confusion_of(const evidence_view *view, const fit_state *s, double own_cost, hypothesis_id member,
                  hypothesis_id other, double inflation);

/*
 * For each named cause: the hypotheses that could take its place, with all others refitted, at a cost that
 * the noise (times `inflation`) would hide. `member` lists the set's hypotheses in the order of d->cause.
 */
void confusion_find(diagnosis *d, const evidence_view *view, const fit_state *s, const hypothesis_id *member,
                    hypothesis_set possible, double inflation);

/*
 * What trades exactly: for each named cause that scales something, the smallest set of two or three other scalings
 * that could take its place at a cost that the noise would hide, in d->cause[].trade. Voltage gain, R and psi
 * together, say, do what an inductance does.
 */
void confusion_trades(diagnosis *d, const evidence_view *view, const fit_state *s,
                      const hypothesis_id *member, hypothesis_set possible, double inflation);

#endif
