/* The duty of the watch's trials (watch_duty.h). */
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
    case WATCH_NOTHING:
    case WATCH_CHANGES:
    default:
        break;
    }
}

/* Of the voltage in linear modulation, so that steps have room. */
static const double VOLTAGE_SHARE = 0.75;
/* How far the speed goes beyond that at which this much voltage is reached at rated current. */
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

bool watch_duty_begin(watch_duty *w, const tune_result *r, uint64_t seed, error *e)
{
    const tune_machine machine = tune_machine_of_motor(&r->motor);
    const motor truth = tuned_motor(&r->motor, &machine);
    w->told = tuned_motor(&r->motor, &r->design.machine);
    motor *m = &w->told;
    plant_config c = plant_config_from_motor(&truth);
    w->I_A = motor_rated_peak_A(m);
    c.inverter.t_dead_s = WATCH_DEAD_S;
    c.sensors.current_noise_A = WATCH_NOISE * w->I_A;
    c.seed = seed;
    m->ext.has[CAUSE_DEAD_TIME] = true;
    m->ext.v_dead_V = m->u_dc_V * WATCH_DEAD_S * m->f_pwm_Hz;
    m->ext.i_knee_A = 0.02 * w->I_A;
    if (!plant_config_check(&c, e) || !tuned_drive_init(&w->firmware, m, &r->design, e) ||
        !tuned_drive_extend(&w->firmware, m, e)) {
        return false;
    }
    const tune_watch sure = {.noise_pu = WATCH_NOISE};
    const tune_watch known = r->region.noise_A > 0.0 ? tune_watch_of(r) : sure;
    tuned_drive_watch(&w->firmware, m, &r->design.machine, &known);
    w->calls = tuned_drive_firmware(&w->firmware);
    plant_random_seed(&w->random, seed, 7);
    drive_loop_begin(&w->loop, m, &c, &w->calls);
    w->design = r;
    w->omega_most = speed_most(r);
    w->omega = between(&w->random, -1.0, 1.0) * w->omega_most;
    w->speed_until = w->current_until = 0;
    plant_set_speed(&w->loop.drive, w->omega, 0.0);
    return true;
}

bool watch_duty_cycle(watch_duty *w, long n, drive_row *row, error *e)
{
    const double T_s = w->loop.base.T_s;
    if (n >= w->speed_until) {
        const double span_s = between(&w->random, 0.05, 0.15);
        const double next = between(&w->random, -1.0, 1.0) * w->omega_most;
        plant_set_speed(&w->loop.drive, w->omega, (next - w->omega) / span_s);
        w->speed_until = n + lround(span_s / T_s);
        w->omega += (next - w->omega) / span_s * (double)lround(span_s / T_s) * T_s;
    }
    if (n >= w->current_until) {
        w->i_d = between(&w->random, -0.4, 0.1);
        w->i_q = between(&w->random, -0.9, 0.9);
        w->current_until = n + lround(between(&w->random, 0.01, 0.05) / T_s);
    }
    const double omega = plant_now(&w->loop.drive).omega_e_rad_s;
    const iqfoc_dq_t i_ref = {iq24_from_double(fmin(w->i_d, weakened(w, omega))), iq24_from_double(w->i_q)};
    return drive_loop_span(&w->loop, i_ref, row, e);
}
