/* The HAL with the simulated drive behind it (hal_host.h). */
#include "hal_host.h"

#include <math.h>

/* The library's limit for a phase current in per unit. */
#define CURRENT_MAX_PU 15.9

static iq24_t current(double i_A, const plant_sensors *sensors, const per_unit *base, bool *clipped)
{
    const double i_pu = i_A / base->I_A;
    const double step_A = ldexp(sensors->current_full_scale_A, 1 - sensors->current_bits);
    if (sensors->current_bits > 0 && fabs(i_A) >= sensors->current_full_scale_A - 1.5 * step_A) {
        *clipped = true;
    }
    if (fabs(i_pu) > CURRENT_MAX_PU) {
        *clipped = true;
        return iq24_from_double(copysign(CURRENT_MAX_PU, i_pu));
    }
    return iq24_from_double(i_pu);
}

iqfoc_sample_t hal_host_sample(const plant_samples *readings, const plant_sensors *sensors,
                               const per_unit *base, iq24_t at)
{
    iqfoc_sample_t sample = {.instant = at};
    sample.i.a = current(readings->i_A[0], sensors, base, &sample.clipped);
    sample.i.b = current(readings->i_A[1], sensors, base, &sample.clipped);
    sample.i.c = current(readings->i_A[2], sensors, base, &sample.clipped);
    sample.theta = turns_from_rad(readings->theta_e_rad);
    sample.speed = turns_from_speed(readings->omega_e_rad_s, base->T_s);
    sample.u_dc = iq24_from_double(readings->u_dc_V / base->U_V);
    /* The timer wraps: whole periods of 2^32 ticks drop out. */
    sample.time = (uint32_t)fmod(nearbyint(readings->t_s * HAL_HOST_TICKS_PER_S), 4294967296.0);
    return sample;
}

/* Sums of ticks wrap as the timer does. */
static uint32_t ticks_after(uint32_t ticks, uint32_t more)
{
    return (uint32_t)(((uint64_t)ticks + more) & UINT32_MAX);
}

void hal_host_interrupt(iqfoc_hal_t *hal, const iqfoc_sample_t *sample)
{
    hal->sample = *sample;
    hal->now_ticks = ticks_after(sample->time, hal->latency_ticks);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    *sample = hal->sample;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    *sample = hal->sample;
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    hal->command = *command;
    hal->by_edges = false;
    hal->written++;
}

void iqfoc_hal_write_edges(iqfoc_hal_t *hal, const iqfoc_edges_t *edges)
{
    hal->edges = *edges;
    hal->by_edges = true;
    hal->written++;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    const uint32_t now = hal->now_ticks;
    hal->now_ticks = ticks_after(now, hal->compute_ticks);
    return now;
}
