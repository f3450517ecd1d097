/* The control cycle, step by step, with the methods that Python names. */
#include "data/motor.h"
#include "drive/firmware_host.h"
#include "extension_host.h"
#include "handles.h"

#include "iqfoc/cycle_six_step.h"
#include "iqfoc/cycle_steps.h"

#include <stdlib.h>
#include <string.h>

struct py_cycle {
    py_firmware firmware;
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t config;
    iqfoc_methods_t methods;
    iqfoc_extension_t extension;
    iqfoc_exact_law_t exact, exact_mean;
    bool timer; /* six-step by a timer */
    iqfoc_six_step_t six;
    iqfoc_six_step_config_t six_config;
    iq24_t speed; /* of the timer's last sample */
};

static bool configure(py_cycle *c, const motor *m, const py_methods *how, error *e)
{
    /* A feedback of the exact model's is as young as the quasi-discrete one: its bandwidth and configuration hold. */
    const scenario_control control = {
        how->feedback == IQFOC_FEEDBACK_CORRECTED_MEAN ? FEEDBACK_CORRECTED_MEAN
        : how->feedback == IQFOC_FEEDBACK_MIDPOINT     ? FEEDBACK_MIDPOINT
                                                       : FEEDBACK_QUASI_DISCRETE_MEAN,
        how->modulation == IQFOC_MODULATION_SIX_STEP ? MODULATION_SIX_STEP : MODULATION_PWM,
        how->bandwidth_Hz, 1, ANGLE_MEASURED};
    iqfoc_exact_winding_t winding;
    if (!config_from_motor(m, &control, &c->config, e) || !winding_from_motor(m, &winding, e) ||
        (how->extended && !extension_from_motor(m, &c->extension, e))) {
        return false;
    }
    c->exact = iqfoc_exact_prediction(&winding, IQ24_ONE);
    c->exact_mean = iqfoc_exact_mean(&winding, IQ24_ONE);
    c->config.data.exact = &c->exact;
    c->config.data.exact_mean = &c->exact_mean;
    c->config.data.extension = how->extended ? &c->extension : NULL;
    if (how->control != IQFOC_CONTROL_PI) {
        c->config.data.k_u_inverse = iqfoc_deadbeat_inverse(
            how->model == IQFOC_MODEL_EXACT ? c->exact.k_u_q26 : c->config.predictor.k_u * 4);
        c->config.data.k_psi = c->config.predictor.k_psi;
        c->config.data.learning = iq24_from_double(how->observer_gain);
    }
    c->methods =
        (iqfoc_methods_t){(iqfoc_model_t)how->model, (iqfoc_feedback_t)how->feedback,
                          (iqfoc_control_t)how->control, (iqfoc_modulation_t)how->modulation, how->extended};
    c->config.feedback = c->methods.feedback;
    c->config.modulation = c->methods.modulation;
    const iqfoc_error_t refused = iqfoc_cycle_init_by(c->methods, &c->cycle, &c->config);
    return refused == IQFOC_OK ||
           error_failure(e, 0, "the library refused its configuration: iqfoc_error_t %d", (int)refused);
}

static bool valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    py_cycle *c = context;
    (void)e;
    c->cycle.i_ref = i_ref;
    if (!c->timer) { /* an interval has no valley */
        (void)iqfoc_cycle_valley_by(c->methods, &c->cycle, sample, sample->time);
    }
    return true;
}

static bool peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                 error *e)
{
    py_cycle *c = context;
    (void)e;
    c->cycle.i_ref = i_ref;
    if (c->timer) {
        const iqfoc_six_step_command_t next =
            iqfoc_cycle_six_step_switch(&c->six, &c->cycle, sample, sample->time);
        c->speed = sample->speed;
        *answer = drive_answer_of_state(&c->cycle, &next);
        return true;
    }
    answer->interval_s = 0.0;
    answer->command =
        iqfoc_cycle_peak_by(c->methods, &c->cycle, sample, c->firmware.output_mid, sample->time);
    answer->status = c->cycle.status;
    return true;
}

py_cycle *py_cycle_new(const motor *m, const py_methods *how, error *e)
{
    py_cycle *c = calloc(1, sizeof *c);
    if (c == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    if (!configure(c, m, how, e)) {
        free(c);
        return NULL;
    }
    py_firmware_begin(&c->firmware, (drive_firmware){c, NULL, valley, peak});
    return c;
}

void py_cycle_free(py_cycle *c)
{
    free(c);
}

py_firmware *py_cycle_firmware(py_cycle *c)
{
    return &c->firmware;
}

bool py_cycle_to_timer(py_cycle *c, const py_sample *sample, const double *gain_and_limits, double angle,
                       bool any_angle, py_command *command, error *e)
{
    const iqfoc_sample_t s = py_sample_of(sample);
    c->six_config = (iqfoc_six_step_config_t){.gain = iq24_from_double(gain_and_limits[0]),
                                              .angle_min = iq24_from_double(gain_and_limits[1]),
                                              .angle_max = iq24_from_double(gain_and_limits[2])};
    const iq24_t begin = any_angle ? iqfoc_cycle_voltage_angle(&c->cycle) : iq24_from_double(angle);
    const iqfoc_six_step_command_t next =
        iqfoc_cycle_six_step_begin(&c->six, &c->cycle, &c->six_config, begin, &s);
    if (c->six.config == NULL) {
        return error_failure(e, 0, "the library refused the configuration of six-step");
    }
    c->timer = true;
    c->speed = s.speed;
    c->firmware.answer = drive_answer_of_state(&c->cycle, &next);
    *command = py_command_of(&c->firmware.answer);
    return true;
}

bool py_cycle_to_carrier(py_cycle *c, py_command *command, error *e)
{
    if (!c->timer) {
        return error_input(e, NULL, 0, 0, "the cycle does not run by the timer");
    }
    if (c->methods.control != IQFOC_CONTROL_PI || c->methods.modulation != IQFOC_MODULATION_OVER) {
        return error_input(e, NULL, 0, 0, "six-step goes over to PI control with modulation \"over\" only");
    }
    iqfoc_cycle_six_step_end(&c->six, &c->cycle, c->speed);
    c->timer = false;
    c->firmware.answer.interval_s = 0.0;
    *command = py_command_of(&c->firmware.answer);
    return true;
}

bool py_cycle_timer(const py_cycle *c, double *angle)
{
    *angle = c->timer ? iq24_to_double(iq24_acc_round(c->six.angle)) : 0.0;
    return c->timer;
}

void py_cycle_enable(py_cycle *c, bool enabled)
{
    c->cycle.enabled = enabled;
    c->firmware.answer.command.gates = enabled && !c->cycle.tripped;
}

void py_cycle_clear(py_cycle *c)
{
    iqfoc_cycle_clear(&c->cycle);
    const iqfoc_dq_t i_ref = c->firmware.i_ref;
    py_firmware_begin(&c->firmware, c->firmware.calls);
    c->firmware.i_ref = i_ref;
    c->firmware.answer.command.gates = c->cycle.enabled;
}

void py_cycle_state(const py_cycle *c, py_state *state)
{
    const iqfoc_cycle_t *x = &c->cycle;
    *state = (py_state){.status = x->status,
                        .enabled = x->enabled,
                        .tripped = x->tripped,
                        .corrected = x->corrected,
                        .i_ref_dq = {c->firmware.i_ref.d, c->firmware.i_ref.q},
                        .i_dq = {x->i_dq.d, x->i_dq.q},
                        .u_dq = {x->u_dq.d, x->u_dq.q},
                        .u_ab = {x->u_ab.alpha, x->u_ab.beta},
                        .i_valley = {x->i_valley.alpha, x->i_valley.beta},
                        .i_next = {x->i_next.alpha, x->i_next.beta},
                        .error = {x->error.alpha, x->error.beta},
                        .i_corrected_dq = {x->i_corrected_dq.d, x->i_corrected_dq.q}};
}

void py_status_text(uint32_t status, char *text, size_t size)
{
    drive_status_text(status, text, size);
}
