/* POSIX: fmemopen. */
#define _POSIX_C_SOURCE 200809L
/*
 * The text of `--effect`: what each id changes, and the messages for bad text.
 */
#include "plant/plant_effect.h"
#include "plant/plant_effect_table.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static plant_config drive(void)
{
    motor m;
    memset(&m, 0, sizeof m);
    m.pole_pairs = 3;
    m.R_ohm = 0.75;
    m.L_d_H = 4e-3;
    m.L_q_H = 6e-3;
    m.psi_f_Wb = 0.134;
    m.I_rated_A_rms = 10.0;
    m.f_pwm_Hz = 5000.0;
    m.u_dc_V = 750.0;
    return plant_config_from_motor(&m);
}

static plant_config with(const char *text)
{
    plant_config c = drive();
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(plant_effect_apply(&c, text, &e), e.text);
    return c;
}

/* Byte by byte: both come from one configuration, which began as zeros. */
static bool same(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(plant_config)) == 0;
}

/* Refused with exit status 2, by a line that holds `part`; the configuration is untouched. */
static void refused(const char *text, const char *part)
{
    plant_config c = drive();
    const plant_config before = c;
    error e = {0};
    TEST_ASSERT_FALSE(plant_effect_apply(&c, text, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_TRUE_MESSAGE(strstr(e.text, part) != NULL, e.text);
    TEST_ASSERT_TRUE(same(&c, &before));
}

static void test_each_id_changes_its_own(void)
{
    TEST_ASSERT_TRUE(with("resistance:R=1.1").machine.R_ohm == 1.1);
    TEST_ASSERT_TRUE(with("resistance:R_ohm=1.1").machine.R_ohm == 1.1);
    TEST_ASSERT_TRUE(with("inductance:L=3e-3").machine.L_d_H == 3e-3 &&
                     with("inductance:L=3e-3").machine.L_q_H == 3e-3);
    TEST_ASSERT_TRUE(with("flux_linkage:psi_f=0.12").machine.psi_f_Wb == 0.12);
    TEST_ASSERT_TRUE(with("saliency:L_q=7e-3").machine.L_q_H == 7e-3 &&
                     with("saliency:L_q=7e-3").machine.L_d_H == 4e-3);
    const plant_config saturated = with("saturation:L_0=6e-3,I_sat_A=25");
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 4.8e-3, saturated.machine.L_d_H); /* the ratio stays, the mean is L_0 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 7.2e-3, saturated.machine.L_q_H);
    TEST_ASSERT_TRUE(saturated.machine.I_sat_A == 25.0);
    const plant_config map = with("saturation_dq:L_d0=3e-3,w_dqq=-1e-5,w_qqqq_Wb/A^3=-1e-6");
    TEST_ASSERT_TRUE(map.machine.L_d_H == 3e-3 && map.machine.L_q_H == 6e-3 && map.machine.w_dqq == -1e-5);
    TEST_ASSERT_TRUE(map.machine.w_qqqq == -1e-6 && map.machine.w_ddd == 0.0);
    refused("saturation_dq:w_qqqq=-1e-3", "the flux map's inductance falls to a tenth at");
    const plant_config dead = with("dead_time:t_dead_s=2e-6,v_switch_V=1.5,v_diode_V=1,r_on_ohm=0.01");
    TEST_ASSERT_TRUE(dead.inverter.t_dead_s == 2e-6 && dead.inverter.v_switch_V == 1.5);
    TEST_ASSERT_TRUE(dead.inverter.v_diode_V == 1.0 && dead.inverter.r_on_ohm == 0.01);
    TEST_ASSERT_TRUE(with("voltage_gain:k_u=0.95").inverter.k_u == 0.95);
    TEST_ASSERT_TRUE(with("current_offset:o_b=-0.3").sensors.current_offset_A[1] == -0.3);
    TEST_ASSERT_TRUE(with("current_gain:g_c=1.02").sensors.current_gain[2] == 1.02);
    TEST_ASSERT_TRUE(with("current_gain:g_c=1.02").sensors.current_gain[0] == 1.0);
    TEST_ASSERT_TRUE(with("current_noise:sigma=0.02").sensors.current_noise_A == 0.02);
    TEST_ASSERT_TRUE(with("current_quantisation:bits=10,full_scale=20").sensors.current_bits == 10);
    TEST_ASSERT_TRUE(with("current_bandwidth:f_Hz=40e3").sensors.current_bandwidth_Hz == 40e3);
    TEST_ASSERT_TRUE(with("angle_offset:theta_0=-0.1").sensors.theta_0_rad == -0.1);
    const plant_config harmonic = with("angle_harmonic:order=2,amplitude=0.02,phase=1");
    TEST_ASSERT_TRUE(harmonic.sensors.harmonic[0].order == 2.0 &&
                     harmonic.sensors.harmonic[0].amplitude_rad == 0.02);
    TEST_ASSERT_TRUE(harmonic.sensors.harmonic[0].phase_rad == 1.0);
    /* Given again it is another one. */
    plant_config several = harmonic;
    error e = {0};
    TEST_ASSERT_TRUE(plant_effect_apply(&several, "angle_harmonic:order=1,amplitude=0.03,phase=2", &e));
    TEST_ASSERT_TRUE(several.sensors.harmonic[0].order == 1.0 &&
                     several.sensors.harmonic[0].amplitude_rad == 0.03);
    TEST_ASSERT_TRUE(several.sensors.harmonic[1].order == 2.0 &&
                     several.sensors.harmonic[1].amplitude_rad == 0.02);
    TEST_ASSERT_TRUE(several.sensors.harmonic[2].amplitude_rad == 0.0);
    TEST_ASSERT_TRUE(with("angle_delay:t_delay=-1e-5").sensors.t_delay_s == -1e-5);
    TEST_ASSERT_TRUE(with("angle_noise:sigma=1e-3").sensors.angle_noise_rad == 1e-3);
    TEST_ASSERT_TRUE(with("voltage_delay:cycles=1.5").inverter.delay_cycles == 1.5);
    TEST_ASSERT_TRUE(with("emf_harmonics:psi_5=-0.002").machine.psi_5_Wb == -0.002);
    TEST_ASSERT_TRUE(with("emf_harmonics:psi_7=0.001").machine.psi_7_Wb == 0.001);
    TEST_ASSERT_TRUE(with("phase_asymmetry:dR_b=0.2").machine.dR_ohm[1] == 0.2);
    TEST_ASSERT_TRUE(with("u_dc_ripple:amplitude=10,frequency=300,logged=1").inverter.ripple_logged);
    TEST_ASSERT_FALSE(with("u_dc_ripple:amplitude=10,frequency=300,logged=0").inverter.ripple_logged);
    TEST_ASSERT_TRUE(with("u_dc_ripple:amplitude=10,frequency=300").inverter.ripple_V == 10.0);
    TEST_ASSERT_TRUE(with("iron_loss:R_fe=300,tau_fe=4e-5").machine.R_fe_ohm == 300.0);
    TEST_ASSERT_TRUE(with("glitch:probability=0.01").inverter.glitch_probability == 0.01);
    TEST_ASSERT_TRUE(with("speed_lag:tau=0.01").sensors.speed_lag_s == 0.01);
    const plant_config swinging = with("dc_link_ripple:frequency=100,share=0.05");
    TEST_ASSERT_TRUE(swinging.inverter.unlogged_Hz == 100.0 && swinging.inverter.unlogged_share == 0.05);
    TEST_ASSERT_TRUE(with("sensor_fault:phase=3,probability=0.01").sensors.fault_phase == 3.0);
    TEST_ASSERT_TRUE(with("loose_sensor:channel=2,probability=0.01").sensors.loose_channel == 2);
    TEST_ASSERT_TRUE(with("sensor_hysteresis:width=0.1").sensors.hysteresis_A == 0.1);
    TEST_ASSERT_TRUE(with("crosstalk:share=-0.02").sensors.crosstalk == -0.02);
    TEST_ASSERT_TRUE(with("hum:amplitude=0.1,channel=3").sensors.hum_channel == 3);
    TEST_ASSERT_TRUE(with("hum:amplitude=0.1").sensors.hum_Hz == 50.0);
    TEST_ASSERT_TRUE(with("switching_noise:amplitude=0.1,coupling=0.2").sensors.edge_coupling == 0.2);
    TEST_ASSERT_TRUE(with("turn_short:turns=0.02,phase=3").machine.short_phase == 3.0);
    TEST_ASSERT_TRUE(with("weak_pole:share=0.2").machine.weak_pole == 0.2);
    TEST_ASSERT_TRUE(with("eccentricity:share=0.05").machine.eccentricity == 0.05);
}

/* Without keys every effect takes a size that is there and that the drive can have. */
static void test_typical_sizes(void)
{
    const plant_config plain = drive();
    for (int n = 0; n < effect_table_length; n++) {
        const plant_config c = with(effect_table[n].id);
        TEST_ASSERT_TRUE_MESSAGE(!same(&c, &plain), effect_table[n].id);
    }
    TEST_ASSERT_EQUAL_INT(38, effect_table_length);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 2e-6, with("dead_time").inverter.t_dead_s);
}

/* A key that is left out keeps its value, but what the effect cannot be without is filled in. */
static void test_needed_keys(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0 * sqrt(2.0) * 10.0, with("saturation:L_0=5e-3").machine.I_sat_A);
    TEST_ASSERT_TRUE(with("u_dc_ripple:amplitude=5").inverter.ripple_Hz == 300.0);
    TEST_ASSERT_TRUE(with("dc_link_ripple:share=0.01").inverter.unlogged_Hz == 300.0);
    TEST_ASSERT_TRUE(with("sensor_fault:phase=2").sensors.loose_probability > 0.0);
    TEST_ASSERT_TRUE(with("iron_loss:R_fe=100").machine.tau_fe_s == 50e-6);
    TEST_ASSERT_TRUE(with("current_quantisation:bits=12").sensors.current_full_scale_A > 28.0);
    TEST_ASSERT_TRUE(with("dead_time:t_dead=1e-6").inverter.v_diode_V == 0.0);
    plant_config c = drive();
    error e = {0};
    TEST_ASSERT_TRUE(plant_effect_apply(&c, "saturation:I_sat=33", &e));
    TEST_ASSERT_TRUE(plant_effect_apply(&c, "saturation:L_0=5e-3", &e));
    TEST_ASSERT_TRUE(c.machine.I_sat_A == 33.0);
}

/* The causes that a diagnosis can name are all there: interfaces.md, the table of cause ids. */
static void test_every_cause_can_be_made(void)
{
    const char *const causes[] = {"resistance",     "inductance",    "flux_linkage",  "saliency",
                                  "saturation",     "saturation_dq", "dead_time",     "voltage_gain",
                                  "current_offset", "current_gain",  "angle_offset",  "angle_harmonic",
                                  "angle_delay",    "voltage_delay", "emf_harmonics", "phase_asymmetry",
                                  "sensor_lag",     "missed_update", "speed_lag",     "dc_link_ripple",
                                  "sensor_fault"};
    for (size_t k = 0; k < sizeof causes / sizeof causes[0]; k++) {
        (void)with(causes[k]);
    }
}

static void test_several_add_up(void)
{
    plant_config c = drive();
    error e = {0};
    TEST_ASSERT_TRUE(plant_effect_apply(&c, "resistance:R=1", &e));
    TEST_ASSERT_TRUE(plant_effect_apply(&c, "dead_time:t_dead=1e-6", &e));
    TEST_ASSERT_TRUE(c.machine.R_ohm == 1.0 && c.inverter.t_dead_s == 1e-6);
}

static void test_bad_text(void)
{
    refused("", "unknown id");
    refused("resistence:R=1", "unknown id \"resistence\"");
    refused("resistance:", "has no '='");
    refused("resistance:R", "has no '='");
    refused("resistance:L=1", "unknown key \"L\", expected one of R (ohm)");
    refused("resistance:R_mohm=1", "unknown key");
    refused("resistance:R=", "the value of R is empty");
    refused("resistance:R=abc", "the value of R is not a number");
    refused("resistance:R=1 ", "is not a number");
    refused("resistance:R=nan", "R is not");
    refused("resistance:R=1,R=2", "given twice");
    refused("resistance:R=1,", "has no '='");
    refused("resistance:R=-1", "0 or more");
    refused("saliency:L_d=0", "greater than 0");
    refused("voltage_delay:cycles=1.25", "a multiple of 0.5");
    refused("voltage_delay:cycles=9", "at most 8");
    refused("u_dc_ripple:amplitude=1,logged=2", "0 or 1");
    refused("glitch:probability=1.5", "at most 1");
    refused("dead_time:t_dead=2e-4", "at most");
    refused("phase_asymmetry:dR_a=-1", "R + dR_a");
    refused("loose_sensor:channel=3", "at most 2");
    refused("turn_short:phase=1.5", "expected 1, 2 or 3");
    refused("hum:channel=4", "at most 3");
    refused("sensor_fault:phase=4", "at most 3");
    refused("sensor_fault:phase=1.5", "expected 1, 2 or 3");
    refused("dc_link_ripple:share=1.5", "at most 1");
    refused("speed_lag:tau=-1e-3", "0 or more");
    refused("loose_sensor:samples=0.5", "1 or more");
    refused("angle_harmonic:order=0", "1 or more");
}

static void test_list(void)
{
    char text[8192] = {0};
    FILE *f = fmemopen(text, sizeof text - 1, "w");
    TEST_ASSERT_NOT_NULL(f);
    plant_effect_list(f);
    TEST_ASSERT_EQUAL_INT(0, fclose(f));
    for (int k = 0; k < effect_table_length; k++) {
        TEST_ASSERT_NOT_NULL(strstr(text, effect_table[k].id));
    }
    TEST_ASSERT_NOT_NULL(strstr(text, "t_dead (s)"));
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
    RUN_TEST(test_each_id_changes_its_own);
    RUN_TEST(test_typical_sizes);
    RUN_TEST(test_needed_keys);
    RUN_TEST(test_every_cause_can_be_made);
    RUN_TEST(test_several_add_up);
    RUN_TEST(test_bad_text);
    RUN_TEST(test_list);
    return UNITY_END();
}
