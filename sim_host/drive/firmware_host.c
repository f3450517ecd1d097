/* The firmware linked into this program (firmware_host.h), and the names of its status bits. */
#include "firmware_host.h"

#include "extension_host.h"

#include "iqfoc/supervision.h"

#include <stdio.h>
#include <string.h>

static bool start(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    drive_host *host = context;
    memset(&host->hal, 0, sizeof host->hal);
    host->config = *config;
    if (host->of_papers) {
        host->config.data.extension = host->extension;
        host->methods.feedback = config->feedback;
        host->methods.modulation = config->modulation;
    }
    const iqfoc_error_t refused = iqfoc_cycle_init_by(host->methods, &host->cycle, &host->config);
    if (refused != IQFOC_OK) {
        return error_failure(e, 0, "the library refused its configuration: iqfoc_error_t %d", (int)refused);
    }
    host->cycle.enabled = true;
    if (host->observed) {
        (void)iqfoc_sensorless_init(&host->sensorless, &host->observer, NULL,
                                    &host->acting); /* checked before */
        iqfoc_sensorless_use(&host->sensorless, true);
    }
    return true;
}

/* What the handler will read. */
static void interrupt(drive_host *host, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample)
{
    host->cycle.i_ref = i_ref;
    hal_host_interrupt(&host->hal, sample);
}

static bool valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    drive_host *host = context;
    (void)e;
    interrupt(host, i_ref, sample);
    if (host->observed) {
        iqfoc_sensorless_valley(&host->sensorless, &host->cycle, &host->hal.sample);
    }
    iqfoc_isr_valley_by(host->methods, &host->cycle, &host->hal);
    return true;
}

static bool peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                 error *e)
{
    drive_host *host = context;
    (void)e;
    interrupt(host, i_ref, sample);
    if (host->observed) {
        iqfoc_sensorless_peak(&host->sensorless, &host->hal.sample);
    }
    iqfoc_isr_peak_by(host->methods, &host->cycle, &host->hal);
    answer->command = host->hal.command;
    answer->status = host->cycle.status;
    return true;
}

drive_answer drive_answer_of_state(const iqfoc_cycle_t *cycle, const iqfoc_six_step_command_t *state)
{
    const drive_answer answer = {state->command, cycle->status, (double)state->ticks / HAL_HOST_TICKS_PER_S,
                                 NULL};
    return answer;
}

drive_firmware drive_firmware_by(drive_host *host, iqfoc_methods_t methods)
{
    const drive_firmware firmware = {host, start, valley, peak};
    host->methods = methods;
    host->of_papers = false;
    host->extension = NULL;
    host->observed = false;
    return firmware;
}

bool drive_host_observe(drive_host *host, const motor *m, error *e)
{
    host->observed = true;
    return extension_from_motor(m, &host->acting, e) && observer_from_motor(m, &host->observer, e);
}

drive_firmware drive_firmware_host(drive_host *host, const iqfoc_extension_t *extension)
{
    const iqfoc_methods_t methods = {
        .model = IQFOC_MODEL_QUASI_DISCRETE, .control = IQFOC_CONTROL_PI, .extended = extension != NULL};
    const drive_firmware firmware = drive_firmware_by(host, methods);
    host->of_papers = true;
    host->extension = extension;
    return firmware;
}

const char *drive_status_text(uint32_t status, char *text, size_t size)
{
    static const struct {
        uint32_t bit;
        const char *name;
    } names[] = {
        {IQFOC_STATUS_MISSED, "MISSED"},
        {IQFOC_STATUS_LATE, "LATE"},
        {IQFOC_STATUS_STALE, "STALE"},
        {IQFOC_STATUS_SAMPLE_CLIPPED, "SAMPLE_CLIPPED"},
        {IQFOC_STATUS_OVERCURRENT, "OVERCURRENT"},
        {IQFOC_STATUS_OVERSPEED, "OVERSPEED"},
        {IQFOC_STATUS_VOLTAGE_LIMIT, "VOLTAGE_LIMIT"},
        {IQFOC_STATUS_DC_LINK, "DC_LINK"},
        {IQFOC_STATUS_NO_INTERVAL, "NO_INTERVAL"},
        {IQFOC_STATUS_ANGLE_LOST, "ANGLE_LOST"},
        {IQFOC_STATUS_LOST_PHASE, "LOST_PHASE"},
        {IQFOC_STATUS_LOST_CURRENT_SENSOR, "LOST_CURRENT_SENSOR"},
        {IQFOC_STATUS_LOST_ANGLE_SENSOR, "LOST_ANGLE_SENSOR"},
        {IQFOC_STATUS_BREAK, "BREAK"},
    };
    size_t used = 0;
    (void)snprintf(text, size, "none");
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        if ((status & names[k].bit) != 0 && used < size) {
            const int wrote =
                snprintf(text + used, size - used, "%s%s", used > 0 ? " | " : "", names[k].name);
            used += wrote > 0 ? (size_t)wrote : 0;
        }
    }
    return text;
}
