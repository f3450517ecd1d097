/* The STM32G474's hardware for the checklist of edges (port_check.h): TIM1, DMA and TIM2's capture, on the bank of memory. */
#ifndef TESTS_TARGET_RIG_STM32G4_EDGES_H
#define TESTS_TARGET_RIG_STM32G4_EDGES_H

#include "hal_stm32g4_edges.h"
#include "port_check.h"

#define RIG_EDGES_HALF  2500u
#define RIG_EDGES_SPANS 10u

/* Ticks from an update event to the burst's end; below a span. */
extern uint32_t rig_edges_latency;

/* Does the rig call hal_stm32g4_edges_follow at each valley, as a drive's handler does? */
extern bool rig_edges_followed;

/* Set up by the port, and running. */
const port_rig *rig_stm32g4_edges_start(void);

/* For the tests of the port itself. */
extern iqfoc_hal_t rig_edges_hal;
extern hal_stm32g4_edges_t rig_edges;

#endif
