/* Help text, manual pages and shell completions, made from the commands' tables (command_table.h). */
#ifndef SIM_HOST_COMMANDS_HELP_H
#define SIM_HOST_COMMANDS_HELP_H

#include "command_table.h"

/* Version and commit, on stdout. */
void help_version(void);

/* The list of commands, on stdout. */
void help_overview(void);

/* A manual page (section 1): of the program, or of one command. */
void help_man(const command *of);

/* A script that completes commands, options, and values that are a list. */
typedef void help_completion(void);
help_completion help_bash, help_zsh, help_fish;

/* Words that an option's value is one of, in `words`: "2016|2019" has two, "F" none. Returns how many. */
enum { HELP_WORDS_MAX = 64 };
typedef struct help_words {
    int count;
    const char *of[HELP_WORDS_MAX];
    char text[200];
} help_words;
void help_values(const option_spec *spec, help_words *words);

#endif
