#include "measure.h"

#include <math.h>
#include <stdlib.h>

/* An innovation longer than this many (robust) standard deviations stands out; by chance once in 1e10 rows.
 */
static const double GLITCH = 7.0;
/* A glitch stands apart. Where more rows lie between these many deviations and GLITCH than beyond it, the
 * tail is a law that does not quite fit (dead time near zero current), and nothing is left out. */
static const double TAIL = 4.5;
/* More glitches than this share of the rows are no glitches, but a model that does not fit. */
static const double GLITCH_SHARE = 0.03;

static bool counts(const row_block *b, size_t group, bool held_out_only)
{
    return (group == MEASURE_ALL || b->group == group) && (b->held_out || !held_out_only);
}

double measure_current(const diagnose_rows *r, size_t group, bool held_out_only)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t b = 0; b < r->blocks; b++) {
        for (size_t j = 0; counts(&r->block[b], group, held_out_only) && j < r->block[b].count; j++) {
            vector_ab i = r->row[r->block[b].first + j].i_A;
            sum += i.a * i.a + i.b * i.b;
            n += 1.0;
        }
    }
    return n > 0.0 ? sqrt(sum / n) : 0.0;
}

double measure_one_cycle(const diagnose_rows *r, const averaged_drive *drive, size_t group,
                         bool held_out_only)
{
    size_t longest = 1;
    for (size_t b = 0; b < r->blocks; b++) {
        longest = r->block[b].count > longest ? r->block[b].count : longest;
    }
    averaged_node *nodes = rows_nodes(r, drive);
    vector_ab *wrong = calloc(longest, sizeof *wrong);
    double sum = 0.0;
    double n = 0.0;
    for (size_t b = 0; nodes && wrong && b < r->blocks; b++) {
        const row_block *block = &r->block[b];
        if (!counts(block, group, held_out_only)) {
            continue;
        }
        filter_one_cycle(r, drive, nodes, block->first, block->count, wrong);
        for (size_t j = 1; j < block->count; j++) {
            sum += wrong[j].a * wrong[j].a + wrong[j].b * wrong[j].b;
            n += 1.0;
        }
    }
    free(nodes);
    free(wrong);
    double current = measure_current(r, group, held_out_only);
    return n > 0.0 && current > 0.0 ? 100.0 * sqrt(sum / n) / current : 0.0;
}

/* Variance of the fast part of a column, from third differences; `wrap` > 0 for an angle. */
static double fast_variance(const recording *rec, const double *x, double wrap)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t s = 0; s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        for (size_t j = 3; j < st->count; j++) {
            const double *v = x + st->first + j;
            double d = v[0] - 3.0 * v[-1] + 3.0 * v[-2] - v[-3];
            d -= wrap > 0.0 ? wrap * round(d / wrap) : 0.0;
            sum += d * d;
            n += 1.0;
        }
    }
    return n > 0.0 ? sum / (20.0 * n) : 0.0;
}

/*
 * Sensor noise where the filter's gain says little, because structure is left: the one-cycle error of white
 * sensor noise is a difference, v(k+1) - v(k), and the lag-two autocovariance of the differenced error is its
 * variance; white disturbances and slow ones leave it alone.
 */
static double lag_two(const diagnose_rows *r, const averaged_drive *drive)
{
    averaged_node *nodes = rows_nodes(r, drive);
    double sum = 0.0;
    double n = 0.0;
    for (size_t b = 0; nodes && b < r->blocks; b++) {
        const row_block *block = &r->block[b];
        vector_ab *e = calloc(block->count, sizeof *e);
        if (!e) {
            break;
        }
        filter_one_cycle(r, drive, nodes, block->first, block->count, e);
        for (size_t j = 4; j < block->count; j++) {
            const unsigned char *bad = r->outlier + block->first + j;
            if (bad[0] || bad[-1] || bad[-2] || bad[-3]) {
                continue;
            }
            sum += (e[j].a - e[j - 1].a) * (e[j - 2].a - e[j - 3].a) +
                   (e[j].b - e[j - 1].b) * (e[j - 2].b - e[j - 3].b);
            n += 1.0;
        }
        free(e);
    }
    free(nodes);
    return n > 0.0 ? sum / n : 0.0;
}

double measure_floor(const diagnose_rows *r, const fit_state *s, const averaged_drive *drive,
                     double *sensor_rms_A)
{
    double trust = 0.0;
    double noise = 0.0;
    double rows = 0.0;
    double gain = 0.0;
    for (size_t g = 0; g < r->groups; g++) {
        const group_noise *n = &s->noise[g];
        double weight = n->rows * (1.0 - n->gain) * (1.0 - n->gain);
        noise += weight * (1.0 - n->gain) * (n->cov[0] + n->cov[2]);
        trust += weight;
        gain += n->rows * n->gain;
        rows += n->rows;
    }
    double variance = trust > 0.0 ? noise / trust : 0.0; /* of a sample's noise vector */
    if (rows > 0.0 && gain / rows > 0.6) {
        double other = lag_two(r, drive);
        variance = other > 0.0 ? other : variance;
    }
    /* Three sensors: a vector carries 4/3 of one's variance. Two: alpha has 1, beta 5/3. */
    *sensor_rms_A = sqrt(variance / (r->two_sensors ? 8.0 / 3.0 : 4.0 / 3.0));
    double L = 0.5 * (drive->L_d_H + drive->L_q_H);
    double decay = exp(-drive->R_ohm * r->T_s / L);
    double angle = fast_variance(r->recording, r->recording->theta_e_rad, 6.28318530717958647693);
    double link = r->recording->u_dc_V ? fast_variance(r->recording, r->recording->u_dc_V, 0.0) : 0.0;
    double more = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const drive_row *row = &r->row[k];
        double emf = row->omega_rad_s * drive->psi_f_Wb;
        more += emf * emf * angle;
        if (r->recording->u_dc_V && r->recording->u_dc_V[k] > 0.0) {
            double share = hypot(row->u_V[0].a, row->u_V[0].b) / r->recording->u_dc_V[k];
            more += share * share * link;
        }
    }
    more *= r->T_s * r->T_s / (L * L * (double)r->rows);
    return sqrt(variance * (1.0 + decay * decay) + more);
}

static int ascending(const void *x, const void *y)
{
    double a = *(const double *)x;
    double b = *(const double *)y;
    return a < b ? -1 : a > b;
}

size_t measure_outliers(fit_data *d, const fit_state *s)
{
    diagnose_rows *r = d->rows;
    averaged_drive drive = parameters_drive(d->parameters, s->z);
    averaged_node *nodes = rows_nodes(r, &drive);
    double *square = calloc(r->rows + 1, sizeof *square);
    double *innovation = calloc(FILTER_OUTPUTS * r->rows + 1, sizeof *innovation);
    size_t found = 0;
    size_t apart = 0;
    size_t between = 0;
    for (size_t g = 0; nodes && square && innovation && g < r->groups; g++) {
        size_t n = 0;
        for (size_t b = 0; b < r->blocks; b++) {
            if (r->block[b].group != g) {
                continue;
            }
            filter_block(r, &drive, nodes, &r->block[b], s->noise[g].gain, 0.0, innovation);
            for (size_t j = 0; j < r->block[b].count; j++) {
                const double *e = innovation + FILTER_OUTPUTS * j;
                square[n] = e[0] * e[0] + e[1] * e[1];
                n += square[n] > 0.0;
            }
        }
        if (n < 20) {
            continue;
        }
        qsort(square, n, sizeof *square, ascending);
        /* The median of a two-dimensional normal square is 2 ln 2 of one component's variance. */
        double deviation = sqrt(square[n / 2] / 1.386294361119891);
        for (size_t k = 0; k < n; k++) {
            double size = sqrt(square[k]) / deviation;
            apart += size > GLITCH;
            between += size > TAIL && size <= GLITCH;
        }
        for (size_t b = 0; b < r->blocks; b++) {
            if (r->block[b].group == g) {
                filter_block(r, &drive, nodes, &r->block[b], s->noise[g].gain, GLITCH * deviation,
                             innovation);
            }
        }
    }
    for (size_t k = 0; k < r->rows; k++) {
        found += r->outlier[k];
    }
    if ((double)found > GLITCH_SHARE * (double)r->rows || between > apart) {
        for (size_t k = 0; k < r->rows; k++) {
            r->outlier[k] = 0;
        }
        found = 0;
    }
    free(nodes);
    free(square);
    free(innovation);
    return found;
}
