/*
 * The smallest drive on an emulated board: 1,000 carrier periods against the stand-in drive, then a word on
 * how it went.
 */
#include "board.h"
#include "board_clock.h"
#include "console.h"
#include "first_drive.h"
#include "hal_emulated.h"

#define HALF_TICKS ((uint32_t)(BOARD_HZ / FIRST_DRIVE_PWM_HZ / 2))
#define PERIODS    1000

static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;
static volatile uint32_t periods;

void board_valley_interrupt(void)
{
    iqfoc_isr_valley_by(first_drive_methods, &cycle, &hal);
}

void board_peak_interrupt(void)
{
    iqfoc_isr_peak_by(first_drive_methods, &cycle, &hal);
    periods = periods + 1;
}

int main(void)
{
    if (!first_drive_start(&cycle, BOARD_HZ, IQ24(0.4))) {
        console_text("refused\n");
        return 1;
    }
    const uint32_t before = board_interrupts_off();
    hal_emulated_start(&hal, HALF_TICKS, board_carrier_start(HALF_TICKS));
    board_interrupts_restore(before);
    while (periods < PERIODS) {
    }
    board_carrier_stop();
    console_text("i_q in thousandths of the rated current: ");
    console_signed((int32_t)(((int64_t)cycle.i_dq.q * 1000) >> 24));
    console_text(", status ");
    console_unsigned(cycle.status);
    console_text("\n");
    return cycle.tripped ? 1 : 0;
}
