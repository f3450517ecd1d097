/*
 * What picolibc wants of a system: text goes out by the UART, and that is all. For test programs that print.
 */
#include "console.h"

#include <stdio.h>
#include <stdlib.h>

static int send(char character, FILE *file)
{
    (void)file;
    console_send(character);
    return character;
}

static FILE serial = FDEV_SETUP_STREAM(send, NULL, NULL, _FDEV_SETUP_WRITE);
FILE *const stdout = &serial;
FILE *const stderr = &serial;

_Noreturn void _exit(int status)
{
    console_exit(status);
}
