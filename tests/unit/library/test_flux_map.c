/*
 * Prediction by a flux map: the fixed-point step against the same steps in double; those against the current that
 * really belongs to the flux, found to 1e-12; and that against a direct integration in which no step of it is used.
 */
#include "iqfoc/extension_params.h"
#include "iqfoc/flux_map.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/iq24_math.h"
#include "reference.h"

#include <complex.h>
#include <stddef.h>
#include <string.h>

#define DRAWS 100000 /* of cycles that an inverter's voltage makes */
#define SEED  UINT64_C(20260101)
#define PARTS IQFOC_FLUX_MAP_PARTS

void setUp(void)
{
}

void tearDown(void)
{
}

/* Constants as doubles, per unit: straight iron, and the parts' energies and currents. */
typedef struct machine {
    double l_d, l_q, r, psi;
    double E[PARTS], I_d[PARTS], I_q[PARTS], I_c[PARTS];
    double v_dead, knee_inverse;
} machine;

typedef struct map_point {
    double complex flux;
    double dd, dq, qq;
} map_point;

/* The gradient of W = l_d d^2/2 + l_q q^2/2 + psi d + sum of E sqrt(1 + ((d - I_c)/I_d)^2 + (q/I_q)^2), and its second derivatives. */
static map_point map_at(const machine *m, double complex i)
{
    const double d = creal(i);
    const double q = cimag(i);
    map_point at = {m->l_d * d + m->psi + I * m->l_q * q, m->l_d, 0.0, m->l_q};
    for (int k = 0; k < PARTS; k++) {
        const double from = d - m->I_c[k];
        const double D = m->I_d[k] * m->I_d[k];
        const double Q = m->I_q[k] * m->I_q[k];
        const double root = sqrt(1.0 + from * from / D + q * q / Q);
        const double per_cube = m->E[k] / (root * root * root);
        at.flux += m->E[k] / root * (from / D + I * q / Q);
        at.dd += per_cube * (1.0 + q * q / Q) / D;
        at.qq += per_cube * (1.0 + from * from / D) / Q;
        at.dq -= per_cube * from * q / (D * Q);
    }
    return at;
}

static double complex newton(const map_point *at, double complex flux)
{
    const double complex off = flux - at->flux;
    const double det = at->dd * at->qq - at->dq * at->dq;
    return (at->qq * creal(off) - at->dq * cimag(off) + I * (at->dd * cimag(off) - at->dq * creal(off))) /
           det;
}

/* Eliminates d as the firmware does: the limit on q acts on d. */
static double complex held_newton(const map_point *at, double complex flux, double most)
{
    const double complex off = flux - at->flux;
    const double q = fmax(-most, fmin(most, cimag(newton(at, flux))));
    const double d = fmax(-most, fmin(most, (creal(off) - at->dq * q) / at->dd));
    return d + I * q;
}

/* The current of a flux, to 1e-12, by steps that are halved until the flux comes closer. */
static double complex current_of(const machine *m, double complex flux, double complex i)
{
    for (int n = 0; n < 300; n++) {
        const map_point at = map_at(m, i);
        double complex more = newton(&at, flux);
        if (cabs(more) < 1e-12) {
            break;
        }
        while (cabs(more) > 1e-13 && cabs(flux - map_at(m, i + more).flux) > cabs(flux - at.flux)) {
            more *= 0.5;
        }
        i += more;
    }
    return i;
}

static double complex acting(const machine *m, double complex u, double complex i)
{
    double lost[3];
    for (int x = 0; x < 3; x++) {
        const double phase = creal(i * cexp(-I * TWO_PI * x / 3.0));
        lost[x] = m->v_dead * fmax(-1.0, fmin(1.0, phase * m->knee_inverse));
    }
    return u - (2.0 * lost[0] - lost[1] - lost[2]) / 3.0 - I * (lost[1] - lost[2]) / sqrt(3.0);
}

/* The header's steps; `exact`: the current of the flux in their place. start, end: e^(j theta). */
static double complex step(const machine *m, double complex i, double complex u, double complex start,
                           double complex end, bool exact)
{
    const double complex from = i * conj(start);
    map_point at = map_at(m, from);
    const double complex flux = at.flux * start;
    const double complex first = (flux + acting(m, u, i) - m->r * i) * conj(end);
    double complex next = exact ? current_of(m, first, from) : from + held_newton(&at, first, 1.0);
    const double complex mean = 0.5 * (i + next * end);
    const double complex goal = (flux + acting(m, u, mean) - m->r * mean) * conj(end);
    if (exact) {
        return current_of(m, goal, next) * end;
    }
    for (double most = 0.5; most > 0.2; most *= 0.5) {
        at = map_at(m, next);
        next += held_newton(&at, goal, most);
    }
    return next * end;
}

static double drawn_evenly(uint64_t *seed, double low, double high)
{
    return to_double(random_iq24(seed, low, high));
}

static double drawn_log(uint64_t *seed, double low, double high)
{
    return low * pow(high / low, drawn_evenly(seed, 0.0, 1.0));
}

/*
 * Reluctance machines with and without magnets. At no current l_d is 0.3 to 3 and l_q 0.7 to 5 times that; straight iron
 * has 30 to 90 % of it in d and 10 to 50 % in q. Parts saturate at 0.3 to 3 times the rated current in d, 1/4 to 2 times
 * in q.
 */
static machine drawn(uint64_t *seed)
{
    machine m = {.knee_inverse = drawn_evenly(seed, 1.0, 100.0)};
    const double l_d = drawn_log(seed, 0.3, 3.0);
    const double l_q = l_d * drawn_log(seed, 0.7, 5.0);
    const double share = drawn_evenly(seed, 0.0, 1.0);
    const double lost_d = drawn_evenly(seed, 0.1, 0.7) * l_d;
    const double lost_q = drawn_evenly(seed, 0.5, 0.9) * l_q;
    m.v_dead = drawn_evenly(seed, -0.02, 0.02);
    m.r = drawn_evenly(seed, 0.0, 0.05) * l_d;
    m.l_d = l_d;
    m.l_q = l_q;
    m.psi = drawn_evenly(seed, 0.0, 3.0) * l_d;
    for (int k = 0; k < PARTS; k++) {
        m.I_d[k] = drawn_log(seed, 0.3, 3.0);
        m.I_q[k] = drawn_log(seed, 0.25, 2.0);
        m.I_c[k] = drawn_evenly(seed, -0.5, 0.5) * (k + 1);
        const double x = m.I_c[k] / m.I_d[k];
        const double root = sqrt(1.0 + x * x);
        m.E[k] = (k == 0 ? share : 1.0 - share) *
                 fmin(lost_d * m.I_d[k] * m.I_d[k] * root * root * root, lost_q * m.I_q[k] * m.I_q[k] * root);
        m.l_d -= m.E[k] / (m.I_d[k] * m.I_d[k] * root * root * root);
        m.l_q -= m.E[k] / (m.I_q[k] * m.I_q[k] * root);
        m.psi += m.E[k] / m.I_d[k] * x / root;
    }
    return m;
}

/* In IQ24; and the machine becomes that of the rounded constants. */
static iqfoc_flux_map_t map_of(machine *m)
{
    iqfoc_flux_map_t map = {to_iq24(m->l_d), to_iq24(m->l_q), to_iq24(m->r), to_iq24(m->psi), {{0, 0, 0, 0}}};
    m->l_d = to_double(map.l_d);
    m->l_q = to_double(map.l_q);
    m->r = to_double(map.r);
    m->psi = to_double(map.psi);
    for (int k = 0; k < PARTS; k++) {
        iqfoc_flux_map_part_t *const p = &map.part[k];
        *p = (iqfoc_flux_map_part_t){to_iq24(m->E[k]), to_iq24(1.0 / m->I_d[k]), to_iq24(1.0 / m->I_q[k]),
                                     to_iq24(m->I_c[k] / m->I_d[k])};
        m->E[k] = to_double(p->e);
        m->I_d[k] = 1.0 / to_double(p->k_d);
        m->I_q[k] = 1.0 / to_double(p->k_q);
        m->I_c[k] = to_double(p->x_0) * m->I_d[k];
    }
    return map;
}

static iqfoc_extension_t extension_of(const machine *m)
{
    iqfoc_extension_t x = IQFOC_EXTENSION_NONE;
    x.v_dead = to_iq24(m->v_dead);
    x.knee_inverse = to_iq24(m->knee_inverse);
    return x;
}

/* What the header allows, in LSB: of the least inductance, and of the flux that the parts make. */
static double allowed(const machine *m)
{
    double parts = 0.0;
    for (int k = 0; k < PARTS; k++) {
        parts += m->E[k] / m->I_d[k] + m->E[k] / m->I_q[k];
    }
    return 8.0 + (2.5 + parts) * (1.0 / m->l_d + 1.0 / m->l_q);
}

/* A cycle: a current, its end's angle, and a voltage that changes it by `change` at most. */
typedef struct cycle {
    machine m;
    iqfoc_flux_map_t map;
    iqfoc_ab_t i, u;
    iq24_sincos_t start, end;
    double complex i_c, u_c, start_c, end_c;
} cycle;

static double complex of_ab(iqfoc_ab_t x)
{
    return to_double(x.alpha) + I * to_double(x.beta);
}

/* False: no inverter has this voltage. */
static bool cycle_drawn(uint64_t *seed, double change, cycle *c)
{
    c->m = drawn(seed);
    c->map = map_of(&c->m);
    c->start = iq24_sincos(random_iq24(seed, 0.0, 1.0));
    const double complex turned = cexp(I * TWO_PI * drawn_evenly(seed, -0.16, 0.16));
    c->start_c = to_double(c->start.cos) + I * to_double(c->start.sin);
    const iqfoc_ab_t end = {to_iq24(creal(turned * c->start_c)), to_iq24(cimag(turned * c->start_c))};
    c->end = (iq24_sincos_t){.sin = end.beta, .cos = end.alpha};
    c->end_c = of_ab(end);
    const double complex from =
        2.0 * sqrt(drawn_evenly(seed, 0.0, 1.0)) * cexp(I * TWO_PI * drawn_evenly(seed, 0.0, 1.0));
    const double complex to =
        from + change * sqrt(drawn_evenly(seed, 0.0, 1.0)) * cexp(I * TWO_PI * drawn_evenly(seed, 0.0, 1.0));
    c->i_c = from * c->start_c;
    c->i = (iqfoc_ab_t){to_iq24(creal(c->i_c)), to_iq24(cimag(c->i_c))};
    c->i_c = of_ab(c->i);
    const double complex mean = 0.5 * (c->i_c + to * c->end_c);
    c->u_c = map_at(&c->m, to).flux * c->end_c - map_at(&c->m, c->i_c * conj(c->start_c)).flux * c->start_c +
             c->m.r * mean;
    c->u = (iqfoc_ab_t){to_iq24(creal(c->u_c)), to_iq24(cimag(c->u_c))};
    c->u_c = of_ab(c->u);
    return cabs(c->u_c) <= 1.0;
}

static double off_lsb(iqfoc_ab_t got, double complex want)
{
    return hypot((double)got.alpha - creal(want) * 16777216.0, (double)got.beta - cimag(want) * 16777216.0);
}

static void test_fixed_point_follows_the_formula(void)
{
    uint64_t seed = SEED;
    double most = 0.0;
    double lsb = 0.0;
    int32_t compared = 0;
    while (compared < DRAWS / IQFOC_TEST_STRIDE) {
        cycle c;
        if (!cycle_drawn(&seed, 0.5, &c)) {
            continue;
        }
        compared++;
        const iqfoc_extension_t x = extension_of(&c.m);
        const double complex want = step(&c.m, c.i_c, c.u_c, c.start_c, c.end_c, false);
        const double off = off_lsb(iqfoc_flux_map_step(&c.map, &x, c.i, c.u, c.start, c.end), want);
        lsb = fmax(lsb, off);
        most = fmax(most, off / allowed(&c.m));
    }
    printf("  error over what is stated %.3f, at most %.0f LSB\n", most, lsb);
    TEST_ASSERT_TRUE(most <= 1.0 && most >= 0.4);
}

/* What three steps leave, in percent of the rated current: the figures in the header. */
static void steps_leave(double change, double most_percent, double most_rms)
{
    uint64_t seed = SEED + 1;
    double largest = 0.0;
    double sum = 0.0;
    int32_t compared = 0;
    while (compared < DRAWS / IQFOC_TEST_STRIDE) {
        cycle c;
        if (!cycle_drawn(&seed, change, &c)) {
            continue;
        }
        c.m.v_dead = 0.0;
        const double off = 100.0 * cabs(step(&c.m, c.i_c, c.u_c, c.start_c, c.end_c, false) -
                                        step(&c.m, c.i_c, c.u_c, c.start_c, c.end_c, true));
        compared++;
        largest = fmax(largest, off);
        sum += off * off;
    }
    const double rms = sqrt(sum / compared);
    printf("  changes up to %.2f: the steps leave %.4f %%, %.5f %% rms\n", change, largest, rms);
    TEST_ASSERT_TRUE(largest <= most_percent && rms <= most_rms && rms >= 0.4 * most_rms);
}

static void test_what_the_steps_leave(void)
{
    steps_leave(0.25, 1.5, 0.03);
    steps_leave(0.5, 7.0, 0.12);
    steps_leave(1.0, 15.0, 0.35);
}

/* d psi/dt in the stationary frame by RK4 with 200 steps; R at every instant. */
static double complex integrated(const machine *m, double complex i, double complex u, double theta,
                                 double phi)
{
    enum { STEPS = 200 };
    const double complex start = cexp(I * theta);
    double complex near = i * conj(start);
    double complex psi = map_at(m, near).flux * start;
    const double h = 1.0 / STEPS;
    for (int n = 0; n < STEPS; n++) {
        double complex slope[4];
        for (int k = 0; k < 4; k++) {
            const double at = k == 0 ? 0.0 : (k < 3 ? 0.5 : 1.0);
            const double complex here = psi + (k == 0 ? 0.0 : at * h * slope[k - 1]);
            const double complex e = cexp(I * (theta + phi * (n + at) * h));
            near = current_of(m, here * conj(e), near);
            slope[k] = u - m->r * near * e;
        }
        psi += h / 6.0 * (slope[0] + 2.0 * slope[1] + 2.0 * slope[2] + slope[3]);
    }
    const double complex end = cexp(I * (theta + phi));
    return current_of(m, psi * conj(end), near) * end;
}

/* A 5 kW reluctance machine with magnets in per unit, invented: L_q falls to a fifth. */
static const machine invented = {.l_d = 0.9,
                                 .l_q = 0.8,
                                 .r = 0.0135,
                                 .psi = 1.5,
                                 .E = {1.3, 0.5},
                                 .I_d = {1.6, 1.1},
                                 .I_q = {0.7, 0.5},
                                 .I_c = {-0.4, 0.3}};

/* What the formula leaves, in percent of the rated current, at up to twice that and with a tenth of the voltage to spare. */
static void formula_errs_by(double phi, double most_percent, double least_percent)
{
    uint64_t seed = SEED + 2;
    double largest = 0.0;
    for (int32_t n = 0; n < 300; n++) {
        const machine *const m = &invented;
        const double theta = drawn_evenly(&seed, 0.0, TWO_PI);
        const double complex e = cexp(I * theta);
        const double complex i = drawn_evenly(&seed, 0.0, 2.0) * cexp(I * drawn_evenly(&seed, 0.0, TWO_PI));
        const double complex u = map_at(m, i * conj(e)).flux * e * (cexp(I * phi) - 1.0) + m->r * i +
                                 0.1 * cexp(I * drawn_evenly(&seed, 0.0, TWO_PI));
        largest = fmax(largest, 100.0 * cabs(step(m, i, u, e, cexp(I * (theta + phi)), false) -
                                             integrated(m, i, u, theta, phi)));
    }
    printf("  phi = %.3f rad: the formula errs by %.4f %% of the rated current\n", phi, largest);
    TEST_ASSERT_TRUE(largest <= most_percent && largest >= least_percent);
}

static void test_formula_against_integration(void)
{
    formula_errs_by(0.0, 0.01, 1e-6);
    formula_errs_by(0.1, 0.02, 1e-5);
    formula_errs_by(0.3, 0.2, 0.01);
}

/* The flux is a gradient whose cross inductances are alike, and its slope is its derivative. */
static void test_the_map_stores_energy(void)
{
    const double h = 1e-5;
    for (int n = 0; n < 40; n++) {
        const double complex i = 2.0 * cexp(I * 0.157 * n);
        const map_point at = map_at(&invented, i);
        const double complex by_d =
            (map_at(&invented, i + h).flux - map_at(&invented, i - h).flux) / (2.0 * h);
        const double complex by_q =
            (map_at(&invented, i + I * h).flux - map_at(&invented, i - I * h).flux) / (2.0 * h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, at.dd, creal(by_d));
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, at.dq, cimag(by_d));
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, at.dq, creal(by_q));
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, at.qq, cimag(by_q));
    }
}

/* Constants at the ends of their ranges, every current to +-8: a voltage moves it by up to a tenth of the rated one. */
static void test_whole_range(void)
{
    static const machine extreme[] = {
        {.l_d = 0.015625, .l_q = 0.015625, .E = {0.63, 0.0}, .I_d = {0.1, 1.0}, .I_q = {0.1, 1.0}},
        {.l_d = 4.0,
         .l_q = 4.0,
         .psi = 16.0,
         .E = {0.59, 0.0},
         .I_d = {0.1, 1.0},
         .I_q = {16.0, 1.0},
         .I_c = {-1.6, 0.0}},
        {.l_d = 4.0,
         .l_q = 4.0,
         .psi = -16.0,
         .E = {64.0, 64.0},
         .I_d = {16.0, 8.0},
         .I_q = {8.0, 16.0},
         .I_c = {256.0, -128.0}},
        {.l_d = 2.0,
         .l_q = 0.05,
         .r = 1.0,
         .E = {7.0, 2.0},
         .I_d = {1.0, 2.0},
         .I_q = {0.7, 0.4},
         .I_c = {3.0, -4.0}},
    };
    const iqfoc_extension_t none = IQFOC_EXTENSION_NONE;
    const iq24_sincos_t still = {0, IQ24_ONE};
    double most = 0.0;
    uint64_t seed = SEED + 3;
    for (size_t n = 0; n < sizeof extreme / sizeof extreme[0]; n++) {
        machine m = extreme[n];
        const iqfoc_flux_map_t map = map_of(&m);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_map_check(&map));
        for (iq24_t d = -IQ24(8.0); d < IQ24(8.0); d += IQ24(0.123)) {
            for (iq24_t q = -IQ24(8.0); q < IQ24(8.0); q += IQ24(0.123)) {
                const iqfoc_ab_t i = {d, q};
                const double complex more =
                    drawn_evenly(&seed, 0.0, 0.1) * cexp(I * drawn_evenly(&seed, 0.0, TWO_PI));
                const double complex moves = map_at(&m, of_ab(i) + more).flux - map_at(&m, of_ab(i)).flux;
                const iqfoc_ab_t u = {to_iq24(creal(moves)), to_iq24(cimag(moves))};
                const double complex want = step(&m, of_ab(i), of_ab(u), 1.0, 1.0, false);
                if (cabs(moves) <= 2.0) {
                    most = fmax(most, off_lsb(iqfoc_flux_map_step(&map, &none, i, u, still, still), want) /
                                          allowed(&m));
                }
            }
        }
    }
    printf("  whole range: error over what is stated %.3f\n", most);
    TEST_ASSERT_TRUE(most <= 1.0 && most >= 0.1);
}

/* Without parts it is the other predictor, unsaturated. */
static void test_without_parts(void)
{
    static const iqfoc_flux_predictor_t plain =
        IQFOC_FLUX_PREDICTOR(0.9, 0.008, 0.011, 0.2, 0.00025, IQFOC_I_BASE(6.0), 565.0);
    static const iqfoc_flux_map_t map =
        IQFOC_FLUX_MAP(0.9, 0.008, 0.011, 0.2, IQFOC_FLUX_MAP_NO_PART, IQFOC_FLUX_MAP_NO_PART, 0.00025,
                       IQFOC_I_BASE(6.0), 565.0);
    const iqfoc_extension_t none = IQFOC_EXTENSION_NONE;
    uint64_t seed = SEED + 3;
    for (int n = 0; n < 2000; n++) {
        const iqfoc_ab_t i = {random_iq24(&seed, -2.0, 2.0), random_iq24(&seed, -2.0, 2.0)};
        const iqfoc_ab_t u = {random_iq24(&seed, -0.3, 0.3), random_iq24(&seed, -0.3, 0.3)};
        const iq24_sincos_t e = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        const iqfoc_ab_t want = iqfoc_flux_predictor_step(&plain, &none, i, u, e, e);
        const iqfoc_ab_t got = iqfoc_flux_map_step(&map, &none, i, u, e, e);
        TEST_ASSERT_INT_WITHIN(20, want.alpha, got.alpha);
        TEST_ASSERT_INT_WITHIN(20, want.beta, got.beta);
    }
}

/* Any inputs: it stays within what the header says. */
static void test_extremes_stay_bounded(void)
{
    static const iq24_t far[] = {IQ24_MIN, IQ24(-8.0), IQ24(-0.001), 0, IQ24(0.5), IQ24(8.0), IQ24_MAX};
    const iqfoc_extension_t none = IQFOC_EXTENSION_NONE;
    uint64_t seed = SEED + 4;
    for (int n = 0; n < 200; n++) {
        machine m = drawn(&seed);
        const iqfoc_flux_map_t map = map_of(&m);
        const iq24_sincos_t start = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        const iq24_sincos_t end = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        for (size_t a = 0; a < sizeof far / sizeof far[0]; a++) {
            for (size_t b = 0; b < sizeof far / sizeof far[0]; b++) {
                const iqfoc_ab_t i = {far[a], far[b]};
                const iqfoc_ab_t u = {far[b] / 64, far[a] / 64};
                const double complex got = of_ab(iqfoc_flux_map_step(&map, &none, i, u, start, end));
                const double complex seen = got * (to_double(end.cos) - I * to_double(end.sin));
                TEST_ASSERT_TRUE(fabs(creal(seen)) <= 9.75001 && fabs(cimag(seen)) <= 9.75001);
            }
        }
    }
}

static void test_refusals(void)
{
    static const iqfoc_flux_map_t good = IQFOC_FLUX_MAP(
        0.9, 0.008, 0.011, 0.2, IQFOC_FLUX_MAP_PART(0.5, 8.0, 6.0, -2.0, 0.00025, IQFOC_I_BASE(6.0), 565.0),
        IQFOC_FLUX_MAP_PART(0.2, 5.0, 4.0, 3.0, 0.00025, IQFOC_I_BASE(6.0), 565.0), 0.00025,
        IQFOC_I_BASE(6.0), 565.0);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_map_check(&good));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_flux_map_check(NULL));
    /* Each value at fault by itself, one LSB below and above its range. */
    const struct {
        size_t offset;
        iq24_t low, high;
        iqfoc_error_t error;
    } range[] = {
        {offsetof(iqfoc_flux_map_t, l_d), IQ24(0.015625), IQ24(8.0), IQFOC_ERROR_INDUCTANCE_D},
        {offsetof(iqfoc_flux_map_t, l_q), IQ24(0.015625), IQ24(8.0), IQFOC_ERROR_INDUCTANCE_Q},
        {offsetof(iqfoc_flux_map_t, r), 0, IQ24_ONE, IQFOC_ERROR_RESISTANCE},
        {offsetof(iqfoc_flux_map_t, psi), IQ24(-16.0), IQ24(16.0), IQFOC_ERROR_FLUX},
        {offsetof(iqfoc_flux_map_t, part[0].e), 0, IQ24(0.5), IQFOC_ERROR_FLUX_PART},
        {offsetof(iqfoc_flux_map_t, part[0].k_d), IQ24(0.0625), IQ24(10.0), IQFOC_ERROR_FLUX_PART},
        {offsetof(iqfoc_flux_map_t, part[0].k_q), IQ24(0.0625), IQ24(10.0), IQFOC_ERROR_FLUX_PART},
        {offsetof(iqfoc_flux_map_t, part[0].x_0), IQ24(-16.0), IQ24(16.0), IQFOC_ERROR_FLUX_PART},
        {offsetof(iqfoc_flux_map_t, part[1].k_q), IQ24(0.0625), IQ24(10.0), IQFOC_ERROR_FLUX_PART},
    };
    for (size_t n = 0; n < sizeof range / sizeof range[0]; n++) {
        const iq24_t value[] = {range[n].low, range[n].high, range[n].low - 1, range[n].high + 1};
        for (size_t k = 0; k < 4; k++) {
            iqfoc_flux_map_t map = good;
            map.part[0].e = map.part[1].e = IQ24(0.25);
            memcpy((char *)&map + range[n].offset, &value[k], sizeof value[k]);
            const bool e_above = range[n].offset == offsetof(iqfoc_flux_map_t, part[0].e) && k == 3;
            TEST_ASSERT_EQUAL_INT(k < 2 || e_above ? IQFOC_OK : range[n].error, iqfoc_flux_map_check(&map));
        }
    }
}

/* e alone, and the sums: of the fluxes 16, of the slopes 64. The parts' other values have no meaning without energy. */
static void test_sums_of_the_parts(void)
{
    iqfoc_flux_map_t map = {
        IQ24_ONE, IQ24_ONE, 0, 0, {{IQ24(64.0), IQ24(0.125), IQ24(0.0625), 0}, {0, IQ24(99.0), 0, IQ24_MAX}}};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_map_check(&map));
    map.part[0].e++;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_FLUX_PART, iqfoc_flux_map_check(&map));
    for (int axis = 0; axis < 2; axis++) {
        iqfoc_flux_map_part_t p = {IQ24(16.0), IQ24(0.0625), IQ24(0.0625), 0};
        iq24_t *const k = axis == 0 ? &p.k_d : &p.k_q;
        /* Fluxes: 8 and 8, then an LSB more. */
        *k = IQ24(0.5);
        map.part[0] = map.part[1] = p;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_map_check(&map));
        map.part[1].e++; /* half an LSB, to nearest */
        TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_FLUX_PART, iqfoc_flux_map_check(&map));
        /* Slopes: 1 and 31.5 and 31.5, then an LSB more. */
        *k = IQ24(8.0);
        p.e = IQ24(31.5 / 64.0);
        map.part[0] = map.part[1] = p;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_map_check(&map));
        iq24_t *const l = axis == 0 ? &map.l_d : &map.l_q;
        ++*l;
        TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_FLUX_PART, iqfoc_flux_map_check(&map));
        --*l;
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fixed_point_follows_the_formula);
    RUN_TEST(test_what_the_steps_leave);
    RUN_TEST(test_formula_against_integration);
    RUN_TEST(test_the_map_stores_energy);
    RUN_TEST(test_whole_range);
    RUN_TEST(test_without_parts);
    RUN_TEST(test_extremes_stay_bounded);
    RUN_TEST(test_refusals);
    RUN_TEST(test_sums_of_the_parts);
    return UNITY_END();
}
