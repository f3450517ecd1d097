/*
 * Clock of the emulated Cortex-M4 board (port/emulated/board.h).
 */
#ifndef PORT_BOARD_CLOCK_H
#define PORT_BOARD_CLOCK_H

#define BOARD_HZ 25000000

#endif
