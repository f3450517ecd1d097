/*
 * Does the plant with the named effects err as the machine did? It is driven through the recording's
 * operating points (plant_replay.h), and its recording is diagnosed with the motor file that the user has.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_PLANT_WITNESS_H
#define SIM_HOST_DIAGNOSE_SHOW_PLANT_WITNESS_H

#include "diagnose/result.h"

typedef struct plant_witness {
    bool simulated;
    char reason[512]; /* why not */
    char effect[512]; /* the physics put into the plant */
    recording rec;
    diagnosis found; /* of rec, with the nominal motor file */
    double size;     /* rms over runs of the nominal error beyond noise, simulated / measured; NAN: none */
} plant_witness;

/* Never fails: what stands in the way is the reason. */
void plant_witness_call(plant_witness *w, const recording *rec, const motor *nominal, const diagnosis *d);
void plant_witness_free(plant_witness *w);

/* The simulated counterpart of the k-th of the diagnosis' runs (one run may be cut into several), or NULL. */
const diagnosis_run *plant_witness_run(const plant_witness *w, const diagnosis *d, size_t k);

#endif
