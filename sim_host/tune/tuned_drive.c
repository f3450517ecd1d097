/* The tuned controller as firmware (tuned_drive.h). */
#include "tuned_drive.h"

#include "extension_host.h"
#include "params_host.h"

#include <math.h>

motor tuned_motor(const motor *m, const tune_machine *machine)
{
    motor made = *m;
    const motor blank = motor_blank();
    made.ext = blank.ext;
    made.R_ohm = machine->R_ohm;
    made.L_d_H = machine->L_d_H;
    made.L_q_H = machine->L_q_H;
    made.psi_f_Wb = machine->psi_f_Wb;
    return made;
}

/*
 * The controller's constants of a design for a motor's bases. False if a value does not fit the library's ranges; *e
 * then names the motor file and the key.
 */
static bool law_of(const motor *m, const tune_design *design, iqfoc_tuned_law_t *law, error *e)
{
    const motor believed = tuned_motor(m, &design->machine);
    iqfoc_tuned_law_t made = {.keep = iq24_from_double(design->keep),
                              .follow = iq24_from_double(design->follow),
                              .learn = iq24_from_double(design->learn),
                              .learn_offset = iq24_from_double(design->learn_offset)};
    if (!salient_from_motor(&believed, &made.machine, e)) {
        return false;
    }
    const int32_t least =
        made.machine.k_d_q26 < made.machine.k_q_q26 ? made.machine.k_d_q26 : made.machine.k_q_q26;
    if (least < IQFOC_TUNED_K_LEAST_Q26) {
        return motor_refuse(
            m->path, "f_pwm_Hz", e,
            "f_pwm_Hz gives T U_b/(L I_b) = %.3g; expected 1/16 to 16, which needs f_pwm_Hz = %.6g",
            ldexp(least, -26), m->f_pwm_Hz * ldexp(least, -26) * 16.0);
    }
    *law = made;
    return true;
}

bool tuned_drive_init(tuned_firmware_t *t, const motor *m, const tune_design *design, error *e)
{
    tuned_firmware_config_t config = {.extended = 0};
    const bool ok = law_of(m, design, &config.law, e);
    tuned_firmware_start(t, &config);
    return ok;
}

bool tuned_drive_extend(tuned_firmware_t *t, const motor *m, error *e)
{
    const bool ok = extension_from_motor(m, &t->config.extension, e);
    t->config.extended = ok ? 1 : 0;
    return ok;
}

void tuned_drive_watch(tuned_firmware_t *t, const motor *m, const tune_machine *machine,
                       const tune_watch *known)
{
    const per_unit base = per_unit_of(m);
    /* No term of it divides by 0: tune_watch_of holds the noise to what the constants take. */
    const iqfoc_watch_config_t config =
        /* NOLINTNEXTLINE(clang-analyzer-core.DivideZero) */
        IQFOC_WATCH_CONFIG_KNOWN(machine->R_ohm, machine->L_d_H, machine->L_q_H, machine->psi_f_Wb,
                                 m->pole_pairs, base.T_s, base.I_A, base.U_V, known->noise_pu, known->R,
                                 known->L, known->psi);
    t->config.watch = config;
    t->config.watched = 1;
}

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    (void)e;
    tuned_firmware_valley(context, i_ref, sample);
    return true;
}

static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    tuned_firmware_t *t = context;
    (void)i_ref;
    (void)e;
    tuned_firmware_peak(t, sample);
    answer->command = t->command;
    answer->status = t->status;
    return true;
}

drive_firmware tuned_drive_firmware(tuned_firmware_t *t)
{
    const drive_firmware firmware = {t, NULL, take_valley, give_peak};
    return firmware;
}
