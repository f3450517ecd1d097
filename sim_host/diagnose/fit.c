#include "fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GAIN_STEPS = 2 };

static const double GAIN_START = 0.5;
/*
 * A gain of nought would trust the model for ever. One part in thirty bounds its memory to thirty cycles: the
 * estimates lose little (the regressor's noise variance is 3 % of the sensor's), and a small slow error of
 * the model is not summed up.
 */
static const double GAIN_LEAST = 0.03;
static const double GAIN_MOST = 0.98;

bool fit_data_make(fit_data *d, diagnose_rows *r, const parameter_set *p, size_t rows_max, bool held_out,
                   error *e)
{
    *d = (fit_data){.rows = r, .parameters = p};
    size_t total = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        total += r->block[b].held_out == held_out ? r->block[b].count : 0;
    }
    size_t every = total / rows_max + 1;
    d->block = calloc(r->blocks + 1, sizeof *d->block);
    size_t seen = 0;
    for (size_t b = 0; d->block && b < r->blocks; b++) {
        if (r->block[b].held_out != held_out) {
            continue;
        }
        if (seen++ % every == 0) {
            d->block[d->blocks++] = b;
            d->longest = r->block[b].count > d->longest ? r->block[b].count : d->longest;
        }
    }
    size_t outputs = FILTER_OUTPUTS * d->longest + 1;
    d->nodes = calloc(r->nodes, sizeof *d->nodes);
    d->base = calloc(outputs, sizeof *d->base);
    d->moved = calloc(outputs, sizeof *d->moved);
    d->columns = calloc(outputs * COLUMN_COUNT, sizeof *d->columns);
    if (!d->block || !d->nodes || !d->base || !d->moved || !d->columns) {
        fit_data_free(d);
        return error_failure(e, 0, "out of memory for a fit of %zu rows", total);
    }
    return true;
}

void fit_data_free(fit_data *d)
{
    free(d->block);
    free(d->nodes);
    free(d->base);
    free(d->moved);
    free(d->columns);
    *d = (fit_data){0};
}

fit_state fit_nominal(void)
{
    fit_state s = {0};
    for (size_t g = 0; g < ROWS_MAX_GROUPS; g++) {
        s.noise[g].gain = GAIN_START;
    }
    return s;
}

/* Turns summed squares into covariances, whitening and the objective. */
static void finish_noise(const fit_data *d, fit_state *s)
{
    double pool[4] = {0};
    double pool_rows = 0.0;
    for (size_t g = 0; g < d->rows->groups; g++) {
        const group_noise *n = &s->noise[g];
        for (size_t k = 0; k < 3; k++) {
            pool[k] += n->cov[k];
        }
        pool[3] += n->zero;
        pool_rows += n->rows;
    }
    s->objective = 0.0;
    for (size_t g = 0; g < d->rows->groups; g++) {
        /* A group of a few rows leans on all the others. */
        const double lean = 20.0;
        group_noise *n = &s->noise[g];
        double count = n->rows + lean;
        double tiny = 1e-14 * d->parameters->i_rated_peak_A * d->parameters->i_rated_peak_A;
        double cov[4];
        for (size_t k = 0; k < 4; k++) {
            double own = k < 3 ? n->cov[k] : n->zero;
            cov[k] = (own + lean * pool[k] / fmax(pool_rows, 1.0)) / count + (k != 1 ? tiny : 0.0);
        }
        for (size_t k = 0; k < 3; k++) {
            n->cov[k] = cov[k];
        }
        n->zero = cov[3];
        double l11 = sqrt(cov[0]);
        double l21 = cov[1] / l11;
        double l22 = sqrt(fmax(cov[2] - l21 * l21, 1e-6 * cov[2]));
        n->white[0] = 1.0 / l11;
        n->white[1] = -l21 / (l11 * l22);
        n->white[2] = 1.0 / l22;
        n->white_zero = d->rows->two_sensors ? 0.0 : 1.0 / sqrt(cov[3]);
        s->objective += n->rows * 2.0 * (log(l11) + log(l22));
        s->objective += d->rows->two_sensors ? 0.0 : n->rows * log(cov[3]);
    }
}

void fit_noise(fit_data *d, fit_state *s)
{
    averaged_drive drive = parameters_drive(d->parameters, s->z);
    rows_nodes_fill(d->rows, &drive, d->nodes);
    for (size_t g = 0; g < d->rows->groups; g++) {
        group_noise *n = &s->noise[g];
        n->cov[0] = n->cov[1] = n->cov[2] = n->zero = n->rows = 0.0;
    }
    for (size_t b = 0; b < d->blocks; b++) {
        const row_block *block = &d->rows->block[d->block[b]];
        group_noise *n = &s->noise[block->group];
        filter_block(d->rows, &drive, d->nodes, block, n->gain, 0.0, d->base);
        for (size_t j = 0; j < block->count; j++) {
            const double *e = d->base + FILTER_OUTPUTS * j;
            n->cov[0] += e[0] * e[0];
            n->cov[1] += e[0] * e[1];
            n->cov[2] += e[1] * e[1];
            n->zero += e[2] * e[2];
            n->rows += e[0] != 0.0 || e[1] != 0.0 ? 1.0 : 0.0;
        }
    }
    finish_noise(d, s);
}

/* One block's innovations times the group's inverse Cholesky factor. */
static void whiten(const group_noise *n, size_t rows, const double *innovation, double *out)
{
    for (size_t j = 0; j < rows; j++) {
        const double *e = innovation + FILTER_OUTPUTS * j;
        double *w = out + FILTER_OUTPUTS * j;
        double second =
            n->white[1] * e[0] + n->white[2] * e[1]; /* first: out may be the innovations themselves */
        w[0] = n->white[0] * e[0];
        w[1] = second;
        w[2] = n->white_zero * e[2];
    }
}

static double dot(const double *x, const double *y, size_t n)
{
    double sum[4] = {0};
    size_t k = 0;
    for (; k + 4 <= n; k += 4) {
        sum[0] += x[k] * y[k];
        sum[1] += x[k + 1] * y[k + 1];
        sum[2] += x[k + 2] * y[k + 2];
        sum[3] += x[k + 3] * y[k + 3];
    }
    for (; k < n; k++) {
        sum[0] += x[k] * y[k];
    }
    return sum[0] + sum[1] + sum[2] + sum[3];
}

void fit_gain(fit_data *d, fit_state *s)
{
    averaged_drive drive = parameters_drive(d->parameters, s->z);
    rows_nodes_fill(d->rows, &drive, d->nodes);
    double down[ROWS_MAX_GROUPS] = {0};
    double curve[ROWS_MAX_GROUPS] = {0};
    const double h = 1e-3;
    for (size_t b = 0; b < d->blocks; b++) {
        const row_block *block = &d->rows->block[d->block[b]];
        const group_noise *n = &s->noise[block->group];
        filter_block(d->rows, &drive, d->nodes, block, n->gain, 0.0, d->base);
        filter_block(d->rows, &drive, d->nodes, block, n->gain + h, 0.0, d->moved);
        whiten(n, block->count, d->base, d->base);
        whiten(n, block->count, d->moved, d->moved);
        for (size_t j = 0; j < FILTER_OUTPUTS * block->count; j++) {
            double slope = (d->moved[j] - d->base[j]) / h;
            down[block->group] += slope * d->base[j];
            curve[block->group] += slope * slope;
        }
    }
    for (size_t g = 0; g < d->rows->groups; g++) {
        if (curve[g] > 0.0) {
            double step = -down[g] / curve[g];
            double gain = s->noise[g].gain + fmin(fmax(step, -0.3), 0.3);
            s->noise[g].gain = fmin(fmax(gain, GAIN_LEAST), GAIN_MOST);
        }
    }
    fit_noise(d, s);
}

size_t fit_columns(const fit_data *d, const fit_state *s, hypothesis_set set, int column[COLUMN_COUNT])
{
    size_t n = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *hypo = &hypothesis_table[h];
        if (!(set & HYPOTHESIS_BIT(h)) || hypo->fixed) {
            continue;
        }
        for (size_t k = 0; k < hypo->columns; k++) {
            if (hypo->column[k] == P_GAIN_C && d->rows->two_sensors) {
                continue; /* no such sensor */
            }
            column[n++] = hypo->column[k];
        }
        if (h == H_DEAD_TIME && s->z[P_V_DEAD] != 0.0) {
            column[n++] = P_KNEE;
            column[n++] = P_RIPPLE;
        }
    }
    if (!d->rows->two_sensors) {
        column[n++] = P_OFFSET_ZERO;
    }
    return n;
}

static double column_step(int column)
{
    return parameters_step(column < P_COUNT ? (parameter_id)column
                                            : P_L_D); /* joint ones move gains or inductances */
}

gram *fit_grams(fit_data *d, const fit_state *s, const int *column, size_t n)
{
    gram *grams = calloc(d->blocks + 1, sizeof *grams);
    size_t stride = FILTER_OUTPUTS * d->longest;
    if (!grams) {
        return NULL;
    }
    averaged_drive drive = parameters_drive(d->parameters, s->z);
    rows_nodes_fill(d->rows, &drive, d->nodes);
    averaged_drive moved[COLUMN_COUNT];
    double step[COLUMN_COUNT];
    for (size_t c = 0; c < n; c++) {
        double z[P_COUNT];
        memcpy(z, s->z, sizeof z);
        if (column[c] == P_EDGE) {
            moved[c] = drive; /* not a number to move: an empty column */
            step[c] = 1.0;
            continue;
        }
        step[c] = column_step(column[c]);
        column_move(column[c], step[c], z);
        moved[c] = parameters_drive(d->parameters, z);
    }
    /* Column by column would need every block's derivatives at once; block by block would need every column's
     * nodes at once. The nodes depend on R, L_d and L_q alone: only those columns bring a table of their own.
     */
    averaged_node *own[COLUMN_COUNT] = {NULL};
    bool complete = true;
    for (size_t c = 0; c < n; c++) {
        own[c] = d->nodes;
        if (moved[c].R_ohm != drive.R_ohm || moved[c].L_d_H != drive.L_d_H || moved[c].L_q_H != drive.L_q_H) {
            own[c] = rows_nodes(d->rows, &moved[c]);
            complete = complete && own[c];
        }
    }
    for (size_t b = 0; complete && b < d->blocks; b++) {
        const row_block *block = &d->rows->block[d->block[b]];
        const group_noise *noise = &s->noise[block->group];
        size_t outputs = FILTER_OUTPUTS * block->count;
        filter_block(d->rows, &drive, d->nodes, block, noise->gain, 0.0, d->base);
        whiten(noise, block->count, d->base, d->base);
        gram *sum = &grams[b];
        sum->group = block->group;
        sum->c = dot(d->base, d->base, outputs);
        for (size_t c = 0; c < n; c++) {
            double *column_c = d->columns + c * stride;
            filter_block(d->rows, &moved[c], own[c], block, noise->gain, 0.0, d->moved);
            whiten(noise, block->count, d->moved, column_c);
            for (size_t j = 0; j < outputs; j++) {
                column_c[j] = (column_c[j] - d->base[j]) / step[c];
            }
            sum->g[c] = dot(column_c, d->base, outputs);
            for (size_t a = 0; a <= c; a++) {
                sum->h[a][c] = sum->h[c][a] = dot(column_c, d->columns + a * stride, outputs);
            }
        }
    }
    for (size_t c = 0; c < n; c++) {
        if (own[c] != d->nodes) {
            free(own[c]);
        }
    }
    if (!complete) {
        free(grams);
        return NULL;
    }
    return grams;
}

/* One Gauss-Newton step, halved until the objective falls. True while steps still matter. */
static bool improve(fit_data *d, fit_state *s, bool *failed)
{
    int column[COLUMN_COUNT];
    size_t n = fit_columns(d, s, s->set, column);
    if (n == 0) {
        return false;
    }
    gram *grams = fit_grams(d, s, column, n);
    if (!grams) {
        *failed = true;
        return false;
    }
    gram *sum = calloc(1, sizeof *sum);
    double step[COLUMN_COUNT] = {0};
    for (size_t b = 0; sum && b < d->blocks; b++) {
        for (size_t i = 0; i < n; i++) {
            sum->g[i] -= grams[b].g[i];
            for (size_t j = 0; j < n; j++) {
                sum->h[i][j] += grams[b].h[i][j];
            }
        }
    }
    free(grams);
    bool solved = sum && fit_solve(n, (const double(*)[COLUMN_COUNT])sum->h, sum->g, step);
    double expected = 0.0;
    for (size_t i = 0; solved && i < n; i++) {
        expected += step[i] * sum->g[i];
    }
    free(sum);
    if (!solved) {
        return false;
    }
    for (double share = 1.0; share > 0.02; share *= 0.4) {
        fit_state trial = *s;
        for (size_t i = 0; i < n; i++) {
            column_move(column[i], share * step[i], trial.z);
        }
        parameters_bound(d->parameters, trial.z);
        fit_noise(d, &trial);
        if (trial.objective < s->objective) {
            *s = trial;
            return expected > 0.3;
        }
    }
    return false;
}

bool fit_refine(fit_data *d, fit_state *s, int iterations)
{
    bool failed = false;
    fit_noise(d, s);
    for (int k = 0; k < iterations; k++) {
        bool more = improve(d, s, &failed);
        double before = s->objective;
        fit_gain(d, s);
        if (!more && fabs(s->objective - before) < 0.5) {
            break;
        }
    }
    for (int k = 0; k < GAIN_STEPS; k++) {
        fit_gain(d, s);
    }
    return !failed;
}
