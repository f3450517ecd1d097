/* Diagnosis of the simulated recording (forward_validation.h). */
#include "forward_validation.h"

#include "diagnose/diagnose.h"
#include "plant_replay.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Squared error of a run without its noise, percent^2. */
static double beyond_noise(const diagnosis_run *run)
{
    return fmax(run->nominal * run->nominal - run->noise_floor * run->noise_floor, 0.0);
}

static double size_of(const forward_validation *w, const diagnosis *d)
{
    double measured = 0.0;
    double simulated = 0.0;
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *run = forward_validation_run(w, d, k);
        if (run != NULL && d->run[k].nominal > 0.0 && run->nominal > 0.0) {
            measured += beyond_noise(&d->run[k]);
            simulated += beyond_noise(run);
        }
    }
    return measured > 0.0 ? sqrt(simulated / measured) : NAN;
}

void forward_validation_call(forward_validation *w, const recording *rec, const motor *nominal,
                             const diagnosis *d)
{
    memset(w, 0, sizeof *w);
    error e = {0};
    const diagnose_options options = {.series = true};
    if (d->causes == 0) {
        snprintf(w->reason, sizeof w->reason, "no cause was named");
        return;
    }
    if (!plant_replay(rec, nominal, &d->extended_motor, d->sensor_noise_A, &w->rec, w->effect,
                      sizeof w->effect, &e)) {
        snprintf(w->reason, sizeof w->reason, "%s", e.text);
        return;
    }
    w->rec.path = "the simulated recording";
    if (!diagnose(&w->found, &w->rec, nominal, &options, &e)) {
        snprintf(w->reason, sizeof w->reason, "%s", e.text);
        recording_free(&w->rec);
        return;
    }
    w->simulated = true;
    w->size = size_of(w, d);
}

void forward_validation_free(forward_validation *w)
{
    if (w->simulated) {
        diagnosis_free(&w->found);
        recording_free(&w->rec);
    }
    memset(w, 0, sizeof *w);
}

const diagnosis_run *forward_validation_run(const forward_validation *w, const diagnosis *d, size_t k)
{
    size_t which = 0;
    for (size_t n = 0; n < k; n++) {
        which += d->run[n].run == d->run[k].run;
    }
    for (size_t n = 0; w->simulated && n < w->found.runs; n++) {
        if (w->found.run[n].run == d->run[k].run && which-- == 0) {
            return &w->found.run[n];
        }
    }
    return NULL;
}
