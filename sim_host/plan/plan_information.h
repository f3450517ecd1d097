/*
 * The information matrix of a recording, as a diagnosis has it: the sums of the fitted rows at the motor file's
 * values (weigh/evidence.h). Runs add.
 */
#ifndef SIM_HOST_PLAN_PLAN_INFORMATION_H
#define SIM_HOST_PLAN_PLAN_INFORMATION_H

#include "data/scenario.h"
#include "diagnose/weigh/evidence.h"

/*
 * The planned parameters, each with the hypothesis whose `least` is its reporting threshold. A voltage gain is not
 * among them: with R, L and psi_f it moves along a line on which nothing changes.
 */
enum { PLAN_ASKED = 19 };

typedef struct plan_asked {
    const char *name, *unit;
    int column;
    hypothesis_id hypothesis;
} plan_asked;

extern const plan_asked plan_asked_list[PLAN_ASKED];

typedef struct plan_information {
    double h[PLAN_ASKED][PLAN_ASKED]; /* in the columns' z */
    double unit[PLAN_ASKED];          /* a step of 1 in z, in the parameter's own unit */
    evidence_view view;               /* all hypotheses' columns; view.rows is `rows` */
    diagnose_rows rows;               /* the number of sensors only */
    hypothesis_set possible;
} plan_information;

/*
 * Runs a scenario in the switching-level plant and evaluates the recording. False with *e set if the drive does not
 * follow it (a trip, a shortened voltage), or if it is too short for blocks.
 */
bool plan_information_of(const motor *m, const scenario *s, long seed, plan_information *info, error *e);

/* Control cycles of a scenario, settling ones included. */
double plan_cycles_of(const motor *m, const scenario *s);

#endif
