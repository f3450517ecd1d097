/* Converters and encoder of the STM32G474's rigs (rig_stm32g4.c, rig_stm32g4_edges.c), on the bank of memory. */
#ifndef TESTS_TARGET_RIG_STM32G4_SENSORS_H
#define TESTS_TARGET_RIG_STM32G4_SENSORS_H

#include "hal_stm32g4.h"
#include "port_check.h"

/* Sensors of the rigs' board, and its half period. */
const hal_stm32g4_board_t *rig_sensors_start(uint32_t half_ticks);

/* The converters' trigger, if the timer gives it as the port has set it up. */
void rig_sensors_sample(uint32_t trgo2);

/* A rig that has these sensors and the outputs' enable bit; the timer is still to come. */
extern const port_rig rig_sensors;

#endif
