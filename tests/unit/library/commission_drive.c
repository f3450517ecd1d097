/* The drives of commission_drive.h. */
#include "commission_drive.h"

#include "unity.h"

#include <math.h>
#include <string.h>

const char *const drawn_names[DRAWN_VALUES] = {"R", "v_dead", "L_d", "L_q", "psi", "o_a", "o_b", "o_c"};

static double between(plant_random *r, double low, double high)
{
    return low + (high - low) * plant_random_uniform(r);
}

static double between_log(plant_random *r, double low, double high)
{
    return low * pow(high / low, plant_random_uniform(r));
}

#define I_ALIGN 0.5
#define TURNS   0.01

/* Per unit: R 0.5 to 8 %, L as a drive of its frequency has it, L_q/L_d 1 (every other drive) to 3, an EMF of 40 % at 1/60 to 1/12 turn
 * per cycle. */
static motor drawn_motor(plant_random *r, uint64_t n)
{
    motor m = motor_blank();
    m.pole_pairs = 1 + (int)(5.0 * plant_random_uniform(r));
    m.I_rated_A_rms = between_log(r, 2.0, 60.0);
    m.u_dc_V = between_log(r, 24.0, 700.0);
    m.f_pwm_Hz = between(r, 4000.0, 8000.0);
    const per_unit base = per_unit_of(&m);
    m.R_ohm = between_log(r, 0.005, 0.08) * base.U_V / base.I_A;
    m.L_d_H = between_log(r, 0.3, 3.0) * base.U_V * base.T_s / base.I_A;
    m.L_q_H = m.L_d_H * (n % 2 == 0 ? 1.0 : between(r, 1.0, 3.0));
    const double least_Wb = 2.0 * (m.L_q_H - m.L_d_H) * I_ALIGN * base.I_A;
    m.psi_f_Wb = fmax(least_Wb, 0.4 / VEC_TWO_PI * between_log(r, 12.0, 60.0) * base.U_V * base.T_s);
    m.n_max_rpm = 0.25 / base.T_s * 60.0 / m.pole_pairs;
    return m;
}

/* A shaft that swings in the field of the alignment at 8 to 25 Hz, with friction that takes at most 0.3 of its torque at the final speed. */
static void draw_shaft(plant_config *c, plant_random *r, const motor *m, const per_unit *base)
{
    const double p = m->pole_pairs;
    const double torque_Nm = 1.5 * p * m->psi_f_Wb * I_ALIGN * base->I_A;
    const double swing_rad_s = VEC_TWO_PI * between(r, 8.0, 25.0);
    const double speed_rad_s = VEC_TWO_PI * TURNS / base->T_s / p;
    const double most = 0.3 * torque_Nm / speed_rad_s;
    c->shaft.mode = PLANT_SHAFT_INERTIA;
    c->shaft.J_kgm2 = p * torque_Nm / (swing_rad_s * swing_rad_s);
    c->shaft.friction_Nms = fmin(c->shaft.J_kgm2 * between(r, 4.0, 12.0), most);
    c->shaft.theta_mech_start_rad = VEC_TWO_PI * plant_random_uniform(r);
}

static void draw_sensors(plant_config *c, plant_random *r, const per_unit *base)
{
    c->inverter.t_dead_s = between(r, 0.5e-6, 2e-6);
    c->sensors.current_bits = 12;
    c->sensors.current_full_scale_A = 3.0 * base->I_A;
    c->sensors.current_noise_A = 0.005 * base->I_A;
    for (int x = 0; x < 3; x++) {
        c->sensors.current_offset_A[x] = between(r, -0.05, 0.05) * base->I_A;
    }
}

static void draw_config(iqfoc_commission_config_t *c, double f_pwm_Hz)
{
    const uint32_t ramp = (uint32_t)(0.3 * f_pwm_Hz);
    memset(c, 0, sizeof *c);
    c->offset.settle = 10;
    c->offset.count_log2 = 11;
    c->offset.offset_max = IQ24(0.25);
    c->offset.noise_max = IQ24(0.05);
    c->start.i_align = IQ24(I_ALIGN);
    c->start.ramp_cycles = ramp;
    c->start.hold_cycles = 3 * ramp;
    c->start.speed_end = IQ24(TURNS);
    c->start.run_up_cycles = 3 * ramp;
    c->i_max = IQ24(1.0);
    c->speed_max = IQ24(2.0 * TURNS);
    c->u_max = IQ24(0.4);
    c->cycles_max = 200000;
    c->settle_cycles = 1000;
    c->block_log2 = 7;
    c->half_log2 = 1;
    c->share_psi = IQ24(0.001);
}

void drawn_begin(drawn_drive *d, uint64_t seed, uint64_t n)
{
    plant_random r;
    error e = {0};
    memset(d, 0, sizeof *d);
    plant_random_seed(&r, seed, n);
    d->motor = drawn_motor(&r, n);
    d->base = per_unit_of(&d->motor);
    plant_config c = plant_config_from_motor(&d->motor);
    draw_sensors(&c, &r, &d->base);
    draw_shaft(&c, &r, &d->motor, &d->base);
    c.seed = seed + n;
    TEST_ASSERT_TRUE_MESSAGE(plant_config_check(&c, &e), e.text);
    plant_init(&d->plant, &c);
    draw_config(&d->config, d->motor.f_pwm_Hz);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_commission_init(&d->commission, &d->config));
    const double flux = d->base.U_V * d->base.T_s;
    d->truth[DRAWN_R] = c.machine.R_ohm * d->base.I_A / d->base.U_V;
    d->truth[DRAWN_V_DEAD] = c.inverter.t_dead_s / d->base.T_s;
    d->truth[DRAWN_L_D] = c.machine.L_d_H * d->base.I_A / flux;
    d->truth[DRAWN_L_Q] = c.machine.L_q_H * d->base.I_A / flux;
    d->truth[DRAWN_PSI] = c.machine.psi_f_Wb / flux;
    const iqfoc_abc_t half = {IQ24(0.5), IQ24(0.5), IQ24(0.5)};
    d->duties_next = half;
    for (int x = 0; x < 3; x++) {
        d->truth[DRAWN_O_A + x] = c.sensors.current_offset_A[x] / d->base.I_A;
    }
}

static void look(drawn_drive *d)
{
    const plant_point now = plant_now(&d->plant);
    for (int x = 0; x < 3; x++) {
        d->highest_A = fmax(d->highest_A, fabs(now.i_A[x]));
    }
    d->highest_rad_s = fmax(d->highest_rad_s, fabs(now.omega_e_rad_s));
}

void drawn_cycle(drawn_drive *d)
{
    plant_samples readings;
    const double duty[3] = {iq24_to_double(d->duties_next.a), iq24_to_double(d->duties_next.b),
                            iq24_to_double(d->duties_next.c)};
    d->duties = d->duties_next;
    plant_begin_cycle(&d->plant, duty);
    plant_sample(&d->plant, &readings);
    look(d);
    d->sample = hal_host_sample(&readings, &d->plant.config.sensors, &d->base, 0);
    d->command = iqfoc_commission_step(&d->commission, &d->sample);
    plant_advance_to(&d->plant, 0.5 * d->base.T_s);
    look(d);
    plant_advance_to(&d->plant, d->base.T_s);
    /* The plant has no gates: off is half, which makes no voltage either. */
    const iqfoc_abc_t half = {IQ24(0.5), IQ24(0.5), IQ24(0.5)};
    d->duties_next = d->command.gates ? d->command.duties.high : half;
}

void drawn_result(const drawn_drive *d, int k, double *value, double *half)
{
    const iqfoc_commission_result_t *x = &d->commission.result;
    const iqfoc_commission_value_t all[DRAWN_VALUES] = {x->r,
                                                        x->v_dead,
                                                        x->l_d,
                                                        x->l_q,
                                                        x->psi,
                                                        {x->i_offset.a, x->i_offset_half.a},
                                                        {x->i_offset.b, x->i_offset_half.b},
                                                        {x->i_offset.c, x->i_offset_half.c}};
    *value = iq24_to_double(all[k].value);
    *half = iq24_to_double(all[k].half);
}
