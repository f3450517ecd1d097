/* The duty of the change detector's trials (watch_duty.h). */
#include "watch_duty.h"

#include <math.h>

static double between(plant_random *r, double low, double high)
{
    return low + (high - low) * plant_random_uniform(r);
}

void watch_duty_change(plant_config *c, watch_change change, int phase)
{
    switch (change) {
    case WATCH_MAGNET:
        c->machine.psi_f_Wb *= 0.95;
        break;
    case WATCH_WINDING:
        c->machine.R_ohm *= 1.0 + 60.0 * 0.00393;
        break;
    case WATCH_SENSOR:
        c->sensors.current_gain[phase] *= 1.02;
        break;
    case WATCH_LEGS:
        c->inverter.t_dead_s *= 2.0;
        break;
    case WATCH_PHASE:
        c->machine.dR_ohm[phase] += 0.5 * c->machine.R_ohm;
        break;
    case WATCH_ROTOR:
        c->machine.eccentricity = 0.05;
        break;
    case WATCH_NOTHING:
    case WATCH_CHANGES:
    default:
        break;
    }
}

/* Of the voltage in linear modulation: a reserve for steps. */
static const double VOLTAGE_SHARE = 0.75;
/* Highest speed over the one that needs this voltage at rated current. */
static const double WEAKENED = 1.2;

static double speed_most(const tune_result *r)
{
    const double flux =
        hypot(r->design.machine.psi_f_Wb, r->design.machine.L_q_H * motor_rated_peak_A(&r->motor));
    const double omega = WEAKENED * VOLTAGE_SHARE * r->motor.u_dc_V / sqrt(3.0) / flux;
    return fmin(omega, motor_speed_rad_s(&r->motor, r->motor.n_max_rpm));
}

/* The i_d at which the voltage suffices at this speed and i_q, or more. */
static double weakened(const watch_duty *w, double omega)
{
    const tune_machine *machine = &w->design->design.machine;
    const double most = VOLTAGE_SHARE * w->design->motor.u_dc_V / sqrt(3.0) / fmax(fabs(omega), 1.0);
    const double flux_q = machine->L_q_H * w->i_q * w->I_A;
    const double flux_d = sqrt(fmax(most * most - flux_q * flux_q, 0.0));
    return (flux_d - machine->psi_f_Wb) / (machine->L_d_H * w->I_A);
}

/* The current at which an inductance that saturates has lost this share: L/(1 + (i/I_sat)^2). */
static double I_sat_of(double share, double I_A)
{
    return I_A / sqrt(1.0 / (1.0 - share) - 1.0);
}

/* Share of L that is lost at rated current. */
static double saturation_of(watch_condition condition)
{
    return condition == WATCH_SATURATION_3 ? 0.03 : condition == WATCH_SATURATION_10 ? 0.10 : 0.0;
}

static void set_condition(plant_config *c, watch_condition condition, double I_A)
{
    const double ripple = condition == WATCH_RIPPLE_1 ? 0.01 : condition == WATCH_RIPPLE_3 ? 0.03 : 0.0;
    const double saturation = saturation_of(condition);
    if (ripple > 0.0) {
        c->inverter.ripple_V = ripple * c->inverter.u_dc_V;
        c->inverter.ripple_Hz = 300.0;
        c->inverter.ripple_logged = true;
    }
    if (saturation > 0.0) {
        c->machine.I_sat_A = I_sat_of(saturation, I_A);
    }
}

/* Copper 0.393 % per K; an NdFeB magnet -0.11 % per K, at half of the winding's swing. */
static void swing_temperature(watch_duty *w, long n)
{
    const double kelvin = WATCH_SWING_K * sin(VEC_TWO_PI * (double)n * w->loop.base.T_s / WATCH_SWING_S);
    plant_machine *machine = &w->loop.drive.config.machine;
    machine->R_ohm = w->R_ohm * (1.0 + 0.00393 * kelvin);
    machine->psi_f_Wb = w->psi_f_Wb * (1.0 - 0.0011 * 0.5 * kelvin);
}

bool watch_duty_begin(watch_duty *w, const tune_result *r, watch_condition condition, uint64_t seed, error *e)
{
    const tune_machine machine = tune_machine_of_motor(&r->motor);
    const motor truth = tuned_motor(&r->motor, &machine);
    w->model = tuned_motor(&r->motor, &r->design.machine);
    motor *m = &w->model;
    plant_config c = plant_config_from_motor(&truth);
    w->I_A = motor_rated_peak_A(m);
    c.inverter.t_dead_s = WATCH_DEAD_S;
    c.sensors.current_noise_A = WATCH_NOISE * w->I_A;
    c.seed = seed;
    plant_config_extend(&c, &r->motor, CAUSE_SATURATION);
    plant_config_extend(&c, &r->motor, CAUSE_SATURATION_DQ);
    set_condition(&c, condition, w->I_A);
    w->condition = condition;
    w->R_ohm = c.machine.R_ohm;
    w->psi_f_Wb = c.machine.psi_f_Wb;
    m->ext.has[CAUSE_DEAD_TIME] = true;
    m->ext.v_dead_V = m->u_dc_V * WATCH_DEAD_S * m->f_pwm_Hz;
    m->ext.i_knee_A = 0.02 * w->I_A;
    if (!plant_config_check(&c, e) || !tuned_drive_init(&w->firmware, m, &r->design, e) ||
        !tuned_drive_extend(&w->firmware, m, e)) {
        return false;
    }
    const tune_watch sure = {.noise_pu = WATCH_NOISE, .L = tune_fall_of(&r->motor).flux};
    tune_watch known = r->region.noise_A > 0.0 ? tune_watch_of(r) : sure;
    known.L = fmax(known.L, saturation_of(condition));
    tuned_drive_watch(&w->firmware, m, &r->design.machine, &known);
    if (condition == WATCH_TEMPERATURE) {
        static const iqfoc_adapt_config_t usual = IQFOC_ADAPT_CONFIG;
        w->firmware.config.adapted = 1;
        w->firmware.config.adapt = usual;
    }
    w->calls = tuned_drive_firmware(&w->firmware);
    plant_random_seed(&w->random, seed, 7);
    drive_loop_begin(&w->loop, m, &c, &w->calls);
    w->design = r;
    w->omega_most = speed_most(r);
    w->omega = between(&w->random, -1.0, 1.0) * w->omega_most;
    w->speed_until = w->current_until = 0;
    w->i_d = w->i_q = 0.0;
    plant_set_speed(&w->loop.drive, w->omega, 0.0);
    return true;
}

/* A load step moves the speed by a tenth at most, in 20 to 50 ms. */
static double next_speed(watch_duty *w, double *span_s)
{
    if (w->condition == WATCH_LOAD_STEPS) {
        *span_s = between(&w->random, 0.02, 0.05);
        const double next = w->omega + between(&w->random, -0.1, 0.1) * w->omega_most;
        return fmax(fmin(next, w->omega_most), -w->omega_most);
    }
    *span_s = between(&w->random, 0.05, 0.15);
    return between(&w->random, -1.0, 1.0) * w->omega_most;
}

static void next_current(watch_duty *w, long n)
{
    const double T_s = w->loop.base.T_s;
    w->i_d = between(&w->random, -0.4, 0.1);
    if (w->condition == WATCH_LOAD_STEPS) {
        w->i_q = w->i_q > 0.0 ? -0.9 : 0.9;
        w->current_until = n + lround(between(&w->random, 0.003, 0.02) / T_s);
    } else {
        w->i_q = between(&w->random, -0.9, 0.9);
        w->current_until = n + lround(between(&w->random, 0.01, 0.05) / T_s);
    }
}

bool watch_duty_cycle(watch_duty *w, long n, drive_row *row, error *e)
{
    const double T_s = w->loop.base.T_s;
    if (w->condition == WATCH_TEMPERATURE && n % 256 == 0) {
        swing_temperature(w, n);
    }
    if (n >= w->speed_until) {
        double span_s = 0.0;
        const double next = next_speed(w, &span_s);
        plant_set_speed(&w->loop.drive, w->omega, (next - w->omega) / span_s);
        w->speed_until = n + lround(span_s / T_s);
        w->omega += (next - w->omega) / span_s * (double)lround(span_s / T_s) * T_s;
    }
    if (n >= w->current_until) {
        next_current(w, n);
    }
    const double omega = plant_now(&w->loop.drive).omega_e_rad_s;
    const iqfoc_dq_t i_ref = {iq24_from_double(fmin(w->i_d, weakened(w, omega))), iq24_from_double(w->i_q)};
    return drive_loop_span(&w->loop, i_ref, row, e);
}
