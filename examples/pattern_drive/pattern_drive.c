/* Motor, pattern and interrupts of the drive with five pulses (pattern_drive.h). */
#include "pattern_drive.h"

#include "iqfoc/params.h"
#include "iqfoc/transform.h"

#include <stddef.h>

/* The motor's data sheet. */
#define R_OHM       0.75
#define L_H         5.2e-3
#define PSI_F_WB    0.134
#define I_RATED_RMS 10.5
#define U_DC_V      750.0

#define T_S      (1.0 / PATTERN_DRIVE_HZ)
#define I_BASE_A IQFOC_I_BASE(I_RATED_RMS)
#define I_MAX    IQ24(2.0) /* of a phase */

/* Angles by `iqfoc patterns --pulses 5`, one row in five. */
PATTERN_DRIVE_CONST static const iqfoc_pattern_row_t rows[8] = {
    {1, 1, {3071368, 3971727}}, /* 0.35 */
    {1, 1, {3112136, 3942197}}, /* 0.40 */
    {1, 1, {3153642, 3913569}}, /* 0.45 */
    {1, 1, {3195907, 3885867}}, /* 0.50 */
    {1, 1, {3239217, 3859365}}, /* 0.55 */
    {1, 1, {3284063, 3834538}}, /* 0.60 */
    {1, 1, {3330883, 3811825}}, /* 0.65 */
    {1, 0, {3380430, 3791980}}, /* 0.70 */
};
PATTERN_DRIVE_CONST static const iqfoc_pattern_t table = {rows, 8, 2, IQ24(0.35), IQ24(20.0)};

bool pattern_drive_start(pattern_drive_t *drive, uint32_t period_ticks, uint32_t least_ticks, iq24_t i_q)
{
    static const iqfoc_pattern_control_config_t config = {
        IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_F_WB, T_S, I_BASE_A, U_DC_V), IQ24(0.1), IQ24(0.02)};
    const iq24_t least = IQFOC_EDGES_LEAST(least_ticks, period_ticks);
    drive->i_ref.d = 0;
    drive->i_ref.q = i_q;
    drive->edges.period_ticks = period_ticks;
    drive->stopped = false;
    return iqfoc_pattern_control_init(&drive->control, &config, &table, least) == IQFOC_OK;
}

PATTERN_DRIVE_FAST static bool within(iq24_t i)
{
    return i <= I_MAX && i >= -I_MAX;
}

/* The edges of the next cycle, from the current of this valley. */
PATTERN_DRIVE_FAST void pattern_drive_valley(pattern_drive_t *drive, iqfoc_hal_t *hal)
{
    iqfoc_pattern_edges_t pattern[3];
    iqfoc_sample_t sample;
    iqfoc_hal_read_valley(hal, &sample);
    drive->stopped =
        drive->stopped || sample.clipped || !within(sample.i.a) || !within(sample.i.b) || !within(sample.i.c);
    if (drive->stopped) {
        const iqfoc_command_t off = {{{0, 0, 0}, IQ24_ONE}, false};
        iqfoc_hal_write(hal, &off);
        return;
    }
    const iqfoc_ab_t i = iqfoc_clarke3(sample.i);
    drive->i = iqfoc_park(i, iq24_sincos(sample.theta));
    if (drive->control.trajectory.speed_abs == 0) { /* the first valley */
        iqfoc_pattern_control_aim(&drive->control, drive->i_ref, sample.speed);
    }
    iqfoc_pattern_control_step(&drive->control, i, sample.theta, sample.u_dc, pattern);
    iqfoc_edges_of_pattern(pattern, drive->edges.period_ticks, &drive->edges);
    iqfoc_hal_write_edges(hal, &drive->edges);
}

/* What does not depend on the next sample. */
PATTERN_DRIVE_FAST void pattern_drive_peak(pattern_drive_t *drive, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    iqfoc_hal_read_peak(hal, &sample);
    iqfoc_pattern_control_aim(&drive->control, drive->i_ref, sample.speed);
}
