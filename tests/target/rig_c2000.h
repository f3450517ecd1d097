/*
 * Hardware of the F28004x and F2837xD for the porting checklist (port_check.h), on the bank of memory.
 */
#ifndef TESTS_TARGET_RIG_C2000_H
#define TESTS_TARGET_RIG_C2000_H

#include "c2000.h"
#include "port_check.h"

/*
 * Which family rig_c2000_start starts, and what is done to the registers after the port's set-up: NULL:
 * nothing.
 */
extern const c2000_chip_t *rig_c2000_chip;
/* What the HAL takes the chip for; NULL: what it is. */
extern const c2000_chip_t *rig_c2000_hal_chip;
extern void (*rig_c2000_plant)(void);

/* The hardware around registers that a firmware set up, at its valley; half_ticks: the firmware's. */
const port_rig *rig_c2000_attach(iqfoc_hal_t *hal, uint32_t half_ticks);

/* Carrier, converters and encoder set up by the port and running. */
const port_rig *rig_c2000_start(void);

#endif
