/*
 * The host's port: the HAL (iqfoc/hal.h) with the simulated drive behind it. The plant's sensor readings
 * become the per-unit numbers that a converter, an encoder and a timer would deliver; the command waits for
 * the next valley.
 */
#ifndef PORT_HOST_HAL_HOST_H
#define PORT_HOST_HAL_HOST_H

#include "params_host.h"
#include "plant/plant.h"

#include "iqfoc/hal.h"

/* The simulated free-running timer: 100 MHz. */
#define HAL_HOST_TICKS_PER_S 1e8

/* The port's state: `struct iqfoc_hal` of the host. */
struct iqfoc_hal {
    iqfoc_sample_t sample;   /* of the interrupt that runs */
    uint32_t latency_ticks;  /* from the sampling instant to the interrupt */
    uint32_t compute_ticks;  /* that pass between two looks at the timer */
    uint32_t now_ticks;      /* the timer, as the handler sees it next */
    iqfoc_command_t command; /* what the next valley brings into force */
    iqfoc_edges_t edges;     /* the same where edges were written last */
    bool by_edges;           /* they were */
    long written;            /* commands and edges written */
};

/*
 * Readings to a sample: at = 0 at the valley, 0.5 at the peak. A current at the end of the converter's range,
 * or beyond what the library's numbers hold, is marked as clipped.
 */
iqfoc_sample_t hal_host_sample(const plant_samples *readings, const plant_sensors *sensors,
                               const per_unit *base, iq24_t at);

/* The carrier is at its valley or peak: what the handler will read, and when it starts. */
void hal_host_interrupt(iqfoc_hal_t *hal, const iqfoc_sample_t *sample);

#endif
