/* Pieces of a next recording, run in the averaged model (trial.h). */
#include "trial.h"

#include "trial_rows.h"

#include "diagnose/identify/gram.h"
#include "diagnose/identify/row_edges.h"

#include <stdlib.h>
#include <string.h>

/* Of the file's largest speed, where the recording says nothing of what the rotor may do. */
static const double SHARE_OF_SPEED = 0.25;

/* The limits that the recording kept. After a recording at standstill, a quarter of the file's largest speed is allowed. */
static plan_limits limits_of(const session *w)
{
    const diagnose_rows *r = &w->rows;
    const motor *m = w->frame.motor;
    const bool turned = r->omega_max_rad_s * r->T_s > 1e-5;
    const double turned_rpm = r->omega_max_rad_s / motor_speed_rad_s(m, 1.0);
    double u_dc = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        u_dc += r->row[k].u_dc_V / (double)r->rows;
    }
    return (plan_limits){.current_A = r->i_peak_A,
                         .speed_rpm = turned ? turned_rpm : SHARE_OF_SPEED * m->n_max_rpm,
                         .u_dc_V = u_dc};
}

/* The trial's rows as the diagnosis would have them of a recording, all of them fitted. */
static bool prepare(diagnose_rows *rows, const recording *rec, const session *w)
{
    error unused = {0};
    if (!rows_prepare(rows, rec, w->frame.motor, &unused)) {
        return false;
    }
    rows->sensors = w->rows.sensors;
    rows->pwm = w->rows.pwm;
    rows_find_missing(rows);
    if (rows->modulator != w->rows.modulator) {
        rows_fill_edges(rows, w->frame.motor, w->rows.modulator);
    }
    for (size_t k = 0; k < rows->rows; k++) {
        rows->row[k].elapsed_s = 0.0; /* a drifting parameter has its reported value */
    }
    for (size_t b = 0; b < rows->blocks; b++) {
        rows->block[b].held_out = false;
    }
    return true;
}

/* The state with the noise of the recording's largest operating point throughout. */
static fit_state state_of(const session *w)
{
    fit_state s = w->state;
    size_t most = 0;
    for (size_t g = 1; g < w->rows.groups; g++) {
        most = s.noise[g].rows > s.noise[most].rows ? g : most;
    }
    const group_noise noise = s.noise[most];
    for (size_t g = 0; g < ROWS_MAX_GROUPS; g++) {
        s.noise[g] = noise;
    }
    return s;
}

/* Sums what the windows tell by their pieces, and makes it that of one cycle. */
static bool inform(trial *t, fit_data *d, const fit_state *s, const trial_rows *of, const int *column,
                   size_t columns)
{
    double seen[PLAN_PIECES] = {0.0};
    gram *grams = gram_blocks(d, s, column, columns);
    if (grams == NULL) {
        return false;
    }
    for (size_t b = 0; b < d->blocks; b++) {
        const row_block *block = &d->rows->block[d->block[b]];
        const size_t p = of->piece[block->stretch];
        seen[p] += (double)block->count;
        for (size_t i = 0; i < columns; i++) {
            for (size_t j = 0; j < columns; j++) {
                t->h[p][column[i]][column[j]] += grams[b].h[i][j];
            }
        }
    }
    free(grams);
    for (size_t p = 0; p < t->pieces; p++) {
        for (size_t i = 0; i < columns; i++) {
            for (size_t j = 0; j < columns; j++) {
                t->h[p][column[i]][column[j]] /= seen[p];
            }
        }
    }
    return true;
}

static bool look(trial *t, const session *w, const trial_rows *of, const int *column, size_t columns)
{
    diagnose_rows rows;
    fit_data fitted;
    error unused = {0};
    if (!prepare(&rows, &of->recording, w)) {
        return false;
    }
    bool ok = fit_data_make(&fitted, &rows, &w->frame, rows.rows + 1, &unused);
    if (ok) {
        const fit_state state = state_of(w);
        ok = inform(t, &fitted, &state, of, column, columns);
        fit_data_free(&fitted);
    }
    rows_free(&rows);
    return ok;
}

bool trial_run(trial *t, const session *w, const motor *m, const int *column, size_t columns)
{
    trial_rows of;
    *t = (trial){.limits = limits_of(w)};
    t->pieces = plan_pieces_list(m, &t->limits, t->piece);
    if (t->pieces == 0) {
        return true;
    }
    t->h = calloc(t->pieces, sizeof *t->h);
    bool ok = t->h != NULL && trial_rows_make(&of, w, t->piece, t->pieces, t->limits.u_dc_V);
    if (ok) {
        ok = look(t, w, &of, column, columns);
        recording_free(&of.recording);
    }
    if (!ok) {
        trial_free(t);
    }
    return ok;
}

void trial_free(trial *t)
{
    free(t->h);
    *t = (trial){0};
}
