#include "corrected_cycle.h"

#include "extension_host.h"

static bool start(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    corrected_cycle *c = context;
    const iqfoc_error_t refused = iqfoc_cycle_init(&c->cycle, config);
    if (refused != IQFOC_OK) {
        return error_failure(e, 0, "the library refused its configuration: iqfoc_error_t %d", (int)refused);
    }
    c->cycle.enabled = true;
    return true;
}

bool corrected_cycle_init(corrected_cycle *c, const motor *assumed, const char *path, error *e)
{
    const scenario_control control = {.feedback = FEEDBACK_MIDPOINT, .modulation = MODULATION_PWM};
    if (!config_from_motor(assumed, path, &control, &c->config, e) ||
        !extension_from_motor(assumed, path, &c->extension, e)) {
        return false;
    }
    c->config.trips = 0;
    return start(c, &c->config, e);
}

static bool reference(void *context, iqfoc_dq_t i_ref, error *e)
{
    (void)e;
    ((corrected_cycle *)context)->cycle.i_ref = i_ref;
    return true;
}

static bool valley(void *context, const iqfoc_sample_t *sample, error *e)
{
    corrected_cycle *c = context;
    iqfoc_sample_t corrected = *sample;
    (void)e;
    iqfoc_extension_sample(&c->extension, &corrected);
    iqfoc_cycle_valley(&c->cycle, &corrected, corrected.time);
    return true;
}

static bool peak(void *context, const iqfoc_sample_t *sample, iqfoc_command_t *command, uint32_t *status,
                 error *e)
{
    corrected_cycle *c = context;
    iqfoc_sample_t corrected = *sample;
    (void)e;
    iqfoc_extension_sample(&c->extension, &corrected);
    *command = iqfoc_cycle_peak(&c->cycle, &corrected, IQ24(1.5), corrected.time);
    iqfoc_extension_compensate(&c->extension, &command->duties, iqfoc_clarke_inverse(c->cycle.i_next),
                               c->cycle.u_dc_inverse);
    *status = c->cycle.status;
    return true;
}

drive_firmware corrected_cycle_firmware(corrected_cycle *c)
{
    const drive_firmware firmware = {c, start, reference, valley, peak};
    return firmware;
}
