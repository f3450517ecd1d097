/*
 * Motor and cycle of the smallest drive (first_drive.h).
 */
#include "first_drive.h"

#include "iqfoc/params.h"

#include <stddef.h>

/* The motor's data sheet. */
#define R_OHM       0.75
#define L_H         5.2e-3
#define PSI_F_WB    0.134
#define I_RATED_RMS 10.5
#define U_DC_V      750.0

#define T_S       (1.0 / FIRST_DRIVE_PWM_HZ)
#define I_BASE_A  IQFOC_I_BASE(I_RATED_RMS)
#define BANDWIDTH 1500.0 /* rad/s: a twentieth of 2 pi / T */

bool first_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q)
{
    /* Constants fold at compile time; one that does not fit IQ24 does not compile. */
    static iqfoc_cycle_config_t config = {
        .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V),
        .gains = IQFOC_GAINS(BANDWIDTH, R_OHM, L_H, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V),
        .safe_state = IQFOC_SAFE_GATES_OFF,
        .span_max = IQ24(0.96),
        .current_limit = IQ24(1.5),
        .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE | IQFOC_STATUS_OVERCURRENT |
                 IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_DC_LINK,
    };
    config.period_ticks = ticks_per_second / FIRST_DRIVE_PWM_HZ;
    config.tolerance_ticks = config.period_ticks / 20;
    config.stale_ticks = config.period_ticks / 4;
    config.deadline_ticks = config.period_ticks / 2 - config.period_ticks / 20;
    if (iqfoc_cycle_init(cycle, &config) != IQFOC_OK) {
        return false;
    }
    cycle->i_ref.q = i_q;
    cycle->enabled = true;
    return true;
}
