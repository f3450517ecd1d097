#include "convert.h"

#include "frames.h"
#include "shift.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what must be there ---- */

/* All that is missing, at once. */
static bool is_enough(const conversion *v)
{
    const import_map *m = v->map;
    char text[400] = "";
    const bool current = conversion_has(v, QUANTITY_I_A, 3) >= 2 || conversion_has(v, QUANTITY_I_D, 2) == 2 ||
                         conversion_has(v, QUANTITY_I_ALPHA, 2) == 2;
    const bool duties = conversion_has(v, QUANTITY_D_A, 3) == 3;
    const bool voltage =
        duties || conversion_has(v, QUANTITY_U_A, 3) == 3 || conversion_has(v, QUANTITY_U_D, 2) == 2 ||
        conversion_has(v, QUANTITY_U_ALPHA, 2) == 2 || conversion_has(v, QUANTITY_U_AB, 3) >= 2;
    if (!m->column[QUANTITY_T].there && m->rate_Hz == 0.0) {
        strcat(text, ", the time (t_s, or [timing] rate_Hz)");
    }
    if (!current) {
        strcat(text,
               ", the currents (two of i_a_A, i_b_A, i_c_A, or i_d_A and i_q_A, or i_alpha_A and i_beta_A)");
    }
    if (!voltage) {
        strcat(text,
               ", the voltages (u_a_V to u_c_V, u_d_V and u_q_V, u_alpha_V and u_beta_V, two of u_ab_V, "
               "u_bc_V, u_ca_V, or d_a, d_b, d_c)");
    }
    if (duties && !m->column[QUANTITY_U_DC].there && !m->has_fixed_u_dc) {
        strcat(text, ", the DC link of the duties (u_dc_V, or [fixed] u_dc_V)");
    }
    if (!m->column[QUANTITY_THETA].there && !m->has_fixed_theta) {
        strcat(text, ", the angle (theta_e_rad, or [fixed] theta_e_rad for a rotor at standstill)");
    }
    return text[0] == '\0' || error_input(v->e, m->path, 0, 0, "[columns] lacks %s", text + 2);
}

static bool is_every_cycle(const conversion *v)
{
    if (v->map->decimation > 1) {
        return error_input(
            v->e, v->map->path, v->map->decimation_line, 0,
            "every %ldth cycle only: the commands between two rows are not in the log, and one "
            "cycle cannot be predicted; log every cycle, in bursts if need be",
            v->map->decimation);
    }
    if (v->motor == NULL) {
        return true;
    }
    const double cycles = v->r->T_s * v->motor->f_pwm_Hz;
    if (cycles > 1.5) {
        return error_input(
            v->e, v->t->path, 0, 0,
            "the rows are %.4g s apart, %.3g cycles of %s: the commands between two rows are not in "
            "the log, and one cycle cannot be predicted; log every cycle, in bursts if need be",
            v->r->T_s, cycles, v->motor->path != NULL ? v->motor->path : "the motor");
    }
    return true;
}

/* ---- time and runs ---- */

static bool put_runs(const conversion *v)
{
    const double *run = v->c.value[QUANTITY_RUN];
    if (run == NULL) {
        return true;
    }
    v->r->run = calloc(v->c.rows + 1, sizeof *v->r->run);
    for (size_t k = 0; v->r->run != NULL && k < v->c.rows; k++) {
        if (run[k] != floor(run[k]) || fabs(run[k]) > INT_MAX) {
            return error_input(v->e, v->t->path, v->t->line[k], 0, "run %g is not a whole number", run[k]);
        }
        v->r->run[k] = (long)run[k];
    }
    return v->r->run != NULL || conversion_out_of_memory(v);
}

static bool is_new_run(const recording *r, size_t k)
{
    return k == 0 || (r->run != NULL && r->run[k] != r->run[k - 1]);
}

/* With a rate, stamps that were rounded go onto the cycle that they mean. */
static bool put_time(const conversion *v)
{
    recording *r = v->r;
    const double rate = v->map->rate_Hz;
    const double *t = v->c.value[QUANTITY_T];
    double cycle = 0.0;
    size_t first = 0;
    r->t_s = conversion_column(v);
    for (size_t k = 0; r->t_s != NULL && k < r->rows; k++) {
        const bool fresh = is_new_run(r, k);
        if (t != NULL && !fresh && t[k] < t[k - 1]) {
            return error_input(v->e, v->t->path, v->t->line[k], 0,
                               "the time %.9g s does not rise: the row before has %.9g s; where a new piece "
                               "begins, map a column of piece numbers as run",
                               t[k], t[k - 1]);
        }
        if (t == NULL) {
            r->t_s[k] = (double)k / rate;
        } else if (rate == 0.0) {
            r->t_s[k] = t[k];
            if (!fresh && t[k] == t[k - 1]) {
                return error_input(
                    v->e, v->t->path, v->t->line[k], 0,
                    "the time %.9g s is there twice: for stamps coarser than a cycle, set [timing] "
                    "rate_Hz",
                    t[k]);
            }
        } else {
            first = fresh ? k : first;
            const double stamped = round((t[k] - t[first]) * rate);
            cycle = fresh ? 0.0 : fmax(cycle + 1.0, stamped);
            if (cycle > stamped + 1.0) {
                return error_input(v->e, v->t->path, v->t->line[k], 0,
                                   "more rows than rate_Hz = %g has cycles up to t = %.9g s", rate, t[k]);
            }
            r->t_s[k] = t[first] + cycle / rate;
        }
    }
    return v->e->status == STATUS_DONE;
}

static bool put_all(const conversion *v)
{
    recording *r = v->r;
    r->rows = v->c.rows;
    r->line = malloc((r->rows + 1) * sizeof *r->line);
    if (r->line == NULL) {
        return conversion_out_of_memory(v);
    }
    memcpy(r->line, v->c.line, r->rows * sizeof *r->line);
    if (!put_runs(v) || !put_time(v)) {
        return false;
    }
    if (!recording_find_stretches(r)) {
        return conversion_out_of_memory(v);
    }
    if (!is_every_cycle(v) || !frames_fill(v)) {
        return false;
    }
    if (!shift_commands(r, lround(2.0 * v->map->shift_cycles))) {
        return conversion_out_of_memory(v);
    }
    r->pwm_stated = v->map->updates_stated;
    r->pwm = v->map->updates;
    return r->rows > 0 ||
           error_input(v->e, v->t->path, 0, 0, "no row has the command that acts in its cycle");
}

bool convert_log(log_table *t, const import_map *map, const motor *m, recording *r, error *e)
{
    *r = (recording){.path = t->path};
    conversion v = {.t = t, .map = map, .motor = m, .r = r, .e = e};
    const bool ok = is_enough(&v) && columns_read(&v.c, t, map, m, e) && put_all(&v);
    columns_free(&v.c);
    if (!ok) {
        recording_free(r);
    }
    return ok;
}

void convert_comment(const log_table *t, const import_map *map, char *text, size_t size)
{
    snprintf(text, size, "imported from %s by %s; shift_cycles = %g%s", t->path, map->path, map->shift_cycles,
             map->column[QUANTITY_OMEGA].there || map->has_fixed_omega ? "" : "; speed from the angle");
}
