/* Motor, start, observer and speed control of the drive without an angle sensor (sensorless_drive.h). */
#include "sensorless_drive.h"

#include "iqfoc/params.h"

#include <stddef.h>

/* The motor's data sheet. */
#define R_OHM       0.75
#define L_H         5.2e-3
#define PSI_F_WB    0.134
#define I_RATED_RMS 10.5
#define U_DC_V      750.0

#define T_S       (1.0 / SENSORLESS_DRIVE_PWM_HZ)
#define I_BASE_A  IQFOC_I_BASE(I_RATED_RMS)
#define BANDWIDTH 1500.0 /* rad/s: a twentieth of 2 pi / T */

/* The start turns up to 600 rpm; the observer is trusted from a twentieth of the top speed on. */
static const iqfoc_start_config_t start_config = {.i_align = IQ24(0.6),
                                                  .ramp_cycles = 1000,
                                                  .hold_cycles = 1500,
                                                  .speed_end = SENSORLESS_DRIVE_TURNS(600.0),
                                                  .run_up_cycles = 3000};
static const iqfoc_observer_config_t observer_config = IQFOC_OBSERVER_CONFIG(
    R_OHM, L_H, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V, 0.16 / T_S, SENSORLESS_DRIVE_TURNS(400.0));

/* Speed control of a shaft of 1 g m2: 11 rad/s, 0.4 s to the top speed, the rated current, a step each cycle. */
static const iqfoc_speed_control_config_t speed_config = IQFOC_SPEED_CONTROL(
    11.0, 1e-3, SENSORLESS_DRIVE_PAIRS, PSI_F_WB, T_S, I_BASE_A, 8000.0 / 0.4, I_BASE_A, 1);

bool sensorless_drive_begin(sensorless_drive_t *drive, uint32_t ticks_per_second)
{
    static iqfoc_cycle_config_t config = {
        .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V),
        .gains = IQFOC_GAINS(BANDWIDTH, R_OHM, L_H, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V),
        .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
        .safe_state = IQFOC_SAFE_GATES_OFF,
        .span_max = IQ24(0.96),
        .current_limit = IQ24(1.8),
        .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE | IQFOC_STATUS_OVERCURRENT |
                 IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_DC_LINK | IQFOC_STATUS_ANGLE_LOST,
    };
    config.period_ticks = ticks_per_second / SENSORLESS_DRIVE_PWM_HZ;
    config.tolerance_ticks = config.period_ticks / 20;
    config.stale_ticks = config.period_ticks / 4;
    config.deadline_ticks = config.period_ticks / 2 - config.period_ticks / 20;
    if (iqfoc_cycle_init(&drive->cycle, &config) != IQFOC_OK ||
        iqfoc_speed_control_init(&drive->speed, &speed_config) != IQFOC_OK ||
        iqfoc_sensorless_init(&drive->angle, &observer_config, &start_config, NULL) != IQFOC_OK) {
        return false;
    }
    drive->target = start_config.speed_end;
    iqfoc_sensorless_start(&drive->angle);
    drive->cycle.enabled = true;
    return true;
}

SENSORLESS_DRIVE_FAST void sensorless_drive_valley(sensorless_drive_t *drive, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    const bool started = drive->angle.source == IQFOC_ANGLE_OBSERVED;
    iqfoc_sensorless_valley(&drive->angle, &drive->cycle, &sample);
    if (drive->angle.source == IQFOC_ANGLE_OBSERVED) {
        if (!started) {
            iqfoc_speed_control_start(&drive->speed, sample.speed, drive->cycle.i_ref.q);
        }
        const iqfoc_dq_t i_ref = {
            0, iqfoc_speed_control_step(&drive->speed, drive->target, sample.speed, speed_config.i_max)};
        drive->cycle.i_ref = i_ref;
    }
    if (iqfoc_cycle_valley(&drive->cycle, &sample, now)) {
        iqfoc_isr_stop(&drive->cycle, hal);
    }
}

SENSORLESS_DRIVE_FAST void sensorless_drive_peak(sensorless_drive_t *drive, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_peak(hal, &sample);
    iqfoc_sensorless_peak(&drive->angle, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak(&drive->cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    if (!iqfoc_cycle_in_time(&drive->cycle, &sample, iqfoc_hal_now(hal)) && drive->cycle.tripped) {
        command = iqfoc_cycle_safe(drive->cycle.config);
    }
    iqfoc_hal_write(hal, &command);
}
