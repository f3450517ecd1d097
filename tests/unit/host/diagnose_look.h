/*
 * What the diagnosis says of a bench, and what its tests ask of that.
 */
#ifndef TESTS_UNIT_DIAGNOSE_LOOK_H
#define TESTS_UNIT_DIAGNOSE_LOOK_H

#include "diagnose/diagnose.h"
#include "diagnose_bench.h"

/* A recording of the bench diagnosed with the bench's motor file, without the causes of id `skip` (may be NULL). */
diagnosis look(const bench *b, const char *skip);

/* Without these hypotheses. */
diagnosis look_without(const bench *b, hypothesis_set skip);

/* The cause has a parameter of that name, whose interval holds the truth. */
void holds(const diagnosis_cause *cause, const char *name, double truth);

/* It is the only one, and explains the recording. */
void one_cause(const diagnosis *d, const char *id);

#endif
