/*
 * Text and numbers over the board's serial line (port/emulated/console.h).
 */
#include "console.h"

void console_text(const char *text)
{
    while (*text != '\0') {
        console_send(*text++);
    }
}

void console_unsigned(uint32_t number)
{
    char digits[11];
    char *first = &digits[10];
    *first = '\0';
    do {
        *--first = (char)('0' + (int)(number % 10));
        number /= 10;
    } while (number != 0);
    console_text(first);
}

void console_signed(int32_t number)
{
    if (number < 0) {
        console_send('-');
    }
    console_unsigned(number < 0 ? 0U - (uint32_t)number : (uint32_t)number);
}

void console_hex64(uint64_t number)
{
    static const char digits[] = "0123456789abcdef";
    for (int32_t shift = 60; shift >= 0; shift -= 4) {
        console_send(digits[(number >> shift) & 15]);
    }
}
