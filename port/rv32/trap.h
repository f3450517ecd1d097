/*
 * Traps of the emulated RV32.
 */
#ifndef PORT_RV32_TRAP_H
#define PORT_RV32_TRAP_H

/* Where every trap arrives (mtvec, direct mode). */
void trap_handler(void);

/* The machine timer's interrupt; a program that uses the timer defines it. */
void timer_handler(void);

#endif
