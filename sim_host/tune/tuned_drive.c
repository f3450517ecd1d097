/* The tuned controller as firmware (tuned_drive.h). */
#include "tuned_drive.h"

#include "extension_host.h"
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

bool tuned_drive_extend(tuned_drive *t, const motor *m, error *e)
{
    t->extended = extension_from_motor(m, &t->extension, e);
    return t->extended;
}

void tuned_drive_watch(tuned_drive *t, const motor *m, const tune_machine *machine, double noise_A)
{
    const per_unit base = per_unit_of(m);
    const double noise = noise_A / base.I_A;
    /*
     * No term of it divides by 0: the law's ranges hold T U_b/(L I_b) to 16, psi/(L I_b) to 8 and R T/L to 1, so
     * that over 0.0025 the greatest term, a voltage 0.05 cycles late, is 2011 of 2048.
     */
    const iqfoc_watch_config_t config =
        /* NOLINTNEXTLINE(clang-analyzer-core.DivideZero) */
        IQFOC_WATCH_CONFIG(machine->R_ohm, machine->L_d_H, machine->L_q_H, machine->psi_f_Wb, base.T_s,
                           base.I_A, base.U_V, noise);
    t->watch_config = config;
    t->watched = true;
    iqfoc_watch_reset(&t->watch);
}

/* What the watch sees of the cycle that ends at this valley, after the controller's step. */
static void be_watched(tuned_drive *t, const iqfoc_sample_t *sample)
{
    const iq24_sincos_t sc = iq24_sincos(sample->theta);
    const iqfoc_ab_t off = iqfoc_park_inverse(t->state.error, sc);
    if (iqfoc_watch_step(&t->watch, off, t->i_start, t->u_start, sc) &&
        iqfoc_watch_block(&t->watch, &t->watch_config, sample->turns, sample->theta)) {
        t->named++;
    }
    t->i_start = t->state.i;
    t->u_start = iqfoc_park(t->u_now, sc);
}

/* The legs' losses in the cycle that the duties are for: at its first current. */
static void compensate(tuned_drive *t, const iqfoc_sample_t *sample)
{
    const iq24_sincos_t sc_next = iq24_sincos(iq24_add_wrap(sample->theta, sample->turns));
    iqfoc_extension_compensate(&t->extension, &t->command.duties,
                               iqfoc_clarke_inverse(iqfoc_park_inverse(t->state.i_next, sc_next)),
                               iq24_div(IQ24_ONE, sample->u_dc));
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
    if (t->extended) {
        compensate(t, sample);
    }
    if (t->watched) {
        be_watched(t, sample);
    }
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
