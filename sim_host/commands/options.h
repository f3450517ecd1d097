/*
 * The options of a command: one table of their names, help texts and variables, for parsing, help and error messages.
 *
 *     static request asked = {...};
 *     static const option_spec specs[] = {{"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path, .needed = true},
 *                                         {.name = NULL}};
 *     options o = options_begin(&about, argc, argv);
 *     ok = options_read(&o, &e) && (o.helped || (options_complete(&o, &e) && run(...)));
 *
 * Afterwards argv[o.first] ... argv[argc - 1] are the arguments that are no options.
 */
#ifndef SIM_HOST_COMMANDS_OPTIONS_H
#define SIM_HOST_COMMANDS_OPTIONS_H

#include "base/error.h"

#include <stddef.h>

struct options;

enum { OPTION_TEXTS_MAX = 32 };

/* All values of a repeatable option. */
typedef struct option_texts {
    const char *of[OPTION_TEXTS_MAX];
    int count;
} option_texts;

typedef struct option_spec {
    const char *name;     /* "motor" for --motor; NULL ends the table */
    char letter;          /* 'o' for -o, or 0 */
    const char *argument; /* the value, as the help shows it: "M.toml"; NULL for a switch */
    const char *help;     /* one or more lines, separated by \n */
    /* The variable: one of these pointers is set. */
    const char **text;
    option_texts *texts;
    bool *flag;
    long *integer;  /* from low to high */
    double *number; /* from low to high */
    size_t *count;  /* set: `number` is an array of `most`, separated by commas */
    size_t most;
    double low, high;
    bool (*take)(const struct options *o, error *e); /* for all other kinds */
    bool needed;  /* options_complete reports it as missing; only with `text` */
    bool written; /* a file that the command writes: reserved (base/inputs.h); only with `text` */
} option_spec;

typedef struct command_about {
    const char *name;         /* "simulate" */
    const char *usage;        /* the text after "iqfoc simulate " */
    const char *description;  /* a paragraph, lines separated by \n */
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

/* --help itself, as the help shows it. */
extern const option_spec options_help;

/* Prints the text of --help. */
void options_print_help(const command_about *about);

enum {
    OPTIONS_END = -1,  /* no more, or --help */
    OPTIONS_ERROR = -2 /* *e is set */
};

/* argv[0] is the command's name, as main hands it over. */
options options_begin(const command_about *about, int argc, char **argv);

/* The index in specs of the next option, OPTIONS_END or OPTIONS_ERROR. */
int options_next(options *o, error *e);

/* Reads all options into their variables. True, too, after --help: o->helped. */
bool options_read(options *o, error *e);

/* False with *e set if an argument is left over, or a needed option is missing. */
bool options_complete(const options *o, error *e);

/* The current option's argument as a number from min to max; false with *e set otherwise. */
bool options_number(const options *o, double min, double max, double *value, error *e);
bool options_integer(const options *o, long min, long max, long *value, error *e);

/* "500,3000,8000": 1 to max numbers, *count of them. */
bool options_numbers(const options *o, double low, double high, double *values, size_t max, size_t *count,
                     error *e);

/* The option of this name; the table has it. */
const option_spec *options_find(const command_about *about, const char *name);

/* Sets "simulate: --motor M.toml is missing". Returns false. */
bool options_missing(const options *o, const char *name, error *e);

/* False with *e set unless there is one other argument, a recording. */
bool options_recording(const options *o, error *e);

/* False with *e set if there are more than `most` other arguments. */
bool options_at_most(const options *o, int most, error *e);

#endif
