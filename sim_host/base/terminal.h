/*
 * Emphasis where somebody looks: on a terminal, unless NO_COLOR is set (no-color.org) or the terminal is a "dumb" one. All are
 * the empty text elsewhere, so that files and pipes hold plain text.
 */
#ifndef SIM_HOST_BASE_TERMINAL_H
#define SIM_HOST_BASE_TERMINAL_H

#include <stdio.h>

const char *terminal_bold(FILE *stream);
const char *terminal_red(FILE *stream);
const char *terminal_plain(FILE *stream);

#endif
