/*
 * The STM32F405's hardware for iqfoc's porting checklist, on the bank of memory.
 */
#ifndef RIG_H
#define RIG_H

#include "port_check.h"

/* Carrier, converters and encoder set up by the port and running; NULL if the carrier does not start. */
const port_rig *rig_start(void);

/* A mistake to be planted in the board's values, by its number; 0: none. False if there is no such. */
bool rig_plant(int number);

#endif
