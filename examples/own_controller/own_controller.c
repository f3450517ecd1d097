/*
 * Your own current controller against the simulated drive, on the PC: replace controller() and see what it does.
 *
 *     own_controller MOTOR.toml [EFFECT...] > rec.csv
 *
 * EFFECT is one of `iqfoc simulate --list-effects`, say dead_time:t_dead=2e-6. Six operating points with small steps of the
 * references go to stdout as a recording that `iqfoc diagnose` reads. The true tracking error of each goes to stderr.
 */
#include "data/motor.h"
#include "plant/plant.h"
#include "plant/plant_effect.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define ROWS   1200 /* control cycles of an operating point */
#define SETTLE 300  /* more ahead of them, not recorded */

/* ---- Yours: what the controller keeps, and what it does once a cycle. ---- */

typedef struct controller_state {
    vec_dq integral; /* V */
} controller_state;

/*
 * A PI controller in the rotor frame, in double. It gets the samples of this valley and gives the duties that act from the
 * next valley on, so that its voltage is turned to the middle of that cycle: 1.5 T ahead.
 */
static void controller(controller_state *s, const motor *m, const plant_samples *in, vec_dq i_ref,
                       double duty[3])
{
    const double T_s = 1.0 / m->f_pwm_Hz;
    const double bandwidth_rad_s = 0.25 / T_s;
    const double omega = in->omega_e_rad_s;
    const vec_dq i = vec_to_dq(vec_from_phases(in->i_A), rotor_at(in->theta_e_rad));
    const vec_dq e = {i_ref.d - i.d, i_ref.q - i.q};
    s->integral.d += bandwidth_rad_s * m->R_ohm * T_s * e.d;
    s->integral.q += bandwidth_rad_s * m->R_ohm * T_s * e.q;
    const vec_dq u = {bandwidth_rad_s * m->L_d_H * e.d + s->integral.d - omega * m->L_q_H * i.q,
                      bandwidth_rad_s * m->L_q_H * e.q + s->integral.q +
                          omega * (m->L_d_H * i.d + m->psi_f_Wb)};
    double u_phase[3];
    vec_to_phases(vec_to_ab(u, rotor_at(in->theta_e_rad + 1.5 * omega * T_s)), u_phase);
    for (int x = 0; x < 3; x++) {
        duty[x] = fmin(fmax(0.5 + u_phase[x] / in->u_dc_V, 0.0), 1.0);
    }
}

/* ---- The bench: operating points, the loop, the recording. ---- */

typedef struct operating_point {
    double speed, i_d, i_q; /* of the top speed, and of the rated peak current */
} operating_point;

static const operating_point points[] = {{0.05, 0.0, 0.2},  {0.15, -0.2, 0.6}, {0.3, 0.0, -0.6},
                                         {-0.3, -0.3, 0.3}, {0.45, 0.1, 0.8},  {0.5, -0.3, 0.1}};

/* A step of +-5 % of the rated current every 40 cycles, by turns in d and q: what a diagnosis sees the inductances by. */
static vec_dq with_steps(vec_dq i, double size, int k)
{
    const int n = k / 40;
    const double step = (n & 2) != 0 ? size : -size;
    return (n & 1) != 0 ? (vec_dq){i.d + step, i.q} : (vec_dq){i.d, i.q + step};
}

static void print_row(int run, const plant_samples *in, const double duty[3])
{
    printf("%d,%.7f,%.4f,%.4f,%.4f,%.6f,%.3f,%.6f,%.6f,%.6f,%.3f\n", run, in->t_s, in->i_A[0], in->i_A[1],
           in->i_A[2], in->theta_e_rad, in->omega_e_rad_s, duty[0], duty[1], duty[2], in->u_dc_V);
}

/* The rms of reference less true mean current, A. */
static double run_point(plant *drive, const motor *m, int number)
{
    const operating_point *at = &points[number];
    const double rated_A = sqrt(2.0) * m->I_rated_A_rms;
    const vec_dq i_point = {at->i_d * rated_A, at->i_q * rated_A};
    controller_state state = {{0.0, 0.0}};
    double duty[3] = {0.5, 0.5, 0.5};
    double sum = 0.0;
    plant_set_speed(drive, at->speed * VEC_TWO_PI / 60.0 * m->n_max_rpm * m->pole_pairs, 0.0);
    for (int k = -SETTLE; k < ROWS; k++) {
        const vec_dq i_ref = with_steps(i_point, 0.05 * rated_A, k + SETTLE);
        plant_samples valley;
        plant_means mean;
        plant_cycle(drive, duty, &valley, NULL, &mean);
        if (k >= 0) {
            print_row(number + 1, &valley, duty);
            const double d = i_ref.d - mean.i_dq_A.d;
            const double q = i_ref.q - mean.i_dq_A.q;
            sum += d * d + q * q;
        }
        controller(&state, m, &valley, i_ref, duty);
    }
    return sqrt(sum / ROWS);
}

static bool run_all(const char *motor_file, int effects, char **effect, error *e)
{
    motor m;
    if (!motor_read(motor_file, &m, e)) {
        return false;
    }
    plant_config c = plant_config_from_motor(&m);
    c.sensors.current_bits = 12;
    c.sensors.current_full_scale_A = 3.0 * m.I_rated_A_rms;
    c.sensors.current_noise_A = 0.003 * m.I_rated_A_rms;
    for (int n = 0; n < effects; n++) {
        if (!plant_effect_apply(&c, effect[n], e)) {
            return false;
        }
    }
    if (!plant_config_check(&c, e)) {
        return false;
    }
    plant drive;
    plant_init(&drive, &c);
    puts("run,t_s,i_a_A,i_b_A,i_c_A,theta_e_rad,omega_e_rad_s,d_a,d_b,d_c,u_dc_V");
    for (int n = 0; n < (int)(sizeof points / sizeof points[0]); n++) {
        const double rms_A = run_point(&drive, &m, n);
        fprintf(stderr, "point %d: %4.0f %% of the top speed, rms tracking error %.3f A\n", n + 1,
                100.0 * points[n].speed, rms_A);
    }
    return true;
}

int main(int argc, char **argv)
{
    error e = {0};
    if (argc < 2) {
        fputs("usage: own_controller MOTOR.toml [EFFECT...] > rec.csv\n", stderr);
        return STATUS_UNUSABLE;
    }
    if (!run_all(argv[1], argc - 2, argv + 2, &e)) {
        error_print(&e);
        return e.status;
    }
    return STATUS_DONE;
}
