/*
 * The proof of the strongest cause: its effect in the recording, with the fitted effect over it.
 *
 * The effect is the residual voltage of the extended model without that cause. Both are shown over the quantity that the
 * cause depends on: a dead time over the phase current, an angle's harmonic over the revolution.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_PROOF_H
#define SIM_HOST_DIAGNOSE_SHOW_PROOF_H

#include "figures.h"

/* The figure; the diagnosis has a cause. False with *e set if memory runs out. */
bool figure_proof(page *p, const report_context *c, error *e);

#endif
