/*
 * A bank of memory in place of the registers of an F28004x or F2837xD. It records the order of writes, loses
 * those that the core's protection would lose, and answers as the chip does where a sequence waits for it.
 * Named as C2000_BUS_HEADER when the port is compiled for the host.
 */
#ifndef TESTS_TARGET_FAKE_C2000_H
#define TESTS_TARGET_FAKE_C2000_H

#include <stdint.h>

uint16_t c2000_read(volatile uint16_t *reg);
void c2000_write(volatile uint16_t *reg, uint16_t value);
uint32_t c2000_read_long(volatile uint16_t *reg);
void c2000_write_long(volatile uint16_t *reg, uint32_t value);
void c2000_unprotect(void);
void c2000_protect(void);

#endif
