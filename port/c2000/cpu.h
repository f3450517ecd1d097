/*
 * The core's interrupts by TI's compiler, for main.c. A test gives its own functions.
 */
#ifndef PORT_C2000_CPU_H
#define PORT_C2000_CPU_H

#include <stdint.h>

#if defined(__TMS320C28XX__)
#define C2000_INTERRUPT __interrupt

extern cregister volatile unsigned int IER;

/* groups: bit 0 is the PIE's group 1. */
static inline void c2000_interrupts_on(uint16_t groups)
{
    IER |= groups;
    __enable_interrupts();
}

/* Waits for an interrupt. */
static inline void c2000_idle(void)
{
    __asm(" IDLE");
}
#else
#define C2000_INTERRUPT
void c2000_interrupts_on(uint16_t groups);
void c2000_idle(void);
#endif

/* A handler's address for c2000_interrupts_start. */
#define C2000_ADDRESS(handler) ((uint32_t)(uintptr_t)(handler))

#endif
