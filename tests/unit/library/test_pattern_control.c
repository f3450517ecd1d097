/*
 * Control of a pulse pattern against its formulas in double: prediction by the exact solution, flux by integrating the pattern's level
 * edge by edge, moved edges from the sorted list of the pattern's edges. An argument is the number of cycles of the test of
 * least times.
 */
#include "pattern_reference.h"

#include "iqfoc/pattern_control.h"
#include "iqfoc/transform.h"

#include <complex.h>

#define SEED UINT64_C(27182818)

enum { DRAWS = 200000, CYCLES = 100000 };

static long cycles_drawn = CYCLES / IQFOC_TEST_STRIDE;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The drive of the 2019 paper at 10 kHz and 565 V. */
static const iqfoc_pattern_control_config_t drive = {
    IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.01)};

static iqfoc_pattern_control_t control_of(const iqfoc_pattern_control_config_t *config, double least)
{
    iqfoc_pattern_control_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, config, &table, to_iq24(least)));
    return c;
}

static double complex of_dq(iqfoc_dq_t x)
{
    return to_double(x.d) + I * to_double(x.q);
}

static double complex of_ab(iqfoc_ab_t x)
{
    return to_double(x.alpha) + I * to_double(x.beta);
}

static iqfoc_ab_t drawn_ab(uint64_t *seed, double most)
{
    const iqfoc_ab_t x = {random_iq24(seed, -most, most), random_iq24(seed, -most, most)};
    return x;
}

/* ---- One cycle in double ---- */

typedef struct cycle {
    iqfoc_pattern_control_config_t config;
    iqfoc_dq_t i_ref;
    iqfoc_ab_t i;
    iq24_t theta, speed, u_dc, u_slope;
} cycle;

/*
 * Current at the end of a cycle, in per unit, by the exact solution; u turns with the rotor, and v is constant in its frame. Both by the
 * first terms of their series in the angle.
 */
static double complex predicted(const cycle *y, double complex i, double complex u, double complex v,
                                double theta)
{
    const double rho = ldexp(y->config.winding.rho_q30, -30);
    const double k_u = ldexp(y->config.winding.k_u_q26, -26);
    const double k_psi = ldexp(y->config.winding.k_psi_q27, -27);
    const double phi = TWO_PI * to_double(y->speed);
    const double complex z = 0.5 * (rho + I * phi);
    const double share = rho > 0.0 ? -expm1(-rho) / rho : 1.0;
    const double complex middle = cexp(I * (theta + 0.5 * phi));
    return exp(-rho) * i +
           share * k_u * (u * (1.0 + I * rho * phi / 12.0) + v * middle * (1.0 - phi * phi / 24.0)) -
           I * k_psi * phi * exp(-0.5 * rho) * csinh(z) / z * middle;
}

/* Integral of a leg's level from 1/4 turn to x: from edge to edge. */
static double integral_to(const pattern *p, double x)
{
    double distance[EDGES];
    const double to = fraction(x - 0.25);
    const int all = distances(p, 0.25, 1.0, distance);
    double sum = 0.0;
    double from = 0.0;
    for (int k = 0; k <= all; k++) {
        const double end = fmin(k < all ? distance[k] : 1.0, to);
        sum += level_at(p, 0.25 + 0.5 * (from + end)) * (end - from);
        from = end;
    }
    return sum;
}

/* The voltage of the reference, in the rotor frame; without its part that is induced if `drop`. */
static double complex reference_voltage(const cycle *y, const iqfoc_pattern_control_t *c,
                                        double complex *drop)
{
    const double l = ldexp(1.0, 26) / y->config.winding.k_u_q26;
    const double r = ldexp(y->config.winding.rho_q30, -30) * l;
    const double psi = ldexp(y->config.winding.k_psi_q27, -27) * l;
    const double complex i = of_dq(y->i_ref);
    *drop = r * i - of_dq(c->v);
    return *drop + I * TWO_PI * to_double(y->speed) * (l * i + psi);
}

/* Places of the legs, in the sense in which time goes forward. */
static void places(const cycle *y, double complex u, double x[3])
{
    const double a = to_double(y->theta) + to_double(y->speed) + carg(u) / TWO_PI + 0.25;
    for (int leg = 0; leg < 3; leg++) {
        x[leg] = a - leg / 3.0;
        x[leg] = fraction(y->speed < 0 ? 0.5 - x[leg] : x[leg]);
    }
}

/*
 * Flux error over the link, from the estimated current at the cycle's end. The link will be off by two slopes: the voltage u is longer by
 * that share, until the next edge of a leg.
 */
static double complex flux_error(const cycle *y, const pattern *p, const double x[3], double complex u,
                                 double complex drop, double complex i_next)
{
    const double off = fmax(fmin(2.0 * to_double(y->u_slope), 0.125), -0.125) / to_double(y->u_dc);
    const double spacing = 0.5 / (2 * p->angles + 1);
    const double l = ldexp(1.0, 26) / y->config.winding.k_u_q26;
    const double psi = ldexp(y->config.winding.k_psi_q27, -27) * l;
    const double phi = TWO_PI * to_double(y->speed);
    const double complex rotor = cexp(I * TWO_PI * (to_double(y->theta) + to_double(y->speed)));
    double complex sum = 0.0;
    for (int leg = 0; leg < 3; leg++) {
        sum += 2.0 / 3.0 * integral_to(p, x[leg]) * cexp(I * TWO_PI / 3.0 * leg);
    }
    return 0.5 * sum / fabs(to_double(y->speed)) +
           ((I * drop / phi - psi - u * off * spacing / fabs(to_double(y->speed))) * rotor - l * i_next) /
               to_double(y->u_dc);
}

/* The edges of a leg whose level is the pattern's, moved by its flux error: their times. */
static int moved_edges(const pattern *p, double x, double speed, double error,
                       double at[IQFOC_PATTERN_EDGES_MAX])
{
    double distance[EDGES];
    const int all = distances(p, x, 1.0, distance);
    int level = level_at(p, x + 1e-9);
    int count = 0;
    double last = 0.0;
    while (count < IQFOC_PATTERN_EDGES_MAX - 1) {
        const double nominal = distance[count % all] / speed;
        const double next = (distance[(count + 1) % all] + (count + 1 >= all)) / speed;
        const double before = count > 0 ? distance[count - 1] / speed : 0.0;
        const double t = fmax(fmin(nominal + level * error, next), fmax(last, before));
        if (t >= 1.0) {
            break;
        }
        at[count] = last = t;
        count++;
        level = -level;
        error += level * (t - nominal);
    }
    return count;
}

/* ---- Tests ---- */

/* Rows of any angles that move by at most 0.2 turns over an index of 1, as those of computed patterns. */
static void smooth_table(uint64_t *seed)
{
    drawn_table(seed);
    const int32_t start = random_bits(seed) % 2 != 0 ? 1 : -1;
    for (int n = 0; n < ROWS; n++) {
        rows[n].start = start;
        rows[n].joined = n + 1 < ROWS;
        for (int k = 0; k < table.angles && n > 0; k++) {
            const iq24_t lowest = k > 0 ? rows[n].angle[k - 1] : 0;
            rows[n].angle[k] =
                iq24_clamp(rows[n - 1].angle[k] + random_iq24(seed, -0.002, 0.002), lowest, IQ24(0.25));
        }
    }
}

static cycle drawn_cycle(uint64_t *seed)
{
    cycle y = {.config = drive};
    const double l = exp(uniform(seed, log(0.1), log(7.9)));
    y.config.winding.rho_q30 = (int32_t)ldexp(uniform(seed, 0.0, fmin(0.2, 0.4 / l)), 30);
    y.config.winding.k_u_q26 = (int32_t)ldexp(1.0 / l, 26);
    y.config.winding.k_psi_q27 = (int32_t)ldexp(uniform(seed, 0.0, fmin(4.0, 15.9 / l)), 27);
    const double speed = exp(uniform(seed, log(1.0 / 127.0), log(0.125)));
    y.speed = to_iq24(random_bits(seed) % 2 != 0 ? speed : -speed);
    y.theta = random_iq24(seed, 0.0, 1.0);
    y.u_dc = random_iq24(seed, 0.5, 1.5);
    y.u_slope = random_iq24(seed, -0.07, 0.07);
    y.i = drawn_ab(seed, 1.5);
    y.i_ref.d = random_iq24(seed, -1.5, 1.5);
    y.i_ref.q = random_iq24(seed, -1.5, 1.5);
    return y;
}

/* A control with any estimate and any commanded duties; the mean of the link is the link. */
static iqfoc_pattern_control_t drawn_control(uint64_t *seed, const cycle *y)
{
    iqfoc_pattern_control_t c = control_of(&y->config, 0.0);
    c.predicted = true;
    c.i_next = drawn_ab(seed, 1.5);
    c.v.d = random_iq24(seed, -0.1, 0.1);
    c.v.q = random_iq24(seed, -0.1, 0.1);
    c.high.a = random_iq24(seed, 0.0, 1.0);
    c.high.b = random_iq24(seed, 0.0, 1.0);
    c.high.c = random_iq24(seed, 0.0, 1.0);
    c.u_dc = c.u_mean = y->u_dc;
    c.u_slope = y->u_slope;
    c.u_dc_inverse = iq24_div(IQ24_ONE, y->u_dc);
    return c;
}

/* Compares the edges of a leg; false if one is too near to the cycle's end, or to another one, to say which is first. */
static bool edges_compared(const pattern *p, double x, double speed, double error,
                           const iqfoc_pattern_edges_t *got, worst *time)
{
    double at[IQFOC_PATTERN_EDGES_MAX + 1];
    double distance[EDGES];
    const double unsure = 3.0 / 16777216.0;
    const int all = distances(p, x, 1.0, distance);
    if (distance[0] < unsure || distance[all - 1] > 1.0 - unsure) {
        return false;
    }
    const int count = moved_edges(p, x, speed, error, at);
    at[count] = 1.0;
    for (int k = 0; k <= count; k++) {
        if (at[k] - (k > 0 ? at[k - 1] : 0.0) < 1e-4) {
            return false;
        }
    }
    double near[IQFOC_PATTERN_EDGES_MAX + 1];
    if (moved_edges(p, x, speed, error + 2e-5, near) != count ||
        moved_edges(p, x, speed, error - 2e-5, near) != count) {
        return false;
    }
    TEST_ASSERT_EQUAL_INT32(count, got->edges);
    for (int k = 0; k < count; k++) {
        time->lsb = fmax(time->lsb, speed * fabs(got->instant[k] - 16777216.0 * at[k]));
    }
    return true;
}

static void test_cycle_is_that_of_the_formulas(void)
{
    uint64_t seed = SEED;
    worst current = {"estimated current over 1 + k_u", 0.0};
    worst flux = {"flux error times the movement in turns", 0.0};
    worst time = {"time of an edge times the movement in turns", 0.0};
    int legs = 0;
    int edges = 0;
    for (int n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        if (n % 100 == 0) {
            smooth_table(&seed);
        }
        const cycle y = drawn_cycle(&seed);
        iqfoc_pattern_control_t c = drawn_control(&seed, &y);
        const double theta = TWO_PI * to_double(y.theta);
        const double complex legs_u = to_double(c.high.a) + to_double(c.high.b) * cexp(I * TWO_PI / 3.0) +
                                      to_double(c.high.c) * cexp(-I * TWO_PI / 3.0);
        const double complex i =
            of_ab(c.i_next) + to_double(y.config.correction) * (of_ab(y.i) - of_ab(c.i_next));
        const double complex i_next =
            predicted(&y, i, 2.0 / 3.0 * to_double(y.u_dc) * legs_u, of_dq(c.v), theta);
        double complex drop;
        const double complex u = reference_voltage(&y, &c, &drop);
        pattern p;
        double x[3];
        iqfoc_pattern_edges_t got[3];
        places(&y, u, x);
        const double index = cabs(u) * TWO_PI / 4.0 / to_double(y.u_dc);
        const bool in_table = index > 0.3 && index < 0.99 && pattern_at(index, &p);
        if (fmax(fabs(creal(i_next)), fabs(cimag(i_next))) > 7.9 || !in_table) {
            continue;
        }
        for (int leg = 0; leg < 3; leg++) {
            c.modulator.leg[leg].level = level_at(&p, x[leg] + 1e-9);
        }
        iqfoc_pattern_control_aim(&c, y.i_ref, y.speed);
        iqfoc_pattern_control_step(&c, y.i, y.theta, y.u_dc, got);
        const double k_u = ldexp(y.config.winding.k_u_q26, -26);
        current.lsb = fmax(current.lsb, 16777216.0 * cabs(i_next - of_ab(c.i_next)) / (1.0 + k_u));
        const double complex e = flux_error(&y, &p, x, u, drop, i_next);
        if (fmax(fabs(creal(e)), fabs(cimag(e))) > 15.9) {
            continue;
        }
        const double speed = fabs(to_double(y.speed));
        flux.lsb = fmax(flux.lsb, 16777216.0 * cabs(speed * e - of_ab(c.error)));
        for (int leg = 0; leg < 3; leg++) {
            const double error = creal(e * cexp(-I * TWO_PI / 3.0 * leg));
            if (edges_compared(&p, x[leg], speed, error, &got[leg], &time)) {
                legs++;
                edges += got[leg].edges;
            }
        }
    }
    printf("%s: %.2f LSB; %s: %.2f LSB; %s: %.2f LSB, of %d legs and %d edges\n", current.what, current.lsb,
           flux.what, flux.lsb, time.what, time.lsb, legs, edges);
    TEST_ASSERT_TRUE(legs > DRAWS / IQFOC_TEST_STRIDE / 4 && edges > legs / 8);
    TEST_ASSERT_TRUE(current.lsb <= 4.0);
    TEST_ASSERT_TRUE(flux.lsb <= 10.0);
    TEST_ASSERT_TRUE(time.lsb <= 10.0);
}

/*
 * The share `correction` of a prediction error moves the estimate. The share `disturbance` adds to v in the rotor frame, without the part
 * that follows from the error before.
 */
static void test_prediction_error_is_learnt(void)
{
    uint64_t seed = SEED;
    smooth_table(&seed);
    iqfoc_pattern_control_t c = control_of(&drive, 0.05);
    const iqfoc_dq_t i_ref = {0, IQ24(0.5)};
    iqfoc_pattern_edges_t edges[3];
    iqfoc_ab_t i = {0, IQ24(0.5)};
    const iq24_t speed = IQ24(0.025);
    iqfoc_pattern_control_aim(&c, i_ref, speed);
    iqfoc_pattern_control_step(&c, i, 0, IQ24_ONE, edges);
    TEST_ASSERT_TRUE(c.predicted && c.miss.alpha == 0 && c.miss.beta == 0);
    const iqfoc_pattern_control_t before = c;
    i.alpha = before.i_next.alpha + IQ24(0.1);
    i.beta = before.i_next.beta - IQ24(0.2);
    iqfoc_pattern_control_aim(&c, i_ref, speed);
    TEST_ASSERT_EQUAL_INT32(0, c.v.d);
    iqfoc_pattern_control_step(&c, i, speed, IQ24_ONE, edges);
    iqfoc_pattern_control_t same = before;
    iqfoc_pattern_control_aim(&same, i_ref, speed);
    iqfoc_pattern_control_step(&same, before.i_next, speed, IQ24_ONE, edges);
    const double stays = exp(-0.75e-4 / 5.2e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.01 * stays, to_double(c.i_next.alpha - same.i_next.alpha));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.02 * stays, to_double(c.i_next.beta - same.i_next.beta));
    iqfoc_pattern_control_aim(&c, i_ref, speed);
    const double l = 5.2e-3 * 14.849 / (1e-4 * 565.0);
    double complex v = 0.01 * l * (0.1 - I * 0.2) * cexp(-I * TWO_PI * 0.025);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, cabs(v - of_dq(c.v)));
    for (int n = 2; n < 4; n++) {
        const double more = n == 2 ? 0.0 : 0.05;
        i.alpha = c.i_next.alpha + to_iq24(0.9 * stays * to_double(c.miss.alpha) + more);
        i.beta = c.i_next.beta + to_iq24(0.9 * stays * to_double(c.miss.beta));
        iqfoc_pattern_control_step(&c, i, n * speed, IQ24_ONE, edges);
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        v += 0.01 * l * more * cexp(-I * TWO_PI * 0.025 * n);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, cabs(v - of_dq(c.v)));
    }
    for (int n = 0; n < 1000; n++) {
        i.alpha = i.beta = IQ24(8.0);
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        iqfoc_pattern_control_step(&c, i, n * speed, IQ24_ONE, edges);
        TEST_ASSERT_TRUE(iq24_within(c.v.d, IQ24(-0.5), IQ24(0.5)) &&
                         iq24_within(c.v.q, IQ24(-0.5), IQ24(0.5)));
        TEST_ASSERT_TRUE(iq24_within(c.i_next.alpha, IQ24(-8.0), IQ24(8.0)));
    }
}

/* What the edge of leg a within a cycle without other edges moves by, over the flux error on its axis: 0 if there is no such edge. */
static double moved_over_error(const iqfoc_pattern_control_t *c, iq24_t theta)
{
    iqfoc_pattern_control_t state[2] = {*c, *c};
    iqfoc_pattern_edges_t edges[2][3];
    state[1].i_next.alpha += IQ24(0.05);
    for (int n = 0; n < 2; n++) {
        iqfoc_pattern_control_step(&state[n], state[n].i_next, theta, IQ24_ONE, edges[n]);
        const bool alone = edges[n][0].edges == 1 && edges[n][1].edges == 0 && edges[n][2].edges == 0;
        if (!alone || !iq24_within(edges[n][0].instant[0], IQ24(0.1), IQ24(0.9))) {
            return 0.0;
        }
    }
    const double error = to_double(state[1].error.alpha) - to_double(state[0].error.alpha);
    const double moved = to_double(edges[1][0].instant[0]) - to_double(edges[0][0].instant[0]);
    return edges[0][0].level * moved * to_double(c->trajectory.speed_abs) / error;
}

/* With long levels, the other two legs correct nothing of the error on a leg's axis: its edge corrects 3/2 of it. */
static void test_edges_of_long_levels(void)
{
    static const iqfoc_pattern_control_config_t config = {
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.01)};
    const iqfoc_dq_t i_ref = {0, IQ24_ONE};
    uint64_t seed = SEED;
    smooth_table(&seed);
    for (int n = 0; n < 4; n++) {
        const bool is_long = n / 2 == 0;
        const iq24_t speed = n % 2 == 0 ? IQ24(0.03) : IQ24(-0.03);
        table.angles = 1;
        for (int k = 0; k < table.rows; k++) {
            rows[k].angle[0] = is_long ? IQ24(0.12) : IQ24(0.13);
        }
        iqfoc_pattern_control_t c = control_of(&config, 0.0);
        int edges = 0;
        for (iq24_t theta = 0; theta < IQ24_ONE; theta += IQ24(0.002)) {
            for (int k = 0; k < 2; k++) { /* the second call knows the angles */
                iqfoc_pattern_control_aim(&c, i_ref, speed);
            }
            c.predicted = true;
            c.i_next = iqfoc_park_inverse(i_ref, iq24_sincos(theta));
            iqfoc_pattern_edges_t now[3];
            iqfoc_pattern_control_t settled = c;
            iqfoc_pattern_control_step(&settled, settled.i_next, theta - speed, IQ24_ONE, now);
            settled.i_next = c.i_next;
            const double share = moved_over_error(&settled, theta);
            if (share != 0.0) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-4, is_long ? 1.5 : 1.0, share);
                edges++;
            }
        }
        TEST_ASSERT_TRUE(edges > 4);
    }
}

/*
 * With long levels, as in six-step, the flux of the link's deviation is (2/pi) r/omega on the d axis: of the link five cycles and tan(delta) of
 * a radian after its last sample. sin(delta) in place of tan(delta), pi/2 times u_d.
 */
static void test_link_with_long_levels(void)
{
    uint64_t seed = SEED;
    for (int n = 0; n < 1000; n++) {
        smooth_table(&seed);
        table.angles = 1 + n % 2;
        for (int k = 0; k < table.rows; k++) {
            rows[k].angle[0] = IQ24(0.02);
            rows[k].angle[1] = n % 4 < 2 ? IQ24(0.12) : IQ24(0.13);
        }
        const bool is_long = table.angles == 1 || n % 4 < 2;
        const cycle y = drawn_cycle(&seed);
        iqfoc_pattern_control_t c = drawn_control(&seed, &y);
        double complex drop;
        const double complex u = reference_voltage(&y, &c, &drop);
        c.u_slope = 0;
        iqfoc_pattern_control_aim(&c, y.i_ref, y.speed);
        iqfoc_pattern_control_t constant = c;
        c.u_slope = y.u_slope / 64;
        iqfoc_pattern_control_t changing = c;
        constant.carried = changing.carried = constant.miss;
        iqfoc_pattern_control_aim(&constant, y.i_ref, y.speed);
        iqfoc_pattern_control_aim(&changing, y.i_ref, y.speed);
        const double speed = fabs(to_double(y.speed));
        const double cycles = 5.0 - fmax(fmin(creal(u), 1.0), -1.0) / (4.0 * speed);
        const double off = fmax(fmin(cycles * to_double(c.u_slope), 0.125), -0.125);
        const double got_d = ldexp(changing.trajectory.steady_q28.d - constant.trajectory.steady_q28.d, -28);
        const double got_q = ldexp(changing.trajectory.steady_q28.q - constant.trajectory.steady_q28.q, -28);
        if (is_long) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, 4.0 / (TWO_PI * TWO_PI) * off / to_double(c.u_mean), got_d);
            TEST_ASSERT_EQUAL_DOUBLE(0.0, got_q);
        } else {
            TEST_ASSERT_TRUE(got_q != 0.0 || c.u_slope == 0);
        }
    }
}

/* The mean of the link moves by 1/64 of the difference per cycle, and its inverse follows. */
static void test_mean_of_the_link(void)
{
    uint64_t seed = SEED;
    smooth_table(&seed);
    iqfoc_pattern_control_t c = control_of(&drive, 0.05);
    const iqfoc_dq_t i_ref = {0, IQ24(0.5)};
    const iqfoc_ab_t i = {0, 0};
    iqfoc_pattern_edges_t edges[3];
    double mean = 0.5;
    iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.025));
    iqfoc_pattern_control_step(&c, i, 0, IQ24(0.5), edges);
    for (int n = 0; n < 2000; n++) {
        const double u_dc = n < 1000 ? 1.5 : 0.5;
        iqfoc_pattern_control_step(&c, i, 0, to_iq24(u_dc), edges);
        iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.025));
        mean += (u_dc - mean) / 64.0;
        TEST_ASSERT_DOUBLE_WITHIN(4e-6, mean, to_double(c.u_mean));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 / mean, 1.0 / mean, to_double(c.u_dc_inverse));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0, to_double(c.u_dc_inverse));
}

/*
 * Rows that are not joined: between them, the angles are on the line through the row and its joined neighbour, if they are in order two
 * rows beyond; otherwise they are the row's.
 */
static void test_angles_go_on_beyond_a_row(void)
{
    uint64_t seed = SEED;
    const iqfoc_dq_t none = {0, 0};
    const double psi = 0.134 / (565.0 * 1e-4);
    int on_the_line = 0;
    int draws = 0;
    for (int n = 0; n < 2000; n++) {
        smooth_table(&seed);
        const int k = 20 + (int)(random_bits(&seed) % 30);
        const double part = uniform(&seed, 0.02, 0.98);
        const iq24_t speed = to_iq24(0.8 * (0.3 + 0.01 * (k + part)) * 4.0 / (TWO_PI * TWO_PI * psi));
        rows[k].joined = 0;
        iqfoc_pattern_control_t c = control_of(&drive, 0.05);
        iqfoc_pattern_control_restart(&c, &table, IQ24(0.8));
        iqfoc_pattern_control_aim(&c, none, speed);
        if (fabs(part - 0.75) < 0.01) {
            continue;
        }
        const int row = part > 0.75 ? k + 1 : k;
        const int other = part > 0.75 ? k + 2 : k - 1;
        const double beyond = part > 0.75 ? 1.0 - part : part;
        bool in_order = true;
        iq24_t lowest = 0;
        for (int a = 0; a < table.angles; a++) {
            const iq24_t end = 3 * rows[row].angle[a] - 2 * rows[other].angle[a];
            in_order = in_order && end >= lowest && end <= IQ24(0.25);
            lowest = end;
        }
        TEST_ASSERT_EQUAL_INT32(row, c.modulator.row);
        for (int a = 0; a < table.angles; a++) {
            const double of_row = to_double(rows[row].angle[a]);
            const double line = of_row + beyond * (of_row - to_double(rows[other].angle[a]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, in_order ? line : of_row, to_double(c.trajectory.angle[1 + a]));
            TEST_ASSERT_TRUE(iq24_within(c.trajectory.angle[1 + a], c.trajectory.angle[a], IQ24(0.25)));
        }
        on_the_line += in_order ? 1 : 0;
        draws++;
    }
    TEST_ASSERT_TRUE(on_the_line > draws / 4 && draws - on_the_line > draws / 20);
}

/*
 * Angle, speed, reference, current, link and table jump: no time between two edges is below the least one, the levels are continuous,
 * and what is stated as held is held.
 */
static void test_no_time_is_below_the_least(void)
{
    uint64_t seed = SEED;
    static iqfoc_pattern_row_t other_rows[ROWS];
    iqfoc_pattern_t other = table;
    smooth_table(&seed);
    memcpy(other_rows, rows, sizeof rows);
    other = table;
    other.row = other_rows;
    drawn_table(&seed);
    edges_so_far so_far = no_edges_yet;
    const iq24_t least = IQ24(0.06);
    iqfoc_pattern_control_t c = control_of(&drive, 0.06);
    iqfoc_dq_t i_ref = {0, IQ24_ONE};
    iqfoc_ab_t i = {0, 0};
    iq24_t theta = 0;
    iq24_t speed = IQ24(0.03);
    iq24_t u_dc = IQ24_ONE;
    double far = 0.1;
    for (long n = 0; n < cycles_drawn; n++) {
        const uint64_t event = random_bits(&seed) % 64;
        if (event == 0) {
            speed = random_iq24(&seed, -0.2, 0.2);
        } else if (event == 1) {
            theta = random_iq24(&seed, -2.0, 2.0);
        } else if (event == 2) {
            i_ref.d = random_iq24(&seed, -8.0, 8.0);
            i_ref.q = random_iq24(&seed, -8.0, 8.0);
        } else if (event == 3) {
            u_dc = random_iq24(&seed, 0.5, 1.5);
        } else if (event == 4) {
            iqfoc_pattern_control_change(&c, c.modulator.table == &table ? &other : &table);
        } else if (event == 5) {
            far = exp(uniform(&seed, log(1e-3), log(8.0)));
        }
        i.alpha = iq24_clamp(c.i_next.alpha + random_iq24(&seed, -far, far), IQ24(-8.0), IQ24(8.0));
        i.beta = iq24_clamp(c.i_next.beta + random_iq24(&seed, -far, far), IQ24(-8.0), IQ24(8.0));
        iqfoc_pattern_edges_t got[3];
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        iqfoc_pattern_control_step(&c, i, theta, u_dc, got);
        theta = iq24_add_wrap(theta, speed);
        check_edges(got, n, &so_far);
        TEST_ASSERT_TRUE(iq24_within(c.error.alpha, IQ24(-4.0), IQ24(4.0)));
        TEST_ASSERT_TRUE(iq24_within(c.error.beta, IQ24(-4.0), IQ24(4.0)));
    }
    printf("shortest time: %.0f LSB above the least, in %ld cycles and %.0f edges\n",
           (double)(so_far.shortest - least), cycles_drawn, (double)so_far.edges);
    TEST_ASSERT_TRUE(so_far.shortest >= least);
    TEST_ASSERT_TRUE(so_far.edges > cycles_drawn / 4);
}

/* ---- Set-up ---- */

static void refused(const iqfoc_pattern_control_config_t *config, iqfoc_error_t error)
{
    iqfoc_pattern_control_t c = {.u_dc = 7};
    TEST_ASSERT_EQUAL_INT(error, iqfoc_pattern_control_init(&c, config, &table, 0));
    TEST_ASSERT_EQUAL_INT32(7, c.u_dc);
}

#define REFUSED(field, bad, good, error)                                                                     \
    do {                                                                                                     \
        iqfoc_pattern_control_config_t config_ = drive;                                                      \
        config_.field = (bad);                                                                               \
        refused(&config_, error);                                                                            \
        config_.field = (good);                                                                              \
        (void)control_of(&config_, 0.0);                                                                     \
    } while (0)

/* rho pi/6 of the correction's delay, at rho = 1: the constant to the last bit. */
static void test_delay_of_the_correction(void)
{
    iqfoc_pattern_control_config_t config = drive;
    three_pulses(1);
    config.winding.rho_q30 = INT32_C(1) << 30;
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(TWO_PI / 12.0, 31)), control_of(&config, 0.0).later_q31);
}

static void test_bad_configurations_are_refused(void)
{
    iqfoc_pattern_control_t c;
    three_pulses(1);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pattern_control_init(NULL, &drive, &table, 0));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pattern_control_init(&c, NULL, &table, 0));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pattern_control_init(&c, &drive, NULL, 0));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PATTERN, iqfoc_pattern_control_init(&c, &drive, &table, -1));
    const int32_t q30 = INT32_C(1) << 30;
    REFUSED(winding.rho_q30, -1, 0, IQFOC_ERROR_PREDICTOR);
    REFUSED(winding.rho_q30, q30 + 1, q30, IQFOC_ERROR_PREDICTOR);
    REFUSED(winding.k_u_q26, q30 / 128 - 1, q30 / 128, IQFOC_ERROR_PREDICTOR);
    REFUSED(winding.k_u_q26, q30 + 1, q30, IQFOC_ERROR_PREDICTOR);
    REFUSED(winding.k_psi_q27, -1, 0, IQFOC_ERROR_PREDICTOR);
    REFUSED(winding.k_psi_q27, q30 + 1, INT32_C(1) << 27, IQFOC_ERROR_PREDICTOR);
    REFUSED(correction, -1, 0, IQFOC_ERROR_GAINS);
    REFUSED(correction, IQ24_ONE + 1, IQ24_ONE, IQFOC_ERROR_GAINS);
    REFUSED(disturbance, -1, 0, IQFOC_ERROR_GAINS);
    REFUSED(disturbance, IQ24(0.25) + 1, IQ24(0.25), IQFOC_ERROR_GAINS);
    iqfoc_pattern_control_config_t config = drive;
    config.winding.k_u_q26 = q30 / 128; /* l = 8 */
    config.winding.k_psi_q27 = q30 / 4; /* 2 */
    (void)control_of(&config, 0.0);
    config.winding.k_psi_q27 += 1;
    refused(&config, IQFOC_ERROR_PREDICTOR); /* psi above 16 */
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        cycles_drawn = strtol(argv[1], NULL, 10);
        if (cycles_drawn < 100 || cycles_drawn > 1000000000) {
            fprintf(stderr, "%s: the number of cycles must be 100 ... 1000000000\n", argv[0]);
            return 2;
        }
    }
    UNITY_BEGIN();
    RUN_TEST(test_cycle_is_that_of_the_formulas);
    RUN_TEST(test_prediction_error_is_learnt);
    RUN_TEST(test_mean_of_the_link);
    RUN_TEST(test_edges_of_long_levels);
    RUN_TEST(test_link_with_long_levels);
    RUN_TEST(test_angles_go_on_beyond_a_row);
    RUN_TEST(test_no_time_is_below_the_least);
    RUN_TEST(test_delay_of_the_correction);
    RUN_TEST(test_bad_configurations_are_refused);
    return UNITY_END();
}
