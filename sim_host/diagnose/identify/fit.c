/* Gauss-Newton and the observer's gains (fit.h). */
#include "fit.h"

#include "base/solve.h"
#include "last_digits.h"
#include "observer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GAIN_STEPS = 2, JOINT_STEPS = 3 };

/*
 * A gain of nought would trust the model for ever. One part in thirty bounds its memory to thirty cycles: the
 * estimates lose little (the regressor's noise variance is 3 % of the sensor's), and a small slow error of
 * the model is not summed up.
 */
static const double GAIN_LEAST = 0.03;
static const double GAIN_MOST = 0.98;

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
        double tiny = 1e-14 * d->frame->i_rated_peak_A * d->frame->i_rated_peak_A;
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

typedef struct sums_task {
    fit_data *d;
    const fit_state *s;
    averaged_drive drive;
    block_sums *sums;
} sums_task;

static const double GAIN_STEP = 1e-3;

static void noise_of_block(void *context, size_t b, size_t worker)
{
    const sums_task *t = context;
    const struct fit_work *work = &t->d->work[worker];
    const row_block *block = &t->d->rows->block[t->d->block[b]];
    block_sums *sums = &t->sums[b];
    observer_block(t->d->rows, &t->drive, t->d->nodes, block, t->s->noise[block->group].gain, 0.0, work->base,
                   work->seen);
    for (size_t j = 0; j < block->count; j++) {
        const double *e = work->base + OBSERVER_OUTPUTS * j;
        sums->cov[0] += e[0] * e[0];
        sums->cov[1] += e[0] * e[1];
        sums->cov[2] += e[1] * e[1];
        sums->zero += e[2] * e[2];
        sums->rows += work->seen[j];
    }
}

static void gain_of_block(void *context, size_t b, size_t worker)
{
    const sums_task *t = context;
    fit_data *d = t->d;
    const struct fit_work *work = &d->work[worker];
    const row_block *block = &d->rows->block[d->block[b]];
    const group_noise *n = &t->s->noise[block->group];
    observer_block(d->rows, &t->drive, d->nodes, block, n->gain, 0.0, work->base, NULL);
    observer_block(d->rows, &t->drive, d->nodes, block, n->gain + GAIN_STEP, 0.0, work->moved, NULL);
    gram_whiten(n, block->count, work->base, work->base);
    gram_whiten(n, block->count, work->moved, work->moved);
    for (size_t j = 0; j < OBSERVER_OUTPUTS * block->count; j++) {
        const double slope = (work->moved[j] - work->base[j]) / GAIN_STEP;
        t->sums[b].down += slope * work->base[j];
        t->sums[b].curve += slope * slope;
    }
}

/* Each block's sums at the state. */
static void sum_blocks(fit_data *d, const fit_state *s, void (*of_block)(void *, size_t, size_t))
{
    sums_task t = {.d = d, .s = s, .drive = fit_drive(d, s), .sums = d->sums};
    rows_nodes_fill(d->rows, &t.drive, d->nodes);
    memset(d->sums, 0, d->blocks * sizeof *d->sums);
    parallel_for(d->blocks, of_block, &t);
}

void fit_noise(fit_data *d, fit_state *s)
{
    sum_blocks(d, s, noise_of_block);
    for (size_t g = 0; g < d->rows->groups; g++) {
        group_noise *n = &s->noise[g];
        n->cov[0] = n->cov[1] = n->cov[2] = n->zero = n->rows = 0.0;
    }
    for (size_t b = 0; b < d->blocks; b++) {
        const block_sums *sums = &d->sums[b];
        group_noise *n = &s->noise[d->rows->block[d->block[b]].group];
        for (size_t k = 0; k < 3; k++) {
            n->cov[k] += sums->cov[k];
        }
        n->zero += sums->zero;
        n->rows += sums->rows;
    }
    finish_noise(d, s);
}

void fit_gain(fit_data *d, fit_state *s)
{
    double down[ROWS_MAX_GROUPS] = {0};
    double curve[ROWS_MAX_GROUPS] = {0};
    sum_blocks(d, s, gain_of_block);
    for (size_t b = 0; b < d->blocks; b++) {
        down[d->rows->block[d->block[b]].group] += d->sums[b].down;
        curve[d->rows->block[d->block[b]].group] += d->sums[b].curve;
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

fit_state fit_of_nominal(fit_data *d)
{
    enum { GAIN_ROUNDS = 4 };
    fit_state s = fit_nominal();
    fit_noise(d, &s);
    for (int k = 0; k < GAIN_ROUNDS; k++) {
        fit_gain(d, &s);
    }
    return s;
}

/* What is made small: the objective, with the prior of what moves unnamed. */
static double goal(const fit_state *s)
{
    return s->objective + last_digits_unusual(s->set, s->z);
}

/* One Gauss-Newton step, halved until the objective falls. True while steps still matter. */
static bool improve(fit_data *d, fit_state *s, bool with_digits, bool *failed)
{
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT] = {0.0};
    double rest[P_COUNT];
    const size_t members = gram_columns(d, s, s->set, column);
    const size_t n = with_digits ? last_digits_append(d, s, members, column, prior) : members;
    if (n == 0) {
        return false;
    }
    gram *grams = gram_blocks(d, s, column, n);
    if (!grams) {
        *failed = true;
        return false;
    }
    gram *sum = calloc(1, sizeof *sum);
    double step[COLUMN_COUNT] = {0};
    for (size_t b = 0; sum && b < d->blocks; b++) {
        gram_add(sum, &grams[b], n);
    }
    free(grams);
    last_digits_rest(s->set, s->z, rest);
    for (size_t i = 0; sum && i < n; i++) {
        sum->g[i] = -sum->g[i];
        if (i >= members) {
            const double digits = coordinate_table[column[i]].digits;
            sum->g[i] -= rest[column[i]] / (digits * digits);
            sum->h[i][i] += prior[i];
        }
    }
    bool solved = sum && solve_positive(n, COLUMN_COUNT, &sum->h[0][0], sum->g, step);
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
        coordinates_bound(d->frame, trial.z);
        fit_noise(d, &trial);
        if (goal(&trial) < goal(s)) {
            *s = trial;
            return expected > 0.3;
        }
    }
    return false;
}

/* Steps until they do not matter; gains between them. */
static bool descend(fit_data *d, fit_state *s, int iterations, bool with_digits)
{
    bool failed = false;
    for (int k = 0; k < iterations; k++) {
        bool more = improve(d, s, with_digits, &failed);
        double before = s->objective;
        fit_gain(d, s);
        if (!more && fabs(s->objective - before) < 0.5) {
            break;
        }
    }
    return !failed;
}

bool fit_refine_within(fit_data *d, fit_state *s, int iterations, double most, double *alone)
{
    fit_noise(d, s);
    /* First the members alone: while they are far off, what is small would run after them. */
    bool ok = descend(d, s, iterations, false);
    *alone = s->objective;
    if (ok && *alone > most) {
        return true;
    }
    ok = ok && descend(d, s, JOINT_STEPS, true);
    for (int k = 0; k < GAIN_STEPS; k++) {
        fit_gain(d, s);
    }
    return ok;
}

bool fit_refine(fit_data *d, fit_state *s, int iterations)
{
    double alone;
    return fit_refine_within(d, s, iterations, INFINITY, &alone);
}
