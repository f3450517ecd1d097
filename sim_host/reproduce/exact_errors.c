/* The errors of the exact solution on a record (exact_errors.h). */
#include "exact_errors.h"

#include "model/exact.h"
#include "params_host.h"

#include "iqfoc/transform.h"

#include <math.h>

/* A machine in all the forms that are needed. */
typedef struct machine {
    papers_machine round;
    exact_salient salient;
    bool is_salient;
    per_unit base;
    iqfoc_exact_law_t end_law, mean_law;
    iqfoc_exact_t end, mean;
    iqfoc_salient_t end_dq, mean_dq;
    iq24_t speed;
} machine;

static bool machine_of(const motor *m, double omega_rad_s, machine *x, error *e)
{
    iqfoc_exact_winding_t winding;
    iqfoc_salient_machine_t in_fixed;
    if (!winding_from_motor(m, &winding, e) || !salient_from_motor(m, &in_fixed, e)) {
        return false;
    }
    x->base = per_unit_of(m);
    x->round = (papers_machine){m->R_ohm, m->L_d_H, m->psi_f_Wb, x->base.T_s};
    x->salient = (exact_salient){m->R_ohm, m->L_d_H, m->L_q_H, m->psi_f_Wb};
    x->is_salient = m->L_d_H != m->L_q_H;
    x->speed = turns_from_speed(omega_rad_s, x->base.T_s);
    x->end_law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    x->mean_law = iqfoc_exact_mean(&winding, IQ24_ONE);
    x->end = iqfoc_exact_at_speed(&x->end_law, x->speed);
    x->mean = iqfoc_exact_at_speed(&x->mean_law, x->speed);
    iqfoc_salient_at_speed(&in_fixed, x->speed, IQ24_ONE, &x->end_dq, &x->mean_dq);
    return true;
}

/* End and mean of a cycle; of a salient machine both as seen from the rotor, at the end and throughout. */
typedef struct cycle_currents {
    double complex end_A, mean_A;
} cycle_currents;

static cycle_currents in_double(const machine *x, const method_input *in)
{
    const double T_s = x->base.T_s;
    if (x->is_salient) {
        const double complex back = vec_turn(-in->theta_rad);
        const exact_span s =
            exact_salient_span(&x->salient, in->i_valley_A * back, in->u_V * back, T_s, in->omega_rad_s);
        return (cycle_currents){s.end_dq_A, s.mean_dq_A};
    }
    const double mid = in->theta_rad + 0.5 * in->omega_rad_s * T_s;
    return (cycle_currents){exact_predict(&x->round, in->i_valley_A, in->u_V, T_s, mid, in->omega_rad_s),
                            exact_mean(&x->round, in->i_valley_A, in->u_V, T_s, mid, in->omega_rad_s)};
}

static cycle_currents in_iq24(const machine *x, const method_input *in)
{
    const iqfoc_ab_t i = ab_from_complex(in->i_valley_A, x->base.I_A);
    const iqfoc_ab_t u = ab_from_complex(in->u_V, x->base.U_V);
    if (x->is_salient) {
        const iq24_sincos_t sc = iq24_sincos(turns_from_rad(in->theta_rad));
        const iqfoc_dq_t i_dq = iqfoc_park(i, sc);
        const iqfoc_dq_t u_dq = iqfoc_park(u, sc);
        return (cycle_currents){complex_from_dq(iqfoc_salient_step(&x->end_dq, i_dq, u_dq), x->base.I_A),
                                complex_from_dq(iqfoc_salient_step(&x->mean_dq, i_dq, u_dq), x->base.I_A)};
    }
    const iq24_sincos_t sc = iq24_sincos(turns_from_rad(in->theta_rad + 0.5 * in->omega_rad_s * x->base.T_s));
    return (cycle_currents){complex_from_ab(iqfoc_exact_step(&x->end, i, u, sc), x->base.I_A),
                            complex_from_ab(iqfoc_exact_step(&x->mean, i, u, sc), x->base.I_A)};
}

static cycle_currents truth(const machine *x, const steady_drive *d, const drive_cycle *at)
{
    if (x->is_salient) {
        const double end_rad = at->theta_rad + d->omega_rad_s * d->T_s;
        return (cycle_currents){at->i_next_valley_A * vec_turn(-end_rad), at->i_mean_dq_A};
    }
    return (cycle_currents){at->i_next_valley_A, at->i_mean_A};
}

bool exact_errors_of(const motor *m, const steady_drive *d, exact_errors *errors, error *e)
{
    machine x;
    if (!machine_of(m, d->omega_rad_s, &x, e)) {
        return false;
    }
    *errors = (exact_errors){0};
    double sum_current = 0.0;
    for (size_t n = 0; n < d->count; n++) {
        const method_input in = method_input_of(d, &d->cycle[n]);
        const cycle_currents computed = in_double(&x, &in);
        const cycle_currents fixed = in_iq24(&x, &in);
        const cycle_currents was = truth(&x, d, &d->cycle[n]);
        method_error_add(&errors->prediction, computed.end_A, fixed.end_A, was.end_A, x.base.I_A);
        method_error_add(&errors->mean, computed.mean_A, fixed.mean_A, was.mean_A, x.base.I_A);
        sum_current += vec_square(in.i_valley_A);
    }
    method_error_finish(&errors->prediction, sum_current);
    method_error_finish(&errors->mean, sum_current);
    return true;
}
