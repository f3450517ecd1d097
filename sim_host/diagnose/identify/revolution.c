/* Finds in which revolution each stretch began (revolution.h). */
#include "revolution.h"

#include "base/solve.h"
#include "gram.h"

#include <math.h>
#include <stdlib.h>

/* Least chi square of the strongest stretch; below it, its phase is chance. */
static const double WORTH_TURNING = 20.0;

/*
 * The phasors of both orders, and a constant angle error and another flux or voltage: without these their effect would be taken for a
 * part of the phasor.
 */
static const int column[] = {P_HARMONIC_1C, P_HARMONIC_1S, P_HARMONIC_2C, P_HARMONIC_2S, P_THETA_0, P_PSI};
enum { COLUMNS = sizeof column / sizeof *column };

typedef struct phasor {
    double c, s;
    double chi_square;
} phasor;

/* The phasor of an order in one stretch, fitted with the constant columns, and the chi square of its two parts. */
static phasor phasor_of(const gram *sum, size_t order)
{
    const size_t at[4] = {2 * (order - 1), 2 * (order - 1) + 1, 4, 5};
    double h[4][COLUMN_COUNT];
    double right[4];
    double with[4];
    double without[4] = {0};
    for (size_t i = 0; i < 4; i++) {
        right[i] = -sum->g[at[i]];
        for (size_t j = 0; j < 4; j++) {
            h[i][j] = sum->h[at[i]][at[j]];
        }
    }
    phasor p = {0};
    if (solve_positive(4, COLUMN_COUNT, &h[0][0], right, with)) {
        double rest[2][COLUMN_COUNT] = {{h[2][2], h[2][3]}, {h[3][2], h[3][3]}};
        double both = 0.0;
        double alone = 0.0;
        solve_positive(2, COLUMN_COUNT, &rest[0][0], right + 2, without);
        for (size_t i = 0; i < 4; i++) {
            both += with[i] * right[i];
            alone += i < 2 ? without[i] * right[i + 2] : 0.0;
        }
        p = (phasor){with[0], with[1], both - alone};
    }
    return p;
}

/* The multiple of 2 pi/pole pairs whose phasor of this order is nearest to the phase `ahead`. */
static double turn_of(double ahead, size_t order, int pole_pairs)
{
    double best = 0.0;
    double nearest = INFINITY;
    for (int m = 0; m < pole_pairs; m++) {
        double angle = VEC_TWO_PI * m / pole_pairs;
        double off = fabs(remainder(ahead - (double)order * angle, VEC_TWO_PI));
        if (off < nearest - 1e-9) {
            nearest = off;
            best = angle;
        }
    }
    return best;
}

static bool has_order(const averaged_drive *drive, size_t order)
{
    return drive->harmonic_cos_rad[order - 1] != 0.0 || drive->harmonic_sin_rad[order - 1] != 0.0;
}

bool revolution_in_file(const fit_data *d)
{
    return has_order(&d->frame->nominal, 1) || has_order(&d->frame->nominal, 2);
}

/* The order of the model's harmonic: first a fitted one, then the motor file's, else `shown`. */
static size_t order_in(hypothesis_set set, const averaged_drive *drive, size_t shown)
{
    if (hypothesis_in(set, H_ANGLE_HARMONIC_1)) {
        return 1;
    }
    if (hypothesis_in(set, H_ANGLE_HARMONIC_2)) {
        return 2;
    }
    return has_order(drive, 1) ? 1 : has_order(drive, 2) ? 2 : shown;
}

bool revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned)
{
    *turned = false;
    const size_t stretches = d->rows->recording->stretches;
    if (d->rows->mech_known || (stretches < 2 && !revolution_in_file(d))) {
        return true;
    }
    gram *grams = gram_blocks(d, s, column, COLUMNS);
    gram *sum = calloc(stretches, sizeof *sum);
    if (!grams || !sum) {
        free(grams);
        free(sum);
        return false;
    }
    for (size_t b = 0; b < d->blocks; b++) {
        gram *to = &sum[d->rows->block[d->block[b]].stretch];
        gram_add(to, &grams[b], COLUMNS);
    }
    free(grams);
    double evidence[3] = {0};
    size_t strongest[3] = {0};
    for (size_t order = 1; order <= 2; order++) {
        double most = 0.0;
        for (size_t n = 0; n < stretches; n++) {
            double chi = phasor_of(&sum[n], order).chi_square;
            evidence[order] += chi;
            if (chi > most) {
                most = chi;
                strongest[order] = n;
            }
        }
    }
    /*
     * If the model has a harmonic, the stretches are compared with its phasor. The phasor of each stretch is then its difference from
     * the model.
     */
    const averaged_drive drive = fit_drive(d, s);
    const size_t order = order_in(s->set, &drive, evidence[2] > evidence[1] ? 2 : 1);
    const phasor fitted = {drive.harmonic_cos_rad[order - 1], drive.harmonic_sin_rad[order - 1], 0.0};
    const bool held = fitted.c != 0.0 || fitted.s != 0.0;
    phasor reference = held ? fitted : phasor_of(&sum[strongest[order]], order);
    bool worth = held || reference.chi_square > WORTH_TURNING;
    for (size_t n = 0; n < stretches && worth; n++) {
        phasor p = phasor_of(&sum[n], order);
        if ((!held && n == strongest[order]) || !(p.chi_square > 0.0)) {
            continue;
        }
        p.c += fitted.c;
        p.s += fitted.s;
        /*
         * c cos(n x) + s sin(n x) is the real part of (c - js) e^{jnx}: if the angle is too small by b, the phasor is turned by n b.
         */
        double ahead = atan2(-p.s, p.c) - atan2(-reference.s, reference.c);
        double angle = turn_of(ahead, order, pole_pairs);
        rows_turn_mechanical(d->rows, n, angle);
        *turned = *turned || angle != 0.0;
    }
    free(sum);
    return true;
}
