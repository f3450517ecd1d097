/*
 * Observer without a sensor (include/iqfoc/observer.h): one step and the start against the header's lines in double,
 * the decay of a flux error at all speeds, lock and the reasons for which it is lost.
 */
#include "iqfoc/observer.h"
#include "reference_vectors.h"

#include <complex.h>
#include <stddef.h>

enum { DRAWS = 400000 / IQFOC_TEST_STRIDE };

static const double unit = 4294967296.0; /* of Q32 */

void setUp(void)
{
}

void tearDown(void)
{
}

static const iqfoc_observer_config_t usual =
    IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 3e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.005));

static iqfoc_flux_predictor_t machine_of(double r, double l_d, double l_q, double psi)
{
    const iqfoc_flux_predictor_t m = {.l_d = to_iq24(l_d),
                                      .l_q = to_iq24(l_q),
                                      .k_d = to_iq24(1.0 / l_d),
                                      .k_q = to_iq24(1.0 / l_q),
                                      .r = to_iq24(r),
                                      .psi = to_iq24(psi)};
    return m;
}

static double round_trip(double turns)
{
    return remainder(turns, 1.0);
}

static iqfoc_ab_t ab_of(double complex x)
{
    const iqfoc_ab_t ab = {to_iq24(creal(x)), to_iq24(cimag(x))};
    return ab;
}

static double complex disc(uint64_t *seed, double radius)
{
    const double length = radius * sqrt(uniform(seed, 0.0, 1.0));
    return length * cexp(I * TWO_PI * uniform(seed, 0.0, 1.0));
}

/* The factor of both inductances at a current. */
static double fall_of(const iqfoc_observer_config_t *c, double complex i)
{
    return 1.0 / (1.0 + fmin(1.0, to_double(c->saturation) * creal(i * conj(i))));
}

static iqfoc_observer_config_t random_config(uint64_t *seed)
{
    iqfoc_observer_config_t c = usual;
    const double r = uniform(seed, 0.0, 0.2);
    const double l_d = uniform(seed, 0.13, 3.0);
    const double l_q = l_d * uniform(seed, 0.5, 2.0);
    c.machine = machine_of(r, l_d, l_q, uniform(seed, 0.3, 8.0));
    c.saturation = uniform(seed, 0.0, 1.0) < 0.5 ? 0 : random_iq24(seed, 0.0, 0.5);
    c.gain_max = random_iq24(seed, 0.125, 1.0);
    c.k1 = random_iq24(seed, 0.01, 1.0);
    c.k2 = random_iq24(seed, 0.01, 0.25);
    c.lost_cycles = UINT32_MAX;
    c.slow_cycles = UINT32_MAX;
    return c;
}

/* The same, over a share. */
static void worst_over(worst *w, iq24_t got, double want, double share)
{
    w->lsb = fmax(w->lsb, fabs((double)got - want * 16777216.0) / share);
}

static void test_step_follows_its_lines(void)
{
    uint64_t seed = 1;
    worst psi_off = {"psi", 0.0};
    worst flux_off = {"off", 0.0};
    double theta_off[2] = {0.0, 0.0}; /* seeking, locked */
    double turns_off[2] = {0.0, 0.0};
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_observer_config_t c = random_config(&seed);
        const iqfoc_flux_predictor_t *m = &c.machine;
        const bool locked = n % 2 == 0;
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &c));
        o.psi = ab_of(disc(&seed, 10.0));
        o.theta_q32 = (int32_t)(unit * uniform(&seed, -0.5, 0.5));
        o.speed_q32 = (int32_t)(unit * uniform(&seed, -0.33, 0.33));
        o.locked = locked;
        o.begins = false;
        const iqfoc_ab_t u_in = ab_of(disc(&seed, 0.6));
        const iqfoc_ab_t mean_in = ab_of(disc(&seed, 1.5));
        const iqfoc_ab_t i_in = ab_of(disc(&seed, 1.5));

        const double complex i = complex_of_ab(i_in);
        const double l_q = to_double(m->l_q) * fall_of(&c, i);
        const double more = to_double(m->l_d - m->l_q) * fall_of(&c, i);
        const double complex psi =
            complex_of_ab(o.psi) + complex_of_ab(u_in) - to_double(m->r) * complex_of_ab(mean_in);
        const double complex a = psi - l_q * i;
        if (cabs(a) < 0.25) {
            continue;
        }
        const double speed = o.speed_q32 / unit;
        const double theta = o.theta_q32 / unit + speed;
        const double complex d =
            locked ? cexp(I * TWO_PI * floor(theta * 16777216.0) / 16777216.0) : a / cabs(a);
        const double radius = to_double(m->psi) + more * creal(i * conj(d));
        const double off = fmax(-8.0, fmin(8.0, radius - creal(a * conj(d))));
        const double phi = TWO_PI * fabs(speed);
        const double gain = fmin(to_double(c.gain_max), locked ? 0.4 * phi : fmax(phi, 0.125));
        const double complex want = psi + gain * off * d;
        const double divisor = fmax(radius, 1.0 / 64.0);
        const double sine = fmax(-1.5, fmin(1.5, cimag(a * conj(d)) / divisor));
        const double e = locked ? sine / TWO_PI : round_trip(carg(a) / TWO_PI - theta);
        const double k1 = locked ? to_double(c.k1) : 0.75;
        const double k2 = locked ? to_double(c.k2) : 0.25;
        if (0.5 - fabs(e) < 1e-6 || fabs(speed + k2 * e) > 0.333) {
            continue; /* a tie, and the limit of the speed */
        }
        iqfoc_observer_step(&o, u_in, mean_in, i_in);
        const double share = 1.0 + cabs(a) + 4.0 * fabs(off) + l_q + fabs(more);
        worst_over(&psi_off, o.psi.alpha, creal(want), share);
        worst_over(&psi_off, o.psi.beta, cimag(want), share);
        worst_over(&flux_off, o.flux_error, off,
                   1.0 + cabs(a) + l_q + 4.0 * fabs(more) * (1.0 + 1.0 / cabs(a)));
        /* The quotient of the locked loop is within 0.4 %. */
        const double angle_lsb =
            locked ? 1.0 + 1.0 / divisor + 0.004 * fabs(e) * 16777216.0 : 1.0 + 1.0 / cabs(a);
        const double theta_lsb =
            fabs(round_trip(o.theta_q32 / unit - theta - k1 * e)) * 16777216.0 / angle_lsb;
        const double turns_lsb = fabs(o.speed_q32 / unit - speed - k2 * e) * 16777216.0 / angle_lsb;
        theta_off[locked] = fmax(theta_off[locked], theta_lsb);
        turns_off[locked] = fmax(turns_off[locked], turns_lsb);
    }
    printf("  theta %.3f, locked %.3f; turns %.3f, locked %.3f\n", theta_off[0], theta_off[1], turns_off[0],
           turns_off[1]);
    worst_check(&psi_off, 2.5);
    worst_check(&flux_off, 1.8);
    TEST_ASSERT_TRUE(theta_off[0] <= 0.7 && theta_off[0] >= 0.35);
    TEST_ASSERT_TRUE(turns_off[0] <= 0.2 && turns_off[0] >= 0.1);
    TEST_ASSERT_TRUE(theta_off[1] <= 0.6 && theta_off[1] >= 0.3);
    TEST_ASSERT_TRUE(turns_off[1] <= 0.1 && turns_off[1] >= 0.05);
}

static void test_start_is_the_machine_s_flux(void)
{
    uint64_t seed = 2;
    worst psi_off = {"psi at the start", 0.0};
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_observer_config_t c = random_config(&seed);
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &c));
        const iqfoc_ab_t i_in = ab_of(disc(&seed, 1.5));
        const iq24_t theta = random_iq24(&seed, -3.0, 3.0);
        const iq24_t speed = random_iq24(&seed, -1.0, 1.0);
        o.status = 7;
        iqfoc_observer_start(&o, i_in, theta, speed, true);
        TEST_ASSERT_TRUE(o.locked && !o.begins);
        TEST_ASSERT_EQUAL_UINT32(0, o.status);
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX),
                                iqfoc_observer_speed(&o));
        TEST_ASSERT_TRUE(fabs(round_trip(o.theta_q32 / unit - to_double(theta))) < 1e-9);
        const double complex turn = cexp(I * TWO_PI * to_double(theta));
        const double complex i = complex_of_ab(i_in) * conj(turn);
        const double l_d = to_double(c.machine.l_d) * fall_of(&c, i);
        const double l_q = to_double(c.machine.l_q) * fall_of(&c, i);
        const double complex flux = to_double(c.machine.psi) + l_d * creal(i) + I * l_q * cimag(i);
        const double complex want = turn * flux;
        const double share = 1.0 + cabs(flux) + l_q + fabs(l_d - l_q);
        worst_over(&psi_off, o.psi.alpha, creal(want), share);
        worst_over(&psi_off, o.psi.beta, cimag(want), share);
    }
    worst_check(&psi_off, 1.8);
}

/* The first step of a seeking observer: from any angle, with the speed's sign, to the flux at the angle that the chord shows. */
static void test_first_step_takes_the_angle_from_the_chord(void)
{
    uint64_t seed = 4;
    worst psi_off = {"psi after the first step", 0.0};
    worst theta_off = {"theta after the first step", 0.0};
    double most = 0.0;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_observer_config_t c = random_config(&seed);
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &c));
        TEST_ASSERT_TRUE(o.begins);
        const double speed = uniform(&seed, 0.05, 0.32) * (n % 2 == 0 ? 1.0 : -1.0);
        const double share = uniform(&seed, 0.5, fmin(1.5, 0.33 / fabs(speed)));
        const double theta = uniform(&seed, 0.0, 1.0);
        const iqfoc_ab_t before = ab_of(disc(&seed, 1.5));
        const iqfoc_ab_t after = ab_of(disc(&seed, 1.5));
        const iqfoc_ab_t mean = ab_of(disc(&seed, 1.5));
        const double l_before = to_double(c.machine.l_q) * fall_of(&c, complex_of_ab(before));
        const double l_after = to_double(c.machine.l_q) * fall_of(&c, complex_of_ab(after));
        /* Of the magnet alone, so that the chord is that of its circle. */
        const double complex chord =
            to_double(c.machine.psi) * cexp(I * TWO_PI * theta) * (1.0 - cexp(-I * TWO_PI * speed));
        const double complex u = chord + l_after * complex_of_ab(after) - l_before * complex_of_ab(before) +
                                 to_double(c.machine.r) * complex_of_ab(mean);
        if (fabs(creal(u)) > 8.0 || fabs(cimag(u)) > 8.0) {
            continue;
        }
        iqfoc_observer_start(&o, before, random_iq24(&seed, -3.0, 3.0), to_iq24(share * speed), false);
        TEST_ASSERT_TRUE(!o.locked && o.begins);
        iqfoc_observer_step(&o, ab_of(u), mean, after);
        TEST_ASSERT_TRUE(!o.locked && !o.begins && o.count == 0);
        const double want = theta + 0.5 * (share - 1.0) * speed;
        const double off = round_trip(o.theta_q32 / unit - want);
        const double length = cabs(chord);
        worst_over(&theta_off, (iq24_t)lround(off * 16777216.0), 0.0,
                   1.0 + (1.0 + to_double(c.machine.l_q)) / length);
        most = fmax(most, fabs(off));
        const double complex d = cexp(I * TWO_PI * o.theta_q32 / unit);
        const double complex i = complex_of_ab(after);
        const double radius = to_double(c.machine.psi) +
                              to_double(c.machine.l_d - c.machine.l_q) * fall_of(&c, i) * creal(i * conj(d));
        const double complex flux = l_after * i + radius * d;
        const double sum =
            1.0 + cabs(flux) + l_after + fabs(to_double(c.machine.l_d - c.machine.l_q)) * fall_of(&c, i);
        worst_over(&psi_off, o.psi.alpha, creal(flux), sum);
        worst_over(&psi_off, o.psi.beta, cimag(flux), sum);
    }
    printf("  angle at most %.2g turns off\n", most);
    worst_check(&theta_off, 1.0);
    worst_check(&psi_off, 1.8);
}

static void test_mean_by_simpson(void)
{
    uint64_t seed = 3;
    worst off = {"mean of three samples", 0.0};
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_ab_t start = {random_iq24(&seed, -15.9, 15.9), random_iq24(&seed, -15.9, 15.9)};
        const iqfoc_ab_t middle = {random_iq24(&seed, -15.9, 15.9), random_iq24(&seed, -15.9, 15.9)};
        const iqfoc_ab_t end = {random_iq24(&seed, -15.9, 15.9), random_iq24(&seed, -15.9, 15.9)};
        const iqfoc_ab_t got = iqfoc_observer_mean(start, middle, end);
        worst_add(&off, got.alpha,
                  (to_double(start.alpha) + 4.0 * to_double(middle.alpha) + to_double(end.alpha)) / 6.0);
        worst_add(&off, got.beta,
                  (to_double(start.beta) + 4.0 * to_double(middle.beta) + to_double(end.beta)) / 6.0);
    }
    worst_check(&off, 0.51);
    /* A current that turns by phi: the mean is sin(phi/2)/(phi/2), in the middle's direction. */
    for (int k = 1; k <= 20; k++) {
        const double phi = k * 0.1;
        const double simpson = (2.0 * cos(phi / 2.0) + 4.0) / 6.0;
        const double ends = cos(phi / 2.0);
        const double mean = sin(phi / 2.0) / (phi / 2.0);
        TEST_ASSERT_TRUE(fabs(simpson - mean) < pow(phi, 4) / 2880.0);
        TEST_ASSERT_TRUE(fabs(ends - mean) < phi * phi / 12.0);
    }
}

/* ---- Stability ---- */

/* Largest eigenvalue of Rot(-phi)(I - g d d^T), from trace and determinant. */
static double radius_at(double phi, double g)
{
    const double half_trace = 0.5 * (2.0 - g) * cos(phi);
    const double complex root = csqrt(half_trace * half_trace - (1.0 - g));
    return fmax(cabs(half_trace + root), cabs(half_trace - root));
}

static void test_flux_error_decays_at_all_speeds(void)
{
    const double most = to_double(usual.gain_max);
    for (int32_t speed = 16; speed <= IQFOC_ROTOR_SPEED_MAX; speed += speed / 64 + 1) {
        const double phi = TWO_PI * to_double(speed);
        const double radius = radius_at(phi, fmin(most, 0.4 * phi));
        TEST_ASSERT_TRUE(radius < 1.0);
        TEST_ASSERT_TRUE(phi > 0.05 || fabs(radius - (1.0 - phi / 5.0)) < phi * phi); /* 1/e in 5 rad */
    }
}

/* A machine without current that turns evenly, and a small error of the flux: it follows the linear map. */
static void test_flux_error_follows_the_linear_map(void)
{
    for (int k = -33; k <= 33; k++) {
        const double speed = k / 100.0;
        if (k == 0) {
            continue;
        }
        const double phi = TWO_PI * speed;
        const double psi = to_double(usual.machine.psi);
        const double g = fmin(to_double(usual.gain_max), 0.4 * fabs(phi));
        iqfoc_observer_config_t config = usual;
        config.k1 = 1; /* the speed, and so the gain, is to stay */
        config.k2 = 1;
        config.lost_cycles = UINT32_MAX;
        iqfoc_observer_t o;
        const iqfoc_ab_t none = {0, 0};
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &config));
        iqfoc_observer_start(&o, none, 0, to_iq24(speed), true);
        double complex x = 1e-3 * psi * (0.6 + 0.8 * I); /* in the rotor's frame, where d is 1 */
        o.psi = ab_of(psi + x);
        for (int cycle = 1; cycle <= 40; cycle++) {
            const double complex at_start = psi * cexp(I * phi * (cycle - 1));
            const double complex at_end = psi * cexp(I * phi * cycle);
            iqfoc_observer_step(&o, ab_of(at_end - at_start), none, none);
            x *= cexp(-I * phi);
            x -= g * creal(x);
            const double complex seen = (complex_of_ab(o.psi) - at_end) * cexp(-I * phi * cycle);
            TEST_ASSERT_TRUE(cabs(seen - x) < 2e-6 * psi);
        }
        TEST_ASSERT_TRUE(cabs(x) <= 2.0 * 1e-3 * psi * pow(radius_at(phi, g), 40));
    }
}

/* ---- Lock ---- */

/* One cycle of the turning machine without current; `jump` moves its angle first, `length` scales its flux. */
typedef struct turning {
    double theta;
    double complex flux;
} turning;

static void cycle_of(iqfoc_observer_t *o, turning *machine, double speed, double jump, double length)
{
    const iqfoc_ab_t none = {0, 0};
    machine->theta += speed + jump;
    const double complex flux =
        length * to_double(o->config->machine.psi) * cexp(I * TWO_PI * machine->theta);
    iqfoc_observer_step(o, ab_of(flux - machine->flux), none, none);
    machine->flux = flux;
}

static void begin(iqfoc_observer_t *o, turning *machine, const iqfoc_observer_config_t *config, double speed,
                  bool known)
{
    const iqfoc_ab_t none = {0, 0};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(o, config));
    TEST_ASSERT_FALSE(o->locked);
    iqfoc_observer_start(o, none, 0, to_iq24(speed), known);
    machine->theta = 0.0;
    machine->flux = to_double(config->machine.psi);
}

static void test_lock_after_the_stated_cycles(void)
{
    iqfoc_observer_t o;
    turning machine;
    begin(&o, &machine, &usual, 0.1, false);
    for (uint32_t k = 0; k <= usual.lock_cycles; k++) { /* one more, for the angle */
        TEST_ASSERT_FALSE(o.locked);
        cycle_of(&o, &machine, 0.1, 0.0, 1.0);
    }
    TEST_ASSERT_TRUE(o.locked);
    /* Not below speed_min, as standstill shows no angle. */
    begin(&o, &machine, &usual, 0.004, false);
    for (int k = 0; k < 100; k++) {
        cycle_of(&o, &machine, 0.004, 0.0, 1.0);
        TEST_ASSERT_FALSE(o.locked);
    }
    TEST_ASSERT_EQUAL_UINT32(0, o.status);
}

static void test_angle_and_speed_of_any_instant(void)
{
    iqfoc_observer_t o;
    turning machine;
    begin(&o, &machine, &usual, -0.2, true);
    for (int k = 0; k < 300; k++) {
        cycle_of(&o, &machine, -0.2, 0.0, 1.0);
        for (int n = -8; n <= 8; n++) {
            const double theta = to_double(iqfoc_observer_theta(&o, to_iq24(0.5 * n)));
            TEST_ASSERT_TRUE(theta >= -0.5 && theta < 0.5);
            TEST_ASSERT_TRUE(fabs(round_trip(theta - machine.theta + 0.1 * n)) < 2e-6);
            const double own = o.theta_q32 / unit + 0.5 * n * (o.speed_q32 / unit);
            TEST_ASSERT_TRUE(fabs(round_trip(theta - own)) * 16777216.0 <= 1.01);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.2, to_double(iqfoc_observer_speed(&o)));
    }
    TEST_ASSERT_TRUE(o.locked);
}

static void test_lost_by_the_angle(void)
{
    iqfoc_observer_config_t config = usual;
    config.lost_cycles = 3;
    config.angle_max = IQ24(0.01);
    config.flux_max = IQ24(7.9);
    iqfoc_observer_t o;
    turning machine;
    begin(&o, &machine, &config, 0.1, true);
    uint32_t far = 0;
    for (int k = 0; k < 40 && o.locked; k++) {
        cycle_of(&o, &machine, 0.1, k == 10 ? 0.3 : 0.0, 1.0);
        far = iq24_within(o.error, -config.angle_max, config.angle_max) ? 0 : far + 1;
        TEST_ASSERT_EQUAL_INT(far <= 3, o.locked);
    }
    TEST_ASSERT_FALSE(o.locked);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_OBSERVER_LOST_ANGLE, o.status);
    for (int k = 0; k < 200; k++) {
        cycle_of(&o, &machine, 0.1, 0.0, 1.0);
    }
    TEST_ASSERT_TRUE(o.locked); /* found again */
    TEST_ASSERT_TRUE(fabs(round_trip(o.theta_q32 / unit - machine.theta)) < 1e-4);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_OBSERVER_LOST_ANGLE, o.status); /* sticky */
}

static void test_lost_by_the_flux(void)
{
    iqfoc_observer_config_t config = usual;
    config.lost_cycles = 20;
    iqfoc_observer_t o;
    turning machine;
    begin(&o, &machine, &config, 0.02, true);
    for (int k = 0; k < 100; k++) {
        cycle_of(&o, &machine, 0.02, 0.0, 1.0);
    }
    TEST_ASSERT_TRUE(o.locked);
    for (int k = 0; k < 3000 && o.locked; k++) {
        cycle_of(&o, &machine, 0.02, 0.0, 1.0 - k / 4000.0); /* a magnet that is lost */
    }
    TEST_ASSERT_FALSE(o.locked);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_OBSERVER_LOST_FLUX, o.status);
}

static void test_lost_when_slow_for_long(void)
{
    iqfoc_observer_config_t config = usual;
    config.slow_cycles = 30;
    iqfoc_observer_t o;
    turning machine;
    begin(&o, &machine, &config, 0.004, true);
    for (uint32_t k = 1; k <= 30; k++) {
        cycle_of(&o, &machine, 0.004, 0.0, 1.0);
        TEST_ASSERT_TRUE(o.locked);
    }
    cycle_of(&o, &machine, 0.004, 0.0, 1.0);
    TEST_ASSERT_FALSE(o.locked);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_OBSERVER_LOST_SLOW, o.status);
    o.slow = UINT32_MAX;
    cycle_of(&o, &machine, 0.004, 0.0, 1.0);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, o.slow);
    /* A speed above speed_min in between starts the count again. */
    begin(&o, &machine, &config, 0.004, true);
    for (int k = 0; k < 100; k++) {
        cycle_of(&o, &machine, k % 25 == 24 ? 0.02 : 0.004, 0.0, 1.0);
        o.speed_q32 = (int32_t)(unit * (k % 25 == 23 ? 0.02 : 0.004));
    }
    TEST_ASSERT_TRUE(o.locked);
}

/* ---- Ranges ---- */

static void test_any_numbers_stay_in_range(void)
{
    uint64_t seed = 5;
    for (int round = 0; round < 300; round++) {
        iqfoc_observer_config_t c = random_config(&seed);
        c.machine = machine_of(1.0, round % 2 == 0 ? 8.0 : 4.0, round % 2 == 0 ? 4.0 : 8.0, 16.0);
        c.gain_max = IQ24_ONE;
        c.saturation = round % 3 == 0 ? IQ24(4.0) : 0;
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &c));
        const iq24_t theta = random_iq24(&seed, -100.0, 100.0);
        const iq24_t speed = random_iq24(&seed, -100.0, 100.0);
        iqfoc_observer_start(&o, ab_of(disc(&seed, 15.9)), theta, speed, round % 2 == 0);
        for (int k = 0; k < 1000; k++) {
            const iqfoc_ab_t u = ab_of(disc(&seed, 2.0));
            const iqfoc_ab_t mean = ab_of(disc(&seed, 15.9));
            iqfoc_observer_step(&o, u, mean, ab_of(disc(&seed, 15.9)));
            TEST_ASSERT_TRUE(fabs(to_double(o.psi.alpha)) <= 32.0 && fabs(to_double(o.psi.beta)) <= 32.0);
            TEST_ASSERT_TRUE(fabs(o.speed_q32 / unit) <= 1.0 / 3.0);
            TEST_ASSERT_TRUE(fabs(to_double(o.flux_error)) <= 8.0);
        }
    }
}

static void refused(iqfoc_observer_config_t config, iqfoc_error_t want)
{
    iqfoc_observer_t o = {.slow = 55};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_observer_check(&config));
    TEST_ASSERT_EQUAL_INT(want, iqfoc_observer_init(&o, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 55, o.slow);
}

#define WITH(field, value, want)                                                                             \
    do {                                                                                                     \
        iqfoc_observer_config_t config = usual;                                                              \
        config.field = (value);                                                                              \
        refused(config, want);                                                                               \
    } while (0)

static void test_limits(void)
{
    iqfoc_observer_t o;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_init(&o, NULL));
    refused(usual, IQFOC_OK);
    WITH(machine.r, -1, IQFOC_ERROR_RESISTANCE);
    WITH(machine.psi, IQ24(0.015625), IQFOC_OK);
    WITH(machine.psi, IQ24(0.015625) - 1, IQFOC_ERROR_OBSERVER);
    WITH(machine, machine_of(0.1, 4.0, 8.0, 1.0), IQFOC_OK);
    WITH(machine, machine_of(0.1, 8.0, 4.0, 1.0), IQFOC_OK);
    WITH(machine, machine_of(0.1, 8.0, 3.99, 1.0), IQFOC_ERROR_OBSERVER);
    WITH(machine, machine_of(0.1, 3.99, 8.0, 1.0), IQFOC_ERROR_OBSERVER);
    WITH(saturation, IQ24(4.0), IQFOC_OK);
    WITH(saturation, IQ24(4.0) + 1, IQFOC_ERROR_OBSERVER);
    WITH(saturation, -1, IQFOC_ERROR_OBSERVER);
    WITH(gain_max, IQ24(0.125), IQFOC_OK);
    WITH(gain_max, IQ24(0.125) - 1, IQFOC_ERROR_OBSERVER);
    WITH(gain_max, IQ24_ONE, IQFOC_OK);
    WITH(gain_max, IQ24_ONE + 1, IQFOC_ERROR_OBSERVER);
    WITH(k1, 1, IQFOC_OK);
    WITH(k1, 0, IQFOC_ERROR_OBSERVER);
    WITH(k1, IQ24_ONE + 1, IQFOC_ERROR_OBSERVER);
    WITH(k2, 1, IQFOC_OK);
    WITH(k2, 0, IQFOC_ERROR_OBSERVER);
    WITH(k2, IQ24(0.25), IQFOC_OK);
    WITH(k2, IQ24(0.25) + 1, IQFOC_ERROR_OBSERVER);
    WITH(speed_min, 0, IQFOC_OK);
    WITH(speed_min, -1, IQFOC_ERROR_OBSERVER);
    WITH(speed_min, IQFOC_ROTOR_SPEED_MAX, IQFOC_OK);
    WITH(speed_min, IQFOC_ROTOR_SPEED_MAX + 1, IQFOC_ERROR_OBSERVER);
    WITH(angle_max, 1, IQFOC_OK);
    WITH(angle_max, 0, IQFOC_ERROR_OBSERVER);
    WITH(angle_max, IQ24(0.5), IQFOC_OK);
    WITH(angle_max, IQ24(0.5) + 1, IQFOC_ERROR_OBSERVER);
    WITH(flux_max, 1, IQFOC_OK);
    WITH(flux_max, 0, IQFOC_ERROR_OBSERVER);
    WITH(flux_max, IQ24(8.0) - 1, IQFOC_OK);
    WITH(flux_max, IQ24(8.0), IQFOC_ERROR_OBSERVER);
    WITH(lock_cycles, 1, IQFOC_OK);
    WITH(lock_cycles, 0, IQFOC_ERROR_OBSERVER);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_step_follows_its_lines);
    RUN_TEST(test_start_is_the_machine_s_flux);
    RUN_TEST(test_first_step_takes_the_angle_from_the_chord);
    RUN_TEST(test_mean_by_simpson);
    RUN_TEST(test_flux_error_decays_at_all_speeds);
    RUN_TEST(test_flux_error_follows_the_linear_map);
    RUN_TEST(test_lock_after_the_stated_cycles);
    RUN_TEST(test_angle_and_speed_of_any_instant);
    RUN_TEST(test_lost_by_the_angle);
    RUN_TEST(test_lost_by_the_flux);
    RUN_TEST(test_lost_when_slow_for_long);
    RUN_TEST(test_any_numbers_stay_in_range);
    RUN_TEST(test_limits);
    return UNITY_END();
}
