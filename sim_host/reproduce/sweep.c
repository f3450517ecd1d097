/* One point of the errors over speed (sweep.h). */
#include "sweep.h"

#include "base/json_file.h"

#include <math.h>

/* Cycles of a record: several beats of carrier and fundamental at any ratio above 3. */
enum { CYCLES = 600 };

/* So many DC links and peak rated currents the firmware's range allows (predictor.h: u <= 2, i <= 32). */
static const double link_max_pu = 3.0;
static const double current_max_pu = 16.0;

bool sweep_point_at(const motor *m, const method_machine *machine, double n_rpm, double complex i_mid_dq_A,
                    sweep_point *point, error *e)
{
    const double turns = fabs(n_rpm) / 60.0 * m->pole_pairs / m->f_pwm_Hz;
    const double sffr = turns > 0.0 ? 1.0 / turns : INFINITY;
    if (sffr < SWEEP_SFFR_MIN * (1.0 - 1e-12)) {
        return error_input(e, m->path, 0, 0,
                           "%g rpm is %.3g switching periods a revolution; expected at least %g (%.6g rpm)",
                           n_rpm, sffr, SWEEP_SFFR_MIN, m->f_pwm_Hz / SWEEP_SFFR_MIN * 60.0 / m->pole_pairs);
    }
    if (cabs(i_mid_dq_A) > current_max_pu * machine->I_base_A) {
        return error_input(e, m->path, 0, 0,
                           "%.4g A rms is more than %g times the rated %.4g A rms, the most expected",
                           cabs(i_mid_dq_A) / sqrt(2.0), current_max_pu, m->I_rated_A_rms);
    }
    steady_drive d;
    if (!steady_drive_run(m, n_rpm, i_mid_dq_A, CYCLES, &d, e)) {
        return false;
    }
    bool ok = true;
    if (d.u_dc_V > link_max_pu * m->u_dc_V) {
        ok = error_input(e, m->path, 0, 0,
                         "%g rpm with this current needs a DC link of %.4g V; expected at most %g times the "
                         "motor file's %g V",
                         n_rpm, d.u_dc_V, link_max_pu, m->u_dc_V);
    } else {
        *point = (sweep_point){.n_rpm = n_rpm,
                               .sffr = sffr,
                               .i_mid_dq_A = i_mid_dq_A,
                               .u_dc_V = d.u_dc_V,
                               .link_raised = d.link_raised,
                               .errors = method_errors_of(&d, machine)};
        ok = exact_errors_of(m, &d, &point->exact, e);
    }
    steady_drive_free(&d);
    return ok;
}

static json_t *errors_json(const sweep_point *p, bool prediction, bool iq24)
{
    const method_error *a = &p->errors.of[prediction ? METHOD_PREDICTION_STANDARD : METHOD_MEAN_STANDARD];
    const method_error *const all[3] = {a, a + 1, prediction ? &p->exact.prediction : &p->exact.mean};
    double rms[3];
    for (int n = 0; n < 3; n++) {
        rms[n] = iq24 ? all[n]->rms_percent_iq24 : all[n]->rms_percent;
    }
    return json_pack("{s:f, s:f, s:f}", "standard", rms[0], "quasi_discrete", rms[1], "exact", rms[2]);
}

json_t *sweep_point_json(const sweep_point *p)
{
    return json_pack("{s:f, s:o, s:o, s:o, s:{s:o, s:o}, s:f, s:f, s:f, s:b}", "rpm", p->n_rpm, "sffr",
                     json_number(p->sffr), "mean", errors_json(p, false, false), "prediction",
                     errors_json(p, true, false), "iq24", "mean", errors_json(p, false, true), "prediction",
                     errors_json(p, true, true), "i_d_A", creal(p->i_mid_dq_A), "i_q_A", cimag(p->i_mid_dq_A),
                     "u_dc_V", p->u_dc_V, "u_dc_raised", (int)p->link_raised);
}
