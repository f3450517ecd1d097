/*
 * The STM32G474's hardware for the porting checklist (port_check.h), on the bank of memory.
 */
#ifndef TESTS_TARGET_RIG_STM32G4_H
#define TESTS_TARGET_RIG_STM32G4_H

#include "port_check.h"

/* Carrier, converters and encoder set up by the port and running. */
const port_rig *rig_stm32g4_start(void);

/* The same rig as it is, without a new start. */
const port_rig *rig_stm32g4(void);

#endif
