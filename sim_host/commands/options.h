/*
 * The options of a command: one table from which getopt_long, the help text and the error lines are made.
 *
 *     options o = options_begin(&about, argc, argv);
 *     for (int which; (which = options_next(&o, &e)) >= 0;)
 *         switch (which) { case OPT_MOTOR: motor_path = o.argument; ... }
 *     if (o.helped) return STATUS_DONE;
 *
 * Afterwards argv[o.first] ... argv[argc - 1] are the arguments that are no options.
 */
#ifndef SIM_HOST_COMMANDS_OPTIONS_H
#define SIM_HOST_COMMANDS_OPTIONS_H

#include "base/error.h"

#include <stddef.h>

typedef struct option_spec {
    const char *name;     /* "motor" for --motor; NULL ends the table */
    char letter;          /* 'o' for -o, or 0 */
    const char *argument; /* what follows, as the help shows it: "M.toml"; NULL for a switch */
    const char *help;     /* one or more lines, split by \n */
} option_spec;

typedef struct command_about {
    const char *name;         /* "simulate" */
    const char *usage;        /* what follows "iqfoc simulate " */
    const char *description;  /* a paragraph, lines split by \n */
    const option_spec *specs; /* --help need not be listed */
} command_about;

typedef struct options {
    const command_about *about;
    int argc;
    char **argv;
    const char *argument; /* of the option just returned */
    int current;          /* its index in specs */
    int first;            /* after the last option: the first other argument */
    bool helped;          /* --help was there and the help has been printed */
} options;

enum {
    OPTIONS_END = -1,  /* no more, or --help */
    OPTIONS_ERROR = -2 /* *e is set */
};

/* argv[0] is the command's name, as main hands it over. */
options options_begin(const command_about *about, int argc, char **argv);

/* The index in specs of the next option, OPTIONS_END or OPTIONS_ERROR. */
int options_next(options *o, error *e);

/* The current option's argument as a number from min to max; with *e set if it is none. */
bool options_number(const options *o, double min, double max, double *value, error *e);
bool options_integer(const options *o, long min, long max, long *value, error *e);

/* "500,3000,8000": 1 to max numbers, *count of them. */
bool options_numbers(const options *o, double low, double high, double *values, size_t max, size_t *count,
                     error *e);

/* Sets "simulate: --motor M.toml is missing". Returns false. */
bool options_missing(const options *o, int which, error *e);

/* Sets an error if there are arguments left beyond `most`. */
bool options_at_most(const options *o, int most, error *e);

#endif
