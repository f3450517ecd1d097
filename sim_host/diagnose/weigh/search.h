/*
 * Which causes: the best set of hypotheses by penalised likelihood.
 *
 * At a state, the evidence of every set is a quadratic form (evidence.h), so that all sets of up to three and
 * the promising larger ones are compared without touching the data again. The best few are then fitted without
 * linearisation, the best of those becomes the new state, and the round repeats until the state stays. Looking
 * at whole sets matters: two effects at once often let a third, wrong one look best alone.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_SEARCH_H
#define SIM_HOST_DIAGNOSE_WEIGH_SEARCH_H

#include "evidence.h"
#include "fitted_sets.h"
#include "teller.h"

/* From s to the best allowed set. `nominal_objective` is that of the motor file's values. `least`: chi square below
 * which no named cause will stand. `fitted`: what earlier searches of the same rows have fitted; this one adds its own. `view`:
 * all zero, or one of the same rows, which may be that of s; left as the last that was looked at. False: out of memory. */
bool search_best(fit_data *d, fit_state *s, hypothesis_set allowed, double nominal_objective, double least,
                 fitted_sets *fitted, evidence_view *view, const diagnose_teller *teller);

/*
 * Takes a hypothesis out of a state. The inductance or the dead time in it stays, to be weighed by itself, if it is above its reporting
 * threshold and allowed.
 */
void search_take_out(const fit_data *d, fit_state *s, hypothesis_id h, hypothesis_set allowed);

/* Takes out the members that turned out too small for a name. True if there were any. */
bool search_drop_small(const fit_data *d, fit_state *s, hypothesis_set allowed);

/* What the sets of two states that were fitted are compared by. False: out of memory. */
bool search_score(fit_data *d, const fit_state *s, double *score);

/* Fits an option from *s without linearisation, and its score; INFINITY if its objective stays above `most`. False: out of memory. */
bool search_fitted(fit_data *d, const evidence_option *option, hypothesis_set allowed, double most,
                   fit_state *s, double *score);

#endif
