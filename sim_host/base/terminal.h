/*
 * Bold text on a terminal, unless NO_COLOR is set (no-color.org) or the terminal is "dumb". Elsewhere the functions return empty text, so
 * that files and pipes hold plain text.
 */
#ifndef SIM_HOST_BASE_TERMINAL_H
#define SIM_HOST_BASE_TERMINAL_H

#include <stdio.h>

const char *terminal_bold(FILE *stream);
const char *terminal_red(FILE *stream);
const char *terminal_plain(FILE *stream);

#endif
