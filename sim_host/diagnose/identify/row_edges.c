/* Switching edges from recorded or assumed duties (row_edges.h). */
#include "row_edges.h"

#include <math.h>

/* A duty this near to 0 or 1 is at a rail. A timer's step is larger. */
static const double AT_RAIL = 1e-5;

static void duties_of(const diagnose_rows *r, const motor *m, size_t k, modulator which, double duty[3])
{
    const recording *rec = r->recording;
    if (rec->duty[0]) {
        for (size_t x = 0; x < 3; x++) {
            duty[x] = fmin(fmax(rec->duty[x][k], 0.0), 1.0);
        }
        return;
    }
    double u[3];
    recording_voltage(rec, k, u);
    modulator_duties(which, u, rec->u_dc_V ? rec->u_dc_V[k] : m->u_dc_V, duty);
}

/* A leg that stays at a rail has no edges; one that goes to a rail or leaves it has one edge, at the valley between. */
static void count_edges(double duty, double before, double *no_rise, double *no_fall)
{
    const bool high = duty > 1.0 - AT_RAIL;
    const bool was_high = before > 1.0 - AT_RAIL;
    const bool pulse = !high && duty > AT_RAIL;
    *no_rise = 1.0 - (pulse || (high && !was_high) ? 1.0 : 0.0);
    *no_fall = 1.0 - (pulse ? 1.0 : 0.0) - (!high && was_high ? 1.0 : 0.0);
}

/* The ripple is the integral of a leg's voltage from the carrier valley, minus that of its mean. */
void rows_fill_edges(diagnose_rows *r, const motor *m, modulator which)
{
    const recording *rec = r->recording;
    double before[3] = {0.0};
    const size_t periods = r->pwm.periods > 1 ? (size_t)r->pwm.periods : 1;
    const double period_s = r->T_s / (double)periods;
    r->modulator = which;
    for (size_t k = 0; k < r->rows; k++) {
        cycle_row *row = &r->row[k];
        double duty[3];
        row->periods = periods;
        const double u_dc = rec->u_dc_V ? rec->u_dc_V[k] : m->u_dc_V;
        duties_of(r, m, k, which, duty);
        for (size_t x = 0; x < 3; x++) {
            double rise = 0.5 * (1.0 - duty[x]);
            double high[3]; /* flux of each leg above its mean when leg x rises; 1: u_dc times the period */
            for (size_t y = 0; y < 3; y++) {
                high[y] = fmax(0.0, rise - 0.5 * (1.0 - duty[y])) - rise * duty[y];
            }
            vec_ab ahead = vec_from_phases(high);
            row->rise[x] = rise;
            row->fell[x] = k > 0 ? row[-1].rise[x] : rise;
            row->u_dc_V = u_dc;
            row->edge_ripple_Wb[x] = (vec_ab){u_dc * period_s * ahead.alpha, u_dc * period_s * ahead.beta};
            count_edges(duty[x], row->history > 0 ? before[x] : duty[x], &row->no_rise[x], &row->no_fall[x]);
            before[x] = duty[x];
        }
    }
}
