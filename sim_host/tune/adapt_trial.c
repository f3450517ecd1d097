/* Trial of the adaptation (adapt_trial.h). */
#include "adapt_trial.h"

#include "watch_duty.h"

#include "base/progress.h"

#include <math.h>

/* Relative error of the firmware's R and psi_f, in percent. */
static void look(const watch_duty *w, adapt_trial *out)
{
    const plant_machine *truth = &w->loop.drive.config.machine;
    const iqfoc_salient_machine_t *model = &w->firmware.config.law.machine;
    const iqfoc_salient_machine_t *has = &w->firmware.law.machine;
    const double r = (double)has->rho_q_q30 / (double)model->rho_q_q30 * w->model.R_ohm / truth->R_ohm - 1.0;
    /* A reluctance machine has no flux to be wrong about. */
    const double psi = truth->psi_f_Wb > 0.0 ? (double)has->k_psi_q_q27 / (double)model->k_psi_q_q27 *
                                                       w->model.psi_f_Wb / truth->psi_f_Wb -
                                                   1.0
                                             : 0.0;
    out->r_percent = 100.0 * r;
    out->psi_percent = 100.0 * psi;
    out->r_most_percent = fmax(out->r_most_percent, fabs(out->r_percent));
    out->psi_most_percent = fmax(out->psi_most_percent, fabs(out->psi_percent));
}

/* Both changes, to a share of what they come to. */
static void change_to(plant_machine *machine, const plant_machine *from, const plant_machine *to,
                      double share)
{
    machine->R_ohm = from->R_ohm + share * (to->R_ohm - from->R_ohm);
    machine->psi_f_Wb = from->psi_f_Wb + share * (to->psi_f_Wb - from->psi_f_Wb);
}

bool adapt_trial_run(const tune_result *r, bool adapted, double warming_s, double seconds, uint64_t seed,
                     adapt_trial *out, error *e)
{
    static const iqfoc_adapt_config_t usual = IQFOC_ADAPT_CONFIG;
    watch_duty w;
    drive_row row = {.run = 0};
    const long cycles = lround(seconds * r->motor.f_pwm_Hz);
    const double warming = fmax(1.0, warming_s * r->motor.f_pwm_Hz);
    const long judged = cycles - cycles / 4;
    double error_square = 0.0;
    double torque_square = 0.0;
    *out = (adapt_trial){.alarm = false};
    if (!watch_duty_begin(&w, r, WATCH_CONSTANT, seed, e)) {
        return false;
    }
    w.firmware.config.adapted = adapted ? 1 : 0;
    w.firmware.config.adapt = usual;
    plant_config changed = w.loop.drive.config;
    const plant_machine begun = changed.machine;
    watch_duty_change(&changed, WATCH_WINDING, 0);
    watch_duty_change(&changed, WATCH_MAGNET, 0);
    progress shown = progress_begin(adapted ? "watch: warming drive, adapted" : "watch: warming drive",
                                    (double)cycles, "cycles");
    bool ok = true;
    for (long n = 0; n < cycles && ok; n++) {
        change_to(&w.loop.drive.config.machine, &begun, &changed.machine, fmin(1.0, (double)n / warming));
        ok = watch_duty_cycle(&w, n, &row, e);
        if (n % IQFOC_WATCH_BLOCK_CYCLES == 0) {
            progress_update(&shown, (double)n);
        }
        if (n >= judged) {
            look(&w, out);
            const iqfoc_dq_t off = w.firmware.state.error;
            const double torque = out->psi_percent * row.truth.i_dq_A.q / w.I_A;
            error_square += pow(iq24_to_double(off.d), 2.0) + pow(iq24_to_double(off.q), 2.0);
            torque_square += torque * torque;
        }
    }
    progress_end(&shown);
    out->alarm = (row.answer.status & TUNED_FIRMWARE_ALARM) != 0;
    out->error_percent = 100.0 * sqrt(error_square / (double)(cycles - judged));
    out->torque_percent = sqrt(torque_square / (double)(cycles - judged));
    return ok;
}
