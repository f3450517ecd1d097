/* Orthogonal matching pursuit over the dictionary (terms.h). */
#include "terms.h"

#include "base/solve.h"

#include <string.h>

/* Smallest share by which a term reduces its axis' square; a term that reduces it by less is left out. */
static const double WORTH = 0.01;

void terms_add(terms_sums *s, const double entry[ENTRIES], vec_dq v_V)
{
    const double v[2] = {v_V.d, v_V.q};
    s->rows += 1.0;
    for (int a = 0; a < 2; a++) {
        s->square[a] += v[a] * v[a];
        for (size_t i = 0; i < ENTRIES; i++) {
            s->with[a][i] += v[a] * entry[i];
        }
    }
    for (size_t i = 0; i < ENTRIES; i++) {
        for (size_t j = 0; j <= i; j++) {
            s->product[i][j] += entry[i] * entry[j];
        }
    }
}

static double product(const terms_sums *s, size_t i, size_t j)
{
    return i >= j ? s->product[i][j] : s->product[j][i];
}

/* Least squares of one axis; false where two entries do the same. */
static bool fit(const terms_sums *s, int axis, size_t n, const size_t *entry, double *value)
{
    double h[TERMS_MOST * TERMS_MOST];
    double b[TERMS_MOST];
    for (size_t i = 0; i < n; i++) {
        b[i] = s->with[axis][entry[i]];
        for (size_t j = 0; j < n; j++) {
            h[i * n + j] = product(s, entry[i], entry[j]);
        }
    }
    return solve_positive(n, n, h, b, value);
}

/* The square that values leave on an axis. */
static double left(const terms_sums *s, int axis, size_t n, const size_t *entry, const double *value)
{
    double sum = s->square[axis];
    for (size_t i = 0; i < n; i++) {
        sum -= 2.0 * value[i] * s->with[axis][entry[i]];
        for (size_t j = 0; j < n; j++) {
            sum += value[i] * value[j] * product(s, entry[i], entry[j]);
        }
    }
    return fmax(sum, 0.0);
}

/* -2 log likelihood that a fall of the square is worth. */
static double worth(double rows, double before, double after)
{
    return before > 0.0 ? rows * log(before / fmax(after, 1e-12 * before)) : 0.0;
}

/* Of a term: Schwarz' log(rows), and the choice among all entries along two axes. */
static double price(double rows)
{
    return fmax(log(rows) + 2.0 * log(2.0 * ENTRIES), WORTH * rows);
}

/*
 * What is seen at one operating point only is no law: without the one where it gains most, a term must be worth its
 * price as well. A frequency that happens to be an order of the angle at one speed fails here.
 */
static bool is_everywhere(const terms_sums *group, size_t groups, int axis, size_t n, const size_t *entry,
                          const double *before, const double *after)
{
    double sum[2] = {0.0, 0.0};
    double rows = 0.0;
    double most[3] = {0.0, 0.0, 0.0};
    for (size_t g = 0; g < groups; g++) {
        const double was = left(&group[g], axis, n - 1, entry, before);
        const double is = left(&group[g], axis, n, entry, after);
        sum[0] += was;
        sum[1] += is;
        rows += group[g].rows;
        if (was - is > most[0] - most[1]) {
            most[0] = was;
            most[1] = is;
            most[2] = group[g].rows;
        }
    }
    rows -= most[2];
    return groups < 2 || rows < 1.0 || worth(rows, sum[0] - most[0], sum[1] - most[1]) > price(rows);
}

static bool has(const terms_chosen *t, int axis, size_t entry)
{
    for (size_t i = 0; i < t->count[axis]; i++) {
        if (t->entry[axis][i] == entry) {
            return true;
        }
    }
    return false;
}

/* Adds the entry that is worth most; false if none is worth its price. */
static bool add_best(terms_chosen *t, const terms_sums *group, size_t groups, const terms_sums *all)
{
    terms_chosen best = *t;
    double most = price(all->rows);
    bool found = false;
    for (int a = 0; a < 2; a++) {
        const size_t n = t->count[a];
        const double before = left(all, a, n, t->entry[a], t->value[a]);
        for (size_t c = 0; c < ENTRIES; c++) {
            terms_chosen with = *t;
            with.entry[a][n] = c;
            with.count[a] = n + 1;
            if (has(t, a, c) || !fit(all, a, n + 1, with.entry[a], with.value[a])) {
                continue;
            }
            const double gains = worth(all->rows, before, left(all, a, n + 1, with.entry[a], with.value[a]));
            if (gains > most &&
                is_everywhere(group, groups, a, n + 1, with.entry[a], t->value[a], with.value[a])) {
                most = gains;
                best = with;
                found = true;
            }
        }
    }
    *t = best;
    return found;
}

/* Drops a term that later ones have made superfluous; false if each is still worth its price. */
static bool drop_one(terms_chosen *t, const terms_sums *all)
{
    for (int a = 0; a < 2; a++) {
        const size_t n = t->count[a];
        const double now = left(all, a, n, t->entry[a], t->value[a]);
        for (size_t i = 0; i < n; i++) {
            terms_chosen without = *t;
            memmove(&without.entry[a][i], &without.entry[a][i + 1], (n - 1 - i) * sizeof without.entry[a][0]);
            without.count[a] = n - 1;
            if (fit(all, a, n - 1, without.entry[a], without.value[a]) &&
                worth(all->rows, left(all, a, n - 1, without.entry[a], without.value[a]), now) <
                    price(all->rows)) {
                *t = without;
                return true;
            }
        }
    }
    return false;
}

static void find_strongest(terms_chosen *t, const terms_sums *all)
{
    double most = -1.0;
    for (size_t a = 0; a < 2; a++) {
        for (size_t i = 0; i < t->count[a]; i++) {
            const double takes =
                t->value[a][i] * t->value[a][i] * product(all, t->entry[a][i], t->entry[a][i]);
            if (takes > most) {
                most = takes;
                t->strongest_axis = a;
                t->strongest_entry = t->entry[a][i];
            }
        }
    }
}

terms_chosen terms_choose(const terms_sums *group, size_t groups, const terms_sums *all)
{
    terms_chosen t = {0};
    while (t.count[0] + t.count[1] < TERMS_MOST && add_best(&t, group, groups, all)) {
    }
    while (drop_one(&t, all)) {
    }
    find_strongest(&t, all);
    return t;
}

vec_dq terms_voltage(const terms_chosen *t, const double entry[ENTRIES])
{
    double v[2] = {0.0, 0.0};
    for (int a = 0; a < 2; a++) {
        for (size_t i = 0; i < t->count[a]; i++) {
            v[a] += t->value[a][i] * entry[t->entry[a][i]];
        }
    }
    return (vec_dq){v[0], v[1]};
}
