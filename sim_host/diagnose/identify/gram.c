/* Sums over blocks (gram.h). */
#include "gram.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void gram_whiten(const group_noise *n, size_t rows, const double *innovation, double *out)
{
    for (size_t j = 0; j < rows; j++) {
        const double *e = innovation + OBSERVER_OUTPUTS * j;
        double *w = out + OBSERVER_OUTPUTS * j;
        /* Computed before w[0] is written, because `out` may be the innovations themselves. */
        const double second = n->white[1] * e[0] + n->white[2] * e[1];
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

size_t gram_columns(const fit_data *d, const fit_state *s, hypothesis_set set, int column[COLUMN_COUNT])
{
    size_t n = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *hypo = &hypothesis_table[h];
        if (!(set & HYPOTHESIS_BIT(h))) {
            continue;
        }
        for (size_t k = hypo->fixed; k < hypo->columns; k++) {
            if (column_shows(hypo->column[k], d->rows)) {
                column[n++] = hypo->column[k];
            }
        }
        for (size_t k = 0; k < hypo->shapes; k++) {
            /* Without the effect its shape moves nothing. */
            const int of = hypo->column[hypo->shape_of[k]];
            double low;
            double high;
            coordinate_range(d->frame, hypo->shape[k], &low, &high);
            if (s->z[of] != 0.0 && low < high) {
                column[n++] = (int)hypo->shape[k];
            }
        }
    }
    if (rows_show_three(d->rows)) {
        column[n++] = P_OFFSET_ZERO;
    }
    return n;
}

/* Step of a column for difference quotients. Joint columns move gains or inductances and have the step of P_L_D. */
static double column_step(const fit_data *d, int column, const double z[P_COUNT])
{
    if (column == COLUMN_GAIN) {
        return 1e-3;
    }
    const coordinate_id id = column < P_COUNT ? (coordinate_id)column : P_L_D;
    return d->searches ? coordinate_look(id, z[id]) : coordinate_step(id);
}

/* What the blocks of one call share. */
typedef struct gram_task {
    fit_data *d;
    const fit_state *s;
    size_t columns;
    averaged_drive drive;
    averaged_drive moved[COLUMN_COUNT];
    averaged_node
        *own[COLUMN_COUNT]; /* nodes depend on R, L_d and L_q only: columns that move these have their own */
    double step[COLUMN_COUNT];
    double more_gain[COLUMN_COUNT];
    bool beside[COLUMN_COUNT]; /* moves only the sensors or the gain: linearised about the state's own run */
    bool any_beside;
    bool alike[COLUMN_COUNT];   /* its cycles are those of the state */
    bool rotates[COLUMN_COUNT]; /* it moves the rotor */
    gram *grams;
} gram_task;

/* Derivatives of the innovations by each column: differences from the state's own in work->base, written to work->columns. */
static void find_slopes(const gram_task *t, const row_block *block, const struct fit_work *work,
                        size_t stride)
{
    const double own_gain = t->s->noise[block->group].gain;
    for (size_t c = 0; c < t->columns; c++) {
        double *slope = work->columns + c * stride;
        const double gain = own_gain + t->more_gain[c];
        if (t->beside[c]) {
            observer_beside(t->d->rows, &t->moved[c], work->cycle, block, gain, work->way, slope);
        } else if (t->alike[c]) {
            observer_through(t->d->rows, &t->moved[c], work->cycle, block, gain, slope);
        } else {
            observer_cycles(t->d->rows, &t->moved[c], t->own[c], block, t->rotates[c] ? NULL : work->cycle,
                            work->own_cycle);
            observer_through(t->d->rows, &t->moved[c], work->own_cycle, block, gain, slope);
        }
        for (size_t j = 0; j < OBSERVER_OUTPUTS * block->count; j++) {
            slope[j] = (slope[j] - work->base[j]) / t->step[c];
        }
    }
}

static void one_block(void *context, size_t b, size_t worker)
{
    const gram_task *t = context;
    fit_data *d = t->d;
    const struct fit_work *work = &d->work[worker];
    const row_block *block = &d->rows->block[d->block[b]];
    const group_noise *noise = &t->s->noise[block->group];
    const size_t outputs = OBSERVER_OUTPUTS * block->count;
    const size_t stride = OBSERVER_OUTPUTS * d->longest;
    gram *sum = &t->grams[b];
    observer_cycles(d->rows, &t->drive, d->nodes, block, NULL, work->cycle);
    if (t->any_beside) {
        observer_way(d->rows, &t->drive, work->cycle, block, noise->gain, work->base, work->way);
    } else {
        observer_through(d->rows, &t->drive, work->cycle, block, noise->gain, work->base);
    }
    find_slopes(t, block, work, stride);
    gram_whiten(noise, block->count, work->base, work->base);
    sum->group = block->group;
    sum->c = d->weight * dot(work->base, work->base, outputs);
    for (size_t c = 0; c < t->columns; c++) {
        double *column_c = work->columns + c * stride;
        gram_whiten(noise, block->count, column_c, column_c);
        sum->g[c] = d->weight * dot(column_c, work->base, outputs);
        for (size_t a = 0; a <= c; a++) {
            sum->h[a][c] = sum->h[c][a] = d->weight * dot(column_c, work->columns + a * stride, outputs);
        }
    }
}

/*
 * Marks the columns that are linearised about the state's own run. Finding the derivatives of that run costs two more runs, so there
 * must be more than two such columns.
 */
static void find_beside(gram_task *t, const int *column)
{
    size_t count = 0;
    for (size_t c = 0; c < t->columns; c++) {
        t->beside[c] =
            column[c] == COLUMN_GAIN || (column[c] < P_COUNT && coordinate_table[column[c]].senses);
        count += t->beside[c] ? 1 : 0;
    }
    t->any_beside = count > 2;
    for (size_t c = 0; c < t->columns; c++) {
        t->beside[c] = t->beside[c] && t->any_beside;
    }
}

/* Sets each column's drive, and its nodes if the column moves R, L_d or L_q. False: out of memory. */
static bool move_columns(gram_task *t, const int *column)
{
    fit_data *d = t->d;
    bool complete = true;
    find_beside(t, column);
    for (size_t c = 0; c < t->columns; c++) {
        double z[P_COUNT];
        memcpy(z, t->s->z, sizeof z);
        t->step[c] = column_step(d, column[c], z);
        if (column[c] == COLUMN_GAIN) {
            t->more_gain[c] = t->step[c];
        } else {
            column_move(column[c], t->step[c], z);
        }
        averaged_drive moved = coordinates_drive(d->frame, z, t->s->edge);
        moved.sign_is_doubted = t->drive.sign_is_doubted;
        t->moved[c] = moved;
        t->alike[c] = averaged_drive_cycles_alike(&moved, &t->drive);
        t->rotates[c] = !averaged_drive_rotors_alike(&moved, &t->drive);
        t->own[c] = d->nodes;
        if (moved.R_ohm != t->drive.R_ohm || moved.L_d_H != t->drive.L_d_H || moved.L_q_H != t->drive.L_q_H) {
            t->own[c] = rows_nodes(d->rows, &moved);
            complete = complete && t->own[c];
        }
    }
    return complete;
}

gram *gram_blocks(fit_data *d, const fit_state *s, const int *column, size_t n)
{
    gram_task t = {.d = d, .s = s, .columns = n, .drive = fit_drive(d, s)};
    rows_nodes_fill(d->rows, &t.drive, d->nodes);
    fit_spend(d, &t.drive, n + 1);
    t.grams = move_columns(&t, column) ? calloc(d->blocks + 1, sizeof *t.grams) : NULL;
    if (t.grams) {
        parallel_for(d->blocks, one_block, &t);
    }
    for (size_t c = 0; c < n; c++) {
        if (t.own[c] != d->nodes) {
            free(t.own[c]);
        }
    }
    return t.grams;
}

void gram_add(gram *to, const gram *from, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        to->g[i] += from->g[i];
        for (size_t j = 0; j < n; j++) {
            to->h[i][j] += from->h[i][j];
        }
    }
}

/* Of a factor's logarithm, for the difference by which its direction is found. */
static const double SCALE_STEP = 1e-4;
/* What the columns cannot follow of it, as a share of the factor. */
static const double SCALE_MISSED = 1e-3;

/* A shape moves nothing without the effect. */
static bool moves_drive(const averaged_drive *drive, coordinate_id id)
{
    bool is_shape = false;
    bool acts = false;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *hypo = &hypothesis_table[h];
        for (size_t k = 0; k < hypo->shapes; k++) {
            const coordinate_id of = (coordinate_id)hypo->column[hypo->shape_of[k]];
            is_shape = is_shape || hypo->shape[k] == id;
            acts = acts || (hypo->shape[k] == id && coordinate_value(drive, of) != 0.0);
        }
    }
    return acts || !is_shape;
}

/*
 * How the drive that a factor on all voltages and another on all currents make of the state's moves along the columns, per unit of the
 * logarithm. False: the columns cannot follow it.
 */
static bool scale_direction(const fit_data *d, const fit_state *s, const int *column, size_t n,
                            double voltages, double currents, double along[COLUMN_COUNT])
{
    double more[P_COUNT];
    double less[P_COUNT];
    memcpy(more, s->z, sizeof more);
    memcpy(less, s->z, sizeof less);
    coordinates_scale(d->frame, exp(SCALE_STEP * voltages), exp(SCALE_STEP * currents), more);
    coordinates_scale(d->frame, exp(-SCALE_STEP * voltages), exp(-SCALE_STEP * currents), less);
    for (size_t k = 0; k < P_COUNT; k++) {
        more[k] = (more[k] - less[k]) / (2.0 * SCALE_STEP);
    }
    double missed[P_COUNT];
    memcpy(missed, more, sizeof missed);
    for (size_t c = 0; c < n; c++) {
        along[c] = column[c] < COLUMN_GAIN ? column_value(column[c], more) : 0.0;
        if (along[c] != 0.0) {
            column_move(column[c], -along[c], missed);
        }
    }
    const averaged_drive drive = fit_drive(d, s);
    bool follows = true;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        follows = follows && (fabs(missed[id]) < SCALE_MISSED || !column_shows((int)id, d->rows) ||
                              !moves_drive(&drive, id));
    }
    return follows;
}

/* x' diag(H) y, over all blocks. */
static double by_diagonal(const fit_data *d, const gram *grams, size_t n, const double *x, const double *y)
{
    double sum = 0.0;
    for (size_t b = 0; b < d->blocks; b++) {
        for (size_t c = 0; c < n; c++) {
            sum += x[c] * grams[b].h[c][c] * y[c];
        }
    }
    return sum;
}

/* Takes a direction out of one block's sums: what they say of it is shared out among the columns by `share`, whose product with it is 1. */
static void take_out(gram *sums, size_t n, const double *along, const double *share)
{
    double of_g = 0.0;
    double of_h[COLUMN_COUNT] = {0.0};
    double of_all = 0.0;
    for (size_t i = 0; i < n; i++) {
        of_g += along[i] * sums->g[i];
        for (size_t j = 0; j < n; j++) {
            of_h[i] += sums->h[i][j] * along[j];
        }
    }
    for (size_t i = 0; i < n; i++) {
        of_all += along[i] * of_h[i];
    }
    for (size_t i = 0; i < n; i++) {
        sums->g[i] -= share[i] * of_g;
        for (size_t j = 0; j < n; j++) {
            sums->h[i][j] += share[i] * share[j] * of_all - share[i] * of_h[j] - of_h[i] * share[j];
        }
    }
}

void gram_free_scale(const fit_data *d, const fit_state *s, const int *column, size_t n, gram *grams)
{
    double along[2][COLUMN_COUNT];
    double square[2] = {0.0};
    size_t found = 0;
    for (int of_currents = 0; of_currents < 2; of_currents++) {
        double *own = along[found];
        if (!scale_direction(d, s, column, n, 1.0 - of_currents, of_currents, own)) {
            continue;
        }
        for (size_t k = 0; k < found; k++) {
            const double shared = by_diagonal(d, grams, n, own, along[k]) / square[k];
            for (size_t c = 0; c < n; c++) {
                own[c] -= shared * along[k][c];
            }
        }
        square[found] = by_diagonal(d, grams, n, own, own);
        found += square[found] > 0.0 ? 1 : 0;
    }
    for (size_t k = 0; k < found; k++) {
        double share[COLUMN_COUNT] = {0.0};
        for (size_t b = 0; b < d->blocks; b++) {
            for (size_t c = 0; c < n; c++) {
                share[c] += grams[b].h[c][c] * along[k][c] / square[k];
            }
        }
        for (size_t b = 0; b < d->blocks; b++) {
            take_out(&grams[b], n, along[k], share);
        }
    }
}
