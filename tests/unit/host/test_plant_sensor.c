/*
 * What the sensors make of the truth, each law of interfaces.md by itself, and the random numbers behind
 * them.
 */
#include "../laboratory_motor.h"
#include "plant/plant.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

#define SEED 20190612u

static plant_config drive(void)
{
    motor m = laboratory_motor();
    plant_config c = plant_config_from_motor(&m);
    c.seed = SEED;
    c.shaft.omega_e_start_rad_s = 700.0;
    c.shaft.theta_mech_start_rad = 0.4;
    return c;
}

static plant_samples first_sample(const plant_config *c)
{
    plant p;
    plant_samples s;
    plant_init(&p, c);
    plant_set_current(&p, (vec_dq){2.0, 7.0});
    plant_sample(&p, &s);
    return s;
}

static void test_perfect_sensors(void)
{
    const plant_config c = drive();
    const plant_samples s = first_sample(&c);
    const double theta = 1.2;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0 * cos(theta) - 7.0 * sin(theta), s.i_A[0]);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-12, 2.0 * cos(theta - 2.0 * VEC_PI / 3.0) - 7.0 * sin(theta - 2.0 * VEC_PI / 3.0), s.i_A[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, s.i_A[0] + s.i_A[1] + s.i_A[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, theta, s.theta_e_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4, s.theta_mech_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 700.0, s.omega_e_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 750.0, s.u_dc_V);
}

static void test_current_gain_and_offset(void)
{
    plant_config c = drive();
    const plant_samples truth = first_sample(&c);
    const double gain[3] = {1.02, 0.97, 1.01}, offset[3] = {0.1, -0.2, 0.3};
    for (int x = 0; x < 3; x++) {
        c.sensors.current_gain[x] = gain[x];
        c.sensors.current_offset_A[x] = offset[x];
    }
    const plant_samples s = first_sample(&c);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, gain[x] * truth.i_A[x] + offset[x], s.i_A[x]);
    }
}

static void test_drifting_gain_and_offset(void)
{
    plant_config c = drive();
    const plant_samples truth = first_sample(&c);
    c.clock_s = 40.0;
    c.sensors.current_gain_rate_s[1] = -1e-3;
    c.sensors.current_offset_rate_A_s[2] = 0.01;
    plant_samples s = first_sample(&c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, truth.i_A[0], s.i_A[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.96 * truth.i_A[1], s.i_A[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, truth.i_A[2] + 0.4, s.i_A[2]);
    /* The clock runs on: a cycle later, at the same currents. */
    plant p;
    plant q;
    const double duty[3] = {0.5, 0.5, 0.5};
    plant_samples later;
    plant_init(&p, &c);
    c.sensors.current_gain_rate_s[1] = 0.0;
    plant_init(&q, &c);
    plant_begin_cycle(&p, duty);
    plant_begin_cycle(&q, duty);
    plant_advance_to(&p, c.T_s);
    plant_advance_to(&q, c.T_s);
    plant_sample(&p, &later);
    plant_sample(&q, &s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (1.0 - 1e-3 * (40.0 + c.T_s)) * s.i_A[1], later.i_A[1]);
}

static void test_quantisation(void)
{
    plant_config c = drive();
    const plant_samples truth = first_sample(&c);
    c.sensors.current_bits = 8;
    c.sensors.current_full_scale_A = 16.0;
    const plant_samples s = first_sample(&c);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.0625 + 1e-12, truth.i_A[x], s.i_A[x]);
        TEST_ASSERT_TRUE(remainder(s.i_A[x], 0.125) == 0.0);
    }
    /* 2's complement: one code fewer above zero. */
    c.sensors.current_full_scale_A = 2.0;
    const plant_samples clipped = first_sample(&c);
    for (int x = 0; x < 3; x++) {
        if (truth.i_A[x] > 2.0) {
            TEST_ASSERT_TRUE(clipped.i_A[x] == 2.0 - 2.0 / 128.0);
        } else if (truth.i_A[x] < -2.0) {
            TEST_ASSERT_TRUE(clipped.i_A[x] == -2.0);
        }
    }
}

/* 1e5 samples: mean within 4 standard errors, deviation within 1 % (4 sigma would be 0.9 %). */
static void test_noise(void)
{
    plant_config c = drive();
    c.sensors.current_noise_A = 0.05;
    c.machine.psi_f_Wb = 0.0;
    plant p;
    plant_init(&p, &c);
    const int n = 100000;
    double sum = 0.0, square = 0.0, product = 0.0;
    for (int k = 0; k < n; k++) {
        plant_samples s;
        plant_sample(&p, &s);
        sum += s.i_A[0];
        square += s.i_A[0] * s.i_A[0];
        product += s.i_A[0] * s.i_A[1];
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 0.05 / sqrt(n), 0.0, sum / n);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 0.05, 0.05, sqrt(square / n));
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 0.0025 / sqrt(n), 0.0, product / n); /* channels are independent */
}

static void test_angle_laws(void)
{
    plant_config c = drive();
    c.sensors.theta_0_rad = 0.05;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25, first_sample(&c).theta_e_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25 / 3.0, first_sample(&c).theta_mech_rad);
    c.sensors.theta_0_rad = 0.0;
    c.sensors.harmonic[0].order = 2.0;
    c.sensors.harmonic[0].amplitude_rad = 0.03;
    c.sensors.harmonic[0].phase_rad = 0.7;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.2 + 0.03 * cos(2.0 * 0.4 + 0.7), first_sample(&c).theta_e_rad);
    c.sensors.harmonic[0].amplitude_rad = 0.0;
    c.sensors.t_delay_s = 20e-6;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.2 + 700.0 * 20e-6, first_sample(&c).theta_e_rad);
    c.sensors.t_delay_s = 0.0;
    c.sensors.theta_0_rad = -1.3; /* wraps */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0 * VEC_PI - 0.1, first_sample(&c).theta_e_rad);
}

/* Applied = k_u * recorded: the same duties and a measured link that stays as it was. */
static void test_voltage_gain(void)
{
    const double duty[3] = {0.6, 0.5, 0.45};
    plant_config c = drive();
    plant_means nominal, m;
    plant_samples s;
    plant p;
    plant_init(&p, &c);
    plant_cycle(&p, duty, NULL, NULL, &nominal);
    c.inverter.k_u = 0.96;
    plant_init(&p, &c);
    plant_cycle(&p, duty, &s, NULL, &m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 750.0, s.u_dc_V);
    for (int x = 0; x < 3; x++) {
        const double commanded = (duty[x] - (duty[0] + duty[1] + duty[2]) / 3.0) * 750.0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, commanded, nominal.u_V[x]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.96 * commanded, m.u_V[x]);
    }
}

static void test_voltage_delay(void)
{
    plant_config c = drive();
    c.inverter.delay_cycles = 2;
    plant p;
    plant_init(&p, &c);
    double commanded_a[20];
    for (int k = 0; k < 20; k++) {
        const double duty[3] = {0.5 + 0.01 * k, 0.5, 0.5};
        plant_means m;
        commanded_a[k] = 0.01 * k * 750.0 * 2.0 / 3.0;
        plant_cycle(&p, duty, NULL, NULL, &m);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, commanded_a[k >= 2 ? k - 2 : 0], m.u_V[0]);
    }
}

/* A compensation adds its voltage along each phase current; more than the legs lose is a negative dead time. */
static void test_compensation(void)
{
    plant_config c = drive();
    c.inverter.compensation_V = 6.0;
    c.shaft.theta_mech_start_rad = 0.0;
    plant p;
    plant_init(&p, &c);
    plant_set_current(&p, (vec_dq){4.0, 0.0}); /* the d axis on phase A: b and c carry half, the other way */
    const double duty[3] = {0.5, 0.5, 0.5};
    plant_means m;
    plant_cycle(&p, duty, NULL, NULL, &m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 6.0 * 4.0 / 3.0, m.u_V[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -6.0 * 2.0 / 3.0, m.u_V[1]);
}

/* A lag is the low-pass of that time constant; a negative one the current of so much later. */
static void test_current_lag(void)
{
    plant_config lag = drive();
    plant_config low_pass = drive();
    plant_config late = drive();
    const plant_config plain = drive();
    lag.sensors.current_lag_s = 8e-6;
    low_pass.sensors.current_bandwidth_Hz = 1.0 / (2.0 * 3.14159265358979323846 * 8e-6);
    late.sensors.current_lag_s = -3e-6;
    plant p[4];
    plant_init(&p[0], &lag);
    plant_init(&p[1], &low_pass);
    plant_init(&p[2], &late);
    plant_init(&p[3], &plain);
    for (int k = 0; k < 10; k++) {
        const double duty[3] = {0.6, 0.5, 0.4};
        plant_samples s[4];
        for (int n = 0; n < 4; n++) {
            plant_begin_cycle(&p[n], duty);
            plant_advance_to(&p[n], n == 3 ? 3e-6 : 0.0);
            plant_sample(&p[n], &s[n]);
            plant_advance_to(&p[n], plain.T_s);
        }
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, s[1].i_A[x], s[0].i_A[x]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, s[3].i_A[x], s[2].i_A[x]);
        }
    }
}

/* Registers that load at the peak: each command acts in the second half of its cycle and in the first of the next, whatever
 * the two are, a leg that stays low or high among them. */
static void test_voltage_delay_of_a_half(void)
{
    static const double duty_a[] = {0.5, 0.8, 0.0, 0.3, 1.0, 0.6, 1.0, 0.0, 0.0, 0.4, 1.0, 1.0, 0.2};
    for (int whole = 0; whole < 2; whole++) {
        plant_config c = drive();
        c.inverter.delay_cycles = 0.5 + whole;
        plant p;
        plant_init(&p, &c);
        for (int k = 0; k < (int)(sizeof duty_a / sizeof *duty_a); k++) {
            const double duty[3] = {duty_a[k], 0.5, 0.5};
            const double now = duty_a[k >= whole ? k - whole : 0];
            const double before = duty_a[k >= whole + 1 ? k - whole - 1 : 0];
            plant_means m;
            plant_begin_cycle(&p, duty);
            plant_advance_to(&p, 0.5 * c.T_s);
            m = plant_mean(&p);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, (before - 0.5) * 750.0 * 2.0 / 3.0, m.u_V[0]);
            plant_advance_to(&p, c.T_s);
            m = plant_mean(&p);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, (0.5 * (before + now) - 0.5) * 750.0 * 2.0 / 3.0, m.u_V[0]);
        }
    }
}

/* A missed update keeps the last duties; the share of cycles is the probability (4 sigma of 20000 draws). */
static void test_glitch(void)
{
    plant_config c = drive();
    c.inverter.glitch_probability = 0.02;
    plant p;
    plant_init(&p, &c);
    const int n = 20000;
    double in_force = 0.0;
    for (int k = 0; k < n; k++) {
        const double duty[3] = {0.5 + 0.1 * ((k * 7) % 11) / 11.0, 0.5, 0.5};
        plant_means m;
        plant_cycle(&p, duty, NULL, NULL, &m);
        if (!(p.glitched && k > 0)) {
            in_force = (duty[0] - 0.5) * 500.0;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, in_force, m.u_V[0]);
    }
    printf("%ld glitches in %d cycles\n", p.glitches, n);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(n * 0.02 * 0.98), n * 0.02, (double)p.glitches);
}

static void test_loose_sensor(void)
{
    plant_config c = drive();
    c.sensors.loose_probability = 0.01;
    c.sensors.loose_channel = 1;
    c.sensors.loose_samples = 4.0;
    c.sensors.loose_gain = 0.25;
    c.sensors.loose_step_A = 0.5;
    plant p;
    plant_init(&p, &c);
    plant_set_current(&p, (vec_dq){2.0, 7.0});
    const plant_samples truth = first_sample(&(plant_config){.machine = c.machine,
                                                             .inverter = c.inverter,
                                                             .shaft = c.shaft,
                                                             .sensors = drive().sensors,
                                                             .T_s = c.T_s,
                                                             .I_scale_A = c.I_scale_A});
    long out = 0;
    const long n = 100000;
    for (long k = 0; k < n; k++) {
        plant_samples s;
        plant_sample(&p, &s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, truth.i_A[0], s.i_A[0]);
        const bool wrong = fabs(s.i_A[1] - truth.i_A[1]) > 1e-9;
        if (wrong) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25 * truth.i_A[1] + 0.5, s.i_A[1]);
        }
        out += wrong;
    }
    /* The mean dropout lasts 4 samples, the mean gap 100. */
    printf("%ld dropouts, %.2f samples each\n", p.sensors.dropouts, (double)out / (double)p.sensors.dropouts);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 4.0, (double)out / (double)p.sensors.dropouts);
    TEST_ASSERT_DOUBLE_WITHIN(150.0, (double)n / 103.0, (double)p.sensors.dropouts);
}

/* The mean voltage of a cycle under a ripple far slower than the cycle is that of the link in its middle. */
static void test_ripple(void)
{
    plant_config c = drive();
    c.inverter.ripple_V = 20.0;
    c.inverter.ripple_Hz = 50.0;
    for (int logged = 0; logged < 2; logged++) {
        c.inverter.ripple_logged = logged == 1;
        plant p;
        plant_init(&p, &c);
        for (int k = 0; k < 100; k++) {
            const double duty[3] = {0.6, 0.5, 0.4};
            plant_samples s;
            plant_means m;
            plant_cycle(&p, duty, &s, NULL, &m);
            const double w = 2.0 * VEC_PI * 50.0;
            const double middle_V = 750.0 + 20.0 * sin(w * (k + 0.5) * 200e-6);
            TEST_ASSERT_DOUBLE_WITHIN(0.1 * 20.0 * 1e-3, 0.1 * middle_V,
                                      m.u_V[0]); /* (w T)^2 / 24 = 1.6e-4 */
            const double seen_V = logged == 1 ? 750.0 + 20.0 * sin(w * k * 200e-6) : 750.0;
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, seen_V, s.u_dc_V);
        }
    }
}

/* The same by its share of the true link, which no reading shows, and with one that is logged. */
static void test_unlogged_ripple(void)
{
    plant_config c = drive();
    c.inverter.k_u = 0.9;
    c.inverter.ripple_V = 7.0;
    c.inverter.ripple_Hz = 30.0;
    c.inverter.ripple_logged = true;
    c.inverter.unlogged_share = 0.04;
    c.inverter.unlogged_Hz = 50.0;
    plant p;
    plant_init(&p, &c);
    for (int k = 0; k < 100; k++) {
        const double duty[3] = {0.6, 0.5, 0.4};
        plant_samples s;
        plant_means m;
        plant_cycle(&p, duty, &s, NULL, &m);
        const double middle_s = (k + 0.5) * 200e-6;
        const double logged_V = 7.0 * sin(60.0 * VEC_PI * k * 200e-6);
        const double link_V =
            675.0 * (1.0 + 0.04 * sin(100.0 * VEC_PI * middle_s)) + 7.0 * sin(60.0 * VEC_PI * middle_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * 27.0 * 1e-3, 0.1 * link_V, m.u_V[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, (675.0 + logged_V) / 0.9, s.u_dc_V);
    }
}

/* Of a speed that climbs evenly a filter shows what it was tau ago, once it has settled from where it began. */
static void test_speed_filter(void)
{
    const double tau_s = 3e-3;
    plant_config c = drive();
    c.shaft.accel_e_rad_s2 = 5000.0;
    plant_samples still;
    plant_samples s;
    plant p;
    c.sensors.speed_lag_s = tau_s;
    plant_init(&p, &c);
    for (int k = 0; k < 200; k++) {
        const double duty[3] = {0.5, 0.5, 0.5};
        plant_samples peak;
        plant_cycle(&p, duty, &s, k % 3 == 0 ? &peak : NULL, NULL);
        const double t_s = k * 200e-6;
        const double shown = 700.0 + 5000.0 * (t_s - tau_s * (1.0 - exp(-t_s / tau_s)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, shown, s.omega_e_rad_s);
    }
    plant_sample(&p, &s);
    plant_sample(&p, &still); /* at the same instant it shows the same */
    TEST_ASSERT_TRUE(s.omega_e_rad_s == still.omega_e_rad_s);
}

/* The phase of a fault goes ahead of the loose channel; all else is that of a loose contact. */
static void test_sensor_fault(void)
{
    plant_config c = drive();
    const plant_samples truth = first_sample(&c);
    c.sensors.loose_probability = 1.0;
    c.sensors.loose_samples = 1e6;
    c.sensors.loose_gain = 0.5;
    for (int phase = 1; phase <= 3; phase++) {
        c.sensors.fault_phase = phase;
        const plant_samples s = first_sample(&c);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, (x + 1 == phase ? 0.5 : 1.0) * truth.i_A[x], s.i_A[x]);
        }
    }
}

/* The same seed gives the same bits, another seed others, and one sensor's noise does not move another's. */
static void test_seed(void)
{
    plant_config c = drive();
    c.sensors.current_noise_A = 0.1;
    c.sensors.angle_noise_rad = 0.01;
    const plant_samples a = first_sample(&c), b = first_sample(&c);
    TEST_ASSERT_TRUE(a.i_A[0] == b.i_A[0] && a.theta_e_rad == b.theta_e_rad);
    c.sensors.angle_noise_rad = 0.0;
    TEST_ASSERT_TRUE(first_sample(&c).i_A[0] == a.i_A[0]);
    c.seed = SEED + 1;
    TEST_ASSERT_TRUE(first_sample(&c).i_A[0] != a.i_A[0]);
}

void setUp(void)
{
}

void tearDown(void)
{
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(test_perfect_sensors);
    RUN_TEST(test_current_gain_and_offset);
    RUN_TEST(test_drifting_gain_and_offset);
    RUN_TEST(test_quantisation);
    RUN_TEST(test_noise);
    RUN_TEST(test_angle_laws);
    RUN_TEST(test_voltage_gain);
    RUN_TEST(test_compensation);
    RUN_TEST(test_current_lag);
    RUN_TEST(test_voltage_delay);
    RUN_TEST(test_voltage_delay_of_a_half);
    RUN_TEST(test_glitch);
    RUN_TEST(test_loose_sensor);
    RUN_TEST(test_ripple);
    RUN_TEST(test_unlogged_ripple);
    RUN_TEST(test_speed_filter);
    RUN_TEST(test_sensor_fault);
    RUN_TEST(test_seed);
    return UNITY_END();
}
