/*
 * Which few entries of the dictionary account for a voltage: orthogonal matching pursuit on the sums of products, with
 * a price for each term.
 */
#ifndef SIM_HOST_DIAGNOSE_LEARN_TERMS_H
#define SIM_HOST_DIAGNOSE_LEARN_TERMS_H

#include "dictionary.h"

enum { TERMS_MOST = 6 };

/* Over the fitted rows of one operating point. */
typedef struct terms_sums {
    double rows;
    double square[2];        /* of v_d, v_q */
    double with[2][ENTRIES]; /* v times entry */
    double product[ENTRIES][ENTRIES];
} terms_sums;

void terms_add(terms_sums *s, const double entry[ENTRIES], vec_dq v_V);

typedef struct terms_chosen {
    size_t count[2]; /* along d, along q */
    size_t entry[2][TERMS_MOST];
    double value[2][TERMS_MOST];
    size_t strongest_axis, strongest_entry; /* the term of the greatest rms voltage */
} terms_chosen;

/* group[groups]: the operating points; all: their sum. */
terms_chosen terms_choose(const terms_sums *group, size_t groups, const terms_sums *all);

/* The voltage that they say. */
vec_dq terms_voltage(const terms_chosen *t, const double entry[ENTRIES]);

#endif
