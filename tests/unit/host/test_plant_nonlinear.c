/*
 * The plant's integrator against CVODE for each effect that leaves the linear path: saturation, harmonics of
 * the magnet's flux, unequal phases, iron loss, the sensors' low-pass, and all of them with a free shaft.
 * Bound 1e-9 of the rated current.
 */
#include "plant/plant_flux.h"
#include "test_plant_compare.h"
#include "unity.h"

#include <math.h>

static void follow(const char *name, plant_config c, double i_q)
{
    plant p;
    plant_init(&p, &c);
    TEST_ASSERT_FALSE(p.linear);
    const comparison w = compare_run(name, &c, i_q, 200);
    compare_check(&w, 1e-9);
}

static void test_saturation(void)
{
    plant_config c = compare_drive(1.0, 800.0);
    c.machine.I_sat_A = 45.0;
    follow("saturation, round", c, 12.0);
    c = compare_drive(2.0, -800.0);
    c.machine.I_sat_A = 45.0;
    follow("saturation, salient", c, 10.0);
}

/* A map whose inductances fall by up to a tenth at 15 A. */
static void put_map(plant_machine *m)
{
    const double L = 0.1 * m->L_q_H;
    m->w_ddd = 3e-3 * L;
    m->w_dqq = -6e-3 * L;
    m->w_dddd = -1e-4 * L;
    m->w_ddqq = -4e-4 * L;
    m->w_qqqq = -2e-4 * L;
}

static void test_flux_map(void)
{
    plant_config c = compare_drive(1.8, 700.0);
    put_map(&c.machine);
    follow("flux map", c, 6.0);
    c.machine.I_sat_A = 40.0;
    follow("and a fall of both axes", c, 6.0);
    c.machine.R_fe_ohm = 150.0;
    c.machine.tau_fe_s = 40e-6;
    c.machine.dL_H[1] = 0.1 * c.machine.L_d_H;
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    c.shaft.J_kgm2 = 5e-4;
    c.shaft.friction_Nms = 1e-3;
    c.shaft.T_load_Nm = 2.0;
    follow("and iron loss, unequal inductances, free shaft", c, 6.0);
}

/* Iron that saturates: a gradient whose slopes are the inductances, those of no current at no current, and no wall. */
static void test_iron_that_saturates(void)
{
    plant_config c = compare_drive(1.8, 700.0);
    plant_machine *m = &c.machine;
    const double L = m->L_d_H;
    m->iron[0] = (plant_iron){0.5 * L * 400.0, 20.0, 15.0, -5.0};
    m->iron[1] = (plant_iron){0.1 * L * 25.0, 5.0, 8.0, 4.0};
    TEST_ASSERT_EQUAL_DOUBLE(4.0 * c.I_scale_A, plant_flux_find_reach(m, c.I_scale_A));
    plant_flux none;
    plant_flux_at(m, (vec_dq){0.0, 0.0}, &none);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, L, none.L_dd_H);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, m->L_q_H, none.L_qq_H);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, fabs(none.psi_Wb.d) + fabs(none.psi_Wb.q) + fabs(none.L_dq_H));
    const double h = 1e-5;
    double energy = 0.0;
    double before = L;
    for (int n = 1; n < 400; n++) {
        const vec_dq i = {0.1 * n * cos(0.3), 0.1 * n * sin(0.3)};
        plant_flux at, on_d, on_q;
        plant_flux_at(m, i, &at);
        plant_flux_at(m, (vec_dq){i.d + h, i.q}, &on_d);
        plant_flux_at(m, (vec_dq){i.d, i.q + h}, &on_q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * L, at.L_dd_H, (on_d.psi_Wb.d - at.psi_Wb.d) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * L, at.L_dq_H, (on_d.psi_Wb.q - at.psi_Wb.q) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * L, at.L_dq_H, (on_q.psi_Wb.d - at.psi_Wb.d) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * L, at.L_qq_H, (on_q.psi_Wb.q - at.psi_Wb.q) / h);
        energy += 0.1 * (at.psi_Wb.d * cos(0.3) + at.psi_Wb.q * sin(0.3));
        before = at.L_dd_H;
    }
    TEST_ASSERT_TRUE(energy > 0.0 && before < 0.8 * L);
}

/* Within its reach a map is its polynomial; beyond, its flux still rises in every direction, without a step in the
 * inductance, and it stays the gradient of an energy. */
static void test_flux_map_goes_on(void)
{
    plant_config c = compare_drive(1.8, 700.0);
    put_map(&c.machine);
    const double least_A = plant_flux_find_reach(&c.machine, c.I_scale_A);
    TEST_ASSERT_TRUE(least_A > 0.5 * c.I_scale_A && least_A < 4.0 * c.I_scale_A);
    for (int n = 0; n < 72; n++) {
        const double angle = 2.0 * VEC_PI * n / 72.0;
        const vec_dq e = {cos(angle), sin(angle)};
        double before = 0.0;
        for (double i_A = 0.25; i_A < 4.0 * c.I_scale_A; i_A += 0.25) {
            const vec_dq i = {i_A * e.d, i_A * e.q};
            const double h = 1e-5;
            plant_flux at, on_d, on_q;
            plant_flux_at(&c.machine, i, &at);
            plant_flux_at(&c.machine, (vec_dq){i.d + h, i.q}, &on_d);
            plant_flux_at(&c.machine, (vec_dq){i.d, i.q + h}, &on_q);
            const double along = at.psi_Wb.d * e.d + at.psi_Wb.q * e.q;
            TEST_ASSERT_TRUE(along > before);
            before = along;
            const double L = c.machine.L_q_H * 1e-3 * (1.0 + at.L_dd_H / c.machine.L_d_H);
            TEST_ASSERT_DOUBLE_WITHIN(L, at.L_dd_H, (on_d.psi_Wb.d - at.psi_Wb.d) / h);
            TEST_ASSERT_DOUBLE_WITHIN(L, at.L_dq_H, (on_d.psi_Wb.q - at.psi_Wb.q) / h);
            TEST_ASSERT_DOUBLE_WITHIN(L, at.L_dq_H, (on_q.psi_Wb.d - at.psi_Wb.d) / h);
            TEST_ASSERT_DOUBLE_WITHIN(L, at.L_qq_H, (on_q.psi_Wb.q - at.psi_Wb.q) / h);
            if (i_A < least_A) {
                const plant_machine *m = &c.machine;
                TEST_ASSERT_DOUBLE_WITHIN(1e-15,
                                          2.0 * i.d * i.q * (m->w_dqq + m->w_ddqq * i.d) + m->L_q_H * i.q +
                                              4.0 * m->w_qqqq * i.q * i.q * i.q,
                                          at.psi_Wb.q);
            }
        }
    }
}

static void test_flux_harmonics(void)
{
    plant_config c = compare_drive(1.4, 900.0);
    c.machine.psi_5_Wb = -0.004;
    c.machine.psi_7_Wb = 0.003;
    follow("flux harmonics", c, 9.0);
    c.machine.psi_11_Wb = 0.002;
    c.machine.psi_13_Wb = -0.0015;
    follow("to the 13th", c, 9.0);
}

static void test_unequal_phases(void)
{
    plant_config c = compare_drive(1.0, 600.0);
    c.machine.dR_ohm[0] = 0.4;
    c.machine.dR_ohm[1] = -0.1;
    follow("unequal phases", c, 9.0);
}

static void test_unequal_inductances(void)
{
    plant_config c = compare_drive(1.5, 700.0);
    c.machine.dL_H[0] = 0.25 * c.machine.L_d_H;
    c.machine.dL_H[2] = -0.1 * c.machine.L_d_H;
    follow("unequal inductances, salient", c, 9.0);
    c.machine.I_sat_A = 45.0;
    c.machine.R_fe_ohm = 150.0;
    c.machine.tau_fe_s = 40e-6;
    follow("and saturation and iron loss", c, 9.0);
}

static void test_iron_loss(void)
{
    plant_config c = compare_drive(1.6, 1500.0);
    c.machine.R_fe_ohm = 150.0;
    c.machine.tau_fe_s = 40e-6;
    follow("iron loss", c, 9.0);
}

/* Far faster than any machine, so that its own voltage and the change within a cycle count. */
static void test_drift(void)
{
    plant_config c = compare_drive(1.3, 900.0);
    c.machine.R_rate_ohm_s = 20.0;
    c.machine.psi_rate_Wb_s = -1.5;
    c.clock_s = -0.01;
    follow("drifting R and psi", c, 9.0);
    c.machine.R_rate_ohm_s = c.machine.psi_rate_Wb_s = c.clock_s = 0.0;
    c.machine.alpha_R = 0.0039;
    c.machine.alpha_psi = -0.0011;
    c.machine.heating_K = 40.0;
    c.machine.heating_s = 0.05;
    c.machine.reference_K = 30.0;
    follow("warming up", c, 9.0);
}

static void test_sensor_bandwidth(void)
{
    plant_config c = compare_drive(1.0, 900.0);
    c.sensors.current_bandwidth_Hz = 20e3;
    const comparison w = compare_run("sensor bandwidth", &c, 9.0, 200);
    compare_check(&w, 1e-9);
    TEST_ASSERT_TRUE(w.seen > 0.0 && w.seen < 1e-10);
    c.machine.I_sat_A = 45.0;
    follow("and saturation", c, 9.0);
}

/* The torque of the reference comes from co-energy. */
static void test_all_with_free_shaft(void)
{
    plant_config c = compare_drive(1.0, 700.0);
    c.machine.psi_5_Wb = 0.003;
    c.machine.psi_7_Wb = -0.002;
    c.machine.dR_ohm[2] = 0.2;
    c.machine.R_fe_ohm = 200.0;
    c.machine.tau_fe_s = 50e-6;
    c.sensors.current_bandwidth_Hz = 30e3;
    c.inverter.r_on_ohm = 0.05;
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    c.shaft.J_kgm2 = 5e-4;
    c.shaft.friction_Nms = 1e-3;
    c.shaft.T_load_Nm = 2.0;
    follow("all, free shaft", c, 9.0);
    c.machine.I_sat_A = 45.0;
    follow("and saturation", c, 9.0);
    c.machine.L_q_H *= 1.8;
    follow("and a saliency", c, 9.0);
}

/* Flux must rise with current for ever, or the machine has no current for a given flux. */
static void test_saturation_goes_on(void)
{
    plant_machine m = {.I_sat_A = 10.0};
    double before = 0.0;
    for (int k = 1; k < 2000; k++) {
        const double i = 0.05 * k;
        double factor, slope;
        machine_saturation(&m, i, &factor, &slope);
        const double flux = factor * i;
        const double differential = factor + slope * i * i;
        TEST_ASSERT_TRUE(flux > before);
        TEST_ASSERT_TRUE(differential > 0.13);
        /* The slope that the integrator uses is the slope of this flux. */
        double ahead, unused;
        machine_saturation(&m, i + 1e-6, &ahead, &unused);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, differential, (ahead * (i + 1e-6) - flux) / 1e-6);
        if (i <= 8.0) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0 / (1.0 + i * i / 100.0), factor);
        }
        before = flux;
    }
}

void setUp(void)
{
}

void tearDown(void)
{
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_saturation);
    RUN_TEST(test_flux_map);
    RUN_TEST(test_iron_that_saturates);
    RUN_TEST(test_flux_map_goes_on);
    RUN_TEST(test_flux_harmonics);
    RUN_TEST(test_unequal_phases);
    RUN_TEST(test_unequal_inductances);
    RUN_TEST(test_iron_loss);
    RUN_TEST(test_drift);
    RUN_TEST(test_sensor_bandwidth);
    RUN_TEST(test_all_with_free_shaft);
    RUN_TEST(test_saturation_goes_on);
    return UNITY_END();
}
