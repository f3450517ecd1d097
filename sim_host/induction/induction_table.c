/* The induction machine's table (induction_table.h). */
#include "induction_table.h"

#include "base/json_file.h"
#include "induction_model.h"
#include "model/papers.h"
#include "model/pwm_cycle.h"
#include "per_unit.h"

#include "iqfoc/induction.h"

#include <stdio.h>
#include <string.h>

/* T circuit, rotor seen from the stator. */
#define R_S_OHM        0.10
#define R_ROTOR_OHM    0.075
#define L_LEAK_S_H     1.3e-3
#define L_LEAK_R_H     1.3e-3
#define L_MAGNETISE_H  27e-3
#define I_RATED_A      (1.4142135623730951 * 220.0) /* peak */
#define I_D_RATED_A    90.0
#define U_DC_V         1500.0
#define F_PWM_HZ       500.0
#define T_S            (1.0 / F_PWM_HZ)
#define INDEX_MOST     0.95
#define CYCLES         500
#define CYCLES_SETTLED 6000 /* 30 time constants of the rotor's flux */

const double induction_table_Hz[INDUCTION_POINTS] = {2.5, 10.0, 25.0, 50.0, 80.0, 120.0};

/* The voltage at mid-cycle that makes this point, held over each cycle. */
static double complex held_voltage(const induction_point *p, double omega_rad_s)
{
    return p->u_dq_V / papers_s1((omega_rad_s + p->omega_slip_rad_s) * T_S);
}

/* Rated current; of it, as much makes flux as the rated flux needs and the DC link allows. */
static double complex current_at(const induction_machine *m, double omega_rad_s)
{
    double low = 0.1 * I_D_RATED_A;
    double high = I_D_RATED_A;
    for (int n = 0; n < 60; n++) {
        const double i_d = n == 0 ? high : 0.5 * (low + high);
        const induction_point p =
            induction_steady(m, vec_complex(i_d, sqrt(I_RATED_A * I_RATED_A - i_d * i_d)), omega_rad_s);
        const bool fits = cabs(held_voltage(&p, omega_rad_s)) <= INDEX_MOST * U_DC_V / sqrt(3.0);
        if (n == 0 && fits) {
            return vec_complex(high, sqrt(I_RATED_A * I_RATED_A - high * high));
        }
        if (n > 0) {
            low = fits ? i_d : low;
            high = fits ? high : i_d;
        }
    }
    return vec_complex(low, sqrt(I_RATED_A * I_RATED_A - low * low));
}

/* The drive, its truth and the observers of flux that run along. */
typedef struct drive {
    induction_machine machine;
    double omega_rad_s, omega_s_rad_s;
    double complex u_dq_V;
    double theta_rad; /* of the voltage's frame */
    induction_state x;
    double complex psi_Wb; /* observed */
    iqfoc_induction_t fixed;
    iqfoc_ab_t flux;        /* observed in fixed point, per unit */
    iqfoc_ab_t flux_pulses; /* the same, the ripple counted */
} drive;

static drive drive_at(const induction_machine *m, double omega_rad_s, double complex i_dq_A)
{
    const induction_point p = induction_steady(m, i_dq_A, omega_rad_s);
    drive d = {.machine = *m, .omega_rad_s = omega_rad_s, .omega_s_rad_s = omega_rad_s + p.omega_slip_rad_s};
    d.u_dq_V = held_voltage(&p, omega_rad_s);
    d.x = (induction_state){i_dq_A, p.psi_Wb};
    const iqfoc_induction_machine_t in_fixed = {
        .rho_s_q30 = (int32_t)lround(ldexp(m->R_s_ohm * T_S / m->L_sigma_H, 30)),
        .rho_r_q30 = (int32_t)lround(ldexp(m->R_r_ohm * T_S / m->L_sigma_H, 30)),
        .a_q30 = (int32_t)lround(ldexp(m->R_r_ohm * T_S / m->L_m_H, 30)),
        .k_u_q26 = (int32_t)lround(ldexp(T_S * U_DC_V / (m->L_sigma_H * I_RATED_A), 26))};
    d.fixed = iqfoc_induction_at_speed(&in_fixed, turns_from_speed(omega_rad_s, T_S), IQ24_ONE);
    return d;
}

/* Sums of squares. */
typedef struct sums {
    double current, mean_standard, mean_quasi, mean_exact, mean_iq24;
    double next_euler, next_quasi, next_exact, next_iq24;
    double mean_pulses, next_pulses;
} sums;

/* The firmware's exact prediction and mean with the pulses' ripple, from its own flux; moves that flux on. */
static void advance_with_pulses(drive *d, sums *s, const double duty[3], iqfoc_ab_t i, iqfoc_ab_t u,
                                const induction_cycle *truth)
{
    const iqfoc_abc_t high = {iq24_from_double(duty[0]), iq24_from_double(duty[1]),
                              iq24_from_double(duty[2])};
    const iqfoc_ab_t v = iqfoc_ripple_vector(high, 0, IQ24_ONE);
    const iqfoc_induction_state_t x = {i, d->flux_pulses};
    const iqfoc_induction_state_t even = iqfoc_induction_step(&d->fixed, x, u);
    const iqfoc_ab_t next = iqfoc_induction_with_ripple(&d->fixed.i, even.i, v);
    const iqfoc_ab_t mean =
        iqfoc_induction_with_ripple(&d->fixed.i_mean, iqfoc_induction_mean(&d->fixed, x, u), v);
    s->next_pulses += vec_square(complex_from_ab(next, I_RATED_A) - truth->whole.end.i_A);
    s->mean_pulses += vec_square(complex_from_ab(mean, I_RATED_A) - truth->whole.i_mean_A);
    d->flux_pulses = iqfoc_induction_with_ripple(&d->fixed.flux, even.flux, v);
}

static void advance(drive *d, sums *s)
{
    const double phi = d->omega_s_rad_s * T_S;
    const double complex u = d->u_dq_V * vec_turn(d->theta_rad + 0.5 * phi);
    double duty[3];
    pwm_duties(u, U_DC_V, duty);
    const double complex i = d->x.i_A;
    const induction_cycle truth = induction_pwm(&d->machine, d->x, duty, U_DC_V, T_S, d->omega_rad_s);

    const induction_state seen = {i, d->psi_Wb};
    const induction_span exact = induction_advance(&d->machine, seen, u, T_S, d->omega_rad_s);
    const iqfoc_induction_state_t fixed = {ab_from_complex(i, I_RATED_A), d->flux};
    const iqfoc_ab_t u_fixed = ab_from_complex(u, U_DC_V);
    const iqfoc_induction_state_t next = iqfoc_induction_step(&d->fixed, fixed, u_fixed);
    const iqfoc_ab_t mean = iqfoc_induction_mean(&d->fixed, fixed, u_fixed);

    /* The papers' formulas: flux, its angle and its speed in the place of the magnet's. */
    const papers_machine papers = {d->machine.R_s_ohm, d->machine.L_sigma_H, cabs(d->psi_Wb), T_S};
    const double angle = carg(d->psi_Wb);
    const double complex end_A = truth.whole.end.i_A;
    const double complex mean_A = truth.whole.i_mean_A;
    s->current += vec_square(i);
    s->mean_standard += vec_square(truth.i_mid_A - mean_A);
    s->mean_quasi += vec_square(papers_mean_quasi_discrete(&papers, i, u, angle, d->omega_s_rad_s) - mean_A);
    s->mean_exact += vec_square(exact.i_mean_A - mean_A);
    s->mean_iq24 += vec_square(complex_from_ab(mean, I_RATED_A) - mean_A);
    s->next_euler += vec_square(papers_predict_euler(&papers, i, u, angle, d->omega_s_rad_s) - end_A);
    s->next_quasi +=
        vec_square(papers_predict_quasi_discrete(&papers, i, u, angle, d->omega_s_rad_s) - end_A);
    s->next_exact += vec_square(exact.end.i_A - end_A);
    s->next_iq24 += vec_square(complex_from_ab(next.i, I_RATED_A) - end_A);

    advance_with_pulses(d, s, duty, fixed.i, u_fixed, &truth);
    d->psi_Wb = exact.end.psi_Wb;
    d->flux = next.flux;
    d->x = truth.whole.end;
    d->theta_rad = remainder(d->theta_rad + phi, VEC_TWO_PI);
}

static double percent(double sum, const sums *s)
{
    return 100.0 * sqrt(sum / s->current);
}

bool induction_errors_at(double f_rotor_Hz, induction_errors *at, error *e)
{
    const induction_machine m =
        induction_from_t_circuit(R_S_OHM, R_ROTOR_OHM, L_LEAK_S_H, L_LEAK_R_H, L_MAGNETISE_H);
    const double omega = VEC_TWO_PI * f_rotor_Hz;
    const double complex i_dq = current_at(&m, omega);
    drive d = drive_at(&m, omega, i_dq);
    const double f_stator_Hz = d.omega_s_rad_s / VEC_TWO_PI;
    if (!(3.0 * fabs(f_stator_Hz) <= F_PWM_HZ)) {
        return error_input(
            e, NULL, 0, 0,
            "induction machine: %g Hz at the rotor is %.3g Hz at the stator; expected at most a third of "
            "the %g Hz that it switches at",
            f_rotor_Hz, f_stator_Hz, F_PWM_HZ);
    }
    sums s = {0};
    for (int n = 0; n < CYCLES_SETTLED; n++) {
        advance(&d, &s);
    }
    s = (sums){0};
    for (int n = 0; n < CYCLES; n++) {
        advance(&d, &s);
    }
    *at = (induction_errors){.f_stator_Hz = f_stator_Hz,
                             .sffr = F_PWM_HZ / fabs(f_stator_Hz),
                             .i_d_A = creal(i_dq),
                             .i_q_A = cimag(i_dq),
                             .psi_Wb = m.L_m_H * creal(i_dq),
                             .slip_Hz = f_stator_Hz - f_rotor_Hz,
                             .modulation_index = cabs(d.u_dq_V) * sqrt(3.0) / U_DC_V,
                             .mean_standard = percent(s.mean_standard, &s),
                             .mean_quasi_discrete = percent(s.mean_quasi, &s),
                             .mean_exact = percent(s.mean_exact, &s),
                             .prediction_standard = percent(s.next_euler, &s),
                             .prediction_quasi_discrete = percent(s.next_quasi, &s),
                             .prediction_exact = percent(s.next_exact, &s),
                             .mean_exact_iq24 = percent(s.mean_iq24, &s),
                             .prediction_exact_iq24 = percent(s.next_iq24, &s),
                             .mean_pulses_iq24 = percent(s.mean_pulses, &s),
                             .prediction_pulses_iq24 = percent(s.next_pulses, &s)};
    return true;
}

static json_t *table_json(const induction_errors points[INDUCTION_POINTS])
{
    json_t *list = json_array();
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        const induction_errors *p = &points[n];
        json_array_append_new(
            list,
            json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:{s:f, s:f, s:f}, s:{s:f, s:f, s:f}, s:{s:f, "
                      "s:f, s:f, s:f}}",
                      "f_stator_Hz", p->f_stator_Hz, "sffr", p->sffr, "i_d_A", p->i_d_A, "i_q_A", p->i_q_A,
                      "psi_Wb", p->psi_Wb, "slip_Hz", p->slip_Hz, "modulation_index", p->modulation_index,
                      "mean", "standard", p->mean_standard, "quasi_discrete", p->mean_quasi_discrete, "exact",
                      p->mean_exact, "prediction", "standard", p->prediction_standard, "quasi_discrete",
                      p->prediction_quasi_discrete, "exact", p->prediction_exact, "iq24", "mean",
                      p->mean_exact_iq24, "prediction", p->prediction_exact_iq24, "mean_with_ripple",
                      p->mean_pulses_iq24, "prediction_with_ripple", p->prediction_pulses_iq24));
    }
    return json_pack("{s:{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}, s:o}", "machine", "R_s_ohm", R_S_OHM,
                     "R_rotor_ohm", R_ROTOR_OHM, "L_leak_s_H", L_LEAK_S_H, "L_leak_r_H", L_LEAK_R_H,
                     "L_magnetising_H", L_MAGNETISE_H, "I_rated_A_peak", I_RATED_A, "u_dc_V", U_DC_V,
                     "f_pwm_Hz", F_PWM_HZ, "points", list);
}

static void print_table(const induction_errors points[INDUCTION_POINTS])
{
    static const char *const columns[2] = {"mean", "prediction"};
    printf("Traction induction machine, rated current, 500 Hz switching; errors in percent of the rms "
           "current\n");
    printf("%10s  %8s  %8s", "", "", "");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s  %12s", columns[k], columns[k], columns[k], columns[k]);
    }
    printf("\n%10s  %8s  %8s", "stator Hz", "SFFR", "psi Wb");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s  %12s", "standard", "quasi-discrete", "exact", "with ripple");
    }
    putchar('\n');
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        const induction_errors *p = &points[n];
        printf("%10.4g  %8.4g  %8.3g", p->f_stator_Hz, p->sffr, p->psi_Wb);
        printf("  %10.4g  %14.4g  %10.4g  %12.4g", p->mean_standard, p->mean_quasi_discrete, p->mean_exact,
               p->mean_pulses_iq24);
        printf("  %10.4g  %14.4g  %10.4g  %12.4g\n", p->prediction_standard, p->prediction_quasi_discrete,
               p->prediction_exact, p->prediction_pulses_iq24);
    }
}

bool induction_table(const char *json_path, error *e)
{
    induction_errors points[INDUCTION_POINTS];
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        if (!induction_errors_at(induction_table_Hz[n], &points[n], e)) {
            return false;
        }
    }
    if (json_path != NULL) {
        json_t *root = table_json(points);
        const bool ok = json_file_write(json_path, root, e);
        json_free(root);
        if (!ok) {
            return false;
        }
    }
    if (json_path == NULL || strcmp(json_path, "-") != 0) {
        print_table(points);
    }
    return true;
}
