/*
 * Two updates a carrier period: the plant's halves against its whole cycles, the ripple of a half against the
 * plant's own mean, and the loops with both.
 */
#include "iqfoc/ripple.h"
#include "loops/update_loops.h"
#include "model/exact.h"
#include "params_host.h"
#include "plant/plant.h"
#include "reference.h"

#include <stdbool.h>

#define SEED UINT64_C(20261122)

void setUp(void)
{
}

void tearDown(void)
{
}

static plant begun(const motor *m, double omega_rad_s, double theta_rad, vec_dq i_A)
{
    plant p;
    plant_config c = plant_config_from_motor(m);
    c.shaft.omega_e_start_rad_s = omega_rad_s;
    c.shaft.theta_mech_start_rad = theta_rad / m->pole_pairs;
    plant_init(&p, &c);
    plant_set_current(&p, i_A);
    return p;
}

static plant_means half(plant *p, const double duty[3], bool to_peak)
{
    plant_begin_half(p, duty, to_peak);
    plant_advance_to(p, p->config.T_s);
    return plant_mean(p);
}

/* Two halves with the same duties are the cycle that they are halves of: the same currents, and the same mean. */
static void test_two_halves_are_a_cycle(void)
{
    uint64_t seed = SEED;
    const motor whole = loop_motor_at(6.0);
    const motor halved = loop_motor_at(12.0);
    for (int n = 0; n < 400; n++) {
        double duty[3];
        for (int x = 0; x < 3; x++) {
            const double d = uniform(&seed, -0.2, 1.2); /* often at an end */
            duty[x] = d < 0.0 ? 0.0 : d > 1.0 ? 1.0 : d;
        }
        const double omega = uniform(&seed, -1600.0, 1600.0);
        const double theta = uniform(&seed, -3.0, 3.0);
        const vec_dq i_A = {uniform(&seed, -15.0, 15.0), uniform(&seed, -15.0, 15.0)};
        plant a = begun(&whole, omega, theta, i_A);
        plant b = begun(&halved, omega, theta, i_A);
        /* From a cycle with other duties, so that legs may be at either end before. */
        const double other[3] = {duty[1], 1.0 - duty[2], duty[0]};
        plant_means mean;
        plant_cycle(&a, other, NULL, NULL, NULL);
        plant_cycle(&a, duty, NULL, NULL, &mean);
        half(&b, other, true);
        half(&b, other, false);
        const plant_means first = half(&b, duty, true);
        const plant_means second = half(&b, duty, false);
        const plant_point end_a = plant_now(&a);
        const plant_point end_b = plant_now(&b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, end_a.i_dq_A.d, end_b.i_dq_A.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, end_a.i_dq_A.q, end_b.i_dq_A.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, mean.i_dq_A.d, 0.5 * (first.i_dq_A.d + second.i_dq_A.d));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, mean.i_dq_A.q, 0.5 * (first.i_dq_A.q + second.i_dq_A.q));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, second.u_ab_V.alpha - first.u_ab_V.alpha);
    }
}

/* The header's formula in double; k and rho of both axes alike. */
static double complex formula(double k, double rho, const double d[3], double u_dc, double phi, bool to_peak,
                              double theta_mid)
{
    double even[3];
    double odd[3];
    for (int x = 0; x < 3; x++) {
        const double b = d[x] * (1.0 - d[x]);
        even[x] = b * (1.0 - phi * phi / 24.0 * (1.0 - 2.0 * b));
        odd[x] = b * (1.0 - 2.0 * d[x]);
    }
    const vec_ab v = vec_from_phases(even);
    const vec_ab w = vec_from_phases(odd);
    const double complex sum = (to_peak ? -0.5 : 0.5) * (1.0 - rho / 2.0) * vec_complex(v.alpha, v.beta) +
                               (I * phi - rho) / 12.0 * vec_complex(w.alpha, w.beta);
    return k * u_dc * sum * vec_turn(-theta_mid);
}

static void test_ripple_in_fixed_point(void)
{
    uint64_t seed = SEED + 1;
    worst off = {"ripple of a half", 0.0};
    for (int n = 0; n < 400000; n++) {
        const iqfoc_abc_t high = {random_iq24(&seed, 0.0, 1.0), random_iq24(&seed, 0.0, 1.0),
                                  random_iq24(&seed, 0.0, 1.0)};
        const double d[3] = {to_double(high.a), to_double(high.b), to_double(high.c)};
        const double k = uniform(&seed, 0.01, n % 2 == 0 ? 16.0 : 1.0);
        const double rho = uniform(&seed, 0.0, 1.0);
        const int32_t k_q26 = (int32_t)lround(k * 67108864.0);
        const int32_t rho_q30 = (int32_t)lround(rho * 1073741824.0);
        const iqfoc_salient_machine_t machine = {
            .k_d_q26 = k_q26, .k_q_q26 = k_q26, .rho_d_q30 = rho_q30, .rho_q_q30 = rho_q30};
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(random_iq24(&seed, -0.333, 0.333));
        const iqfoc_ripple_half_t half_ripple = iqfoc_ripple_half_at_speed(&machine, &rotor);
        const iq24_t u_dc = random_iq24(&seed, 0.0, 2.0);
        const iq24_t theta = random_iq24(&seed, -1.0, 1.0);
        const bool to_peak = n % 3 == 0;
        const iqfoc_dq_t got = iqfoc_ripple_half_seen(&half_ripple, high, u_dc, to_peak, iq24_sincos(theta));
        const double complex want =
            formula(k, rho, d, to_double(u_dc), to_double(rotor.phi), to_peak, TWO_PI * to_double(theta));
        worst_add(&off, got.d, creal(want));
        worst_add(&off, got.q, cimag(want));
        TEST_ASSERT_TRUE(fabs(to_double(got.d)) <= 7.0 && fabs(to_double(got.q)) <= 7.0);
    }
    worst_check(&off, 28.0);
}

/*
 * What pulses add to the mean that the same mean voltage would make (model/exact.h), by the plant, against the
 * formula.
 */
static void test_ripple_is_the_plants(void)
{
    uint64_t seed = SEED + 2;
    double largest = 0.0;
    double without = 0.0;
    const motor m = loop_motor_at(10.0);
    const double rated_A = per_unit_of(&m).I_A;
    const double T_s = per_unit_of(&m).T_s;
    const exact_salient machine = {m.R_ohm, m.L_d_H, m.L_q_H, m.psi_f_Wb};
    for (int n = 0; n < 2000; n++) {
        const double duty[3] = {uniform(&seed, 0.0, 1.0), uniform(&seed, 0.0, 1.0), uniform(&seed, 0.0, 1.0)};
        const double omega = uniform(&seed, -1.0, 1.0) * TWO_PI * 250.0;
        const double theta = uniform(&seed, -3.0, 3.0);
        const bool to_peak = n % 2 == 0;
        const vec_dq i_A = {uniform(&seed, -15.0, 15.0), uniform(&seed, -15.0, 15.0)};
        plant p = begun(&m, omega, theta, i_A);
        const plant_means mean = half(&p, duty, to_peak);
        const vec_ab v = vec_from_phases(duty);
        const exact_span even =
            exact_salient_span(&machine, vec_complex(i_A.d, i_A.q),
                               m.u_dc_V * vec_complex(v.alpha, v.beta) * vec_turn(-theta), T_s, omega);
        const double complex truth = vec_complex(mean.i_dq_A.d, mean.i_dq_A.q);
        const double complex ripple = formula(T_s / m.L_d_H, m.R_ohm * T_s / m.L_d_H, duty, m.u_dc_V,
                                              omega * T_s, to_peak, theta + 0.5 * omega * T_s);
        largest = fmax(largest, cabs(truth - even.mean_dq_A - ripple) / rated_A);
        without = fmax(without, cabs(truth - even.mean_dq_A) / rated_A);
    }
    printf("  ripple of a half: %.4f of rated off the plant, %.4f without it\n", largest, without);
    TEST_ASSERT_TRUE(largest < 0.0015 && largest > 1e-4);
    TEST_ASSERT_TRUE(without > 0.25);
}

/* Half the delay: half the constant error of the quasi-discrete mean's PI, which settles in fewer periods; the
 * constant error of the quasi-discrete predictor is of the second order of the angle of a cycle. */
static void test_two_updates_gain_at_low_ratios(void)
{
    for (int k = 3; k < UPDATE_RATIOS; k++) {
        loop_result once;
        loop_result twice;
        error e = {0};
        TEST_ASSERT_TRUE(update_loop_run(update_ratios[k], LOOP_PI_MEAN, false, &once, &e));
        TEST_ASSERT_TRUE(update_loop_run(update_ratios[k], LOOP_PI_MEAN, true, &twice, &e));
        TEST_ASSERT_TRUE(twice.offset_percent < 0.8 * once.offset_percent);
        TEST_ASSERT_TRUE(twice.settling_cycles / 2 < once.settling_cycles);
        TEST_ASSERT_TRUE(twice.overshoot_percent < once.overshoot_percent);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * once.switching_Hz, once.switching_Hz, twice.switching_Hz);
        TEST_ASSERT_TRUE(update_loop_run(update_ratios[k], LOOP_DEADBEAT_QUASI_DISCRETE, false, &once, &e));
        TEST_ASSERT_TRUE(update_loop_run(update_ratios[k], LOOP_DEADBEAT_QUASI_DISCRETE, true, &twice, &e));
        TEST_ASSERT_TRUE(twice.offset_percent < 0.5 * once.offset_percent);
    }
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_two_halves_are_a_cycle);
    RUN_TEST(test_ripple_in_fixed_point);
    RUN_TEST(test_ripple_is_the_plants);
    RUN_TEST(test_two_updates_gain_at_low_ratios);
    return UNITY_END();
}
