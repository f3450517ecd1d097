/*
 * The open numbers of a recording, and the columns that are free in addition.
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_QUESTION_H
#define SIM_HOST_DIAGNOSE_NEXT_QUESTION_H

#include "diagnose/result.h"
#include "diagnose/session.h"
#include "diagnose/weigh/evidence.h"

typedef struct question {
    const session *w;
    const evidence_view *view;
    size_t columns;
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT]; /* the precision known beforehand */
    size_t numbers;
    const motor_value *number[DIAGNOSIS_ESTIMATES];
    double by[DIAGNOSIS_ESTIMATES][COLUMN_COUNT]; /* its change for a step of 1 along each column */
    double enough[DIAGNOSIS_ESTIMATES];           /* half width that counts as excited */
    hypothesis_id pair[2];            /* the pair that is not distinguishable; H_COUNT: numbers are open */
    double at[2][HYPOTHESIS_COLUMNS]; /* the place of each if it were the true one */
} question;

/* Uncertainty of the numbers. */
typedef struct answer {
    double half_width[DIAGNOSIS_ESTIMATES]; /* 95 %, in their units */
    double correlation;                     /* of a pair's */
    double apart; /* chi square that separates the pair, the smaller of both directions */
} answer;

/*
 * A named cause and one that could take its place. False if no segment could separate them: one contains the other, or they depend on
 * time or temperature.
 */
bool question_of_pair(question *q, const session *w, const evidence_view *view, hypothesis_id member,
                      cause_id other);

/* The numbers that are not excited. False if there are none. */
bool question_of_estimates(question *q, const session *w, const evidence_view *view, const diagnosis *d);

/* The uncertainty after this recording and `cycles` cycles of another, each with the information `more`. False if it is singular. */
bool question_ask(const question *q, const double more[COLUMN_COUNT][COLUMN_COUNT], double cycles,
                  answer *out);

#endif
