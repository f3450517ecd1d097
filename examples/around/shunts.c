/* Low-side shunts and one trigger a period: both of the cycle's calls from the valley's interrupt. */
#include "around.h"

#include "iqfoc/shunts.h"
#include "iqfoc/transform.h"

static const iqfoc_shunts_t shunts = {.duty_max = IQ24(0.9)};
static iqfoc_abc_t ended;   /* duties of the period that ended at this valley */
static iqfoc_abc_t running; /* and of the one that begins */

void around_shunts_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    sample.i = iqfoc_shunts_read(&shunts, sample.i, ended, iqfoc_clarke_inverse(cycle->i_next)).i;
    ended = running;
    iqfoc_cycle_valley(cycle, &sample, now);
    iqfoc_command_t command = iqfoc_cycle_peak(cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    command.duties.high = iqfoc_shunts_make_room(&shunts, command.duties.high);
    running = command.duties.high;
    iqfoc_hal_write(hal, &command);
}
