/* Minimum of the distortion of a pattern (pattern_search.h). The variables are the distances between the edges. */
#include "pattern_search.h"

#include "base/solve.h"
#include "base/vector.h"

#include <string.h>

enum { GAPS_MOST = PATTERN_ANGLES_MOST + 1, STEPS_MOST = 300, ROUNDS = 6 };

/* Weight of the fundamental's error over that of a harmonic flux; the rounds remove what it leaves. */
static const double FUNDAMENTAL_WEIGHT = 30.0;
static const double STEP_END_RAD = 1e-9;
static const double INDEX_ERROR_MOST = 1e-8;

typedef struct search {
    pattern_shape *s;
    const pattern_weight *w;
    double target; /* of b_1 */
    double least[GAPS_MOST];
    double y[GAPS_MOST]; /* distances: 0 to the first angle, ..., the last angle to pi/2 */
    int tied;            /* of the distances: the one that the others determine */
    double h[PATTERN_ANGLES_MOST * PATTERN_ANGLES_MOST];
    double g[PATTERN_ANGLES_MOST];
} search;

static void set_least(double *least, int angles, double gap)
{
    for (int k = 0; k < angles; k++) {
        least[k] = gap;
    }
    /* Mirrored at pi/2. */
    least[angles] = 0.5 * gap;
}

static void angles_from(pattern_shape *s, const double *y)
{
    double at = 0.0;
    for (int k = 0; k < s->angles; k++) {
        at += y[k];
        s->angle[k] = fmin(at, 0.5 * VEC_PI);
    }
}

bool pattern_has_room(int angles, double gap)
{
    return gap * (angles + 0.5) < 0.5 * VEC_PI;
}

void pattern_spread(pattern_shape *s, double gap, const double *share)
{
    double y[GAPS_MOST];
    double sum = 0.0;
    set_least(y, s->angles, gap);
    for (int k = 0; k <= s->angles; k++) {
        sum += share[k];
    }
    for (int k = 0; k <= s->angles; k++) {
        y[k] += share[k] / sum * (0.5 * VEC_PI - gap * (s->angles + 0.5));
    }
    angles_from(s, y);
}

static int widest(const search *f)
{
    int most = 0;
    for (int k = 1; k <= f->s->angles; k++) {
        most = f->y[k] - f->least[k] > f->y[most] - f->least[most] ? k : most;
    }
    return most;
}

/* The distances of the pattern, each raised to its least value at the cost of the widest. */
static bool begin(search *f, double gap)
{
    const int n = f->s->angles;
    double before = 0.0;
    double raised = 0.0;
    set_least(f->least, n, gap);
    for (int k = 0; k <= n; k++) {
        const double next = k < n ? f->s->angle[k] : 0.5 * VEC_PI;
        f->y[k] = fmax(next - before, f->least[k]);
        raised += f->y[k];
        before = next;
    }
    const int at = widest(f);
    f->y[at] -= raised - 0.5 * VEC_PI;
    angles_from(f->s, f->y);
    return f->y[at] >= f->least[at];
}

/* Sum of squares; with `slopes`, h and g of the step, over all distances but the tied one. */
static double squares(search *f, bool slopes)
{
    double error[PATTERN_ERRORS + 1];
    double by_angle[PATTERN_ERRORS + 1][PATTERN_ANGLES_MOST];
    const int n = f->s->angles;
    double sum = 0.0;
    pattern_errors(f->s, f->w, error, slopes ? by_angle : NULL);
    error[PATTERN_ERRORS] =
        FUNDAMENTAL_WEIGHT * (pattern_fundamental(f->s, by_angle[PATTERN_ERRORS]) - f->target);
    memset(f->h, 0, sizeof f->h);
    memset(f->g, 0, sizeof f->g);
    for (int r = 0; r <= PATTERN_ERRORS; r++) {
        sum += error[r] * error[r];
        if (!slopes) {
            continue;
        }
        const double weight = r == PATTERN_ERRORS ? FUNDAMENTAL_WEIGHT : 1.0;
        double by[PATTERN_ANGLES_MOST];
        double part = 0.0;
        /* A distance below the tied one moves the angles from it to the tied one up, one above moves them down. */
        for (int k = f->tied - 1; k >= 0; k--) {
            part += by_angle[r][k];
            by[k] = weight * part;
        }
        part = 0.0;
        for (int k = f->tied; k < n; k++) {
            part -= by_angle[r][k];
            by[k] = weight * part;
        }
        for (int i = 0; i < n; i++) {
            f->g[i] -= by[i] * error[r];
            for (int j = 0; j < n; j++) {
                f->h[PATTERN_ANGLES_MOST * i + j] += by[i] * by[j];
            }
        }
    }
    return sum;
}

/* The distance that variable i stands for. */
static int distance_of(const search *f, int i)
{
    return i < f->tied ? i : i + 1;
}

/* Takes a step, shortened so that the tied distance keeps its least value. Returns its largest part. */
static double move(search *f, const double *step)
{
    double sum = 0.0;
    double most = 0.0;
    for (int i = 0; i < f->s->angles; i++) {
        sum += step[i];
    }
    const double room = f->y[f->tied] - f->least[f->tied];
    const double share = sum > room ? room / sum : 1.0;
    for (int i = 0; i < f->s->angles; i++) {
        f->y[distance_of(f, i)] += share * step[i];
        most = fmax(most, fabs(share * step[i]));
    }
    f->y[f->tied] -= share * sum;
    angles_from(f->s, f->y);
    return most;
}

/* Steps with more and less damping until they are short. */
static void descend(search *f)
{
    const int n = f->s->angles;
    double damping = 1e-3;
    f->tied = widest(f);
    double now = squares(f, true);
    for (int count = 0; count < STEPS_MOST && damping < 1e9; count++) {
        const search before = *f;
        double low[PATTERN_ANGLES_MOST];
        double high[PATTERN_ANGLES_MOST];
        double step[PATTERN_ANGLES_MOST];
        for (int i = 0; i < n; i++) {
            f->h[(PATTERN_ANGLES_MOST + 1) * i] *= 1.0 + damping;
            low[i] = f->least[distance_of(f, i)] - f->y[distance_of(f, i)];
            high[i] = INFINITY;
        }
        const pattern_shape shape = *f->s;
        const bool solved = solve_within((size_t)n, PATTERN_ANGLES_MOST, f->h, f->g, low, high, step);
        const double length = solved ? move(f, step) : 0.0;
        const double then = solved ? squares(f, false) : INFINITY;
        if (then > now) {
            *f = before;
            *f->s = shape;
            damping *= 8.0;
            continue;
        }
        damping = fmax(0.2 * damping, 1e-12);
        f->tied = widest(f);
        now = squares(f, true);
        if (length < STEP_END_RAD) {
            break;
        }
    }
}

bool pattern_minimum(pattern_shape *s, double index, double gap, const pattern_weight *w)
{
    const double wanted = 4.0 / VEC_PI * index;
    search f = {.s = s, .w = w, .target = wanted};
    double unused[PATTERN_ANGLES_MOST];
    if (!begin(&f, gap)) {
        return false;
    }
    for (int round = 0; round < ROUNDS; round++) {
        descend(&f);
        const double short_by = wanted - pattern_fundamental(s, unused);
        if (fabs(short_by) < INDEX_ERROR_MOST) {
            return true;
        }
        f.target += short_by;
    }
    return false;
}
