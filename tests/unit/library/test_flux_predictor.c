/*
 * Prediction by flux linkage: the fixed-point step against the same formula in double, and that formula
 * against a direct integration of the salient, saturated machine in which nothing of it is used.
 */
#include "iqfoc/extension_params.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/iq24_math.h"
#include "reference.h"

#include <complex.h>
#include <stddef.h>
#include <string.h>

#define DRAWS 200000
#define SEED  UINT64_C(20210607)

void setUp(void)
{
}

void tearDown(void)
{
}

/* Constants as doubles, per unit. */
typedef struct machine {
    double l_d, l_q, r, psi, s, k_u, v_dead, knee_inverse;
} machine;

/* The current's square in the measure of the energy that it stores unsaturated. */
static double square_of(const machine *m, double complex i)
{
    return 2.0 * (m->l_d * creal(i) * creal(i) + m->l_q * cimag(i) * cimag(i)) / (m->l_d + m->l_q);
}

static double complex flux_of(const machine *m, double complex i)
{
    const double fall = 1.0 / (1.0 + fmin(1.0, m->s * square_of(m, i)));
    return m->l_d * creal(i) * fall + m->psi + I * m->l_q * cimag(i) * fall;
}

static double complex current_of(const machine *m, double complex flux)
{
    const double complex y = (creal(flux) - m->psi) / m->l_d + I * cimag(flux) / m->l_q;
    const double x4 = 4.0 * fmin(0.25, m->s * square_of(m, y));
    return 2.0 * y / (1.0 + sqrt(1.0 - x4));
}

static double complex acting(const machine *m, double complex u, double complex i)
{
    double lost[3];
    for (int x = 0; x < 3; x++) {
        const double phase = creal(i * cexp(-I * TWO_PI * x / 3.0));
        lost[x] = m->v_dead * fmax(-1.0, fmin(1.0, phase * m->knee_inverse));
    }
    return m->k_u * u - (2.0 * lost[0] - lost[1] - lost[2]) / 3.0 - I * (lost[1] - lost[2]) / sqrt(3.0);
}

/* The header's formula. start, end: e^(j theta). */
static double complex step(const machine *m, double complex i, double complex u, double complex start,
                           double complex end)
{
    const double complex flux = flux_of(m, i * conj(start)) * start;
    double complex next = current_of(m, (flux + acting(m, u, i) - m->r * i) * conj(end)) * end;
    const double complex mean = 0.5 * (i + next);
    next = current_of(m, (flux + acting(m, u, mean) - m->r * mean) * conj(end)) * end;
    return next;
}

static machine drawn(uint64_t *seed, bool saturates)
{
    const machine m = {to_double(random_iq24(seed, 0.2, 3.0)),
                       to_double(random_iq24(seed, 0.2, 3.0)),
                       to_double(random_iq24(seed, 0.0, 0.2)),
                       to_double(random_iq24(seed, 0.0, 3.0)),
                       saturates ? to_double(random_iq24(seed, 0.01, 0.15)) : 0.0,
                       to_double(random_iq24(seed, 0.9, 1.1)),
                       to_double(random_iq24(seed, -0.02, 0.02)),
                       to_double(random_iq24(seed, 1.0, 100.0))};
    return m;
}

static iqfoc_flux_predictor_t predictor_of(const machine *m)
{
    const iqfoc_flux_predictor_t p = {to_iq24(m->l_d),
                                      to_iq24(m->l_q),
                                      to_iq24(1.0 / m->l_d),
                                      to_iq24(1.0 / m->l_q),
                                      to_iq24(m->r),
                                      to_iq24(m->psi),
                                      to_iq24((m->l_d - m->l_q) / (m->l_d + m->l_q))};
    return p;
}

static iqfoc_extension_t extension_of(const machine *m)
{
    iqfoc_extension_t x = IQFOC_EXTENSION_NONE;
    x.k_u = to_iq24(m->k_u);
    x.v_dead = to_iq24(m->v_dead);
    x.knee_inverse = to_iq24(m->knee_inverse);
    x.saturation = to_iq24(m->s);
    return x;
}

/* Error over what the header allows for it: 8 + 2.5 (k_d + k_q) LSB. */
static double worst_step(bool saturates, uint64_t seed)
{
    double most = 0.0;
    int32_t compared = 0;
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const machine m = drawn(&seed, saturates);
        const iqfoc_flux_predictor_t p = predictor_of(&m);
        const iqfoc_extension_t x = extension_of(&m);
        const double reach = saturates ? 1.0 : 4.0;
        const iqfoc_ab_t i = {random_iq24(&seed, -reach, reach), random_iq24(&seed, -reach, reach)};
        const iq24_t theta = random_iq24(&seed, 0.0, 1.0);
        const iq24_t speed = random_iq24(&seed, -0.33, 0.33);
        const iq24_sincos_t start = iq24_sincos(theta);
        const iq24_sincos_t end = iq24_sincos(iq24_add_wrap(theta, speed));
        const double complex e = to_double(start.cos) + I * to_double(start.sin);
        const double complex turned = to_double(end.cos) + I * to_double(end.sin);
        const double complex i_c = to_double(i.alpha) + I * to_double(i.beta);
        /*
         * About what holds the current, as a drive's voltage does: else it leaves the range within one cycle.
         */
        const double complex holds = flux_of(&m, i_c * conj(e)) * (turned - e);
        if (cabs(holds) > 1.6) {
            continue;
        }
        const iqfoc_ab_t u = {to_iq24(creal(holds)) + random_iq24(&seed, -0.2, 0.2),
                              to_iq24(cimag(holds)) + random_iq24(&seed, -0.2, 0.2)};
        const iqfoc_ab_t got = iqfoc_flux_predictor_step(&p, &x, i, u, start, end);
        const double complex want = step(&m, i_c, to_double(u.alpha) + I * to_double(u.beta), e, turned);
        if (saturates && m.s * square_of(&m, want * conj(turned)) > 0.5) {
            continue; /* close to where the law ends the current is undetermined */
        }
        compared++;
        const double off =
            hypot((double)got.alpha - creal(want) * 16777216.0, (double)got.beta - cimag(want) * 16777216.0);
        most = fmax(most, off / (8.0 + 2.5 * (1.0 / m.l_d + 1.0 / m.l_q)));
    }
    TEST_ASSERT_TRUE(compared > DRAWS / IQFOC_TEST_STRIDE / 10);
    return most;
}

static void test_fixed_point_follows_the_formula(void)
{
    const double plain = worst_step(false, SEED);
    const double saturated = worst_step(true, SEED + 1);
    printf("  error over what is stated unsaturated: %.3f without, %.3f with saturation\n", plain, saturated);
    TEST_ASSERT_TRUE(plain <= 1.0 && plain >= 0.5);
    TEST_ASSERT_TRUE(saturated <= 2.0 && saturated >= 1.0);
}

/* d psi/dt in the stationary frame by RK4 with 400 steps; R and saturation at every instant. */
static double complex integrated(const machine *m, double complex i, double complex u, double theta,
                                 double phi)
{
    enum { STEPS = 400 };
    const double complex start = cexp(I * theta);
    double complex psi = flux_of(m, i * conj(start)) * start;
    const double h = 1.0 / STEPS;
    for (int n = 0; n < STEPS; n++) {
        double complex slope[4];
        for (int k = 0; k < 4; k++) {
            const double at = k == 0 ? 0.0 : (k < 3 ? 0.5 : 1.0);
            const double complex here = psi + (k == 0 ? 0.0 : at * h * slope[k - 1]);
            const double complex e = cexp(I * (theta + phi * (n + at) * h));
            slope[k] = u - m->r * current_of(m, here * conj(e)) * e;
        }
        psi += h / 6.0 * (slope[0] + 2.0 * slope[1] + 2.0 * slope[2] + slope[3]);
    }
    const double complex end = cexp(I * (theta + phi));
    return current_of(m, psi * conj(end)) * end;
}

/* What the formula leaves, in percent of the rated current: the figures in the header. */
static void formula_errs_by(double phi, double most_percent, double least_percent)
{
    uint64_t seed = SEED + 2;
    double worst_percent = 0.0;
    for (int32_t n = 0; n < 300; n++) {
        machine m = {0.66, 0.92, 0.0135, 1.4, n % 2 == 0 ? 0.0 : 0.06, 1.0, 0.0, 1.0};
        const double theta = to_double(random_iq24(&seed, 0.0, TWO_PI));
        const double complex i = cexp(I * to_double(random_iq24(&seed, 0.0, TWO_PI)));
        /* A voltage that nearly holds the current, as a drive applies: the flux turns by phi. */
        const double complex e = cexp(I * theta);
        const double complex u = flux_of(&m, i * conj(e)) * e * (cexp(I * phi) - 1.0) + m.r * i;
        const double complex off =
            step(&m, i, u, e, cexp(I * (theta + phi))) - integrated(&m, i, u, theta, phi);
        worst_percent = fmax(worst_percent, 100.0 * cabs(off));
    }
    printf("  phi = %.3f rad: the formula errs by %.4f %% of the rated current\n", phi, worst_percent);
    TEST_ASSERT_TRUE(worst_percent <= most_percent);
    TEST_ASSERT_TRUE(worst_percent >= least_percent);
}

static void test_formula_against_integration(void)
{
    formula_errs_by(0.0, 0.001, 0.0);
    formula_errs_by(0.1, 0.01, 1e-5);
    formula_errs_by(0.5, 0.2, 0.05);
    formula_errs_by(1.0, 0.8, 0.2);
}

/* A flux that is the gradient of an energy has cross inductances that are alike; the law by |i| alone has not. */
static void test_the_law_stores_energy(void)
{
    const machine m = {0.5, 1.4, 0.0, 0.7, 0.1, 1.0, 0.0, 1.0};
    const double h = 1e-5;
    for (int n = 0; n < 40; n++) {
        const double complex i = 1.2 * cexp(I * 0.157 * n);
        const double d_by_q = creal(flux_of(&m, i + I * h) - flux_of(&m, i - I * h)) / (2.0 * h);
        const double q_by_d = cimag(flux_of(&m, i + h) - flux_of(&m, i - h)) / (2.0 * h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, d_by_q, q_by_d);
    }
}

static void test_refusals(void)
{
    const iqfoc_flux_predictor_t good =
        IQFOC_FLUX_PREDICTOR(0.9, 0.008, 0.011, 0.2, 0.00025, IQFOC_I_BASE(6.0), 565.0);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&good));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_flux_predictor_check(NULL));
    /* Each value at fault by itself, below and above its range, or no longer the other's reciprocal. */
    const struct {
        size_t offset;
        iq24_t value;
        iqfoc_error_t error;
    } bad[] = {
        {offsetof(iqfoc_flux_predictor_t, l_d), IQ24(0.0625) - 1, IQFOC_ERROR_INDUCTANCE_D},
        {offsetof(iqfoc_flux_predictor_t, l_d), IQ24(8.0) + 1, IQFOC_ERROR_INDUCTANCE_D},
        {offsetof(iqfoc_flux_predictor_t, k_d), IQ24(0.125) - 1, IQFOC_ERROR_INDUCTANCE_D},
        {offsetof(iqfoc_flux_predictor_t, k_d), good.k_d + IQ24(0.01), IQFOC_ERROR_INDUCTANCE_D},
        {offsetof(iqfoc_flux_predictor_t, l_q), IQ24(8.0) + 1, IQFOC_ERROR_INDUCTANCE_Q},
        {offsetof(iqfoc_flux_predictor_t, k_q), good.k_q + IQ24(0.01), IQFOC_ERROR_INDUCTANCE_Q},
        {offsetof(iqfoc_flux_predictor_t, skew), good.skew + IQ24(0.01), IQFOC_ERROR_INDUCTANCE_Q},
        {offsetof(iqfoc_flux_predictor_t, skew), -IQ24_ONE, IQFOC_ERROR_INDUCTANCE_Q},
        {offsetof(iqfoc_flux_predictor_t, r), -1, IQFOC_ERROR_RESISTANCE},
        {offsetof(iqfoc_flux_predictor_t, r), IQ24_ONE + 1, IQFOC_ERROR_RESISTANCE},
        {offsetof(iqfoc_flux_predictor_t, psi), -1, IQFOC_ERROR_FLUX},
        {offsetof(iqfoc_flux_predictor_t, psi), IQ24(16.0) + 1, IQFOC_ERROR_FLUX},
    };
    for (size_t n = 0; n < sizeof bad / sizeof bad[0]; n++) {
        iqfoc_flux_predictor_t p = good;
        memcpy((char *)&p + bad[n].offset, &bad[n].value, sizeof bad[n].value);
        TEST_ASSERT_EQUAL_INT(bad[n].error, iqfoc_flux_predictor_check(&p));
    }
}

/* Of two inductances of 1/2 the skew is its own error: 2^-10 is accepted, one LSB more is not. */
static void test_most_error_of_skew(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        iqfoc_flux_predictor_t p = {
            IQ24(0.5), IQ24(0.5), IQ24(2.0), IQ24(2.0), 0, 0, sign * IQ24(0.0009765625)};
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&p));
        p.skew += sign;
        TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_INDUCTANCE_Q, iqfoc_flux_predictor_check(&p));
    }
    /* Of two of 3/4 its error is 1 1/2 times the skew, to nearest: 16384 1/2 LSB is 16385, and -16384 1/2 is -16384. */
    iqfoc_flux_predictor_t p = {IQ24(0.75), IQ24(0.75), IQ24(4.0 / 3.0), IQ24(4.0 / 3.0), 0, 0, 10922};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&p));
    p.skew = 10923;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_INDUCTANCE_Q, iqfoc_flux_predictor_check(&p));
    p.skew = -10923;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&p));
    p.skew = -10924;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_INDUCTANCE_Q, iqfoc_flux_predictor_check(&p));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fixed_point_follows_the_formula);
    RUN_TEST(test_formula_against_integration);
    RUN_TEST(test_the_law_stores_energy);
    RUN_TEST(test_refusals);
    RUN_TEST(test_most_error_of_skew);
    return UNITY_END();
}
