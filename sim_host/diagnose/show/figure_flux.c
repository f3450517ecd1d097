/* Flux linkage of a machine that saturates, over the current of each axis (figures.h). */
#include "figures.h"

#include "model/flux_map.h"

#include <math.h>

enum { POINTS = 240 };

/* The recorded currents in the rotor frame, and how far the curves go. */
typedef struct range {
    vec_dq low, high;
    double most_A;
} range;

static range range_of(const report_context *c)
{
    range r = {{0.0, 0.0}, {0.0, 0.0}, motor_rated_peak_A(c->nominal)};
    for (size_t k = 1; k < c->rec->rows; k++) {
        residual_point p;
        if (!residual_at(&c->after, k, &p)) {
            continue;
        }
        const vec_dq i = vec_to_dq(vec_from_phases(p.i_phase_A), rotor_at(p.theta_rad));
        r.low = (vec_dq){fmin(r.low.d, i.d), fmin(r.low.q, i.q)};
        r.high = (vec_dq){fmax(r.high.d, i.d), fmax(r.high.q, i.q)};
    }
    r.most_A = fmax(r.most_A, fmax(fmax(-r.low.d, r.high.d), fmax(-r.low.q, r.high.q)));
    return r;
}

static double larger(double low, double high)
{
    return -low > high ? low : high;
}

/* Flux linkage of an axis at its current and the other axis' one. */
static double flux_of(const averaged_drive *drive, bool of_q, double own_A, double other_A)
{
    const vec_dq flux = flux_map_flux(drive, of_q ? (vec_dq){other_A, own_A} : (vec_dq){own_A, other_A});
    return of_q ? flux.q : drive->psi_f_Wb + flux.d;
}

static bool figure_axis(page *p, const report_context *c, bool of_q, const char *id, const char *caption,
                        error *e)
{
    const range r = range_of(c);
    const double low = of_q ? r.low.q : r.low.d;
    const double high = of_q ? r.high.q : r.high.d;
    const double other_A = of_q ? larger(r.low.d, r.high.d) : larger(r.low.q, r.high.q);
    const averaged_drive *after = &c->d->extended_drive;
    chart_data d = chart_data_of(5);
    for (int n = 0; n <= POINTS; n++) {
        const double own_A = 1.2 * r.most_A * (2.0 * n / POINTS - 1.0);
        const double flux_Wb = flux_of(after, of_q, own_A, 0.0);
        chart_data_add(&d, (double[]){own_A, own_A >= low && own_A <= high ? flux_Wb : NAN,
                                      flux_of(&c->d->nominal_drive, of_q, own_A, 0.0), flux_Wb,
                                      flux_of(after, of_q, own_A, other_A)});
    }
    char crossed[64];
    snprintf(crossed, sizeof crossed, "extended, i_%s = %.3g A", of_q ? "d" : "q", other_A);
    const chart drawn = {
        .x_label = of_q ? "current i_q, A" : "current i_d, A",
        .y_label = of_q ? "flux linkage of q, Wb" : "flux linkage of d, Wb",
        .x = {.fixed = true, .low = -1.2 * r.most_A, .high = 1.2 * r.most_A},
        .series = {{.label = "recorded range", .data = &d, .column = 1, .colour = CHART_FAINT, .width = 8.0},
                   figure_nominal(c, &d, 2, CHART_LINE),
                   figure_extended(c, &d, 3, CHART_LINE),
                   {.label = crossed,
                    .data = &d,
                    .column = 4,
                    .colour = CHART_PURPLE,
                    .role = CHART_EXTENDED,
                    .dashed = true}}};
    const bool ok = page_chart(p, &drawn, id, caption, e);
    chart_data_free(&d);
    return ok;
}

bool figure_flux_d(page *p, const report_context *c, error *e)
{
    return figure_axis(
        p, c, false, "flux-d",
        "Flux linkage of the d axis over its current, without current in the other axis; dashed: with "
        "the largest one recorded. Outside the recorded range the model extrapolates.",
        e);
}

bool figure_flux_q(page *p, const report_context *c, error *e)
{
    return figure_axis(p, c, true, "flux-q", "The same for the q axis.", e);
}
