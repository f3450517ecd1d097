/* The errors of the papers' methods on a record (method_errors.h). */
#include "method_errors.h"

#include "params_host.h"

#include "iqfoc/mean_current.h"

#include <math.h>

const struct method_words method_words[METHOD_COUNT] = {
    [METHOD_MEAN_STANDARD] = {"mean", "standard"},
    [METHOD_MEAN_QUASI_DISCRETE] = {"mean", "quasi-discrete"},
    [METHOD_PREDICTION_STANDARD] = {"prediction", "standard"},
    [METHOD_PREDICTION_QUASI_DISCRETE] = {"prediction", "quasi-discrete"}};

bool method_machine_of(const motor *m, method_machine *machine, error *e)
{
    const per_unit base = per_unit_of(m);
    *machine = (method_machine){.in_double = {.R_ohm = m->R_ohm,
                                              .L_H = 0.5 * (m->L_d_H + m->L_q_H),
                                              .psi_f_Wb = m->psi_f_Wb,
                                              .T_s = base.T_s},
                                .I_base_A = base.I_A,
                                .U_base_V = base.U_V};
    return predictor_from_motor(m, &machine->in_iq24, e);
}

method_input method_input_of(const steady_drive *d, const drive_cycle *at)
{
    const method_input in = {at->i_valley_A, at->i_mid_A, at->u_V, at->theta_rad, d->omega_rad_s};
    return in;
}

double complex method_compute(method which, const method_machine *m, const method_input *in)
{
    const papers_machine *p = &m->in_double;
    switch (which) {
    case METHOD_MEAN_STANDARD:
        return in->i_mid_A;
    case METHOD_MEAN_QUASI_DISCRETE:
        return papers_mean_quasi_discrete(p, in->i_valley_A, in->u_V, in->theta_rad, in->omega_rad_s);
    case METHOD_PREDICTION_STANDARD:
        return papers_predict_euler(p, in->i_valley_A, in->u_V, in->theta_rad, in->omega_rad_s);
    case METHOD_PREDICTION_QUASI_DISCRETE:
        return papers_predict_quasi_discrete(p, in->i_valley_A, in->u_V, in->theta_rad, in->omega_rad_s);
    case METHOD_COUNT:
        break;
    }
    return NAN;
}

double complex method_compute_iq24(method which, const method_machine *m, const method_input *in)
{
    const double phi = in->omega_rad_s * m->in_double.T_s;
    const iqfoc_ab_t i = ab_from_complex(in->i_valley_A, m->I_base_A);
    const iqfoc_ab_t u = ab_from_complex(in->u_V, m->U_base_V);
    const iqfoc_rotor_t movement =
        iqfoc_rotor_from_speed(turns_from_speed(in->omega_rad_s, m->in_double.T_s));
    const iq24_sincos_t sc = iq24_sincos(turns_from_rad(in->theta_rad));
    const iq24_sincos_t sc_mid = iq24_sincos(turns_from_rad(in->theta_rad + 0.5 * phi));
    iqfoc_ab_t result = ab_from_complex(in->i_mid_A, m->I_base_A);
    switch (which) {
    case METHOD_MEAN_STANDARD:
        break;
    case METHOD_MEAN_QUASI_DISCRETE:
        result = iqfoc_mean_current_quasi_discrete(&m->in_iq24, i, u, &movement, sc_mid);
        break;
    case METHOD_PREDICTION_STANDARD:
        result = iqfoc_predictor_euler(&m->in_iq24, i, u, &movement, sc);
        break;
    case METHOD_PREDICTION_QUASI_DISCRETE:
        result = iqfoc_predictor_quasi_discrete(&m->in_iq24, i, u, &movement, sc_mid);
        break;
    case METHOD_COUNT:
        break;
    }
    return complex_from_ab(result, m->I_base_A);
}

double complex method_truth(method which, const drive_cycle *at)
{
    return which == METHOD_MEAN_STANDARD || which == METHOD_MEAN_QUASI_DISCRETE ? at->i_mean_A
                                                                                : at->i_next_valley_A;
}

void method_error_add(method_error *e, double complex computed, double complex fixed, double complex truth,
                      double base_A)
{
    e->rms_percent += vec_square(computed - truth);
    e->rms_percent_iq24 += vec_square(fixed - truth);
    e->peak_A = fmax(e->peak_A, fabs(creal(computed - truth)));
    e->peak_A_iq24 = fmax(e->peak_A_iq24, fabs(creal(fixed - truth)));
    e->iq24_off = fmax(e->iq24_off, cabs(fixed - computed) / base_A);
}

/* The rms of three phases without zero sequence is that of their vector over sqrt(2), above and below. */
void method_error_finish(method_error *e, double sum_current)
{
    e->rms_percent = 100.0 * sqrt(e->rms_percent / sum_current);
    e->rms_percent_iq24 = 100.0 * sqrt(e->rms_percent_iq24 / sum_current);
}

method_errors method_errors_of(const steady_drive *d, const method_machine *m)
{
    method_errors e = {.of = {{.rms_percent = 0.0}}};
    double sum_current = 0.0;
    for (size_t n = 0; n < d->count; n++) {
        const method_input in = method_input_of(d, &d->cycle[n]);
        for (int which = 0; which < METHOD_COUNT; which++) {
            method_error_add(&e.of[which], method_compute((method)which, m, &in),
                             method_compute_iq24((method)which, m, &in),
                             method_truth((method)which, &d->cycle[n]), m->I_base_A);
        }
        sum_current += vec_square(in.i_valley_A);
    }
    for (int which = 0; which < METHOD_COUNT; which++) {
        method_error_finish(&e.of[which], sum_current);
    }
    return e;
}
