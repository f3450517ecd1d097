/* Margins of a closed loop (tune_margins.h). */
#include "tune_margins.h"

#include "base/solve.h"
#include "base/vector.h"

#include <complex.h>
#include <math.h>
#include <string.h>

double tune_poles(const tune_loop *loop, tune_pole pole[TUNE_ORDER])
{
    double a[TUNE_ORDER * TUNE_ORDER] = {0.0};
    double re[TUNE_ORDER];
    double im[TUNE_ORDER];
    const int order = loop->order;
    for (int n = 0; n < order; n++) {
        memcpy(&a[n * order], loop->a[n], (size_t)order * sizeof a[0]);
    }
    if (!solve_eigenvalues((size_t)order, a, re, im)) {
        return INFINITY;
    }
    double largest = 0.0;
    for (int n = 0; n < order; n++) {
        largest = fmax(largest, hypot(re[n], im[n]));
        if (pole != NULL) {
            pole[n] = (tune_pole){re[n], im[n]};
        }
    }
    return largest;
}

/* The larger singular value of a complex 2x2 matrix. */
static double largest_singular(double complex m[2][2])
{
    double sum = 0.0;
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            sum += creal(m[n][k] * conj(m[n][k]));
        }
    }
    const double det = cabs(m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    return sqrt(0.5 * (sum + sqrt(fmax(sum * sum - 4.0 * det * det, 0.0))));
}

/* The loop from an added voltage to the controller's, in coordinates in which its matrix is a Hessenberg matrix. */
typedef struct response {
    int order;
    double a[TUNE_ORDER * TUNE_ORDER]; /* Q^T a Q */
    double push[TUNE_ORDER * 2];       /* Q^T push */
    double q[TUNE_ORDER * TUNE_ORDER];
} response;

static bool response_of(const tune_loop *loop, response *r)
{
    const int order = r->order = loop->order;
    for (int n = 0; n < order; n++) {
        memcpy(&r->a[n * order], loop->a[n], (size_t)order * sizeof r->a[0]);
    }
    if (!solve_hessenberg((size_t)order, r->a, r->q)) {
        return false;
    }
    for (int n = 0; n < order; n++) {
        for (int k = 0; k < 2; k++) {
            r->push[n * 2 + k] = 0.0;
            for (int m = 0; m < order; m++) {
                r->push[n * 2 + k] += r->q[m * order + n] * loop->push[m][k];
            }
        }
    }
    return true;
}

/* S less `shift` at a frequency: what acts is the controller's voltage plus what is added. */
static double sensitivity(const response *r, double rad_per_cycle, double shift)
{
    double complex a[TUNE_ORDER * TUNE_ORDER];
    double complex x[TUNE_ORDER * 2];
    const int order = r->order;
    const double complex z = cexp(I * rad_per_cycle);
    for (int n = 0; n < order * order; n++) {
        a[n] = -r->a[n];
    }
    for (int n = 0; n < order; n++) {
        a[n * order + n] += z;
        x[n * 2] = r->push[n * 2];
        x[n * 2 + 1] = r->push[n * 2 + 1];
    }
    if (!solve_complex_pair((size_t)order, (const double *)a, (double *)x)) {
        return INFINITY;
    }
    double complex s[2][2];
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            s[n][k] = n == k ? 1.0 - shift : 0.0;
            for (int m = 0; m < order; m++) {
                s[n][k] += r->q[(TUNE_V + n) * order + m] * x[m * 2 + k];
            }
        }
    }
    return largest_singular(s);
}

double tune_sensitivity(const tune_loop *loop, double rad_per_cycle)
{
    response r;
    return response_of(loop, &r) ? sensitivity(&r, rad_per_cycle, 0.0) : INFINITY;
}

/* Points over half a turn per cycle, and as many again below the first of them, on a logarithmic scale. */
enum { LINEAR = 72, LOGARITHMIC = 16, BISECTIONS = 24 };

static double frequency(int n)
{
    const double step = VEC_PI / LINEAR;
    return n < LOGARITHMIC ? step * pow(10.0, 2.5 * ((double)n / LOGARITHMIC - 1.0))
                           : step * (double)(n - LOGARITHMIC + 1);
}

double tune_disk_margin(const tune_loop *loop)
{
    response r;
    if (tune_poles(loop, NULL) >= 1.0 || !response_of(loop, &r)) {
        return 0.0;
    }
    int at = 0;
    double most = 0.0;
    for (int n = 0; n < LINEAR + LOGARITHMIC; n++) {
        const double s = sensitivity(&r, frequency(n), 0.5);
        if (s > most) {
            most = s;
            at = n;
        }
    }
    /* Golden section between the neighbours of the highest point. */
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double low = at > 0 ? frequency(at - 1) : 0.0;
    double high = at < LINEAR + LOGARITHMIC - 1 ? frequency(at + 1) : VEC_PI;
    double left = high - golden * (high - low);
    double right = low + golden * (high - low);
    double s_left = sensitivity(&r, left, 0.5);
    double s_right = sensitivity(&r, right, 0.5);
    for (int n = 0; n < BISECTIONS; n++) {
        if (s_left > s_right) {
            high = right;
            right = left;
            s_right = s_left;
            left = high - golden * (high - low);
            s_left = sensitivity(&r, left, 0.5);
        } else {
            low = left;
            left = right;
            s_left = s_right;
            right = low + golden * (high - low);
            s_right = sensitivity(&r, right, 0.5);
        }
        most = fmax(most, fmax(s_left, s_right));
    }
    return 1.0 / most;
}

/* ---- Margins of one kind: how far until a pole leaves the circle ---- */

typedef struct way {
    const tune_design *design;
    const tune_machine *truth;
    double phi_rad;
    tune_fault (*fault)(double amount);
} way;

static tune_fault more_gain(double dB)
{
    return (tune_fault){pow(10.0, dB / 20.0), 0.0, 0.0};
}

static tune_fault less_gain(double dB)
{
    return more_gain(-dB);
}

static tune_fault turned_ahead(double degrees)
{
    return (tune_fault){1.0, degrees * VEC_PI / 180.0, 0.0};
}

static tune_fault turned_back(double degrees)
{
    return turned_ahead(-degrees);
}

static tune_fault later(double cycles)
{
    return (tune_fault){1.0, 0.0, cycles};
}

static bool stable(const way *w, double amount)
{
    const tune_fault fault = w->fault(amount);
    tune_loop loop;
    tune_loop_make(w->design, w->truth, w->phi_rad, &fault, &loop);
    return tune_poles(&loop, NULL) < 1.0;
}

/* Steps outwards until the loop is lost, then halves the last step. */
static double reach(way w, tune_fault (*fault)(double amount), double step, double most)
{
    w.fault = fault;
    double held = 0.0;
    double lost = step;
    while (lost <= most && stable(&w, lost)) {
        held = lost;
        lost += step;
    }
    if (lost > most) {
        return most;
    }
    for (int n = 0; n < BISECTIONS / 2; n++) {
        const double middle = 0.5 * (held + lost);
        if (stable(&w, middle)) {
            held = middle;
        } else {
            lost = middle;
        }
    }
    return held;
}

tune_margins tune_margins_of(const tune_design *design, const tune_machine *truth, double phi_rad)
{
    const way w = {design, truth, phi_rad, NULL};
    tune_loop loop;
    tune_loop_make(design, truth, phi_rad, &tune_no_fault, &loop);
    tune_margins m = {.disk = tune_disk_margin(&loop)};
    if (m.disk > 0.0) {
        m.gain_dB =
            fmin(reach(w, more_gain, 1.0, TUNE_GAIN_MOST_DB), reach(w, less_gain, 2.0, TUNE_GAIN_MOST_DB));
        m.phase_deg = fmin(reach(w, turned_ahead, 4.0, TUNE_PHASE_MOST_DEG),
                           reach(w, turned_back, 4.0, TUNE_PHASE_MOST_DEG));
        m.delay_cycles = reach(w, later, 0.05, TUNE_DELAY_MOST);
    }
    return m;
}

tune_margins tune_margins_worst(tune_margins a, tune_margins b)
{
    const tune_margins worst = {fmin(a.disk, b.disk), fmin(a.gain_dB, b.gain_dB),
                                fmin(a.phase_deg, b.phase_deg), fmin(a.delay_cycles, b.delay_cycles)};
    return worst;
}
