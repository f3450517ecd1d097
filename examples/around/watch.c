/* A lost phase, a lost sensor, a break: what stops the drive for good, and what it may try again. */
#include "around.h"

#include "iqfoc/restart.h"
#include "iqfoc/supervision.h"

#include <stddef.h>

static const iqfoc_supervision_config_t watched = {.i_least = IQ24(0.1),
                                                   .share = IQ24(0.125),
                                                   .window_min = 12,
                                                   .windows_bad = 3,
                                                   .sum_max = IQ24(0.2),
                                                   .sums_bad = 5};
static const iqfoc_restart_config_t restarts = {.may_restart = IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_BREAK,
                                                .wait_cycles = 5000,
                                                .tries = 3,
                                                .forget_cycles = 300000};
static iqfoc_supervision_t supervision;
static iqfoc_restart_t restart;

void around_watch(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, bool break_active)
{
    if (restart.config == NULL) {
        (void)iqfoc_supervision_init(&supervision, &watched);
        (void)iqfoc_restart_init(&restart, &restarts);
    }
    /* The bits of a trip stay set until it is cleared: they count in the cycle in which the drive is still on. */
    const bool on = cycle->enabled;
    const uint32_t trips = on && cycle->tripped ? cycle->status & cycle->config->trips : 0;
    const uint32_t lost = iqfoc_supervision_step(&supervision, sample->i, sample->speed, on);
    switch (iqfoc_restart_step(&restart, trips | lost | (break_active ? IQFOC_STATUS_BREAK : 0))) {
    case IQFOC_RESTART_TRY: /* and the port's break latch is cleared here */
        iqfoc_cycle_clear(cycle);
        cycle->enabled = true;
        break;
    case IQFOC_RESTART_RUN:
        break;
    case IQFOC_RESTART_WAIT:
    case IQFOC_RESTART_LATCHED:
    default:
        cycle->enabled = false;
        break;
    }
}
