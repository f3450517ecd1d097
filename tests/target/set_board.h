/* The board's services (board.h) with a clock that the program sets. Included once in a program. */
#ifndef TESTS_TARGET_SET_BOARD_H
#define TESTS_TARGET_SET_BOARD_H

#include "board.h"

static uint32_t clock_ticks;

uint32_t board_ticks(void)
{
    return clock_ticks;
}

uint32_t board_interrupts_off(void)
{
    return 0;
}

void board_interrupts_restore(uint32_t before)
{
    (void)before;
}

#endif
