/*
 * A stream that writes into memory and says at its end whether all of the text is there. glibc's open_memstream keeps what fits when
 * memory runs out, and its fclose reports success.
 */
#ifndef SIM_HOST_BASE_TEXT_OUT_H
#define SIM_HOST_BASE_TEXT_OUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct text_out {
    char *bytes; /* 0-terminated once closed; to be freed */
    size_t length, room;
    bool failed;
    FILE *stream;
} text_out;

/* Stays where it is until it is closed. False when out of memory. */
bool text_out_open(text_out *t);

/* False when any of the text was lost, with `bytes` NULL; also on a text that could not be opened. */
bool text_out_close(text_out *t);

/* Writes text inside a C comment: `_` for what would end the comment or its line. */
void text_out_comment(FILE *out, const char *text);

#endif
