/* What a register is on the host: STM32F405_BUS_HEADER. */
#ifndef FAKE_BUS_H
#define FAKE_BUS_H

#include <stdint.h>

void reg_write(volatile uint32_t *reg, uint32_t value);
uint32_t reg_read(volatile uint32_t *reg);

#endif
