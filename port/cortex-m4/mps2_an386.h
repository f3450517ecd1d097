/*
 * Registers of the board that QEMU calls mps2-an386 (Arm MPS2, application note AN386): what this port uses.
 *
 * Sources: Arm DDI 0479 "Cortex-M System Design Kit", CMSDK APB UART and APB timer; Arm DDI 0439 and
 * Armv7-M ARM for the core's own registers. The clock of the peripherals is 25 MHz.
 */
#ifndef PORT_MPS2_AN386_H
#define PORT_MPS2_AN386_H

#include <stdint.h>

/* CMSDK APB UART. */
typedef struct mps2_uart {
    volatile uint32_t data;
    volatile uint32_t state; /* bit 0: transmitter full, bit 1: byte received */
    volatile uint32_t ctrl;  /* bit 0: transmitter on, bit 1: receiver on */
    volatile uint32_t intstatus;
    volatile uint32_t bauddiv; /* 16 or more */
} mps2_uart_t;

#define MPS2_UART_STATE_TX_FULL  UINT32_C(1)
#define MPS2_UART_STATE_RX_FULL  UINT32_C(2)
#define MPS2_UART_CTRL_TX_ENABLE UINT32_C(1)
#define MPS2_UART_CTRL_RX_ENABLE UINT32_C(2)
#define MPS2_UART0               ((mps2_uart_t *)0x40004000)

/* CMSDK APB timer: counts down, reloads at zero and then raises its interrupt. */
typedef struct mps2_timer {
    volatile uint32_t ctrl; /* bit 0: on, bit 3: interrupt on */
    volatile uint32_t value;
    volatile uint32_t reload;
    volatile uint32_t intclear; /* write 1: interrupt taken */
} mps2_timer_t;

#define MPS2_TIMER_CTRL_ENABLE    UINT32_C(1)
#define MPS2_TIMER_CTRL_INTERRUPT UINT32_C(8)
#define MPS2_TIMER0               ((mps2_timer_t *)0x40000000)
#define MPS2_TIMER1               ((mps2_timer_t *)0x40001000)
#define MPS2_TIMER0_IRQ           8
#define MPS2_TIMER1_IRQ           9

/* CMSDK dual timer, its first half: a free-running counter, 32 bits, downwards. */
typedef struct mps2_dual_timer {
    volatile uint32_t load;
    volatile uint32_t value;
    volatile uint32_t ctrl; /* bit 7: on, bit 1: 32 bits */
} mps2_dual_timer_t;

#define MPS2_DUAL_TIMER_CTRL_ENABLE UINT32_C(0x80)
#define MPS2_DUAL_TIMER_CTRL_32_BIT UINT32_C(0x02)
#define MPS2_DUAL_TIMER             ((mps2_dual_timer_t *)0x40002000)

/* The core's interrupt controller (Armv7-M ARM, B3.4). */
#define ARM_NVIC_ISER0 (*(volatile uint32_t *)0xE000E100)
#define ARM_NVIC_ICER0 (*(volatile uint32_t *)0xE000E180)
#define ARM_NVIC_ICPR0 (*(volatile uint32_t *)0xE000E280)
/* Eight bits each, four to a word: the priorities of interrupts 8 to 11. Less is sooner. */
#define ARM_NVIC_IPR2 (*(volatile uint32_t *)0xE000E408)

#endif
