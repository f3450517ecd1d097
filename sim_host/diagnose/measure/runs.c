/* Figures per operating point and per method, and the series (runs.h). */
#include "runs.h"

#include "diagnose/identify/corrected_rows.h"
#include "diagnose/identify/observer.h"
#include "errors.h"
#include "model/sensor_chain.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/*
 * The two papers' predictors with the same parameters (2019, eqs. 3 and 12) as they would run on these rows;
 * they know one inductance, so that a salient machine has its mean inductance.
 */
static double method_error(const diagnose_rows *r, const averaged_drive *d, bool quasi_discrete)
{
    const sensor_course course = sensor_course_of(d, r->sensors);
    double L = 0.5 * (d->L_d_H + d->L_q_H);
    double sum = 0.0;
    double n = 0.0;
    for (size_t b = 0; b < r->blocks; b++) {
        const row_block *block = &r->block[b];
        for (size_t j = 0; block->held_out && j + 1 < block->count; j++) {
            const cycle_row *row = &r->row[block->first + j];
            const sensor_map sensors = sensor_course_at(&course, row);
            vec_ab i = sensor_map_unmeasure(&sensors, row->i_A);
            double phi = row->omega_rad_s * r->T_s;
            double theta =
                atan2(row->sin_theta, row->cos_theta) - d->theta_0_rad - d->t_delay_s * row->omega_rad_s;
            double half = 0.5 * phi;
            double s1 = fabs(half) < 1e-6 ? 1.0 : sin(half) / half;
            double at = quasi_discrete ? theta + half : theta;
            double emf = d->psi_f_Wb * phi / L * (quasi_discrete ? s1 : 1.0);
            vec_ab next = {
                i.alpha + r->T_s / L * (d->k_u * row->u_V[0].alpha - d->R_ohm * i.alpha) + emf * sin(at),
                i.beta + r->T_s / L * (d->k_u * row->u_V[0].beta - d->R_ohm * i.beta) - emf * cos(at)};
            const sensor_map then = sensor_course_at(&course, row + 1);
            vec_ab shown = sensor_map_measure(&then, next);
            double a = row[1].i_A.alpha - shown.alpha;
            double c = row[1].i_A.beta - shown.beta;
            sum += a * a + c * c;
            n += 1.0;
        }
    }
    double current = measure_current(r, MEASURE_ALL, true);
    return n > 0.0 && current > 0.0 ? 100.0 * sqrt(sum / n) / current : NAN;
}

/* Open-loop simulation error of each group and (returned) of all, percent of the current; optionally keeps the series. */
static double free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       double *percent, vec_ab *scratch, vec_ab *keep)
{
    double wrong[ROWS_MAX_GROUPS] = {0};
    double current[ROWS_MAX_GROUPS] = {0};
    for (size_t b = 0; b < r->blocks;) {
        /* Once for the blocks of a stretch. A row of none is no measure: there a sensor is at the end of its range. */
        const size_t first = r->block[b].first;
        size_t end = b;
        while (end < r->blocks && r->block[end].stretch == r->block[b].stretch) {
            end++;
        }
        const size_t count = r->block[end - 1].first + r->block[end - 1].count - first;
        observer_free_run(r, drive, nodes, first, count, scratch);
        if (keep) {
            memcpy(keep + first, scratch, count * sizeof *keep);
        }
        for (; b < end; b++) {
            const row_block *block = &r->block[b];
            for (size_t k = block->first; k < block->first + block->count; k++) {
                const vec_ab i = r->row[k].i_A;
                const double a = i.alpha - scratch[k - first].alpha;
                const double c = i.beta - scratch[k - first].beta;
                wrong[block->group] += a * a + c * c;
                current[block->group] += i.alpha * i.alpha + i.beta * i.beta;
            }
        }
    }
    double all_wrong = 0.0;
    double all_current = 0.0;
    for (size_t g = 0; g < r->groups; g++) {
        percent[g] = current[g] > 0.0 ? 100.0 * sqrt(wrong[g] / current[g]) : NAN;
        all_wrong += wrong[g];
        all_current += current[g];
    }
    return all_current > 0.0 ? 100.0 * sqrt(all_wrong / all_current) : NAN;
}

double measure_open_loop(const diagnose_rows *r, const averaged_drive *drive, double run[ROWS_MAX_GROUPS])
{
    double percent[ROWS_MAX_GROUPS];
    averaged_node *nodes = rows_nodes(r, drive);
    vec_ab *scratch = calloc(r->rows + 1, sizeof *scratch);
    const double all = nodes && scratch ? free_run(r, drive, nodes, run ? run : percent, scratch, NULL) : NAN;
    free(nodes);
    free(scratch);
    return isfinite(all) ? all : NAN;
}

static void one_cycle_series(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                             vec_ab *series)
{
    for (size_t n = 0; n < r->recording->stretches; n++) {
        const stretch *st = &r->recording->stretch[n];
        observer_one_cycle(r, drive, nodes, st->first, st->count, series + st->first);
        series[st->first] = (vec_ab){NAN, NAN};
    }
}

static bool make_series(const diagnose_rows *r, diagnosis *d)
{
    d->error_nominal = calloc(r->rows, sizeof *d->error_nominal);
    d->error_extended = calloc(r->rows, sizeof *d->error_extended);
    d->free_nominal = calloc(r->rows, sizeof *d->free_nominal);
    d->free_extended = calloc(r->rows, sizeof *d->free_extended);
    d->held_out = calloc(r->rows, 1);
    if (!d->error_nominal || !d->error_extended || !d->free_nominal || !d->free_extended || !d->held_out) {
        return false;
    }
    for (size_t k = 0; k < r->rows; k++) {
        d->free_nominal[k] = d->free_extended[k] = (vec_ab){NAN, NAN};
    }
    for (size_t b = 0; b < r->blocks; b++) {
        for (size_t j = 0; r->block[b].held_out && j < r->block[b].count; j++) {
            d->held_out[r->block[b].first + j] = 1;
        }
    }
    return true;
}

static void describe_run(const diagnose_rows *r, size_t group, diagnosis_run *run)
{
    double n = 0.0;
    double u2 = 0.0;
    for (size_t b = 0; b < r->blocks; b++) {
        for (size_t j = 0; r->block[b].group == group && j < r->block[b].count; j++) {
            const cycle_row *row = &r->row[r->block[b].first + j];
            run->omega_rad_s += row->omega_rad_s;
            run->i_d_A += row->i_A.alpha * row->cos_theta + row->i_A.beta * row->sin_theta;
            run->i_q_A += row->i_A.beta * row->cos_theta - row->i_A.alpha * row->sin_theta;
            u2 += row->u_V[0].alpha * row->u_V[0].alpha + row->u_V[0].beta * row->u_V[0].beta;
            n += 1.0;
        }
    }
    run->rows = (size_t)n;
    if (n > 0.0) {
        run->omega_rad_s /= n;
        run->i_d_A /= n;
        run->i_q_A /= n;
        run->u_rms_V = sqrt(u2 / n);
    }
    run->i_rms_A = measure_current(r, group, false);
    run->run = r->group_run[group];
}

bool measure_runs(const diagnose_rows *r, diagnosis *d, bool series)
{
    const diagnose_rows recorded = corrected_rows_before(r, 0);
    averaged_node *nominal = rows_nodes(r, &d->nominal_drive);
    averaged_node *extended = rows_nodes(r, &d->extended_drive);
    vec_ab *scratch = calloc(r->rows + 1, sizeof *scratch);
    double percent[2][ROWS_MAX_GROUPS] = {{0}};
    bool ok = nominal && extended && scratch && (!series || make_series(r, d));
    if (ok) {
        d->free_nominal_percent = free_run(&recorded, &d->nominal_drive, nominal, percent[0], scratch,
                                           series ? d->free_nominal : NULL);
        d->free_extended_percent =
            free_run(r, &d->extended_drive, extended, percent[1], scratch, series ? d->free_extended : NULL);
        if (series) {
            one_cycle_series(&recorded, &d->nominal_drive, nominal, d->error_nominal);
            one_cycle_series(r, &d->extended_drive, extended, d->error_extended);
        }
        double all = measure_current(r, MEASURE_ALL, true);
        d->runs = r->groups;
        for (size_t g = 0; g < r->groups; g++) {
            diagnosis_run *run = &d->run[g];
            describe_run(r, g, run);
            run->nominal = measure_one_cycle(&recorded, &d->nominal_drive, g, true);
            run->extended = measure_one_cycle(r, &d->extended_drive, g, true);
            double own = measure_current(r, g, true);
            run->noise_floor = own > 0.0 ? d->noise_floor * all / own : NAN;
            run->free_nominal = percent[0][g];
            run->free_extended = percent[1][g];
        }
        d->method_nominal = (diagnosis_method){method_error(&recorded, &d->nominal_drive, false),
                                               method_error(&recorded, &d->nominal_drive, true), d->nominal};
        d->method_extended = (diagnosis_method){method_error(r, &d->extended_drive, false),
                                                method_error(r, &d->extended_drive, true), d->extended};
    }
    free(nominal);
    free(extended);
    free(scratch);
    return ok;
}
