/*
 * The computed next recording (diagnosis_experiment) in words: the test segment, and the uncertainty it would reach.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_EXPERIMENT_WORDS_H
#define SIM_HOST_DIAGNOSE_TELL_EXPERIMENT_WORDS_H

#include "diagnose/result.h"

/* The best test segment and the uncertainty after it. False, and nothing written, if no segment is good enough. */
bool experiment_words(const diagnosis_experiment *x, char *text, size_t size);

/* A test segment: "run-up from standstill, 0 to 3000 rpm, i_q 5 A, steps of +-1 A on both". */
void experiment_piece_words(const plan_piece *p, char *text, size_t size);

/* A half width: in percent of the value; in its unit if the value is smaller than it. */
void experiment_width_words(const diagnosis_open *number, double half_width, char *text, size_t size);

#endif
