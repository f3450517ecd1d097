/* All commands, in the order of the help. main, help, manual pages and completions use this table. */
#ifndef SIM_HOST_COMMANDS_COMMAND_TABLE_H
#define SIM_HOST_COMMANDS_COMMAND_TABLE_H

#include "command.h"

typedef struct command {
    const command_about *about;
    const char *summary;
    int (*run)(int argc, char **argv);
    unsigned needs; /* rights of the process, before the arguments are known: base/confine.h */
} command;

#ifdef IQFOC_FMU
enum { COMMANDS = 19 };
#else
enum { COMMANDS = 18 };
#endif

extern const command command_table[COMMANDS];

/* NULL with *e set for an unknown name; the message suggests the closest one. `given` may be NULL. */
const command *command_find(const char *given, error *e);

#endif
