/*
 * Clock of the emulated RV32 board (port/emulated/board.h).
 */
#ifndef PORT_BOARD_CLOCK_H
#define PORT_BOARD_CLOCK_H

#define BOARD_HZ 10000000

#endif
