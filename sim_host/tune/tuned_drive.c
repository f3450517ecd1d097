/* The tuned controller as firmware (tuned_drive.h). */
#include "tuned_drive.h"

#include "params_host.h"

#include "iqfoc/modulation.h"

#include <math.h>
#include <string.h>

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

bool tuned_law_of(const motor *m, const tune_design *design, iqfoc_tuned_law_t *law, error *e)
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
            "f_pwm_Hz gives T U_b/(L I_b) = %.3g; the tuned controller holds 1/16 to 16, which "
            "f_pwm_Hz = %.6g would give",
            ldexp(least, -26), m->f_pwm_Hz * ldexp(least, -26) * 16.0);
    }
    *law = made;
    return true;
}

bool tuned_drive_init(tuned_drive *t, const motor *m, const tune_design *design, error *e)
{
    memset(t, 0, sizeof *t);
    return tuned_law_of(m, design, &t->law, e);
}

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    tuned_drive *t = context;
    (void)e;
    const iqfoc_tuned_t tuned = iqfoc_tuned_at_speed(&t->law, sample->turns);
    t->u_now = t->u_next;
    const iqfoc_ab_t u =
        iqfoc_tuned_step(&t->state, &tuned, iqfoc_clarke3(sample->i), t->u_now, i_ref, sample->theta);
    t->command.duties = iqfoc_modulate(u, iq24_div(IQ24_ONE, sample->u_dc), IQ24_ONE);
    t->command.gates = true;
    t->u_next.alpha = iq24_mul_round(u.alpha, t->command.duties.scale);
    t->u_next.beta = iq24_mul_round(u.beta, t->command.duties.scale);
    return true;
}

static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    tuned_drive *t = context;
    (void)i_ref;
    (void)e;
    iqfoc_tuned_peak(&t->state, iqfoc_clarke3(sample->i), sample->theta);
    answer->command = t->command;
    return true;
}

drive_firmware tuned_drive_firmware(tuned_drive *t)
{
    const drive_firmware firmware = {t, NULL, take_valley, give_peak};
    return firmware;
}
