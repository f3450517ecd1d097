/* Test segments of a recording (plan_pieces.h). */
#include "plan_pieces.h"

#include "base/vector.h"

#include <math.h>
#include <stdio.h>

/* Amplitude of the squares over the current limit: with another current, and without one. */
static const double SMALL = 0.12;
static const double LARGE = 0.5;
/* Their half periods in control cycles: long enough for the current to settle, and without a common divisor. */
enum { HALF_D = 23, HALF_Q = 37 };
/* Of the voltage in linear modulation. */
static const double VOLTAGE_SHARE = 0.9;

typedef struct list {
    const motor *motor;
    const plan_limits *limits;
    plan_piece *piece;
    size_t count;
} list;

/* The largest steady voltage of the four corners of a segment's currents, at its larger speed. */
static double voltage_of(const motor *m, const plan_piece *p)
{
    const double omega = motor_speed_rad_s(m, fmax(fabs(p->rpm[0]), fabs(p->rpm[1])));
    double L_d;
    double L_q;
    double most = 0.0;
    motor_inductances(m, &L_d, &L_q);
    for (int n = 0; n < 8; n++) {
        const double d = p->i_d_A[n & 1] + ((n & 2) != 0 ? p->square_d_A : -p->square_d_A);
        const double q = p->i_q_A[n & 1] + ((n & 4) != 0 ? p->square_q_A : -p->square_q_A);
        const double flux = hypot(L_d * d + m->psi_f_Wb, L_q * q);
        most = fmax(most, m->R_ohm * hypot(d, q) + omega * flux);
    }
    return most;
}

static void add(list *l, plan_piece p)
{
    const double current = hypot(fmax(fabs(p.i_d_A[0]), fabs(p.i_d_A[1])) + p.square_d_A,
                                 fmax(fabs(p.i_q_A[0]), fabs(p.i_q_A[1])) + p.square_q_A);
    p.half_d_cycles = HALF_D;
    p.half_q_cycles = HALF_Q;
    if (l->count < PLAN_PIECES && current <= l->limits->current_A * (1.0 + 1e-9) &&
        voltage_of(l->motor, &p) <= VOLTAGE_SHARE * l->limits->u_dc_V / sqrt(3.0)) {
        l->piece[l->count++] = p;
    }
}

/* A locked rotor in three positions, so that the phases take turns. */
static void add_standstill(list *l)
{
    const double I = l->limits->current_A;
    for (int n = 0; n < 3; n++) {
        const double theta = n * VEC_TWO_PI / 9.0;
        const double small = SMALL * I;
        add(l, (plan_piece){
                   .words = "standstill: pulses of i_d", .square_d_A = LARGE * I, .theta_e_rad = theta});
        add(l, (plan_piece){
                   .words = "standstill: pulses of i_q", .square_q_A = LARGE * I, .theta_e_rad = theta});
        add(l, (plan_piece){.words = "standstill: small pulses of both",
                            .square_d_A = small,
                            .square_q_A = small,
                            .theta_e_rad = theta});
        for (int sign = -1; sign <= 1; sign += 2) {
            const double level = sign * 0.7 * I;
            add(l, (plan_piece){.words = "standstill: steps at a level of i_d",
                                .i_d_A = {level, level},
                                .square_d_A = small,
                                .square_q_A = small,
                                .theta_e_rad = theta});
            add(l, (plan_piece){.words = "standstill: steps at a level of i_q",
                                .i_q_A = {level, level},
                                .square_d_A = small,
                                .square_q_A = small,
                                .theta_e_rad = theta});
        }
        add(l, (plan_piece){.words = "standstill: i_d through all levels",
                            .i_d_A = {-0.85 * I, 0.85 * I},
                            .square_q_A = small,
                            .theta_e_rad = theta});
    }
}

/* The speed that the voltage allows at 0.7 of the current limit, with a small reserve. */
static double speed_with_room(const motor *m, const plan_limits *limits)
{
    double L_d;
    double L_q;
    motor_inductances(m, &L_d, &L_q);
    const double flux = hypot(m->psi_f_Wb, L_q * 0.8 * limits->current_A);
    const double volts = 0.85 * limits->u_dc_V / sqrt(3.0) - m->R_ohm * limits->current_A;
    const double rpm = volts / fmax(flux, 1e-9) / motor_speed_rad_s(m, 1.0);
    return fmin(rpm, limits->speed_rpm);
}

static void add_steady(list *l)
{
    static const double speed[] = {0.08, 0.25, 0.55, 1.0};
    static const double level[][2] = {{0.0, 0.0}, {0.0, 0.35}, {0.0, 0.7}, {0.0, -0.5}, {-0.35, 0.5}};
    const double I = l->limits->current_A;
    const double rpm = speed_with_room(l->motor, l->limits);
    for (size_t s = 0; s < sizeof speed / sizeof *speed; s++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            for (size_t n = 0; n < sizeof level / sizeof *level; n++) {
                const double at = sign * speed[s] * rpm;
                const double d = level[n][0] * I;
                const double q = level[n][1] * I;
                add(l, (plan_piece){.words =
                                        n == 0 ? "speed: steps about no current" : "speed: steps at a level",
                                    .rpm = {at, at},
                                    .i_d_A = {d, d},
                                    .i_q_A = {q, q},
                                    .square_d_A = SMALL * I,
                                    .square_q_A = SMALL * I});
            }
        }
    }
}

static void add_ramps(list *l)
{
    const double I = l->limits->current_A;
    const double rpm = speed_with_room(l->motor, l->limits);
    for (int sign = -1; sign <= 1; sign += 2) {
        add(l, (plan_piece){.words = "run-up from standstill",
                            .rpm = {0.0, sign * rpm},
                            .i_q_A = {sign * 0.35 * I, sign * 0.35 * I},
                            .square_d_A = SMALL * I,
                            .square_q_A = SMALL * I});
        add(l, (plan_piece){.words = "reversal under load",
                            .rpm = {-sign * 0.6 * rpm, sign * 0.6 * rpm},
                            .i_q_A = {0.35 * I, 0.35 * I},
                            .square_d_A = SMALL * I,
                            .square_q_A = SMALL * I});
        add(l, (plan_piece){.words = "speed: i_q through all levels",
                            .rpm = {sign * 0.25 * rpm, sign * 0.25 * rpm},
                            .i_q_A = {-0.8 * I, 0.8 * I},
                            .square_d_A = SMALL * I});
    }
}

size_t plan_pieces_list(const motor *m, const plan_limits *limits, plan_piece piece[PLAN_PIECES])
{
    list l = {.motor = m, .limits = limits, .piece = piece};
    add_standstill(&l);
    add_steady(&l);
    add_ramps(&l);
    return l.count;
}

/* Three decimals and whole rpm are what a scenario shows. */
static double to_step(double x, double step)
{
    const double value = round(x / step) * step;
    return round(value * 1e6) / 1e6 + 0.0;
}

static profile course(const double value[2], double step, double amplitude, int half_cycles, double T_s,
                      double length_s)
{
    profile p = profile_constant(to_step(value[0], step));
    if (value[0] != value[1]) {
        p.points = 2;
        p.ramps = true;
        p.t_s[1] = length_s;
        p.value[1] = to_step(value[1], step);
    }
    if (amplitude > 0.0) {
        p.excitation = EXCITATION_SQUARE;
        p.amplitude = to_step(amplitude, step);
        p.period_s = 2.0 * half_cycles * T_s;
    }
    return p;
}

scenario_run plan_piece_run(const plan_piece *p, const motor *m, const plan_limits *limits, long cycles)
{
    const double T_s = 1.0 / m->f_pwm_Hz;
    const double length_s = (double)cycles * T_s;
    const scenario_run run = {.cycles = cycles,
                              .settle_cycles = PLAN_SETTLE_CYCLES,
                              .speed_rpm = course(p->rpm, 1.0, 0.0, 0, T_s, length_s),
                              .i_d_A = course(p->i_d_A, 1e-3, p->square_d_A, p->half_d_cycles, T_s, length_s),
                              .i_q_A = course(p->i_q_A, 1e-3, p->square_q_A, p->half_q_cycles, T_s, length_s),
                              .u_dc_V = limits->u_dc_V == m->u_dc_V ? 0.0 : limits->u_dc_V,
                              .theta_mech_start_rad = to_step(p->theta_e_rad / m->pole_pairs, 1e-4),
                              .load_Nm = profile_constant(0.0)};
    return run;
}

scenario plan_scenario(const plan_limits *limits, scenario_run *run, size_t runs)
{
    scenario s = {.sensors = {.current_bits = limits->bits,
                              .current_full_scale_A = limits->full_scale_A,
                              .current_noise_A = limits->noise_A},
                  .log = {.voltages = true, .duties = true, .u_dc = true, .third_current = true},
                  .runs = runs,
                  .run = run};
    (void)snprintf(s.name, sizeof s.name, "Planned recording");
    return s;
}
