/* The modulator of pulse patterns with a table as `iqfoc patterns` computes it: over arrays, and on a plant. */
#include "iqfoc/pattern.h"

#include "handles.h"
#include "patterns/patterns_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.283185307179586

struct py_pattern {
    iqfoc_pattern_row_t row[PATTERNS_ROWS];
    iqfoc_pattern_t table;
    iqfoc_pattern_modulator_t modulator;
    iq24_t least;
};

/* least: cycles. */
static bool take(py_pattern *p, const patterns_result *found, double least, error *e)
{
    patterns_table(found, p->row, &p->table);
    p->least = iq24_from_double(fmin(least, 8.0));
    const iqfoc_error_t refused = iqfoc_pattern_init(&p->modulator, &p->table, p->least);
    return refused == IQFOC_OK ||
           error_failure(e, 0, "the library refused the pattern: iqfoc_error_t %d", (int)refused);
}

py_pattern *py_pattern_new(const motor *m, int pulses, double on_time_s, double dead_time_s, error *e)
{
    const patterns_request asked = {
        .m = m, .pulses = pulses, .on_time_s = on_time_s, .dead_time_s = dead_time_s};
    patterns_result *found = calloc(1, sizeof *found);
    py_pattern *p = calloc(1, sizeof *p);
    if (found == NULL || p == NULL) {
        free(found);
        free(p);
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    const bool ok =
        patterns_find(&asked, found, e) && take(p, found, (on_time_s + dead_time_s) / per_unit_of(m).T_s, e);
    free(found);
    if (!ok) {
        free(p);
        return NULL;
    }
    return p;
}

void py_pattern_free(py_pattern *p)
{
    free(p);
}

void py_pattern_range(const py_pattern *p, double *low, double *high)
{
    *low = patterns_index(0);
    *high = patterns_index(p->table.rows - 1);
}

void py_pattern_clear(py_pattern *p)
{
    (void)iqfoc_pattern_init(&p->modulator, &p->table, p->least); /* passed before */
}

void py_pattern_steps(py_pattern *p, size_t n, const int32_t *const *in, int32_t *level, int32_t *edges,
                      int32_t *instant, int32_t *high)
{
    for (size_t k = 0; k < n; k++) {
        iqfoc_pattern_edges_t leg[3];
        iqfoc_pattern_step(&p->modulator, in[0][k], in[1][k], in[2][k], leg);
        for (size_t x = 0; x < 3; x++) {
            level[3 * k + x] = leg[x].level;
            edges[3 * k + x] = leg[x].edges;
            high[3 * k + x] = leg[x].high;
            for (int j = 0; j < IQFOC_PATTERN_EDGES_MAX; j++) {
                instant[(3 * k + x) * IQFOC_PATTERN_EDGES_MAX + (size_t)j] =
                    j < leg[x].edges ? leg[x].instant[j] : 0;
            }
        }
    }
}

/* One cycle: an interval of the plant from each edge of any leg to the next. *row gets duties and true means. */
static void play(plant *drive, const iqfoc_pattern_edges_t leg[3], double T_s, drive_row *row)
{
    int next[3] = {0, 0, 0};
    bool high[3];
    for (int x = 0; x < 3; x++) {
        high[x] = leg[x].level > 0;
        row->duty[x] = iq24_to_double(leg[x].high);
    }
    row->truth.duration_s = T_s;
    for (double from = 0.0; from < 1.0;) {
        double until = 1.0;
        for (int x = 0; x < 3; x++) {
            while (next[x] < leg[x].edges && iq24_to_double(leg[x].instant[next[x]]) <= from) {
                high[x] = !high[x];
                next[x]++;
            }
            until = next[x] < leg[x].edges ? fmin(until, iq24_to_double(leg[x].instant[next[x]])) : until;
        }
        plant_begin_interval(drive, high, (until - from) * T_s);
        plant_advance_to(drive, (until - from) * T_s);
        const plant_means part = plant_mean(drive);
        row->truth.i_dq_A.d += (until - from) * part.i_dq_A.d;
        row->truth.i_dq_A.q += (until - from) * part.i_dq_A.q;
        from = until;
    }
}

void py_pattern_run(py_pattern *p, py_plant *on, double index, double ahead, size_t cycles,
                    double *const *column)
{
    plant *const drive = &on->loop.drive;
    const double T_s = on->loop.base.T_s;
    for (size_t k = 0; k < cycles; k++) {
        drive_row row = {.run = 1};
        iqfoc_pattern_edges_t leg[3];
        plant_sample(drive, &row.valley);
        const plant_point now = plant_now(drive);
        const double angle = fmod(now.theta_e_rad / TWO_PI + ahead, 1.0);
        iqfoc_pattern_step(&p->modulator, iq24_from_double(angle),
                           iq24_from_double(now.omega_e_rad_s * T_s / TWO_PI), iq24_from_double(index), leg);
        play(drive, leg, T_s, &row);
        py_run_put(&row, plant_now(drive).torque_Nm, false, column, k);
    }
}
