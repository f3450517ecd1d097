/*
 * Closed loop with the small emulated drive (closed_loop.h). The board's clock is a variable here: the run depends on
 * no timer and is the same everywhere.
 */
#include "closed_loop.h"

#include "digest.h"
#include "hal_emulated.h"
#include "set_board.h"

#define HALF_TICKS 1000

static void add_state(uint64_t *digest, const iqfoc_cycle_t *cycle, const iqfoc_command_t *command)
{
    digest_add(digest, command->duties.high.a);
    digest_add(digest, command->duties.high.b);
    digest_add(digest, command->duties.high.c);
    digest_add(digest, command->duties.scale);
    digest_add(digest, command->gates);
    digest_add(digest, cycle->i_dq.d);
    digest_add(digest, cycle->i_dq.q);
    digest_add(digest, cycle->i_next.alpha);
    digest_add(digest, cycle->i_next.beta);
    digest_add(digest, cycle->error.alpha);
    digest_add(digest, cycle->error.beta);
    digest_add(digest, (int32_t)cycle->status);
}

static int32_t larger(int32_t x, int32_t y)
{
    return x > y ? x : y;
}

closed_loop_result_t closed_loop_run(void)
{
    static const iqfoc_feedback_t feedbacks[3] = {IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                                                  IQFOC_FEEDBACK_CORRECTED_MEAN, IQFOC_FEEDBACK_MIDPOINT};
    iqfoc_cycle_config_t config = small_drive_config;
    iqfoc_cycle_t cycle;
    iqfoc_hal_t hal;
    closed_loop_result_t result = {DIGEST_START, 0, 0, 0};
    uint32_t since_limit = 0;
    config.period_ticks = 2 * HALF_TICKS;
    config.tolerance_ticks = 1;
    config.stale_ticks = 1;
    config.deadline_ticks = 1;
    (void)iqfoc_cycle_init(&cycle, &config);
    cycle.enabled = true;
    clock_ticks = 0;
    hal_emulated_start(&hal, HALF_TICKS, 0);
    for (uint32_t k = 0; k < CLOSED_LOOP_CYCLES; k++) {
        config.feedback = feedbacks[k / 7000];
        cycle.i_ref = small_drive_reference(k);
        iqfoc_isr_valley(&cycle, &hal);
        clock_ticks += HALF_TICKS;
        iqfoc_isr_peak(&cycle, &hal);
        clock_ticks += HALF_TICKS;
        add_state(&result.digest, &cycle, &hal.shadow);

        since_limit = hal.shadow.duties.scale < IQ24_ONE ? 0 : since_limit + 1;
        result.limited += hal.shadow.duties.scale < IQ24_ONE ? 1 : 0;
        if (k % 500 >= 400 && since_limit >= 400) {
            const int32_t d = iq24_abs_sat(cycle.i_ref.d - cycle.i_dq.d);
            result.worst_error =
                larger(result.worst_error, larger(d, iq24_abs_sat(cycle.i_ref.q - cycle.i_dq.q)));
        }
    }
    result.status = cycle.status;
    return result;
}
