/*
 * The evidence for a set of hypotheses: what it leaves of the likelihood, and what it must pay, as a quadratic
 * form in the sums of one view of the data.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_EVIDENCE_H
#define SIM_HOST_DIAGNOSE_WEIGH_EVIDENCE_H

#include "diagnose/identify/last_digits.h"

/* All columns' sums at a state, and what follows from them. */
typedef struct evidence_view {
    /* It is of this state, for sets of these hypotheses; where rows have changed the caller takes that back. */
    bool stands;
    bool searches; /* as in fit_data */
    fit_state of;
    hypothesis_set allowed;
    const diagnose_rows *rows;
    const coordinate_frame *frame;
    edge_law edge;
    double of_least;  /* as in coordinate_frame */
    double explained; /* by what the state reduces the motor file's -2 log likelihood; set by the search */
    double least;     /* what a named cause must explain at the least, by what is left; set by the search */
    double worth;     /* reduction by the tolerances of the state's laws (tolerance.h) */
    double scatter[CAUSE_COUNT];     /* by what share effects differ between operating points (tolerance.h) */
    gram sums;                       /* over the fit blocks, deflated by what the laws may err by */
    gram total;                      /* these, deflated by what may move unnamed */
    double to_nominal[COLUMN_COUNT]; /* step that takes every unit column back to the motor file (nuisances
                                        excepted) */
} evidence_view;

typedef struct evidence_option {
    hypothesis_set set;
    double cost;  /* chi square the set leaves */
    double score; /* that, its penalty and how unusual it is: what is compared */
    double z[P_COUNT];
} evidence_option;

/*
 * For sets of the `allowed` hypotheses: what none of them moves is not looked at. A valid view, of the same state and for
 * these hypotheses at the least, is not made again. False: out of memory, and it is no longer valid.
 */
bool evidence_look(fit_data *d, const fit_state *s, hypothesis_set allowed, evidence_view *view);

/*
 * The view without the tolerance of what h moves: for sets that do without it. A value beyond `least` is no last digit, and
 * what the prior of these would take of it (three deviations at the most) is not distinguished here.
 */
void evidence_hold(const evidence_view *view, hypothesis_id h, evidence_view *held);

/* Whether two states are one, to the last bit: the sums of two neighbouring ones differ. */
bool evidence_is_same(const fit_state *a, const fit_state *b);

/*
 * The cost of a set at the view, and where its optimum lies. False if the set is no choice: its optimum is not
 * physical (a negative dead time) or too small for a name, or two of its columns are not distinguishable; in that
 * last case the option is the one without a step, its score infinite. A set that is the same drive as another has the cost of that one,
 * as the sums, a parabola about the state, would give it more.
 */
bool evidence_cost(const evidence_view *view, const fit_state *s, hypothesis_set set,
                   evidence_option *option);

/* The least that h must explain in addition to a set's other members, in the measure of what all of them explain. */
double evidence_least(double explained, hypothesis_set set, hypothesis_id h);

/* What a set pays for its causes, its parameters and their surprise, in chi square. With two sensors a gain
 * of the third is no parameter. */
double evidence_penalty(const evidence_view *view, hypothesis_set set);

/* That, with how unusual the sizes at z are, and what is more than one cause by its values. */
double evidence_price(const evidence_view *view, hypothesis_set set, const double z[P_COUNT]);

/* A set as text: "dead_time + resistance". */
const char *evidence_words(hypothesis_set set, char *text, size_t size);

#endif
