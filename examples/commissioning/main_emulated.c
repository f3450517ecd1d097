/*
 * Self-commissioning on an emulated board: a drive that knows nothing of its motor measures it, in the valley's interrupt. Prints the
 * results with the half widths of their intervals, and compares them with the stand-in drive (shaft_drive.c). Exit status 1 if the
 * run does not end well, or a result is off by more than 1 percent.
 */
#include "board.h"
#include "board_clock.h"
#include "console.h"
#include "hal_emulated.h"

#include "iqfoc/commission.h"
#include "iqfoc/extension_params.h"

#define PWM_HZ     5000
#define HALF_TICKS ((uint32_t)(BOARD_HZ / PWM_HZ / 2))
#define T_S        (1.0 / PWM_HZ)
#define I_BASE_A   14.8492424
#define U_DC_V     750.0

/* The converters of the stand-in drive have steps and no noise: their rounding does not average out, the shares allow for it. */
static const iqfoc_commission_config_t config = {
    .offset = {.settle = 10, .count_log2 = 8, .offset_max = IQ24(0.1), .noise_max = IQ24(0.02)},
    .start = {.i_align = IQ24(0.5),
              .ramp_cycles = 1500,
              .hold_cycles = 8000,
              .speed_end = IQ24(0.02),
              .run_up_cycles = 6000},
    .i_max = IQ24(1.0),
    .speed_max = IQ24(0.03),
    .u_max = IQ24(0.4),
    .cycles_max = 100000,
    .settle_cycles = 500,
    .block_log2 = 6,
    .half_log2 = 1,
    .share_r = IQ24(0.005),
    .share_l = IQ24(0.005),
    .share_psi = IQ24(0.002)};

static iqfoc_commission_t commission;
static iqfoc_hal_t hal;

void board_valley_interrupt(void)
{
    iqfoc_sample_t sample;
    iqfoc_hal_read_valley(&hal, &sample);
    const iqfoc_command_t command = iqfoc_commission_step(&commission, &sample);
    iqfoc_hal_write(&hal, &command);
}

void board_peak_interrupt(void)
{
}

/* In millionths of the base. */
static void print_millionths(iq24_t x)
{
    console_signed((int32_t)((int64_t)x * 1000000 / IQ24_ONE));
}

/* One line; false if the result is off by more than 1 percent. */
static bool shown(const char *name, iqfoc_commission_value_t found, iq24_t truth)
{
    console_text(name);
    print_millionths(found.value);
    console_text(" +- ");
    print_millionths(found.half);
    console_text(", true ");
    print_millionths(truth);
    console_text("\n");
    return iq24_abs_sat(found.value - truth) <= iq24_mul_round(truth, IQ24(0.01));
}

int main(void)
{
    if (iqfoc_commission_init(&commission, &config) != IQFOC_OK) {
        console_text("refused\n");
        return 1;
    }
    const uint32_t before = board_interrupts_off();
    hal_emulated_start(&hal, HALF_TICKS, board_carrier_start(HALF_TICKS));
    board_interrupts_restore(before);
    const volatile iqfoc_commission_end_t *end = &commission.end;
    while (*end == IQFOC_COMMISSION_RUNNING) {
    }
    board_carrier_stop();
    const iqfoc_commission_result_t *x = &commission.result;
    const iq24_t l = IQFOC_FLUX_L(5.2e-3, T_S, I_BASE_A, U_DC_V);
    bool good = commission.end == IQFOC_COMMISSION_DONE;
    console_text("end ");
    console_unsigned((uint32_t)commission.end);
    console_text(" in phase ");
    console_unsigned((uint32_t)commission.phase);
    console_text(" after ");
    console_unsigned(commission.cycles);
    console_text(" cycles; in millionths of the base:\n");
    good = shown("R    ", x->r, IQFOC_FLUX_R(0.75, I_BASE_A, U_DC_V)) && good;
    good = shown("L_d  ", x->l_d, l) && good;
    good = shown("L_q  ", x->l_q, l) && good;
    good = shown("psi  ", x->psi, IQFOC_FLUX_PSI(0.134, T_S, U_DC_V)) && good;
    console_text("dead ");
    print_millionths(x->v_dead.value);
    console_text(" +- ");
    print_millionths(x->v_dead.half);
    console_text("\n");
    return good ? 0 : 1;
}
