/*
 * The charts of a diagnosis: where the model errs, before and after, and the plant beside the machine.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_FIGURES_H
#define SIM_HOST_DIAGNOSE_SHOW_FIGURES_H

#include "diagnose/result.h"
#include "plant_witness.h"
#include "report/page.h"
#include "residual.h"

/* What all charts are drawn from. */
typedef struct evidence {
    const recording *rec;
    const motor *nominal;
    const diagnosis *d;
    const plant_witness *witness;
    residual before, after; /* nominal and extended model, this recording */
    residual plant;         /* nominal model, the simulated recording; error NULL if there is none */
    bool turns;             /* the rotor turns, two revolutions at least */
    const char *was;        /* what to call the nominal model */
    bool extended;          /* there is an extended model that differs from the nominal */
} evidence;

evidence evidence_of(const recording *rec, const motor *nominal, const diagnosis *d,
                     const plant_witness *witness);

/* A column as the curve of the model as it was, and as that of the extended model: none where there is none. */
chart_series figure_nominal(const evidence *v, const chart_data *d, size_t column, chart_mark mark);
chart_series figure_extended(const evidence *v, const chart_data *d, size_t column, chart_mark mark);

/* Each draws one figure; false with *e set if memory runs out. */
bool figure_time(page *p, const evidence *v, error *e);
bool figure_current(page *p, const evidence *v, error *e);
bool figure_voltage(page *p, const evidence *v, error *e);
bool figure_angle(page *p, const evidence *v, error *e);
bool figure_speed(page *p, const evidence *v, error *e);
bool figure_orders(page *p, const evidence *v, error *e);
bool figure_runs(page *p, const evidence *v, error *e);
bool figure_free_runs(page *p, const evidence *v, error *e);
bool figure_methods(page *p, const evidence *v, error *e);
bool figure_plant_runs(page *p, const evidence *v, error *e);
bool figure_plant_current(page *p, const evidence *v, error *e);
/* d->learned has points. */
bool figure_learned(page *p, const evidence *v, error *e);

#endif
