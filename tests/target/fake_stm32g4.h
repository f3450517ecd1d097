/*
 * A bank of memory in place of the STM32G474's registers. It records the order of writes, and answers as the
 * chip does where a sequence waits for it. Named as STM32G4_BUS_HEADER when the port is compiled for the
 * host.
 */
#ifndef TESTS_TARGET_FAKE_STM32G4_H
#define TESTS_TARGET_FAKE_STM32G4_H

#include <stdbool.h>
#include <stdint.h>

void stm32g4_write(volatile uint32_t *reg, uint32_t value);
uint32_t stm32g4_read(volatile uint32_t *reg);

#endif
