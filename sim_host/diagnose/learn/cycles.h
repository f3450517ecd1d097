/*
 * What the extended drive leaves, cycle by cycle, as a voltage seen from the rotor in the cycle's middle:
 *
 *     v = L (measured - predicted) / T,     L = (L_d, L_q) in the rotor frame at the cycle's end
 */
#ifndef SIM_HOST_DIAGNOSE_LEARN_CYCLES_H
#define SIM_HOST_DIAGNOSE_LEARN_CYCLES_H

#include "diagnose/identify/rows.h"
#include "dictionary.h"

typedef struct learn_left {
    learn_cycle cycle;
    vec_dq v_V;
    vec_ab wrong_A; /* that voltage's one-cycle error */
    vec_rotor end;  /* electrical angle at the cycle's end */
    bool glitch;    /* marked by the fit: not to learn from */
} learn_left;

typedef struct learn_model {
    const diagnose_rows *rows;
    const averaged_drive *drive;
    const averaged_node *nodes;
    int pole_pairs;
} learn_model;

/* The cycles that end in rows 1 ... count - 1 of a block: those of the one-cycle error. `wrong` has room for count + 1 of
 * them. Returns their number. */
size_t cycles_of(const learn_model *m, const row_block *block, vec_ab *wrong, learn_left *out);

/* The one-cycle error that a voltage would have made in this cycle. */
vec_ab cycles_error(const learn_model *m, const learn_left *left, vec_dq v_V);

#endif
