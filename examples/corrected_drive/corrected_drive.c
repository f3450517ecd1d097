/*
 * The corrected drive's cycle (corrected_drive.h).
 */
#include "corrected_drive.h"

#include "iqfoc_extension.h"

#include "iqfoc/transform.h"

#include <stddef.h>

#define BANDWIDTH 1250.0 /* rad/s: a twentieth of 2 pi / T */

static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;

bool corrected_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q)
{
    static iqfoc_cycle_config_t config = {
        .predictor = IQFOC_DIAGNOSED_PREDICTOR,
        .gains = IQFOC_DIAGNOSED_GAINS(BANDWIDTH),
        .feedback = IQFOC_FEEDBACK_MIDPOINT,
        .modulation = IQFOC_MODULATION_PWM,
        .safe_state = IQFOC_SAFE_GATES_OFF,
        .span_max = IQ24(0.96),
        .current_limit = IQ24(1.5),
        .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE | IQFOC_STATUS_OVERCURRENT |
                 IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_DC_LINK,
    };
    config.period_ticks = ticks_per_second / CORRECTED_DRIVE_PWM_HZ;
    config.tolerance_ticks = config.period_ticks / 20;
    config.stale_ticks = config.period_ticks / 4;
    config.deadline_ticks = config.period_ticks / 2 - config.period_ticks / 20;
    if (iqfoc_extension_check(&extension) != IQFOC_OK || iqfoc_cycle_init(cycle, &config) != IQFOC_OK) {
        return false;
    }
    cycle->i_ref.q = i_q;
    cycle->enabled = true;
    return true;
}

void corrected_drive_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    iqfoc_extension_sample(&extension, &sample);
    iqfoc_cycle_valley(cycle, &sample, now);
}

void corrected_drive_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_peak(hal, &sample);
    iqfoc_extension_sample(&extension, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak(cycle, &sample, IQ24(1.5), now);
    if (command.gates && !cycle->tripped) {
        /* The duties act from the next valley on, at the current predicted for it. */
        iqfoc_extension_compensate(&extension, &command.duties, iqfoc_clarke_inverse(cycle->i_next),
                                   cycle->u_dc_inverse);
    }
    if (!iqfoc_cycle_in_time(cycle, &sample, iqfoc_hal_now(hal)) && cycle->tripped) {
        command = iqfoc_cycle_safe(cycle->config);
    }
    iqfoc_hal_write(hal, &command);
}
