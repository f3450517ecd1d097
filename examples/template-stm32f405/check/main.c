/*
 * Ticks off iqfoc's porting checklist for this port: exit status 0 if every line is. With a number, a mistake is
 * planted first (rig.h), and the status is 0 if a line noticed.
 */
#include "board.h"
#include "fake_bank.h"
#include "rig.h"

#include <stdio.h>
#include <stdlib.h>

/* The parts of set-up that the checklist has no word for. */
static int check_set_up(void)
{
    fake_reset();
    const bool clock = board_clock_start(&fake_chip);
    board_pins_start(&fake_chip);
    const bool pins = (fake_bank.gpioa.MODER >> 16 & 0x3F) == 0x2A && fake_bank.gpiob.MODER >> 24 == 0xAA &&
                      (fake_bank.gpioc.MODER & 0xFF) == 0xFF;
    (void)printf("[%c] clock\n[%c] pins\n", clock ? 'x' : ' ', pins ? 'x' : ' ');
    return (clock ? 0 : 1) + (pins ? 0 : 1);
}

int main(int count, char **words)
{
    const int number = count > 1 ? (int)strtol(words[1], NULL, 10) : 0;
    if (!rig_plant(number) || rig_start() == NULL) {
        (void)fprintf(stderr, "port_check: no such mistake, or the carrier does not start\n");
        return 2;
    }
    const int failed = check_set_up() + port_check_all(rig_start, stdout);
    return (failed != 0) == (number != 0) ? 0 : 1;
}
