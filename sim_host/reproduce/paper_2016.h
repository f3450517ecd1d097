/* The 2016 paper's figures and tables: Table 1's motors through the six-step scenario of its Section 5. */
#ifndef SIM_HOST_REPRODUCE_PAPER_2016_H
#define SIM_HOST_REPRODUCE_PAPER_2016_H

#include "rows.h"
#include "six_step.h"

enum { PAPER_2016_MOTORS = 3 };

typedef struct paper_2016_motor {
    const char *name;
    double L_H, R_ohm;
} paper_2016_motor;

extern const paper_2016_motor paper_2016_motors[PAPER_2016_MOTORS];

/* The scenario of Figs. 13-15, 0.1 s steady and 0.2 s after the step. */
six_step_scenario paper_2016_scenario(const paper_2016_motor *of);

bool paper_2016_compare(comparison *c, error *e);

#endif
