/*
 * HAL of the emulated boards (port/emulated/hal_emulated.h).
 */
#include "hal_emulated.h"

#include "board.h"

static const iqfoc_command_t gates_off = {{{0, 0, 0}, IQ24_ONE}, false};

void hal_emulated_start(iqfoc_hal_t *hal, uint32_t half_ticks, uint32_t first_valley)
{
    small_drive_start(&hal->drive);
    hal->half_ticks = half_ticks;
    hal->next_time = first_valley;
    hal->next_is_valley = true;
    hal->shadow = gates_off;
    hal->active = gates_off;
    hal->by_edges = false;
    hal->edges_wait = false;
    hal->edges_act = false;
    hal->valley = small_drive_sample(&hal->drive);
    hal->valley.time = first_valley - 2 * half_ticks;
    hal->peak = hal->valley;
    hal->peak.time = first_valley - half_ticks;
}

/* ---- Edges ---- */

/* The share of the ticks from..to that a leg is high. */
static iq24_t high_share(const iqfoc_leg_edges_t *leg, uint32_t from, uint32_t to)
{
    int32_t level = leg->level;
    uint32_t since = from;
    uint32_t high = 0;
    for (int32_t k = 0; k < leg->edges && leg->instant[k] < to; k++) {
        const uint32_t at = leg->instant[k] > from ? leg->instant[k] : from;
        high += level > 0 ? at - since : 0;
        since = at;
        level = -level;
    }
    high += level > 0 ? to - since : 0;
    return (iq24_t)(((uint64_t)high << IQ24_FRACTION_BITS) / (to - from));
}

/* The command of a half period that gives the drive the voltage of its edges. */
static void take_half(iqfoc_hal_t *hal)
{
    const uint32_t from = hal->next_is_valley ? hal->half_ticks : 0;
    iqfoc_abc_t *high = &hal->active.duties.high;
    high->a = high_share(&hal->edges.leg[0], from, from + hal->half_ticks);
    high->b = high_share(&hal->edges.leg[1], from, from + hal->half_ticks);
    high->c = high_share(&hal->edges.leg[2], from, from + hal->half_ticks);
}

/* The edges that wait become those of the cycle that begins; without any, the legs keep their levels. */
static void begin_edges(iqfoc_hal_t *hal)
{
    if (hal->edges_wait) {
        hal->edges = hal->edges_shadow;
        hal->edges_wait = false;
    } else if (hal->edges_act) {
        for (int32_t k = 0; k < 3; k++) {
            iqfoc_leg_edges_t *leg = &hal->edges.leg[k];
            leg->level = leg->edges % 2 == 0 ? leg->level : -leg->level;
            leg->edges = 0;
        }
    }
    hal->edges_act = hal->by_edges;
}

/* Valley or peak: the drive has come to here, the converters sample, at a valley the shadow registers act. */
static void instant(iqfoc_hal_t *hal)
{
    if (hal->edges_act) {
        take_half(hal);
    }
    small_drive_advance_half(&hal->drive, &hal->active);
    if (hal->next_is_valley) {
        small_drive_begin_cycle(&hal->drive);
        hal->active = hal->shadow;
        begin_edges(hal);
        hal->valley = small_drive_sample(&hal->drive);
        hal->valley.instant = 0;
        hal->valley.time = hal->next_time;
    } else {
        hal->peak = small_drive_sample(&hal->drive);
        hal->peak.instant = IQ24_ONE / 2;
        hal->peak.time = hal->next_time;
    }
    hal->next_is_valley = !hal->next_is_valley;
    hal->next_time += hal->half_ticks;
}

/*
 * The peak's handler may interrupt the valley's anywhere; registers of a chip would not mind,
 * this drive would.
 */
static void catch_up(iqfoc_hal_t *hal)
{
    const uint32_t before = board_interrupts_off();
    while ((int32_t)(board_ticks() - hal->next_time) >= 0) {
        instant(hal);
    }
    board_interrupts_restore(before);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    catch_up(hal);
    *sample = hal->valley;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    catch_up(hal);
    *sample = hal->peak;
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    catch_up(hal);
    hal->shadow = *command;
    hal->by_edges = false;
    hal->edges_wait = false;
    if (!command->gates) {
        hal->active = *command;
        hal->edges_act = false;
    }
}

void iqfoc_hal_write_edges(iqfoc_hal_t *hal, const iqfoc_edges_t *edges)
{
    if (edges->period_ticks != 2 * hal->half_ticks) {
        iqfoc_hal_write(hal, &gates_off);
        return;
    }
    catch_up(hal);
    hal->shadow.gates = true;
    hal->edges_shadow = *edges;
    hal->by_edges = true;
    hal->edges_wait = true;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    (void)hal;
    return board_ticks();
}
