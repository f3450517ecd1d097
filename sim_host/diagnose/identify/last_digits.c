/* Parameter tolerances, marginalised (last_digits.h). */
#include "last_digits.h"

#include "base/solve.h"

#include <math.h>
#include <string.h>

/* Largest deviation without a name, in standard deviations of its tolerance. */
static const double MOST = 3.0;

static double precision(coordinate_id id)
{
    const double digits = coordinate_table[id].digits;
    return 1.0 / (digits * digits);
}

size_t last_digits_list(const diagnose_rows *r, coordinate_id at[P_COUNT])
{
    size_t n = 0;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        if (coordinate_table[id].digits > 0.0 && column_shows((int)id, r)) {
            at[n++] = id;
        }
    }
    return n;
}

void last_digits_deflate(const diagnose_rows *r, const bool *held, gram *sums)
{
    coordinate_id at[P_COUNT];
    double small[COLUMN_COUNT][COLUMN_COUNT];
    double inverse[COLUMN_COUNT][COLUMN_COUNT];
    double row[P_COUNT][COLUMN_COUNT + 1]; /* H of the tolerances' coordinates, and their g */
    double part[COLUMN_COUNT + 1];         /* a row of M times `row` */
    size_t count = 0;
    const size_t smalls = last_digits_list(r, at);
    for (size_t k = 0; k < smalls; k++) {
        if (!held || !held[at[k]]) {
            at[count++] = at[k];
        }
    }
    for (size_t i = 0; i < count; i++) {
        memcpy(row[i], sums->h[at[i]], sizeof sums->h[at[i]]);
        row[i][COLUMN_COUNT] = sums->g[at[i]];
        for (size_t j = 0; j < count; j++) {
            small[i][j] = sums->h[at[i]][at[j]] + (i == j ? precision(at[i]) : 0.0);
        }
    }
    if (count == 0 || !solve_inverse(count, COLUMN_COUNT, &small[0][0], &inverse[0][0])) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t c = 0; c <= COLUMN_COUNT; c++) {
            part[c] = 0.0;
            for (size_t j = 0; j < count; j++) {
                part[c] += inverse[i][j] * row[j][c];
            }
        }
        sums->c -= row[i][COLUMN_COUNT] * part[COLUMN_COUNT];
        for (size_t a = 0; a < COLUMN_COUNT; a++) {
            sums->g[a] -= row[i][a] * part[COLUMN_COUNT];
            for (size_t b = 0; b < COLUMN_COUNT; b++) {
                sums->h[a][b] -= row[i][a] * part[b];
            }
        }
    }
}

size_t last_digits_append(const fit_data *d, const fit_state *s, size_t members, int column[COLUMN_COUNT],
                          double prior[COLUMN_COUNT])
{
    coordinate_id small[P_COUNT];
    const size_t smalls = last_digits_list(d->rows, small);
    bool taken[P_COUNT] = {false};
    double share[P_COUNT];
    size_t n = members;
    for (size_t k = 0; k < P_COUNT; k++) {
        share[k] = 1.0;
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        bool moved[P_COUNT] = {false};
        double coordinates = 0.0;
        if (!hypothesis_in(s->set, h)) {
            continue;
        }
        hypothesis_mark(h, moved);
        for (size_t k = 0; k < P_COUNT; k++) {
            coordinates += moved[k] ? 1.0 : 0.0;
        }
        size_t left = hypothesis_table[h].columns;
        for (size_t k = P_COUNT; k-- > 0;) {
            if (moved[k]) {
                /*
                 * k coordinates that share m directions have k - m free ones: each keeps the share 1 - m/k of its prior's precision.
                 */
                share[k] = 1.0 - (double)hypothesis_table[h].columns / coordinates;
                taken[k] = taken[k] || left > 0;
                left -= left > 0 ? 1 : 0;
            }
        }
    }
    for (size_t k = 0; k < smalls; k++) {
        if (!taken[small[k]]) {
            prior[n] = share[small[k]] * precision(small[k]);
            column[n++] = (int)small[k];
        }
    }
    return n;
}

void last_digits_rest(hypothesis_set set, const double z[P_COUNT], double rest[P_COUNT])
{
    double own[P_COUNT] = {0.0};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h)) {
            hypothesis_copy(h, z, own);
        }
    }
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        rest[id] = z[id] - own[id];
    }
}

double last_digits_unusual(hypothesis_set set, const double z[P_COUNT])
{
    double rest[P_COUNT];
    double sum = 0.0;
    last_digits_rest(set, z, rest);
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        sum += coordinate_table[id].digits > 0.0 ? rest[id] * rest[id] * precision(id) : 0.0;
    }
    return sum;
}

void last_digits_bound(hypothesis_set set, double z[P_COUNT])
{
    double rest[P_COUNT];
    last_digits_rest(set, z, rest);
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        const double most = MOST * coordinate_table[id].digits;
        if (most > 0.0) {
            z[id] += fmin(fmax(rest[id], -most), most) - rest[id];
        }
    }
}

void last_digits_keep(hypothesis_id h, double z[P_COUNT])
{
    bool moved[P_COUNT] = {false};
    hypothesis_mark(h, moved);
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        if (moved[id]) {
            const double most = MOST * coordinate_table[id].digits;
            z[id] = fmin(fmax(z[id], -most), most);
        }
    }
}
