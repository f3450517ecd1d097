/*
 * The rows of the comparison: a figure of a paper and this project's values, in double precision and from the IQ24
 * firmware. Printed as aligned tables and written as JSON.
 */
#ifndef SIM_HOST_REPRODUCE_ROWS_H
#define SIM_HOST_REPRODUCE_ROWS_H

#include "../base/error.h"
#include "base/json.h"

#include <stddef.h>
#include <stdio.h>

typedef struct comparison_row {
    const char *paper;     /* "2016", "2019" */
    const char *item;      /* "Table 1" */
    const char *quantity;  /* "prediction" */
    const char *method;    /* "quasi-discrete"; "" where none applies */
    const char *condition; /* "8000 rpm" */
    const char *unit;      /* "%" */
    double paper_value;    /* NAN: the paper gives none */
    double value;          /* the formula in double precision on the simulated drive's truth */
    double value_iq24;     /* the same by the firmware's functions; NAN: no function computes it */
    const char *note;
} comparison_row;

/* Rows own copies of their texts. Zero-initialise; free with comparison_free. */
typedef struct comparison {
    comparison_row *row;
    size_t count, capacity;
    bool out_of_memory;
} comparison;

/* Out of memory is remembered; comparison_check reports it. */
void comparison_add(comparison *c, comparison_row row);
bool comparison_check(const comparison *c, error *e);
void comparison_free(comparison *c);

/* The value over the paper's, NAN where there is none. */
double comparison_ratio(const comparison_row *row);

/* The number of a note, from 1 on in order of first use; 0 for an empty one, or where there are too many. */
enum { COMPARISON_NOTES = 32 };
int comparison_note(const char *notes[COMPARISON_NOTES], int *count, const char *note);

/* A table of each paper's items, columns aligned, notes as numbered lines below. */
void comparison_print(const comparison *c, FILE *out);

/* {"rows": [...], "own": [...]}: those that have a figure of a paper, and those that do not. NAN becomes
 * null. NULL when out of memory. */
json_t *comparison_json(const comparison *c);

#endif
