/*
 * Forward validation: does a simulated drive with the named causes show the same model error? It runs through the recording's operating
 * points (plant_replay.h), and its recording is diagnosed with the user's motor file.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_FORWARD_VALIDATION_H
#define SIM_HOST_DIAGNOSE_SHOW_FORWARD_VALIDATION_H

#include "diagnose/result.h"

typedef struct forward_validation {
    bool simulated;
    char reason[512]; /* if it was not simulated */
    char effect[512]; /* the physics of the simulated drive, in words */
    recording rec;
    diagnosis found; /* of rec, with the nominal motor file */
    double size;     /* rms over runs of the nominal error beyond noise, simulated / measured; NAN: none */
} forward_validation;

/* Never fails: `reason` has the cause of a missing simulation. */
void forward_validation_call(forward_validation *w, const recording *rec, const motor *nominal,
                             const diagnosis *d);
void forward_validation_free(forward_validation *w);

/* The simulated counterpart of the k-th of the diagnosis' runs (one run may be cut into several), or NULL. */
const diagnosis_run *forward_validation_run(const forward_validation *w, const diagnosis *d, size_t k);

#endif
