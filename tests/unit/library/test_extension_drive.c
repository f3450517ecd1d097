/*
 * The corrections in a closed loop with the switching-level drive. With the value of an effect in the firmware,
 * prediction and true current return to their values without the effect.
 */
#include "../laboratory_motor.h"
#include "drive/drive_run.h"
#include "drive/firmware_host.h"
#include "extension_host.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a run came to, rms: the true dq current off its reference, and the prediction off the next sample. */
typedef struct score {
    double current_A, prediction_A;
} score;

typedef struct watch {
    const drive_host *drive;
    double i_d_A, i_q_A, base_A;
    double current, prediction;
    long rows;
} watch;

void setUp(void)
{
}

void tearDown(void)
{
}

static bool look(void *context, const drive_row *row, error *e)
{
    watch *w = context;
    (void)e;
    const double d = row->truth.i_dq_A.d - w->i_d_A;
    const double q = row->truth.i_dq_A.q - w->i_q_A;
    const iqfoc_ab_t off = w->drive->cycle.error;
    w->current += d * d + q * q;
    w->prediction += w->base_A * w->base_A *
                     (iq24_to_double(off.alpha) * iq24_to_double(off.alpha) +
                      iq24_to_double(off.beta) * iq24_to_double(off.beta));
    w->rows++;
    return true;
}

static score run(const plant_config *truth, const motor *corrected)
{
    static drive_host drive;
    iqfoc_extension_t extension;
    const motor m = laboratory_motor();
    error e = {0};
    iqfoc_cycle_config_t config;
    const scenario_control control = {FEEDBACK_QUASI_DISCRETE_MEAN, MODULATION_PWM, 0.0, 1, ANGLE_MEASURED};
    scenario_run r = {.cycles = 1500, .settle_cycles = 1500, .shaft = SHAFT_GIVEN};
    uint32_t status = 0;
    watch w = {.drive = &drive, .i_d_A = -3.0, .i_q_A = 8.0, .base_A = per_unit_of(&m).I_A};
    const drive_firmware firmware = drive_firmware_host(&drive, &extension);
    const drive_log log = {&w, look};
    r.speed_rpm = profile_constant(700.0);
    r.i_d_A = profile_constant(w.i_d_A);
    r.i_q_A = profile_constant(w.i_q_A);
    r.load_Nm = profile_constant(0.0);
    TEST_ASSERT_TRUE_MESSAGE(extension_from_motor(corrected, &extension, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(config_from_motor(&m, &control, &config, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(drive_run(&m, truth, &r, 1, &config, &firmware, &log, &status, &e), e.text);
    const score s = {sqrt(w.current / (double)w.rows), sqrt(w.prediction / (double)w.rows)};
    return s;
}

/*
 * `improves`: at least so many times better; half of what was seen.
 */
static void check(const char *what, const plant_config *truth, const motor *found, double current_improves,
                  double prediction_improves)
{
    const motor nothing = laboratory_motor();
    const score before = run(truth, &nothing);
    const score after = run(truth, found);
    printf("  %-16s current off by %.4f A, corrected %.4f A; prediction by %.4f A, corrected %.4f A\n", what,
           before.current_A, after.current_A, before.prediction_A, after.prediction_A);
    TEST_ASSERT_TRUE_MESSAGE(before.current_A > current_improves * after.current_A, what);
    TEST_ASSERT_TRUE_MESSAGE(before.prediction_A > prediction_improves * after.prediction_A, what);
}

static void test_dead_time(void)
{
    motor m = laboratory_motor();
    plant_config truth = plant_config_from_motor(&m);
    truth.inverter.t_dead_s = 2e-6;
    m.ext.has[CAUSE_DEAD_TIME] = true;
    m.ext.v_dead_V = 2e-6 * 750.0 * 5000.0;
    m.ext.i_knee_A = 0.5;
    check("dead time", &truth, &m, 4.5, 6.5);
}

static void test_sensors(void)
{
    motor m = laboratory_motor();
    plant_config truth = plant_config_from_motor(&m);
    const double g[3] = {1.05, 0.97, 1.0};
    const double o[3] = {0.4, -0.1, -0.3};
    m.ext.has[CAUSE_CURRENT_GAIN] = m.ext.has[CAUSE_CURRENT_OFFSET] = true;
    memcpy(m.ext.g, g, sizeof g);
    memcpy(m.ext.o_A, o, sizeof o);
    memcpy(truth.sensors.current_gain, g, sizeof g);
    memcpy(truth.sensors.current_offset_A, o, sizeof o);
    check("current sensors", &truth, &m, 80.0, 1.4);
}

static void test_angle(void)
{
    motor m = laboratory_motor();
    plant_config truth = plant_config_from_motor(&m);
    m.ext.has[CAUSE_ANGLE_OFFSET] = m.ext.has[CAUSE_ANGLE_DELAY] = true;
    m.ext.theta_0_rad = truth.sensors.theta_0_rad = 0.06;
    m.ext.t_delay_s = truth.sensors.t_delay_s = 5e-5;
    check("angle", &truth, &m, 120.0, 6.5);
}

static void test_link(void)
{
    motor m = laboratory_motor();
    plant_config truth = plant_config_from_motor(&m);
    m.ext.has[CAUSE_VOLTAGE_GAIN] = true;
    m.ext.k_u = truth.inverter.k_u = 0.93;
    check("DC link", &truth, &m, 9.0, 8.5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_dead_time);
    RUN_TEST(test_sensors);
    RUN_TEST(test_angle);
    RUN_TEST(test_link);
    return UNITY_END();
}
