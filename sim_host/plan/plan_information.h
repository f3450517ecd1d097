/*
 * What a recording tells of the causes, as the information matrix that a diagnosis would have of it: the sums
 * of the fitted rows at the motor file's values (choose/evidence.h). Runs add.
 */
#ifndef SIM_HOST_PLAN_PLAN_INFORMATION_H
#define SIM_HOST_PLAN_PLAN_INFORMATION_H

#include "data/scenario.h"
#include "diagnose/choose/evidence.h"

/* The parameters that are asked for, each with the hypothesis whose `least` says what of it is worth a name. A
 * voltage's gain is not among them: with R, L and psi_f it moves along a line on which nothing changes. */
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
    diagnose_rows rows;               /* nothing but how many sensors there are */
    hypothesis_set possible;
} plan_information;

/*
 * Runs a scenario in the switching-level drive and looks at the recording. False with *e set if the drive does
 * not follow it (a trip, a shortened voltage) or it is too short to be cut into blocks.
 */
bool plan_information_of(const motor *m, const scenario *s, long seed, plan_information *info, error *e);

/* Control cycles of a scenario, settling ones included. */
double plan_cycles_of(const motor *m, const scenario *s);

#endif
