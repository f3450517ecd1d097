/*
 * Semihosting: the emulator does for the image what it asks by a trap. Both boards know it.
 */
#ifndef PORT_EMULATED_SEMIHOST_H
#define PORT_EMULATED_SEMIHOST_H

#include <stdint.h>

/* Operations (Arm IHI 0065 / "Semihosting for AArch32 and AArch64"; RISC-V uses the same numbers). */
#define SEMIHOST_OPEN          0x01
#define SEMIHOST_WRITE         0x05
#define SEMIHOST_READ          0x06
#define SEMIHOST_EXIT_EXTENDED 0x20

/* One call: operation and the address of its arguments; returns what the emulator answers. Per target. */
intptr_t semihost_call(intptr_t operation, const void *arguments);

/*
 * The emulator's console, whole blocks at a time. An emulated UART hands over one byte per turn of the
 * emulator's main loop: too slow for two samples in every control cycle.
 */

/* Waits for at least one byte; returns how many came, at most count. 0: the other end is closed. */
uint32_t semihost_receive(uint8_t *bytes, uint32_t count);
void semihost_send(const uint8_t *bytes, uint32_t count);

#endif
