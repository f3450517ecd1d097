/* Latch and restart after a break (include/iqfoc/restart.h). */
#include "iqfoc/restart.h"

#include <stddef.h>

#define CYCLES_MAX (UINT32_C(1) << 31)

iqfoc_error_t iqfoc_restart_init(iqfoc_restart_t *restart, const iqfoc_restart_config_t *config)
{
    if (restart == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (config->wait_cycles < 1 || config->wait_cycles > CYCLES_MAX || config->forget_cycles < 1 ||
        config->forget_cycles > CYCLES_MAX) {
        return IQFOC_ERROR_RESTART;
    }
    const iqfoc_restart_t fresh = {config, IQFOC_RESTART_RUN, 0, 0, 0};
    *restart = fresh;
    return IQFOC_OK;
}

/* A fault, in any state: `quiet` restarts, so that a cause that persists delays the try. */
static iqfoc_restart_action_t after_fault(iqfoc_restart_t *restart, uint32_t faults)
{
    const bool running = restart->action == IQFOC_RESTART_RUN || restart->action == IQFOC_RESTART_TRY;
    restart->faults |= faults;
    restart->quiet = 0;
    if (restart->action == IQFOC_RESTART_LATCHED || (faults & ~restart->config->may_restart) != 0 ||
        (running && restart->tried >= restart->config->tries)) {
        return IQFOC_RESTART_LATCHED;
    }
    return IQFOC_RESTART_WAIT;
}

static iqfoc_restart_action_t while_quiet(iqfoc_restart_t *restart)
{
    restart->quiet += restart->quiet < UINT32_MAX ? 1 : 0;
    switch (restart->action) {
    case IQFOC_RESTART_WAIT:
        if (restart->quiet < restart->config->wait_cycles) {
            return IQFOC_RESTART_WAIT;
        }
        restart->quiet = 0;
        restart->tried += restart->tried < UINT32_MAX ? 1 : 0;
        return IQFOC_RESTART_TRY;
    case IQFOC_RESTART_LATCHED:
        return IQFOC_RESTART_LATCHED;
    case IQFOC_RESTART_RUN:
    case IQFOC_RESTART_TRY:
    default:
        restart->tried = restart->quiet >= restart->config->forget_cycles ? 0 : restart->tried;
        return IQFOC_RESTART_RUN;
    }
}

iqfoc_restart_action_t iqfoc_restart_step(iqfoc_restart_t *restart, uint32_t faults)
{
    restart->action = faults != 0 ? after_fault(restart, faults) : while_quiet(restart);
    return restart->action;
}

void iqfoc_restart_acknowledge(iqfoc_restart_t *restart)
{
    if (restart->action == IQFOC_RESTART_LATCHED) {
        restart->action = IQFOC_RESTART_WAIT;
        restart->faults = 0;
        restart->quiet = 0;
        restart->tried = 0;
    }
}
