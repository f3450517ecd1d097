/*
 * The proof of the strongest cause: its effect in the recording, with the fitted effect over it.
 *
 * The effect is the residual voltage of the extended model without that cause. Both are shown over the quantity that the
 * cause depends on: a dead time over the phase current, an angle's harmonic over the revolution.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_PROOF_H
#define SIM_HOST_DIAGNOSE_SHOW_PROOF_H

#include "figures.h"

/* One-cycle errors of the extended model without the strongest cause, and what that cause removes from them. */
typedef struct proof {
    const diagnosis_cause *cause;
    bool alone;                   /* false: without and of all causes together */
    vec_ab *without_A, *fitted_A; /* one entry per row; NAN: no prediction there */
} proof;

/* False with *e set if memory runs out. The diagnosis has a cause. */
bool proof_make(proof *of, const report_context *c, error *e);
void proof_free(proof *of);

/* The cause's values in one sentence: "3.36 V lost against the current's sign: 2 us at 4 kHz and 420 V." */
void proof_words(const diagnosis *d, const diagnosis_cause *cause, char *text, size_t size);

/* The figure. False with *e set if memory runs out. */
bool figure_proof(page *p, const report_context *c, error *e);

#endif
