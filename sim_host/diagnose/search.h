/*
 * Which causes: the best set of hypotheses by penalised likelihood.
 *
 * At a state, the sums of fit_grams over all columns give the cost of every set of hypotheses as a quadratic
 * form, so that all sets of up to three and the promising larger ones are compared without touching the data
 * again. The best few are then fitted without linearisation, the best of those becomes the new state, and the
 * round repeats until the state stays. Looking at whole sets matters: two effects at once often let a third,
 * wrong one look best alone.
 */
#ifndef SIM_HOST_DIAGNOSE_SEARCH_H
#define SIM_HOST_DIAGNOSE_SEARCH_H

#include "fit.h"

#include <stdio.h>

/* All columns' sums at a state, and what follows from them. */
typedef struct search_view {
    bool two_sensors;
    double explained; /* what the state takes off the motor file's -2 log likelihood; set by search_best */
    gram total;       /* over the fit blocks */
    double to_nominal[COLUMN_COUNT]; /* step that takes every unit column back to the motor file (nuisances
                                        excepted) */
} search_view;

typedef struct search_option {
    hypothesis_set set;
    double cost;  /* chi square the set leaves */
    double score; /* that, its penalty and how unusual it is: what is compared */
    double z[P_COUNT];
} search_option;

/* False: out of memory. */
bool search_look(fit_data *d, const fit_state *s, search_view *view);

/*
 * The cost of a set at the view, and where its optimum lies. False if two of its columns cannot be told
 * apart, or the optimum is not physical (a negative dead time).
 */
bool search_cost(const search_view *view, const fit_state *s, hypothesis_set set, search_option *option);

/* The least that h must explain beside a set's other members, in the measure of what all of them explain. */
double search_least(double explained, hypothesis_set set, hypothesis_id h);

/* What a set pays for its causes, its parameters and their surprise, in chi square. With two sensors a gain
 * of the third is no parameter. */
double search_penalty(const search_view *view, hypothesis_set set);

/* From s to the best allowed set. `nominal_objective` is that of the motor file's values. `trace` may be
 * NULL. */
bool search_best(fit_data *d, fit_state *s, hypothesis_set allowed, double nominal_objective, FILE *trace);

/* A set as text: "dead_time + resistance". */
const char *search_words(hypothesis_set set, char *text, size_t size);

#endif
