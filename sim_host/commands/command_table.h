/* All commands, in the order of the help: the one list that main, the help, the man pages and the completions are made from. */
#ifndef SIM_HOST_COMMANDS_COMMAND_TABLE_H
#define SIM_HOST_COMMANDS_COMMAND_TABLE_H

#include "command.h"

typedef struct command {
    const command_about *about;
    const char *summary;
    int (*run)(int argc, char **argv);
    unsigned needs; /* before it knows its arguments: base/confine.h */
} command;

#ifdef IQFOC_FMU
enum { COMMANDS = 13 };
#else
enum { COMMANDS = 12 };
#endif

extern const command command_table[COMMANDS];

/* NULL, and *e says so, with the one that was likely meant; `given` may be NULL. */
const command *command_find(const char *given, error *e);

#endif
