/*
 * What a recording is asked: numbers, and the columns that are free beside them.
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_QUESTION_H
#define SIM_HOST_DIAGNOSE_NEXT_QUESTION_H

#include "diagnose/choose/evidence.h"
#include "diagnose/choose/session.h"
#include "diagnose/result.h"

typedef struct question {
    const session *w;
    const evidence_view *view;
    size_t columns;
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT]; /* the precision of what is known beforehand */
    size_t numbers;
    const motor_value *number[DIAGNOSIS_ESTIMATES];
    double by[DIAGNOSIS_ESTIMATES][COLUMN_COUNT]; /* what a step of 1 along each column changes of it */
    double enough[DIAGNOSIS_ESTIMATES]; /* of what is not excited: the half width that would be one */
    hypothesis_id pair[2];              /* the two that are confused; H_COUNT: numbers are asked */
    double at[2][HYPOTHESIS_COLUMNS];   /* where each would lie, were it the true one */
} question;

/* What is known of the numbers. */
typedef struct answer {
    double half_width[DIAGNOSIS_ESTIMATES]; /* 95 %, in their units */
    double correlation;                     /* of a pair's */
    double apart; /* chi square by which the one of a pair would lose the other's place that loses less */
} answer;

/* A named cause and one that could take its place. False if no experiment of pieces could tell these two apart: one
 * contains the other, or they follow time or temperature. */
bool question_of_pair(question *q, const session *w, const evidence_view *view, hypothesis_id member,
                      cause_id other);

/* The numbers that are not excited. False if there are none. */
bool question_of_estimates(question *q, const session *w, const evidence_view *view, const diagnosis *d);

/* What this recording and so many cycles of another tell, each of the information `more`. False if that cannot be said. */
bool question_ask(const question *q, const double more[COLUMN_COUNT][COLUMN_COUNT], double cycles,
                  answer *out);

#endif
