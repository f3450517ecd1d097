#include "current_sum.h"

#include "base/vector.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A share of the three currents' power that no sensor's noise reaches in their sum. */
static const double SUM_SHARE = 0.02;
/* The share of the sum's power that is left after correcting a single column: the other gains may be wrong as well. */
static const double LEFT_SHARE = 0.05;
/* Gains of 0.6 to 1.6 are the cause `current_gain`, and one of 1.6 with two of 0.6 appears as 2.67. Beyond that a column is
 * in another unit. */
static const double GAIN_LEAST = 0.34;
static const double GAIN_MOST = 2.9;
/* A gain this near to -1 is a sign error. */
static const double SIGN_WIDTH = 0.25;
/* A column with less than this share of a usual column's power is still. */
static const double STILL = 1e-4;
static const double NOTHING = 1e-12;
/* Two currents with a correlation beyond this lie on one line, and the third may be zero. */
static const double ON_ONE_LINE = 0.95;

/* Products of the three currents about their means: offsets, which are causes, fall out. */
typedef struct spread {
    double rows;
    double of[3][3];
} spread;

static const char phase_name[] = "ABC";

/* Whether the rotor makes a turn or more in the stretch: then no phase can be still while another is not. */
static bool turns(const recording *rec, const stretch *s)
{
    double angle = 0.0;
    for (size_t k = s->first; k < s->first + s->count; k++) {
        angle += fabs(rec->omega_e_rad_s[k]) * rec->T_s;
    }
    return angle > VEC_TWO_PI;
}

static spread spread_of(const recording *rec, bool turning_only)
{
    spread all = {0};
    double mean[3] = {0.0, 0.0, 0.0};
    for (int pass = 0; pass < 2; pass++) {
        for (size_t n = 0; n < rec->stretches; n++) {
            const stretch *s = &rec->stretch[n];
            const size_t count = !turning_only || turns(rec, s) ? s->count : 0;
            for (size_t k = s->first; k < s->first + count; k++) {
                all.rows += pass == 0 ? 1.0 : 0.0;
                for (size_t x = 0; x < 3; x++) {
                    mean[x] += pass == 0 ? rec->i_A[x][k] : 0.0;
                    for (size_t y = 0; pass == 1 && y < 3; y++) {
                        all.of[x][y] += (rec->i_A[x][k] - mean[x]) * (rec->i_A[y][k] - mean[y]);
                    }
                }
            }
        }
        for (size_t x = 0; pass == 0 && x < 3; x++) {
            mean[x] /= fmax(all.rows, 1.0);
        }
    }
    return all;
}

/* Power of the middle one of three columns: neither a dead one nor one in another unit. */
static double usual(const spread *s)
{
    const double a = s->of[0][0];
    const double b = s->of[1][1];
    const double c = s->of[2][2];
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

static bool refuse_still(const recording *rec, size_t x, error *e)
{
    return error_input(e, rec->path, 0, 0,
                       "the current column of phase %c looks dead: it stays at %.3g A while others move "
                       "(check its sensor and the log)",
                       phase_name[x], rec->i_A[x][0]);
}

/* Still compared with the others, or so small that it has no signal at all. */
static bool is_still(const spread *s, size_t x)
{
    const double most = fmax(s->of[0][0], fmax(s->of[1][1], s->of[2][2]));
    return s->of[x][x] < STILL * usual(s) || s->of[x][x] < NOTHING * most;
}

/* A still column: of a rotor that turns, or of three measured ones whose sum is not zero. */
static bool check_still(const recording *rec, const spread *s, error *e)
{
    const spread turning = spread_of(rec, true);
    for (size_t x = 0; x < 3; x++) {
        if (is_still(&turning, x)) {
            return refuse_still(rec, x, e);
        }
        const size_t y = (x + 1) % 3;
        const size_t z = (x + 2) % 3;
        const double aligned = fabs(s->of[y][z]) / sqrt(fmax(s->of[y][y] * s->of[z][z], 1e-300));
        if (rec->i_c_measured && is_still(s, x) && aligned < ON_ONE_LINE) {
            return refuse_still(rec, x, e);
        }
    }
    return true;
}

/*
 * If column x alone is at fault, showing g times its current, the other two sum to -x / g. False if they do
 * not. With all currents on one line more than one phase can be it.
 */
static bool explains(const spread *s, size_t x, double sum_power, double *gain)
{
    const size_t y = (x + 1) % 3;
    const size_t z = (x + 2) % 3;
    if (s->of[x][x] < STILL * usual(s)) {
        return false;
    }
    const double cross = s->of[x][y] + s->of[x][z];
    const double others = s->of[y][y] + s->of[z][z] + 2.0 * s->of[y][z];
    *gain = cross == 0.0 ? INFINITY : -s->of[x][x] / cross;
    return others - cross * cross / s->of[x][x] < LEFT_SHARE * fmin(sum_power, others);
}

static bool is_sign(double gain)
{
    return fabs(gain + 1.0) < SIGN_WIDTH;
}

static bool refuse_column(const recording *rec, const bool suspect[3], double gain, error *e)
{
    char phases[16] = "";
    for (size_t x = 0; x < 3; x++) {
        const size_t used = strlen(phases);
        if (suspect[x]) {
            snprintf(phases + used, sizeof phases - used, "%s%c", used > 0 ? " or " : "", phase_name[x]);
        }
    }
    if (is_sign(gain)) {
        return error_input(
            e, rec->path, 0, 0,
            "the current column of phase %s looks negated: with its sign changed, the three sum to zero",
            phases);
    }
    return error_input(e, rec->path, 0, 0,
                       "the current column of phase %s looks scaled by %.3g: divided by that, the three sum "
                       "to zero (check its unit)",
                       phases, gain);
}

bool check_current_sum(const recording *rec, error *e)
{
    const spread s = spread_of(rec, false);
    if (!check_still(rec, &s, e)) {
        return false;
    }
    double power = 0.0;
    double sum_power = 0.0;
    for (size_t x = 0; x < 3; x++) {
        power += s.of[x][x];
        sum_power += s.of[x][0] + s.of[x][1] + s.of[x][2];
    }
    if (!rec->i_c_measured || sum_power < SUM_SHARE * power) {
        return true;
    }
    bool suspect[3] = {false, false, false};
    bool negated[3] = {false, false, false};
    size_t suspects = 0;
    size_t signs = 0;
    double scale = 1.0;
    for (size_t x = 0; x < 3; x++) {
        double gain = 1.0;
        suspect[x] = explains(&s, x, sum_power, &gain);
        if (suspect[x] && gain > GAIN_LEAST && gain < GAIN_MOST) {
            return true;
        }
        negated[x] = suspect[x] && is_sign(gain);
        scale = suspect[x] ? gain : scale;
        suspects += suspect[x];
        signs += negated[x];
    }
    if (signs > 0) {
        return refuse_column(rec, negated, -1.0, e);
    }
    /* Which one is scaled, and by how much, is known only if it can be no other. */
    return suspects != 1 || refuse_column(rec, suspect, scale, e);
}
