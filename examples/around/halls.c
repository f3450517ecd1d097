/* Three Halls and nothing else: torque from the first cycle on, without alignment. */
#include "around.h"

#include "iqfoc/halls.h"

#include <stddef.h>

static const iqfoc_halls_config_t config = IQFOC_HALLS(2000);
static iqfoc_halls_t halls;

void around_halls_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal, uint32_t bits, uint32_t since_q8)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    if (halls.config == NULL && iqfoc_halls_init(&halls, &config) != IQFOC_OK) {
        cycle->enabled = false;
        return;
    }
    iqfoc_halls_step(&halls, bits, since_q8);
    sample.theta = halls.theta;
    sample.speed = halls.speed;
    cycle->enabled = cycle->enabled && halls.faults == 0;
    iqfoc_cycle_valley(cycle, &sample, now);
}
