/* The drive of around_drive.h. */
#include "around_drive.h"

#include "../laboratory_motor.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static motor laboratory(double u_dc_V)
{
    motor m = laboratory_motor();
    m.u_dc_V = u_dc_V;
    return m;
}

plant_config around_plant(double u_dc_V)
{
    const motor m = laboratory(u_dc_V);
    plant_config truth = plant_config_from_motor(&m);
    truth.shaft.mode = PLANT_SHAFT_INERTIA;
    truth.shaft.J_kgm2 = 1e-3;
    truth.shaft.friction_Nms = 0.01;
    truth.sensors.current_bits = 12;
    truth.sensors.current_full_scale_A = 45.0;
    truth.sensors.current_noise_A = 0.03;
    return truth;
}

void around_begin_motor(around_drive *d, const motor *m, const plant_config *truth)
{
    error e = {0};
    memset(d, 0, sizeof *d);
    d->motor = *m;
    d->base = per_unit_of(m);
    TEST_ASSERT_TRUE_MESSAGE(plant_config_check(truth, &e), e.text);
    plant_init(&d->plant, truth);
}

void around_begin(around_drive *d, const plant_config *truth)
{
    const scenario_control control = {FEEDBACK_QUASI_DISCRETE_MEAN, MODULATION_PWM, 0.0, 1, ANGLE_MEASURED};
    const motor m = laboratory(truth->inverter.u_dc_V);
    error e = {0};
    around_begin_motor(d, &m, truth);
    TEST_ASSERT_TRUE_MESSAGE(config_from_motor(&d->motor, &control, &d->config, &e), e.text);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&d->cycle, &d->config));
}

iqfoc_sample_t around_valley(around_drive *d)
{
    plant_samples readings;
    if (d->plant.duration_s > 0.0) {
        plant_advance_to(&d->plant, d->base.T_s);
        const plant_means means = plant_mean(&d->plant);
        d->mean_dq_A[0] = means.i_dq_A.d;
        d->mean_dq_A[1] = means.i_dq_A.q;
    }
    plant_begin_cycle(&d->plant, d->duty);
    plant_sample(&d->plant, &readings);
    d->valley = d->truth = plant_now(&d->plant);
    return hal_host_sample(&readings, &d->plant.config.sensors, &d->base, 0);
}

void around_valley_handler(around_drive *d, const iqfoc_sample_t *sample)
{
    hal_host_interrupt(&d->hal, sample);
    iqfoc_isr_valley(&d->cycle, &d->hal);
}

iqfoc_sample_t around_peak(around_drive *d)
{
    plant_samples readings;
    plant_advance_to(&d->plant, 0.5 * d->base.T_s);
    plant_sample(&d->plant, &readings);
    d->truth = plant_now(&d->plant);
    return hal_host_sample(&readings, &d->plant.config.sensors, &d->base, IQ24(0.5));
}

void around_peak_handler(around_drive *d, const iqfoc_sample_t *sample)
{
    hal_host_interrupt(&d->hal, sample);
    iqfoc_isr_peak(&d->cycle, &d->hal);
    around_take_command(d);
}

void around_take_command(around_drive *d)
{
    const iqfoc_abc_t high = d->hal.command.duties.high;
    d->duty[0] = iq24_to_double(high.a);
    d->duty[1] = iq24_to_double(high.b);
    d->duty[2] = iq24_to_double(high.c);
}

double around_turns(const around_drive *d)
{
    return d->truth.theta_e_rad / VEC_TWO_PI;
}

double around_speed(const around_drive *d)
{
    return d->truth.omega_e_rad_s * d->base.T_s / VEC_TWO_PI;
}

double around_off(iq24_t theta, double turns)
{
    return remainder(iq24_to_double(theta) - turns, 1.0);
}

uint32_t around_encoder(const around_drive *d, uint32_t counts, double zero_turns)
{
    const double shaft = around_turns(d) / d->motor.pole_pairs - zero_turns;
    return (uint32_t)floor((shaft - floor(shaft)) * counts) % counts;
}
