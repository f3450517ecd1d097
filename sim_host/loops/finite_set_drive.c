/* Finite-set control as firmware (finite_set_drive.h). */
#include "finite_set_drive.h"

#include "params_host.h"

#include "iqfoc/predictor_form.h"
#include "iqfoc/transform.h"

#include <string.h>

bool finite_set_drive_init(finite_set_drive *p, const motor *assumed, iqfoc_model_t model, error *e)
{
    iqfoc_exact_winding_t winding;
    memset(p, 0, sizeof *p);
    p->model = model;
    if (!predictor_from_motor(assumed, &p->predictor, e) || !winding_from_motor(assumed, &winding, e)) {
        return false;
    }
    p->law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    return true;
}

static iqfoc_exact_t model_at(const finite_set_drive *p, const iqfoc_rotor_t *rotor)
{
    return p->model == IQFOC_MODEL_EULER            ? iqfoc_form_euler(&p->predictor, rotor)
           : p->model == IQFOC_MODEL_QUASI_DISCRETE ? iqfoc_form_quasi_discrete(&p->predictor, rotor)
                                                    : iqfoc_exact_at_speed(&p->law, rotor->speed);
}

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    finite_set_drive *p = context;
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(sample->speed);
    const iqfoc_finite_set_t set = {.model = model_at(p, &rotor),
                                    .reference = iqfoc_valley_reference_at(&rotor, p->predictor.k_psi),
                                    .weight = p->weight,
                                    .horizon = p->horizon};
    (void)e;
    p->decisions++;
    p->state = iqfoc_finite_set_choose(&set, iqfoc_clarke3(sample->i), p->state, i_ref, sample->theta,
                                       rotor.speed, sample->u_dc, &p->nodes);
    const iqfoc_abc_t legs = {(p->state & 1) != 0 ? IQ24_ONE : 0, (p->state & 2) != 0 ? IQ24_ONE : 0,
                              (p->state & 4) != 0 ? IQ24_ONE : 0};
    p->command.duties.high = legs;
    p->command.duties.scale = IQ24_ONE;
    p->command.gates = true;
    return true;
}

/* The controller needs the valley's sample only; its command waits until the peak, as the cycle's does. */
static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    (void)i_ref;
    (void)sample;
    (void)e;
    answer->command = ((const finite_set_drive *)context)->command;
    return true;
}

drive_firmware finite_set_drive_firmware(finite_set_drive *p)
{
    const drive_firmware firmware = {p, NULL, take_valley, give_peak};
    return firmware;
}
