/* The control cycle, step by step, with the methods that Python names. */
#include "data/motor.h"
#include "drive/firmware.h"
#include "extension_host.h"
#include "interface.h"

#include "iqfoc/cycle_steps.h"

#include <stdlib.h>
#include <string.h>

struct py_cycle {
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t config;
    iqfoc_methods_t methods;
    iqfoc_extension_t extension;
    iqfoc_exact_law_t exact, exact_mean;
};

static bool configure(py_cycle *c, const motor *m, const py_methods *how, error *e)
{
    /* A feedback of the exact model's is as young as the quasi-discrete one: its bandwidth and configuration hold. */
    const scenario_control control = {
        how->feedback == IQFOC_FEEDBACK_CORRECTED_MEAN ? FEEDBACK_CORRECTED_MEAN
        : how->feedback == IQFOC_FEEDBACK_MIDPOINT     ? FEEDBACK_MIDPOINT
                                                       : FEEDBACK_QUASI_DISCRETE_MEAN,
        how->modulation == IQFOC_MODULATION_SIX_STEP ? MODULATION_SIX_STEP : MODULATION_PWM,
        how->bandwidth_Hz, 1};
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
    c->methods = (iqfoc_methods_t){(iqfoc_model_t)how->model, (iqfoc_feedback_t)how->feedback,
                                   IQFOC_CONTROL_PI, (iqfoc_modulation_t)how->modulation, how->extended};
    const iqfoc_error_t refused = iqfoc_cycle_init_by(c->methods, &c->cycle, &c->config);
    return refused == IQFOC_OK ||
           error_failure(e, 0, "the library refused its configuration: iqfoc_error_t %d", (int)refused);
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
    return c;
}

void py_cycle_free(py_cycle *c)
{
    free(c);
}

void py_cycle_enable(py_cycle *c, bool enabled)
{
    c->cycle.enabled = enabled;
}

void py_cycle_clear(py_cycle *c)
{
    iqfoc_cycle_clear(&c->cycle);
}

void py_cycle_reference(py_cycle *c, int32_t d, int32_t q)
{
    const iqfoc_dq_t i_ref = {d, q};
    c->cycle.i_ref = i_ref;
}

static iqfoc_sample_t sample_of(const py_sample *s)
{
    const iqfoc_sample_t sample = {.i = {s->i[0], s->i[1], s->i[2]},
                                   .i_mean = {s->i_mean[0], s->i_mean[1], s->i_mean[2]},
                                   .theta = s->theta,
                                   .turns = s->turns,
                                   .u_dc = s->u_dc,
                                   .at = s->at,
                                   .time = s->time,
                                   .has_mean = s->has_mean,
                                   .clipped = s->clipped};
    return sample;
}

void py_cycle_valley(py_cycle *c, const py_sample *sample)
{
    const iqfoc_sample_t s = sample_of(sample);
    iqfoc_cycle_valley_by(c->methods, &c->cycle, &s, s.time);
}

void py_cycle_peak(py_cycle *c, const py_sample *sample, int32_t output_mid, py_command *command)
{
    const iqfoc_sample_t s = sample_of(sample);
    const iqfoc_command_t answer = iqfoc_cycle_peak_by(c->methods, &c->cycle, &s, output_mid, s.time);
    const iqfoc_abc_t high = answer.duties.high;
    *command = (py_command){{high.a, high.b, high.c}, answer.duties.scale, answer.gates};
}

void py_cycle_state(const py_cycle *c, py_state *state)
{
    const iqfoc_cycle_t *x = &c->cycle;
    *state = (py_state){.status = x->status,
                        .enabled = x->enabled,
                        .tripped = x->tripped,
                        .corrected = x->corrected,
                        .i_ref_dq = {x->i_ref.d, x->i_ref.q},
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
