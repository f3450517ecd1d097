/* Gauss-Newton steps and the observer's gains (fit.h). */
#include "fit.h"

#include "base/solve.h"
#include "fit_step.h"
#include "last_digits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A fit takes far fewer joint steps than this limit: it should end by its aim. */
enum { GAIN_STEPS = 4, JOINT_STEPS = 8 };

/* The members alone need only come near: their limits are those of the aim times this. */
static const double NEAR = 10.0;

/* What a descent moves: gains only, gains and the set's own columns, or also the parameter tolerances. */
typedef enum moved_by { GAINS, MEMBERS, ALL } moved_by;

/*
 * Limits of the observer gain. A gain of 0 would never correct the model. 0.03 limits the observer's memory to thirty cycles. The
 * estimates lose little by that (the regressor's noise variance is 3 % of the sensor's), and a small slow error of the model does not
 * accumulate.
 */
static const double GAIN_LEAST = 0.03;
static const double GAIN_MOST = 0.98;

/* Computes covariances, whitening and the objective from the sums of squares. */
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
        pool_rows += n->counted;
    }
    s->objective = 0.0;
    for (size_t g = 0; g < d->rows->groups; g++) {
        /* Weight of the mean over all groups, in rows: a group of a few rows has no reliable covariance of its own. */
        const double lean = d->pooled ? 1e6 : 20.0;
        group_noise *n = &s->noise[g];
        double count = n->counted + lean;
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
        n->white_zero = d->rows->sensors == SENSORS_THREE ? 1.0 / sqrt(cov[3]) : 0.0;
        s->objective += n->rows * 2.0 * (log(l11) + log(l22));
        s->objective += d->rows->sensors == SENSORS_THREE ? n->rows * log(cov[3]) : 0.0;
    }
}

typedef struct sums_task {
    fit_data *d;
    const fit_state *s;
    averaged_drive drive;
    block_sums *sums;
} sums_task;

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
        sums->rows += work->seen[j] > 0.0 ? 1.0 : 0.0;
        sums->counted += work->seen[j];
    }
}

void fit_noise(fit_data *d, fit_state *s)
{
    sums_task t = {.d = d, .s = s, .drive = fit_drive(d, s), .sums = d->sums};
    rows_nodes_fill(d->rows, &t.drive, d->nodes);
    fit_spend(d, &t.drive, 1);
    memset(d->sums, 0, d->blocks * sizeof *d->sums);
    parallel_for(d->blocks, noise_of_block, &t);
    for (size_t g = 0; g < d->rows->groups; g++) {
        group_noise *n = &s->noise[g];
        n->cov[0] = n->cov[1] = n->cov[2] = n->zero = n->rows = n->counted = 0.0;
    }
    for (size_t b = 0; b < d->blocks; b++) {
        const block_sums *sums = &d->sums[b];
        group_noise *n = &s->noise[d->rows->block[d->block[b]].group];
        for (size_t k = 0; k < 3; k++) {
            n->cov[k] += d->weight * sums->cov[k];
        }
        n->zero += d->weight * sums->zero;
        n->rows += d->weight * sums->rows;
        n->counted += d->weight * sums->counted;
    }
    finish_noise(d, s);
}

/* The function that a descent minimises: the objective, with the priors of the parameter tolerances. */
static double goal(const fit_state *s)
{
    return s->objective + last_digits_unusual(s->set, s->z);
}

/* Columns that move together, their step, and how every group's gain follows. */
typedef struct descent {
    size_t n;
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT];
    double step[COLUMN_COUNT];
    gain_line gain[ROWS_MAX_GROUPS];
    gram sum;
} descent;

void fit_step_sums(const fit_data *d, const fit_state *s, const gram *grams, size_t n, gain_line *line,
                   gram *sum)
{
    for (size_t b = 0; b < d->blocks; b++) {
        gain_line *own = &line[grams[b].group];
        gram_add(sum, &grams[b], n);
        own->down -= grams[b].g[n];
        own->curve += grams[b].h[n][n];
        for (size_t i = 0; i < n; i++) {
            own->lean[i] += grams[b].h[n][i];
        }
    }
    for (size_t g = 0; g < d->rows->groups; g++) {
        gain_line *own = &line[g];
        const double gain = s->noise[g].gain;
        own->held = !(own->curve > 0.0) || (gain <= GAIN_LEAST && own->down < 0.0) ||
                    (gain >= GAIN_MOST && own->down > 0.0);
        for (size_t i = 0; !own->held && i < n; i++) {
            sum->g[i] += own->lean[i] * own->down / own->curve;
            for (size_t j = 0; j < n; j++) {
                sum->h[i][j] -= own->lean[i] * own->lean[j] / own->curve;
            }
        }
    }
}

/* The step of a group's gain that belongs to a step of the columns. */
static double gain_step(const gain_line *line, size_t n, const double *step)
{
    double down = line->down;
    for (size_t i = 0; i < n; i++) {
        down -= line->lean[i] * step[i];
    }
    return line->held ? 0.0 : down / line->curve;
}

void fit_step_room(const fit_data *d, const fit_state *s, const int *column, size_t n, double *low,
                   double *high)
{
    for (size_t i = 0; i < n; i++) {
        low[i] = -INFINITY;
        high[i] = INFINITY;
        if (column[i] < P_COUNT) {
            const coordinate_id id = (coordinate_id)column[i];
            coordinate_range(d->frame, id, &low[i], &high[i]);
            low[i] -= s->z[id];
            high[i] -= s->z[id];
            const double stride = coordinate_table[id].stride;
            low[i] = stride > 0.0 ? fmax(low[i], -stride) : low[i];
            high[i] = stride > 0.0 ? fmin(high[i], stride) : high[i];
        }
    }
}

/* Finds the step, damped by a share of each curvature; *expected: the reduction that it predicts. False: there is none. */
static bool find_step(const fit_data *d, const fit_state *s, const gram *grams, double damping, descent *by,
                      double *expected)
{
    double rest[P_COUNT];
    double low[COLUMN_COUNT];
    double high[COLUMN_COUNT];
    gram *sum = &by->sum;
    memset(sum, 0, sizeof *sum);
    memset(by->gain, 0, sizeof by->gain);
    fit_step_sums(d, s, grams, by->n, by->gain, sum);
    last_digits_rest(s->set, s->z, rest);
    for (size_t i = 0; i < by->n; i++) {
        sum->g[i] = -sum->g[i];
        if (by->prior[i] > 0.0) {
            const double digits = coordinate_table[by->column[i]].digits;
            sum->g[i] -= rest[by->column[i]] / (digits * digits);
            sum->h[i][i] += by->prior[i];
        }
        sum->h[i][i] *= 1.0 + damping;
    }
    /* With bounds: if a step is clipped afterwards, the other columns compensate for a movement that does not take place. */
    fit_step_room(d, s, by->column, by->n, low, high);
    if (!solve_within(by->n, COLUMN_COUNT, &sum->h[0][0], sum->g, low, high, by->step)) {
        return false;
    }
    *expected = 0.0;
    for (size_t i = 0; i < by->n; i++) {
        *expected += 2.0 * by->step[i] * sum->g[i];
        for (size_t j = 0; j < by->n; j++) {
            *expected -= by->step[i] * sum->h[i][j] * by->step[j];
        }
    }
    for (size_t g = 0; g < d->rows->groups; g++) {
        *expected += by->gain[g].held ? 0.0 : by->gain[g].down * by->gain[g].down / by->gain[g].curve;
    }
    return *expected > 0.0;
}

fit_state fit_step_taken(fit_data *d, const fit_state *s, const int *column, const double *step, size_t n,
                         const gain_line *line, double share)
{
    fit_state trial = *s;
    for (size_t i = 0; i < n; i++) {
        column_move(column[i], share * step[i], trial.z);
    }
    for (size_t g = 0; g < d->rows->groups; g++) {
        const double gain = trial.noise[g].gain + share * gain_step(&line[g], n, step);
        trial.noise[g].gain = fmin(fmax(gain, GAIN_LEAST), GAIN_MOST);
    }
    coordinates_bound(d->frame, trial.z);
    fit_noise(d, &trial);
    return trial;
}

/* Takes a step, shortened until the objective falls. False: it never does. */
static bool take_step(fit_data *d, fit_state *s, const descent *by)
{
    for (double share = 1.0; share > 0.02; share *= 0.4) {
        const fit_state trial = fit_step_taken(d, s, by->column, by->step, by->n, by->gain, share);
        if (goal(&trial) < goal(s)) {
            *s = trial;
            return true;
        }
    }
    return false;
}

/*
 * A step that makes the objective fall. The shapes of a flux map's parts nearly replace one another, so that the parabola ends far
 * from where it holds: where no part of its step brings anything, a damped step does (Levenberg and Marquardt).
 */
static void step_down(fit_data *d, fit_state *s, const gram *grams, descent *by, double *expected)
{
    static const double dampings[] = {0.0, 1e-3, 0.1, 10.0};
    const bool parts = hypothesis_in(s->set, H_IRON_1) || hypothesis_in(s->set, H_IRON_2);
    for (size_t k = 0; k < (parts ? sizeof dampings / sizeof *dampings : 1); k++) {
        if (find_step(d, s, grams, dampings[k], by, expected) && take_step(d, s, by)) {
            return;
        }
    }
    *expected = 0.0;
}

/* One Gauss-Newton step; *expected: the reduction that it predicted, 0 if there was none. False: out of memory. */
static bool improve(fit_data *d, fit_state *s, moved_by what, double *expected)
{
    descent *by = calloc(1, sizeof *by);
    gram *grams = NULL;
    if (by) {
        by->n = what == GAINS ? 0 : gram_columns(d, s, s->set, by->column);
        by->n = what == ALL ? last_digits_append(d, s, by->n, by->column, by->prior) : by->n;
        by->column[by->n] = COLUMN_GAIN;
        grams = gram_blocks(d, s, by->column, by->n + 1);
    }
    const bool ok = grams != NULL;
    if (ok) {
        step_down(d, s, grams, by, expected);
    }
    free(grams);
    free(by);
    return ok;
}

/*
 * Takes steps until one predicts a reduction of at most aim->enough. It also ends if the reduction is the predicted one: the parabola
 * holds there, so nothing is left to find. A small reduction alone is no sign of the end: a shortened step, or a step past a bend,
 * may leave much. Gives up if aim->most is out of reach even though each step brings two thirds of the one before.
 */
static bool descend(fit_data *d, fit_state *s, int steps, moved_by what, const fit_aim *aim)
{
    for (int k = 0; k < steps; k++) {
        const double before = goal(s);
        double expected = 0.0;
        if (!improve(d, s, what, &expected)) {
            return false;
        }
        const double fell = before - goal(s);
        if (expected <= aim->enough || fabs(expected - fell) <= aim->held ||
            (k > 0 && goal(s) - 2.0 * fell > aim->most)) {
            break;
        }
    }
    return true;
}

bool fit_of_nominal(fit_data *d, fit_state *s)
{
    *s = fit_nominal();
    return fit_gains(d, s);
}

bool fit_gains(fit_data *d, fit_state *s)
{
    fit_noise(d, s);
    const fit_aim kept = fit_kept(INFINITY);
    return descend(d, s, GAIN_STEPS, GAINS, &kept);
}

bool fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone)
{
    fit_noise(d, s);
    if (!isfinite(s->objective)) {
        *alone = NAN;
        return true;
    }
    /* First the members alone: while they are far off, the tolerances would move to compensate for them. */
    const fit_aim near = {.enough = NEAR * aim->enough, .held = NEAR * aim->held, .most = aim->most};
    const bool ok = descend(d, s, iterations, MEMBERS, &near);
    *alone = s->objective;
    return ok && (*alone > aim->most || descend(d, s, JOINT_STEPS, ALL, aim));
}

bool fit_refine(fit_data *d, fit_state *s, int iterations)
{
    double alone;
    const fit_aim kept = fit_kept(INFINITY);
    return fit_refine_within(d, s, iterations, &kept, &alone);
}

bool fit_members(fit_data *d, fit_state *s, int iterations, const fit_aim *aim)
{
    fit_noise(d, s);
    return !isfinite(s->objective) || descend(d, s, iterations, MEMBERS, aim);
}
