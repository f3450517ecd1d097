/*
 * The drive without an angle sensor on an emulated board, in real time: from standstill to the top speed and back. The rotor's angle
 * of the stand-in drive (shaft_drive.c) is not read by the firmware; the observed one is compared with it. Exit status 1 if the
 * drive trips, does not reach the speed or is more than 5 degrees off.
 */
#include "board.h"
#include "board_clock.h"
#include "console.h"
#include "hal_emulated.h"
#include "sensorless_drive.h"

#define HALF_TICKS ((uint32_t)(BOARD_HZ / SENSORLESS_DRIVE_PWM_HZ / 2))
#define TOP        SENSORLESS_DRIVE_TURNS(8000.0)
#define LOW        SENSORLESS_DRIVE_TURNS(600.0)
#define UP         12000
#define PERIODS    18000

static sensorless_drive_t drive;
static iqfoc_hal_t hal;
static volatile uint32_t periods;
static iq24_t highest;
static iq24_t farthest; /* |observed angle - true angle|, turns */

void board_valley_interrupt(void)
{
    drive.target = periods < UP ? TOP : LOW;
    sensorless_drive_valley(&drive, &hal);
    if (drive.angle.source == IQFOC_ANGLE_OBSERVED) {
        farthest = iq24_max(farthest, iq24_abs_sat(drive.angle.difference));
        highest = iq24_max(highest, iqfoc_observer_speed(&drive.angle.observer));
    }
}

void board_peak_interrupt(void)
{
    sensorless_drive_peak(&drive, &hal);
    periods = periods + 1;
}

static int32_t rpm_of(iq24_t speed)
{
    return (int32_t)((int64_t)speed * (60 * SENSORLESS_DRIVE_PWM_HZ / SENSORLESS_DRIVE_PAIRS) / IQ24_ONE);
}

int main(void)
{
    if (!sensorless_drive_begin(&drive, BOARD_HZ)) {
        console_text("refused\n");
        return 1;
    }
    const uint32_t before = board_interrupts_off();
    hal_emulated_start(&hal, HALF_TICKS, board_carrier_start(HALF_TICKS));
    board_interrupts_restore(before);
    while (periods < PERIODS) {
    }
    board_carrier_stop();
    const int32_t last_rpm = rpm_of(iqfoc_observer_speed(&drive.angle.observer));
    console_text("top speed ");
    console_signed(rpm_of(highest));
    console_text(" rpm, then ");
    console_signed(last_rpm);
    console_text(" rpm, angle off by at most ");
    console_signed((int32_t)(((int64_t)farthest * 3600) >> 24));
    console_text(" tenths of a degree, status ");
    console_unsigned(drive.cycle.status);
    console_text("\n");
    const bool good =
        rpm_of(highest) > 7900 && last_rpm > 550 && last_rpm < 650 && farthest < IQ24(5.0 / 360.0);
    return drive.cycle.tripped || !good ? 1 : 0;
}
