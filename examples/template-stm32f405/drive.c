/* The first drive (drive.h). */
#include "drive.h"

#include "iqfoc/transform.h"

#include <stddef.h>

static const iqfoc_offset_limits_t offset_limits = {
    .settle = PWM_HZ / 20, .count_log2 = 10, .offset_max = IQ24(0.2), .noise_max = IQ24(0.02)};

static const iqfoc_start_config_t alignment = {
    .i_align = IQ24(I_ALIGN_PU),
    .ramp_cycles = (uint32_t)(ALIGN_SECONDS * PWM_HZ),
    .hold_cycles = (uint32_t)(ALIGN_SECONDS * PWM_HZ),
    .speed_end = 0,
};

/* A second after a break, three times in a row; never by itself in the first run. */
static const iqfoc_restart_config_t restarts = {
    .may_restart = IQFOC_STATUS_BREAK | IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_DC_LINK,
    .wait_cycles = PWM_HZ,
    .tries = FIRST_RUN ? 0 : 3,
    .forget_cycles = UINT32_C(60) * PWM_HZ,
};

/* Shunts make the third current of two, so that their sum says nothing: a lost sensor looks like a lost phase. */
static const iqfoc_supervision_config_t supervised = {
    .i_least = IQ24(0.05),
    .share = IQ24(0.125),
    .window_min = 12,
    .windows_bad = 5,
    .sum_max = IQ24(0.3),
    .sums_bad = 10,
};

static const iqfoc_cycle_config_t at_compile_time = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V),
    .gains = IQFOC_GAINS(BANDWIDTH, R_OHM, L_H, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN, /* the one that needs the valley's sample alone */
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(0.9), /* what the shunts need */
    .current_limit = IQ24(I_LIMIT_PU),
    .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE | IQFOC_STATUS_OVERCURRENT |
             IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_DC_LINK,
};

bool drive_begin(drive_t *drive, uint32_t ticks_per_second)
{
    const iqfoc_dq_t none = {0, 0};
    drive->config = at_compile_time;
    drive->config.period_ticks = ticks_per_second / PWM_HZ;
    drive->config.tolerance_ticks = drive->config.period_ticks / 20;
    drive->config.stale_ticks = drive->config.period_ticks / 4;
    /* From the valley to the next, less what writing takes: one trigger a period leaves a whole one. */
    drive->config.deadline_ticks = drive->config.period_ticks - drive->config.period_ticks / 10;
    drive->state = DRIVE_CALIBRATES;
    drive->why = 0;
    drive->i_wanted = none;
    return iqfoc_cycle_init(&drive->cycle, &drive->config) == IQFOC_OK &&
           iqfoc_offset_init(&drive->offset, &offset_limits) == IQFOC_OK &&
           iqfoc_start_init(&drive->start, &alignment) == IQFOC_OK &&
           iqfoc_restart_init(&drive->restart, &restarts) == IQFOC_OK &&
           iqfoc_supervision_init(&drive->supervision, &supervised) == IQFOC_OK;
}

static void off(drive_t *drive, uint32_t why)
{
    drive->state = DRIVE_IS_OFF;
    drive->why |= why;
    drive->cycle.enabled = false;
}

static void calibrate(drive_t *drive, iqfoc_hal_t *hal, const iqfoc_sample_t *sample)
{
    const iqfoc_offset_verdict_t verdict = iqfoc_offset_step(&drive->offset, sample->i);
    if (verdict == IQFOC_OFFSET_GOOD) {
        port_set_offset(hal, drive->offset.offset);
        port_clear_break(hal); /* what came up while the supplies did */
        drive->state = DRIVE_ALIGNS;
        drive->cycle.enabled = true;
    } else if (verdict != IQFOC_OFFSET_BUSY) {
        off(drive, DRIVE_OFFSET_BAD);
    }
}

/* The start's angle in place of the sensor's, which it watches; then the sensor's, put right. */
static void align(drive_t *drive, iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    iqfoc_start_step(&drive->start, sample->theta);
    drive->cycle.i_ref = drive->start.i_ref;
    if (drive->start.stage == IQFOC_START_ALIGNED) {
        if (drive->start.verdict != IQFOC_START_GOOD) {
            off(drive, DRIVE_ALIGNMENT_BAD);
            return;
        }
        port_align(hal, drive->start.theta);
        drive->state = DRIVE_RUNS;
    }
    sample->theta = drive->start.theta;
    sample->speed = drive->start.speed;
}

/* What is wrong at this moment. Of a trip only its first cycle counts: its bits stay until it is cleared. */
static uint32_t faults(drive_t *drive, const iqfoc_hal_t *hal, const iqfoc_sample_t *sample)
{
    const bool up = drive->cycle.enabled;
    const uint32_t trips = up && drive->cycle.tripped ? drive->cycle.status & drive->config.trips : 0;
    const uint32_t lost = iqfoc_supervision_step(&drive->supervision, sample->i, sample->speed, up);
    return trips | lost | (port_angle_lost(hal) ? IQFOC_STATUS_LOST_ANGLE_SENSOR : 0) |
           (port_break(hal) ? IQFOC_STATUS_BREAK : 0);
}

static void watch(drive_t *drive, iqfoc_hal_t *hal, const iqfoc_sample_t *sample)
{
    const uint32_t wrong = faults(drive, hal, sample);
    drive->why |= wrong;
    switch (iqfoc_restart_step(&drive->restart, wrong)) {
    case IQFOC_RESTART_RUN:
        break;
    case IQFOC_RESTART_TRY:
        port_clear_break(hal);
        iqfoc_cycle_clear(&drive->cycle);
        drive->cycle.enabled = true;
        drive->state = drive->start.stage == IQFOC_START_ALIGNED ? DRIVE_RUNS : DRIVE_ALIGNS;
        break;
    case IQFOC_RESTART_WAIT:
        /* The break's latch is cleared so that its cause can be seen to have gone. */
        port_clear_break(hal);
        drive->state = DRIVE_WAITS;
        drive->cycle.enabled = false;
        break;
    case IQFOC_RESTART_LATCHED:
    default:
        off(drive, 0);
        break;
    }
}

/*
 * Both handlers of iqfoc/hal.h in one: with one trigger a period the peak's sample is the valley's, and its angle that of
 * the valley, too.
 */
static void cycle(drive_t *drive, iqfoc_hal_t *hal, const iqfoc_sample_t *sample, uint32_t now)
{
    iqfoc_cycle_valley(&drive->cycle, sample, now);
    port_set_predicted(hal, iqfoc_clarke_inverse(drive->cycle.i_next));
    iqfoc_command_t command = iqfoc_cycle_peak(&drive->cycle, sample, IQFOC_HAL_OUTPUT_MID, now);
    if (!iqfoc_cycle_in_time(&drive->cycle, sample, iqfoc_hal_now(hal)) && drive->cycle.tripped) {
        command = iqfoc_cycle_safe(&drive->config);
    }
    iqfoc_hal_write(hal, &command);
}

void drive_interrupt(drive_t *drive, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    switch (drive->state) {
    case DRIVE_CALIBRATES:
        calibrate(drive, hal, &sample);
        break;
    case DRIVE_ALIGNS:
        watch(drive, hal, &sample);
        if (drive->state == DRIVE_ALIGNS) {
            align(drive, hal, &sample);
        }
        break;
    case DRIVE_RUNS:
        drive->cycle.i_ref = drive->i_wanted;
        watch(drive, hal, &sample);
        break;
    case DRIVE_WAITS:
        watch(drive, hal, &sample);
        break;
    case DRIVE_IS_OFF:
    default:
        break;
    }
    cycle(drive, hal, &sample, now);
}
