#include "time_stamps.h"

#include "base/sort.h"

#include <math.h>
#include <string.h>

enum {
    DECIMALS_MOST = 9,
    WINDOW = 32,  /* steps of a first guess: it errs by less than a quantum in so many cycles */
    PASSES = 4,   /* each knows the spacing better, and so follows the ladder further */
    LOOK_BACK = 8 /* rows after a gap until which it may have gone unseen */
};

/* A quantum below this share of a step is not what makes the steps uneven. */
static const double FINE = 2e-4;
/* Rounding keeps stamps within a quantum of one another about their ladder; and some room. */
static const double ROOM = 1.05;

static bool is_new_run(const recording *r, size_t k)
{
    return k == 0 || (r->run != NULL && r->run[k] != r->run[k - 1]);
}

/* The largest power of ten that divides all stamps; 0 if it is below `least`. */
static double quantum_of(const recording *r, double least)
{
    double per_second = 1.0;
    for (int decimals = 0; decimals <= DECIMALS_MOST && 1.0 > least * per_second; decimals++) {
        bool all = true;
        for (size_t k = 0; all && k < r->rows; k++) {
            const double multiple = r->t_s[k] * per_second;
            all = fabs(multiple - nearbyint(multiple)) < 1e-3;
        }
        if (all) {
            return 1.0 / per_second;
        }
        per_second *= 10.0;
    }
    return 0.0;
}

static bool steps_are_even(const recording *r, double step, double quantum)
{
    size_t uneven = 0;
    for (size_t k = 1; k < r->rows; k++) {
        const double off = fabs(r->t_s[k] - r->t_s[k - 1] - step);
        uneven += !is_new_run(r, k) && off > 0.5 * quantum && off < 1.5 * quantum;
    }
    /* A few are gaps of a ladder whose spacing is a multiple of the quantum. */
    return 50 * uneven < r->rows;
}

/*
 * Mean over windows of the mean step, of windows that rounding alone may part from their median: gaps spoil a
 * few, and those are left out.
 */
static double guess(const recording *r, double quantum, double *means)
{
    size_t count = 0;
    size_t begin = 0;
    for (size_t k = 1; k < r->rows; k++) {
        begin = is_new_run(r, k) ? k : begin;
        if (k - begin == WINDOW) {
            means[count++] = (r->t_s[k] - r->t_s[begin]) / WINDOW;
            begin = k;
        }
    }
    if (count == 0) {
        return 0.0;
    }
    sort_ascending(means, count);
    const double median = means[count / 2];
    double sum = 0.0;
    double used = 0.0;
    for (size_t n = 0; n < count; n++) {
        const bool usual = fabs(means[n] - median) < ROOM * quantum / WINDOW;
        sum += usual ? means[n] : 0.0;
        used += usual ? 1.0 : 0.0;
    }
    return sum / used;
}

/* The gap that showed at row k is the longest step of the rows before it. */
static size_t gap_before(const recording *r, size_t k, size_t first)
{
    size_t at = k;
    for (size_t j = k; j > first && k - j < LOOK_BACK; j--) {
        at = r->t_s[j] - r->t_s[j - 1] > r->t_s[at] - r->t_s[at - 1] + 1e-12 ? j : at;
    }
    return at;
}

typedef struct ladder {
    size_t first;     /* row of its first stamp */
    double low, high; /* how far rows lie from it, at the least and at the most */
} ladder;

static double off_ladder(const recording *r, const ladder *l, size_t k, double T)
{
    return r->t_s[k] - r->t_s[l->first] - (double)(k - l->first) * T;
}

/* Forgets all rows but those from `from` to k: a spacing that is not yet right drifts off. */
static void forget(ladder *l, const recording *r, size_t from, size_t k, double T)
{
    l->low = INFINITY;
    l->high = -INFINITY;
    for (size_t j = from; j <= k; j++) {
        const double off = off_ladder(r, l, j, T);
        l->low = fmin(l->low, off);
        l->high = fmax(l->high, off);
    }
}

/* Follows the ladder of spacing T from row to row, by the last `memory` to twice as many. */
static void follow(const recording *r, double T, double quantum, size_t memory, unsigned char *starts)
{
    ladder l = {0, 0.0, 0.0};
    size_t remembered = 0;
    memset(starts, 0, r->rows);
    for (size_t k = 0; k < r->rows; k++) {
        const double off = off_ladder(r, &l, k, T);
        const bool leaves = off - l.low > ROOM * quantum || l.high - off > ROOM * quantum;
        if (is_new_run(r, k) || leaves) {
            k = is_new_run(r, k) ? k : gap_before(r, k, l.first);
            l = (ladder){k, 0.0, 0.0};
            starts[k] = 1;
            remembered = k;
            continue;
        }
        if (k - remembered >= 2 * memory) {
            remembered = k - memory;
            forget(&l, r, remembered, k, T);
        }
        l.low = fmin(l.low, off);
        l.high = fmax(l.high, off);
    }
}

/* Slope of t_s over the rows of all stretches, by least squares: the ends alone would err by a quantum. */
static double spacing(const recording *r, const unsigned char *starts, double T, size_t *longest)
{
    double along = 0.0;
    double weight = 0.0;
    *longest = 0;
    for (size_t k = 0; k < r->rows;) {
        size_t end = k + 1;
        while (end < r->rows && !starts[end]) {
            end++;
        }
        const double middle = 0.5 * (double)(end - 1 - k);
        for (size_t j = k; j < end; j++) {
            const double x = (double)(j - k) - middle;
            along += x * (r->t_s[j] - r->t_s[k]);
            weight += x * x;
        }
        *longest = end - k > *longest ? end - k : *longest;
        k = end;
    }
    return weight > 0.0 ? along / weight : T;
}

double time_stamps_ladder(const recording *r, double step, unsigned char *starts, double *scratch)
{
    const double quantum = quantum_of(r, FINE * step);
    if (quantum == 0.0 || steps_are_even(r, step, quantum)) {
        return 0.0;
    }
    double T = guess(r, quantum, scratch);
    if (T < quantum) {
        return 0.0; /* several rows have the same stamp */
    }
    size_t memory = WINDOW;
    for (int pass = 0; pass < PASSES; pass++) {
        size_t longest;
        follow(r, T, quantum, memory, starts);
        T = spacing(r, starts, T, &longest);
        memory = longest / 4 > memory ? longest / 4 : memory;
    }
    follow(r, T, quantum, memory, starts);
    return T;
}
