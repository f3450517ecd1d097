/* The noise floor (floor.h). */
#include "floor.h"

#include "diagnose/identify/observer.h"
#include "model/sensor_chain.h"

#include <math.h>
#include <stdlib.h>

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
        vec_ab *e = calloc(block->count, sizeof *e);
        if (!e) {
            break;
        }
        observer_one_cycle(r, drive, nodes, block->first, block->count, e);
        for (size_t j = 4; j < block->count; j++) {
            const unsigned char *bad = r->outlier + block->first + j;
            if (bad[0] || bad[-1] || bad[-2] || bad[-3]) {
                continue;
            }
            sum += (e[j].alpha - e[j - 1].alpha) * (e[j - 2].alpha - e[j - 3].alpha) +
                   (e[j].beta - e[j - 1].beta) * (e[j - 2].beta - e[j - 3].beta);
            n += 1.0;
        }
        free(e);
    }
    free(nodes);
    return n > 0.0 ? sum / n : 0.0;
}

/*
 * An over-compensation goes by the sign of the current at the cycle's start. Where the recorded one has the other sign by
 * noise of that variance, a perfect model errs by twice the compensation: the mean square over the rows.
 */
static double by_wrong_signs(const diagnose_rows *r, const averaged_drive *drive, double variance)
{
    const double L = 0.5 * (drive->L_d_H + drive->L_q_H);
    const double jump_A = 2.0 * (1.0 + drive->dead_share) * drive->v_dead_V * 2.0 / 3.0 * r->T_s / L;
    const sensor_map sensors = sensor_map_of(drive, r->two_sensors, 0.0);
    double sum = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const vec_ab i = sensor_map_unmeasure(&sensors, r->row[k].i_A);
        for (int x = 0; x < 3; x++) {
            const double wrong = 0.5 * erfc(fabs(vec_phase(i, x)) / sqrt(2.0 * variance));
            sum += wrong * (1.0 - wrong);
        }
    }
    return jump_A * jump_A * sum / (double)r->rows;
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
    double angle = fast_variance(r->recording, r->recording->theta_e_rad, VEC_TWO_PI);
    double link = r->recording->u_dc_V ? fast_variance(r->recording, r->recording->u_dc_V, 0.0) : 0.0;
    double more = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const cycle_row *row = &r->row[k];
        double emf = row->omega_rad_s * drive->psi_f_Wb;
        more += emf * emf * angle;
        if (r->recording->u_dc_V && r->recording->u_dc_V[k] > 0.0) {
            double share = hypot(row->u_V[0].alpha, row->u_V[0].beta) / r->recording->u_dc_V[k];
            more += share * share * link;
        }
    }
    more *= r->T_s * r->T_s / (L * L * (double)r->rows);
    if (drive->edge == EDGE_OVER && drive->v_dead_V != 0.0 && variance > 0.0) {
        /* A phase of a vector has half of its power. */
        more += by_wrong_signs(r, drive, 0.5 * variance);
    }
    return sqrt(variance * (1.0 + decay * decay) + more);
}
