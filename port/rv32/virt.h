/*
 * Registers of the board that QEMU calls virt (riscv32): what this port uses.
 *
 * Sources: QEMU's documentation of the machine; NS16550A data sheet for the UART; RISC-V privileged
 * architecture for machine timer and CSRs.
 */
#ifndef PORT_VIRT_H
#define PORT_VIRT_H

#include <stdint.h>

/* NS16550A, one byte a register; read and written as volatile bytes, as the bus demands. */
#define VIRT_UART_DATA   (*(volatile uint8_t *)0x10000000)
#define VIRT_UART_STATUS (*(volatile uint8_t *)0x10000005)

#define VIRT_UART_STATUS_RECEIVED 0x01
#define VIRT_UART_STATUS_TX_EMPTY 0x20

/* "sifive_test": ends the emulator. 0x5555 is success, 0x3333 failure with a status above it. */
#define VIRT_TEST (*(volatile uint32_t *)0x00100000)

/* CLINT: the 64-bit machine timer, 10 MHz, and the moment of its next interrupt, in halves. */
#define VIRT_MTIME_LOW     (*(volatile uint32_t *)0x0200BFF8)
#define VIRT_MTIME_HIGH    (*(volatile uint32_t *)0x0200BFFC)
#define VIRT_MTIMECMP_LOW  (*(volatile uint32_t *)0x02004000)
#define VIRT_MTIMECMP_HIGH (*(volatile uint32_t *)0x02004004)
#define VIRT_TIMER_HZ      10000000

#define RISCV_MSTATUS_MIE  UINT32_C(0x8)
#define RISCV_MIE_MTIE     UINT32_C(0x80)
#define RISCV_MCAUSE_TIMER UINT32_C(0x80000007)

#endif
