#include "polarity.h"

#include "base/solve.h"
#include "base/vector.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    R,
    L_D,
    L_Q,
    PSI_D,
    V_DEAD,
    BOUNDED, /* those ahead of it are not negative */
    PSI_Q = BOUNDED,
    UNKNOWNS,
    ROWS_MOST = 6000,
    SPAN =
        5 /* cycles summed to one equation: the noise of di/dt, which is large in one cycle, is that of their ends */
};

/* As recorded, the residual must be at least this share of the voltage's power ... */
static const double BAD = 2e-3;
/* ... and with the mistake undone at most a sixth of that, and at most this share. */
static const double BETTER = 6.0;
static const double HOLDS = 0.15;
/* Arrangements with a residual up to this factor above the best one are not distinguishable from it. */
static const double ALIKE = 1.3;
/* Below this rms speed, rad/s, the rotor is at standstill. */
static const double STANDSTILL = 1.0;
/* Angle offsets that are tried, in steps, either way: up to a radian. */
enum { OFFSETS = 5 };
static const double OFFSET_STEP = 0.2;
/* Current over which a leg's lost voltage changes sign, as a share of the rms current. */
static const double KNEE = 0.02;

/* In which recordings an arrangement can be: negating one sensor also changes a current computed from it. */
typedef enum sensors {
    ANY,
    ALL_MEASURED,
    TURNING,      /* the magnet shows in the voltage only then */
    SUM_TO_NOUGHT /* one of the three was computed from the others, here or by the logger */
} sensors;

typedef struct arrangement {
    double i[3][3], u[3][3];            /* true phase quantity = matrix * column */
    double angle_sign, angle_ahead_rad; /* true angle = sign * column - ahead */
    sensors sensors;
    bool c_computed; /* needs phase C to be the computed one where the file has no i_c_A */
    const char *words;
} arrangement;

/* clang-format off */
#define AS_IT_IS  {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
#define MINUS     {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}
#define SWAP_BC   {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}
#define SWAP_AB   {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}
#define SWAP_AC   {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}
#define SHIFT_1   {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}
#define SHIFT_2   {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}

#define QUARTER   (0.25 * VEC_TWO_PI)
#define TURNED    "the magnet shows "
#define ZERO      " degrees from the recorded d axis (theta_e = 0 must be where its flux lies on phase A's axis)"

static const arrangement as_recorded = {AS_IT_IS, AS_IT_IS, 1.0, 0.0, ANY, false, NULL};

static const arrangement mistakes[] = {
    {MINUS, AS_IT_IS, 1.0, 0.0, ANY, false,
     "the currents have the wrong sign (a positive phase current must flow into the motor)"},
    {AS_IT_IS, MINUS, 1.0, 0.0, ANY, false, "the voltages or duties look inverted (-u, or 1 - d: compare counts of the other edge)"},
    {SWAP_BC, AS_IT_IS, 1.0, 0.0, ANY, false, "the current columns of phases B and C look swapped"},
    {SWAP_AB, AS_IT_IS, 1.0, 0.0, ANY, false, "the current columns of phases A and B look swapped"},
    {SWAP_AC, AS_IT_IS, 1.0, 0.0, ANY, false, "the current columns of phases A and C look swapped"},
    {SHIFT_1, AS_IT_IS, 1.0, 0.0, ANY, false, "the current columns look shifted by one phase against the voltages"},
    {SHIFT_2, AS_IT_IS, 1.0, 0.0, ANY, false, "the current columns look shifted by two phases against the voltages"},
    {AS_IT_IS, SWAP_BC, 1.0, 0.0, ANY, false, "the voltages or duties of phases B and C look swapped"},
    {AS_IT_IS, SWAP_AB, 1.0, 0.0, ANY, false, "the voltages or duties of phases A and B look swapped"},
    {AS_IT_IS, SWAP_AC, 1.0, 0.0, ANY, false, "the voltages or duties of phases A and C look swapped"},
    {AS_IT_IS, AS_IT_IS, -1.0, 0.0, ANY, false,
     "the angle counts against the phases A-B-C: its direction is wrong, or two motor phases are swapped"},
    {SWAP_AB, SWAP_AB, 1.0, 0.0, TURNING, false, TURNED "120" ZERO ", and counts backwards: two motor phases are swapped"},
    {SWAP_AC, SWAP_AC, 1.0, 0.0, TURNING, false, TURNED "-120" ZERO ", and counts backwards: two motor phases are swapped"},
    {AS_IT_IS, AS_IT_IS, 1.0, 2.0 * QUARTER, TURNING, false, TURNED "180" ZERO},
    {AS_IT_IS, AS_IT_IS, 1.0, QUARTER, TURNING, false, TURNED "-90" ZERO},
    {AS_IT_IS, AS_IT_IS, 1.0, -QUARTER, TURNING, false, TURNED "90" ZERO},
    {AS_IT_IS, AS_IT_IS, 1.0, 4.0 / 3.0 * QUARTER, TURNING, false, TURNED "-120" ZERO},
    {AS_IT_IS, AS_IT_IS, 1.0, -4.0 / 3.0 * QUARTER, TURNING, false, TURNED "120" ZERO},
    {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, AS_IT_IS, 1.0, 0.0, ALL_MEASURED, false, "the current column of phase A looks negated"},
    {{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, AS_IT_IS, 1.0, 0.0, ALL_MEASURED, false, "the current column of phase B looks negated"},
    {{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, AS_IT_IS, 1.0, 0.0, ALL_MEASURED, false, "the current column of phase C looks negated"},
    {{{-1, 0, 0}, {0, 1, 0}, {1, -1, 0}}, AS_IT_IS, 1.0, 0.0, SUM_TO_NOUGHT, true, "the current column of phase A looks negated"},
    {{{1, 0, 0}, {0, -1, 0}, {-1, 1, 0}}, AS_IT_IS, 1.0, 0.0, SUM_TO_NOUGHT, true, "the current column of phase B looks negated"},
    {{{-1, 0, 0}, {1, 0, -1}, {0, 0, 1}}, AS_IT_IS, 1.0, 0.0, SUM_TO_NOUGHT, false,
     "the current of phase A looks negated (and B computed from it)"},
    {{{1, 0, 0}, {-1, 0, 1}, {0, 0, -1}}, AS_IT_IS, 1.0, 0.0, SUM_TO_NOUGHT, false,
     "the current of phase C looks negated (and B computed from it)"},
    {{{0, 1, -1}, {0, -1, 0}, {0, 0, 1}}, AS_IT_IS, 1.0, 0.0, SUM_TO_NOUGHT, false,
     "the current of phase B looks negated (and A computed from it)"},
    {{{0, -1, 1}, {0, 1, 0}, {0, 0, -1}}, AS_IT_IS, 1.0, 0.0, SUM_TO_NOUGHT, false,
     "the current of phase C looks negated (and A computed from it)"},
};
/* clang-format on */

enum { MISTAKES = sizeof mistakes / sizeof *mistakes };

/* u = design * unknowns, in d and q. */
typedef struct equations {
    double design[2][UNKNOWNS], u[2];
} equations;

typedef struct sums {
    double h[UNKNOWNS][UNKNOWNS], g[UNKNOWNS], power;
} sums;

static void multiply(const double matrix[3][3], const double x[3], double out[3])
{
    for (size_t p = 0; p < 3; p++) {
        out[p] = matrix[p][0] * x[0] + matrix[p][1] * x[1] + matrix[p][2] * x[2];
    }
}

static double held_to_one(double x)
{
    return fmax(-1.0, fmin(x, 1.0));
}

/* The two equations of cycle k, added to those of the cycles before it. */
static void add_cycle(equations *out, const recording *rec, const arrangement *a, size_t k, double knee_A)
{
    const double theta = a->angle_sign * rec->theta_e_rad[k] - a->angle_ahead_rad;
    const double omega = a->angle_sign * rec->omega_e_rad_s[k];
    const vec_rotor middle = rotor_at(theta + 0.5 * omega * rec->T_s);
    double leg[3] = {0.0, 0.0, 0.0};
    vec_dq i[2];
    for (size_t j = 0; j < 2; j++) {
        const double column[3] = {rec->i_A[0][k + j], rec->i_A[1][k + j], rec->i_A[2][k + j]};
        double phase[3];
        multiply(a->i, column, phase);
        i[j] = vec_to_dq(vec_from_phases(phase), rotor_at(theta + (double)j * omega * rec->T_s));
        for (size_t x = 0; x < 3; x++) {
            leg[x] += 0.5 * held_to_one(phase[x] / knee_A);
        }
    }
    double column[3];
    double phase[3];
    recording_voltage(rec, k, column);
    multiply(a->u, column, phase);
    const vec_dq u = vec_to_dq(vec_from_phases(phase), middle);
    const vec_dq lost = vec_to_dq(vec_from_phases(leg), middle);
    const double d = 0.5 * (i[0].d + i[1].d);
    const double q = 0.5 * (i[0].q + i[1].q);
    const double design[2][UNKNOWNS] = {
        {[R] = d,
         [L_D] = (i[1].d - i[0].d) / rec->T_s,
         [L_Q] = -omega * q,
         [V_DEAD] = lost.d,
         [PSI_Q] = -omega},
        {[R] = q,
         [L_D] = omega * d,
         [L_Q] = (i[1].q - i[0].q) / rec->T_s,
         [V_DEAD] = lost.q,
         [PSI_D] = omega},
    };
    out->u[0] += u.d;
    out->u[1] += u.q;
    for (size_t m = 0; m < UNKNOWNS; m++) {
        out->design[0][m] += design[0][m];
        out->design[1][m] += design[1][m];
    }
}

static void take(sums *s, const equations *row)
{
    for (size_t axis = 0; axis < 2; axis++) {
        s->power += row->u[axis] * row->u[axis];
        for (size_t m = 0; m < UNKNOWNS; m++) {
            s->g[m] += row->design[axis][m] * row->u[axis];
            for (size_t n = 0; n < UNKNOWNS; n++) {
                s->h[m][n] += row->design[axis][m] * row->design[axis][n];
            }
        }
    }
}

/* What the unknowns of a set explain, as a share of the voltage's power; 0 if a bounded one comes out negative. */
static double explained(const sums *s, unsigned set)
{
    size_t in[UNKNOWNS] = {0};
    size_t n = 0;
    for (size_t m = 0; m < UNKNOWNS; m++) {
        if (set & (1u << m)) {
            in[n++] = m;
        }
    }
    double h[UNKNOWNS][UNKNOWNS] = {{0}};
    double g[UNKNOWNS] = {0};
    double x[UNKNOWNS] = {0};
    for (size_t a = 0; a < n; a++) {
        g[a] = s->g[in[a]];
        for (size_t b = 0; b < n; b++) {
            h[a][b] = s->h[in[a]][in[b]];
        }
        /* At standstill the flux has no column, and with one direction of current two may be alike. */
        h[a][a] = h[a][a] > 0.0 ? h[a][a] * (1.0 + 1e-5) : 1.0;
    }
    double sum = 0.0;
    if (n == 0 || !solve_positive(n, UNKNOWNS, &h[0][0], g, x)) {
        return 0.0;
    }
    for (size_t a = 0; a < n; a++) {
        if (in[a] < BOUNDED && x[a] < 0.0) {
            return 0.0;
        }
        sum += g[a] * x[a];
    }
    return sum / s->power;
}

/* The share of the voltage's power that is left with the best values that a machine may have. */
static double left_over(const recording *rec, const arrangement *a, double knee_A)
{
    sums s = {0};
    const size_t every = SPAN * (rec->rows / ROWS_MOST + 1);
    for (size_t n = 0; n < rec->stretches; n++) {
        for (size_t j = 0; j + SPAN < rec->stretch[n].count; j += every) {
            equations row = {0};
            for (size_t k = 0; k < SPAN; k++) {
                add_cycle(&row, rec, a, rec->stretch[n].first + j + k, knee_A);
            }
            take(&s, &row);
        }
    }
    double most = 0.0;
    for (unsigned set = 0; s.power > 0.0 && set < 1u << BOUNDED; set++) {
        most = fmax(most, explained(&s, set | 1u << PSI_Q));
    }
    return fmax(1.0 - most, 0.0);
}

/* The rms current of all columns. */
static double current_rms(const recording *rec)
{
    double size2 = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        for (size_t x = 0; x < 3; x++) {
            size2 += rec->i_A[x][k] * rec->i_A[x][k];
        }
    }
    return sqrt(size2 / (3.0 * (double)rec->rows));
}

static bool rotor_turns(const recording *rec)
{
    double omega2 = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        omega2 += rec->omega_e_rad_s[k] * rec->omega_e_rad_s[k];
    }
    return omega2 > STANDSTILL * STANDSTILL * (double)rec->rows;
}

static bool applies(const arrangement *a, const recording *rec, bool three_sensors, bool turns)
{
    switch (a->sensors) {
    case ALL_MEASURED:
        return three_sensors;
    case TURNING:
        return turns;
    case SUM_TO_NOUGHT:
        return !three_sensors && (rec->i_c_measured || a->c_computed);
    case ANY:
        break;
    }
    return true;
}

/* As recorded, but for an angle offset, which is a cause: at standstill it can look like other mistakes. */
static double left_with_offset(const recording *rec, double knee_A)
{
    double least = 1.0;
    for (int n = -OFFSETS; n <= OFFSETS; n++) {
        arrangement turned = as_recorded;
        turned.angle_ahead_rad = n * OFFSET_STEP;
        least = fmin(least, left_over(rec, &turned, knee_A));
    }
    return least;
}

bool check_polarity(const recording *rec, error *e)
{
    const double rms = current_rms(rec);
    if (rms == 0.0) {
        return true;
    }
    const double own = left_over(rec, &as_recorded, KNEE * rms);
    if (own < BAD) {
        return true;
    }
    const bool three_sensors = recording_three_sensors(rec);
    const bool turns = rotor_turns(rec);
    double left[MISTAKES];
    size_t best = 0;
    for (size_t k = 0; k < MISTAKES; k++) {
        left[k] =
            applies(&mistakes[k], rec, three_sensors, turns) ? left_over(rec, &mistakes[k], KNEE * rms) : 1.0;
        best = left[k] < left[best] ? k : best;
    }
    if (left[best] > HOLDS || BETTER * left[best] > own ||
        BETTER * left[best] > left_with_offset(rec, KNEE * rms)) {
        return true;
    }
    const double alike = ALIKE * left[best];
    const char *one = NULL;
    const char *other = NULL;
    for (size_t k = 0; k < MISTAKES; k++) {
        other = one && !other && left[k] <= alike ? mistakes[k].words : other;
        one = !one && left[k] <= alike ? mistakes[k].words : one;
    }
    return error_input(e, rec->path, 0, 0,
                       "%s%s%s: with this corrected, the residual of the voltage equation is %.2g %% of the "
                       "voltage, as recorded %.2g %%",
                       one, other ? ", or " : "", other ? other : "", 100.0 * sqrt(left[best]),
                       100.0 * sqrt(own));
}
