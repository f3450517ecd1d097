/*
 * The experiment that was computed (diagnosis_experiment), in words with its figures.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_EXPERIMENT_WORDS_H
#define SIM_HOST_DIAGNOSE_TELL_EXPERIMENT_WORDS_H

#include "diagnose/result.h"

/* The best piece and what would be known by it. False, and nothing written, if it leaves open what is open. */
bool experiment_words(const diagnosis_experiment *x, char *text, size_t size);

/* A piece: "run-up from standstill, 0 to 3000 rpm, i_q 5 A, steps of +-1 A on both". */
void experiment_piece_words(const plan_piece *p, char *text, size_t size);

/* A half width of a number: as a share of its value where there is one. */
void experiment_width_words(const diagnosis_open *number, double half_width, char *text, size_t size);

#endif
