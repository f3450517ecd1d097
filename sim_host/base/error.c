#include "error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void append_args(error *e, const char *format, va_list args)
{
    const size_t used = strlen(e->text);
    vsnprintf(e->text + used, sizeof e->text - used, format, args);
}

static void append(error *e, const char *format, ...) ERROR_PRINTF(2, 3);

static void append(error *e, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    append_args(e, format, args);
    va_end(args);
}

/*
 * A message quotes what a file holds, and a file may hold anything: a line break or an escape sequence in it
 * must not turn one line of bad news into two, or into a command to the terminal.
 */
static void make_one_line(char *text)
{
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c < 0x20 || c == 0x7f) {
            *text = '?';
        }
    }
}

bool error_input(error *e, const char *file, long line, long column, const char *format, ...)
{
    if (e->status != 0) {
        return false;
    }
    e->status = STATUS_UNUSABLE;
    e->text[0] = '\0';
    if (file != NULL) {
        append(e, "%s:", file);
        if (line > 0) {
            append(e, "%ld:", line);
        }
        if (line > 0 && column > 0) {
            append(e, "%ld:", column);
        }
        append(e, " ");
    }
    va_list args;
    va_start(args, format);
    append_args(e, format, args);
    va_end(args);
    make_one_line(e->text);
    return false;
}

bool error_failure(error *e, int errno_value, const char *format, ...)
{
    if (e->status != 0) {
        return false;
    }
    e->status = STATUS_FAILED;
    e->text[0] = '\0';
    va_list args;
    va_start(args, format);
    append_args(e, format, args);
    va_end(args);
    if (errno_value != 0) {
        append(e, ": %s", strerror(errno_value));
    }
    make_one_line(e->text);
    return false;
}

int error_print(const error *e)
{
    if (e->status != 0) {
        fprintf(stderr, "iqfoc: %s\n", e->text);
    }
    return e->status;
}
