/*
 * The charts of a report page: residuals of the nominal and the extended model over time, current, voltage, speed, angle and
 * order; errors by run and method; the simulated drive of the forward validation.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_FIGURES_H
#define SIM_HOST_DIAGNOSE_SHOW_FIGURES_H

#include "diagnose/result.h"
#include "firmware_gain.h"
#include "forward_validation.h"
#include "report/page.h"
#include "residual.h"

/* The inputs of all charts. */
typedef struct report_context {
    const recording *rec;
    const motor *nominal;
    const diagnosis *d;
    const forward_validation *validation;
    const firmware_gain *firmware;
    residual before, after; /* nominal and extended model, this recording */
    residual plant;         /* nominal model, the simulated recording; error NULL if there is none */
    bool turns;             /* the rotor turns, two revolutions at least */
    bool extended;          /* the extended model differs from the nominal model */
} report_context;

report_context report_context_of(const recording *rec, const motor *nominal, const diagnosis *d,
                                 const forward_validation *validation, const firmware_gain *firmware);

/* A column as the curve of the nominal or of the extended model; no curve if there is no extended model. */
chart_series figure_nominal(const report_context *c, const chart_data *d, size_t column, chart_mark mark);
chart_series figure_extended(const report_context *c, const chart_data *d, size_t column, chart_mark mark);

/* Each draws one figure; false with *e set if memory runs out. */
bool figure_time(page *p, const report_context *c, error *e);
bool figure_current(page *p, const report_context *c, error *e);
bool figure_voltage(page *p, const report_context *c, error *e);
bool figure_angle(page *p, const report_context *c, error *e);
bool figure_speed(page *p, const report_context *c, error *e);
bool figure_orders(page *p, const report_context *c, error *e);
bool figure_runs(page *p, const report_context *c, error *e);
bool figure_free_runs(page *p, const report_context *c, error *e);
bool figure_methods(page *p, const report_context *c, error *e);
bool figure_plant_runs(page *p, const report_context *c, error *e);
bool figure_plant_current(page *p, const report_context *c, error *e);
/* The extended model saturates. */
bool figure_flux_d(page *p, const report_context *c, error *e);
bool figure_flux_q(page *p, const report_context *c, error *e);
/* d->learned has points. */
bool figure_learned(page *p, const report_context *c, error *e);

#endif
