/*
 * The drive with five pulses on an emulated board: from a machine that turns without current at 247 Hz, through steps of the current, to 320
 * Hz. Exit status 1 if it stops, or the mean of i_q over the last 100 cycles is more than 2 % of the rated current off.
 */
#include "board.h"
#include "board_clock.h"
#include "console.h"
#include "hal_emulated.h"
#include "pattern_drive.h"

#define HALF_TICKS  ((uint32_t)(BOARD_HZ / PATTERN_DRIVE_HZ / 2))
#define LEAST_TICKS (BOARD_HZ / 250000) /* dead time and least on-time: 4 us */
#define PERIODS     600
#define MEANS       100  /* some six turns */
#define BEGINS      5300 /* cycle of the stand-in drive's plan (small_drive.c) */

static pattern_drive_t drive;
static iqfoc_hal_t hal;
static volatile uint32_t periods;
static int32_t with_edges[3]; /* cycles of a leg with none, one, two and more */
static int64_t sum_q;

void board_valley_interrupt(void)
{
    pattern_drive_valley(&drive, &hal);
    for (int32_t k = 0; k < 3; k++) {
        const int32_t edges = drive.edges.leg[k].edges;
        with_edges[edges < 2 ? edges : 2]++;
    }
    sum_q += periods >= PERIODS - MEANS ? drive.i.q : 0;
}

void board_peak_interrupt(void)
{
    pattern_drive_peak(&drive, &hal);
    periods = periods + 1;
    drive.i_ref.q = periods >= 200 ? IQ24(0.4) : periods >= 100 ? IQ24(-0.3) : IQ24(0.5);
}

int main(void)
{
    if (!pattern_drive_start(&drive, 2 * HALF_TICKS, LEAST_TICKS, IQ24(0.5))) {
        console_text("refused\n");
        return 1;
    }
    const uint32_t before = board_interrupts_off();
    hal_emulated_start(&hal, HALF_TICKS, board_carrier_start(HALF_TICKS));
    hal.drive.cycle = BEGINS;
    board_interrupts_restore(before);
    while (periods < PERIODS) {
    }
    board_carrier_stop();
    const int32_t i_q = (int32_t)(sum_q / MEANS * 1000 / IQ24_ONE);
    console_text("i_q in thousandths of the rated current: ");
    console_signed(i_q);
    console_text("; legs' cycles with no edge ");
    console_signed(with_edges[0]);
    console_text(", one ");
    console_signed(with_edges[1]);
    console_text(", more ");
    console_signed(with_edges[2]);
    console_text("\n");
    return drive.stopped || i_q < 380 || i_q > 420 || with_edges[2] == 0 ? 1 : 0;
}
