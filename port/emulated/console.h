/*
 * What the two emulated boards offer a program besides the drive: a serial line, and an end.
 */
#ifndef PORT_EMULATED_CONSOLE_H
#define PORT_EMULATED_CONSOLE_H

#include <stdint.h>

/* Sends one byte (0 ... 255) over the UART; waits while its transmitter is full. */
void console_send(int32_t byte);

/* The next byte received, 0 ... 255, or -1 if none waits. */
int32_t console_receive(void);

/* Text, and a number in decimal or as 16 hexadecimal digits: all that the images print, without a printf. */
void console_text(const char *text);
void console_unsigned(uint32_t number);
void console_signed(int32_t number);
void console_hex64(uint64_t number);

/* Ends the emulator with this exit status, 0 ... 127. */
_Noreturn void console_exit(int32_t status);

#endif
