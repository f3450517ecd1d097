/* The sequences of ECMA-48 (terminal.h). */
#define _XOPEN_SOURCE 700 /* POSIX: fileno */

#include "terminal.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *where_wanted(FILE *stream, const char *sequence)
{
    const char *no_color = getenv("NO_COLOR");
    const char *kind = getenv("TERM");
    const bool wanted = isatty(fileno(stream)) == 1 && (no_color == NULL || no_color[0] == '\0') &&
                        kind != NULL && strcmp(kind, "dumb") != 0;
    return wanted ? sequence : "";
}

const char *terminal_bold(FILE *stream)
{
    return where_wanted(stream, "\033[1m");
}

const char *terminal_red(FILE *stream)
{
    return where_wanted(stream, "\033[1;31m");
}

const char *terminal_plain(FILE *stream)
{
    return where_wanted(stream, "\033[0m");
}
