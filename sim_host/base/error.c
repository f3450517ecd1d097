/* Bad news: put together, kept to one line, printed (error.h). */
#include "error.h"

#include "terminal.h"

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

/* Length of the UTF-8 character at `text` if it is one that prints, else 0. */
static size_t printable_length(const unsigned char *text)
{
    if (text[0] < 0x80) {
        return text[0] >= 0x20 && text[0] != 0x7f ? 1 : 0;
    }
    const size_t length = text[0] >= 0xf0 && text[0] < 0xf5   ? 4
                          : text[0] >= 0xe0 && text[0] < 0xf0 ? 3
                          : text[0] >= 0xc2 && text[0] < 0xe0 ? 2
                                                              : 0;
    for (size_t i = 1; i < length; i++) {
        if ((text[i] & 0xC0) != 0x80) {
            return 0;
        }
    }
    /* U+0080 to U+009F are control characters too. */
    return text[0] == 0xc2 && text[1] < 0xa0 ? 0 : length;
}

/*
 * A message quotes what a file holds, and a file may hold anything: a line break or an escape sequence in it
 * must not turn one line of bad news into two, or into a command to the terminal.
 */
static void make_one_line(char *text)
{
    while (*text != '\0') {
        const size_t length = printable_length((unsigned char *)text);
        if (length == 0) {
            *text = '?';
        }
        text += length > 0 ? length : 1;
    }
}

bool error_input_args(error *e, const char *file, long line, long column, const char *format, va_list args)
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
    append_args(e, format, args);
    make_one_line(e->text);
    return false;
}

bool error_input(error *e, const char *file, long line, long column, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    error_input_args(e, file, line, column, format, args);
    va_end(args);
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
        fprintf(stderr, "%siqfoc:%s %s\n", terminal_red(stderr), terminal_plain(stderr), e->text);
    }
    return e->status;
}
