/* What drive.h asks of the port beyond the HAL, on the STM32F405. */
#include "drive.h"
#include "hal_stm32f405.h"

void port_set_offset(iqfoc_hal_t *hal, iqfoc_abc_t offset)
{
    hal->i_offset = offset;
}

void port_set_predicted(iqfoc_hal_t *hal, iqfoc_abc_t current)
{
    hal->i_predicted = current;
}

/* Restarts the tracker: all its angles change. */
void port_align(iqfoc_hal_t *hal, iq24_t theta)
{
    iqfoc_encoder_align(&hal->encoder, hal->count, theta);
    iqfoc_tracker_restart(&hal->tracker);
}

bool port_angle_lost(const iqfoc_hal_t *hal)
{
    return hal->tracker.lost;
}

bool port_break(const iqfoc_hal_t *hal)
{
    return hal_broken(hal) || hal_break_active(hal);
}

void port_clear_break(iqfoc_hal_t *hal)
{
    hal_clear_break(hal);
}
