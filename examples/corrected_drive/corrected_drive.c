/*
 * The corrected drive's cycle (corrected_drive.h).
 */
#include "corrected_drive.h"

#include "iqfoc/cycle_check.h"
#include "iqfoc_extension.h"

#include <stddef.h>

#define BANDWIDTH 1250.0 /* rad/s: a twentieth of 2 pi / T */

static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;

bool corrected_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q)
{
    static iqfoc_cycle_config_t config = {
        .predictor = IQFOC_DIAGNOSED_PREDICTOR,
        .gains = IQFOC_DIAGNOSED_GAINS(BANDWIDTH),
        .safe_state = IQFOC_SAFE_GATES_OFF,
        .span_max = IQ24(0.96),
        .current_limit = IQ24(1.5),
        .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE | IQFOC_STATUS_OVERCURRENT |
                 IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_DC_LINK,
        .data = {.extension = &extension},
    };
    config.period_ticks = ticks_per_second / CORRECTED_DRIVE_PWM_HZ;
    config.tolerance_ticks = config.period_ticks / 20;
    config.stale_ticks = config.period_ticks / 4;
    config.deadline_ticks = config.period_ticks / 2 - config.period_ticks / 20;
    if (iqfoc_cycle_init_by(corrected_drive_methods, cycle, &config) != IQFOC_OK) {
        return false;
    }
    cycle->i_ref.q = i_q;
    cycle->enabled = true;
    return true;
}
