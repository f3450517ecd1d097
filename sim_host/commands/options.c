/* Options of a command: parsing, help text and error messages (options.h). */
#define _GNU_SOURCE /* getopt_long */

#include "options.h"

#include "base/inputs.h"
#include "base/number.h"
#include "base/suggest.h"
#include "base/terminal.h"

#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum {
    OPTIONS_MAX = 32,
    HELP_COLUMN = 28,           /* column of the explanations */
    OPTION_BASE = UCHAR_MAX + 1 /* getopt_long's values for specs[i]: beyond all letters */
};

static int spec_count(const command_about *about)
{
    int count = 0;
    while (about->specs[count].name != NULL) {
        count++;
    }
    return count;
}

/* ---- help ---- */

static void print_option(const option_spec *spec)
{
    char left[80];
    const bool lettered = spec->letter != 0;
    const int width =
        snprintf(left, sizeof left, "  %c%c%c --%s%s%s", lettered ? '-' : ' ', lettered ? spec->letter : ' ',
                 lettered ? ',' : ' ', spec->name, spec->argument != NULL ? " " : "",
                 spec->argument != NULL ? spec->argument : "");
    printf("%-*s", HELP_COLUMN, left);
    if (width >= HELP_COLUMN) {
        printf("\n%*s", HELP_COLUMN, "");
    }
    for (const char *line = spec->help; line != NULL;) {
        const size_t length = strcspn(line, "\n");
        printf("%.*s\n", (int)length, line);
        line = line[length] == '\n' ? line + length + 1 : NULL;
        if (line != NULL) {
            printf("%*s", HELP_COLUMN, "");
        }
    }
}

const option_spec options_help = {.name = "help", .letter = 'h', .help = "print this text"};

void options_print_help(const command_about *about)
{
    printf("usage: iqfoc %s%s%s %s\n\n%s\n\n", terminal_bold(stdout), about->name, terminal_plain(stdout),
           about->usage, about->description);
    for (const option_spec *spec = about->specs; spec->name != NULL; spec++) {
        print_option(spec);
    }
    print_option(&options_help);
}

/* ---- parsing ---- */

options options_begin(const command_about *about, int argc, char **argv)
{
    optind = 0; /* glibc: restart the parser */
    opterr = 0; /* error messages are printed here */
    return (options){.about = about, .argc = argc, .argv = argv, .current = -1};
}

static int refuse_unknown(const options *o, error *e)
{
    const char *given = o->argv[optind - 1];
    if (optopt > 0 && optopt <= UCHAR_MAX && strncmp(given, "--", 2) != 0) {
        error_input(e, NULL, 0, 0, "%s: unknown option -%c; `iqfoc %s --help` lists them", o->about->name,
                    optopt, o->about->name);
        return OPTIONS_ERROR;
    }
    if (optopt >= OPTION_BASE) {
        error_input(e, NULL, 0, 0, "%s: --%s takes no value", o->about->name,
                    o->about->specs[optopt - OPTION_BASE].name);
        return OPTIONS_ERROR;
    }
    char word[80];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(given + 2, "="), given + 2);
    const char *names[OPTIONS_MAX];
    const int count = spec_count(o->about);
    for (int i = 0; i < count; i++) {
        names[i] = o->about->specs[i].name;
    }
    const char *meant = suggest(word, names, (size_t)count);
    error_input(e, NULL, 0, 0,
                meant != NULL ? "%s: unknown option --%s; did you mean --%s?"
                              : "%s: unknown option --%s; `iqfoc %s --help` lists them",
                o->about->name, word, meant != NULL ? meant : o->about->name);
    return OPTIONS_ERROR;
}

/* The index in specs of an option of ours that getopt_long has returned. */
static int index_of(const command_about *about, int got)
{
    int n = 0;
    while (about->specs[n].name != NULL && got != OPTION_BASE + n && got != about->specs[n].letter) {
        n++;
    }
    return n;
}

static int refuse_without_value(const options *o, error *e)
{
    const option_spec *spec = &o->about->specs[index_of(o->about, optopt)];
    error_input(e, NULL, 0, 0, "%s: --%s needs a value: %s", o->about->name, spec->name, spec->argument);
    return OPTIONS_ERROR;
}

/* The value of a short option written as -m=FILE: FILE. The value of -m =FILE stays. */
static const char *without_equals(const options *o, int got, const char *value)
{
    const char *given = o->argv[optind - 1];
    const bool attached = value != NULL && got < OPTION_BASE && value == given + 2;
    return attached && value[0] == '=' ? value + 1 : value;
}

int options_next(options *o, error *e)
{
    struct option longs[OPTIONS_MAX + 2] = {0};
    char letters[2 * OPTIONS_MAX + 4] = ":h"; /* the colon: report a missing value as ':', not as '?' */
    size_t at = strlen(letters);
    const int count = spec_count(o->about);
    for (int i = 0; i < count && i < OPTIONS_MAX; i++) {
        const option_spec *spec = &o->about->specs[i];
        longs[i] = (struct option){spec->name, spec->argument != NULL ? required_argument : no_argument, NULL,
                                   OPTION_BASE + i};
        if (spec->letter != 0) {
            letters[at++] = spec->letter;
            if (spec->argument != NULL) {
                letters[at++] = ':';
            }
        }
    }
    letters[at] = '\0';
    longs[count] = (struct option){"help", no_argument, NULL, 'h'};

    const int got = getopt_long(o->argc, o->argv, letters, longs, NULL);
    o->argument = without_equals(o, got, optarg);
    o->first = optind;
    if (got == -1) {
        return OPTIONS_END;
    }
    if (got == 'h') {
        options_print_help(o->about);
        o->helped = true;
        return OPTIONS_END;
    }
    if (got == '?') {
        return refuse_unknown(o, e);
    }
    if (got == ':') {
        return refuse_without_value(o, e);
    }
    o->current = index_of(o->about, got);
    return o->current;
}

/* ---- values ---- */

static bool refuse_value(const options *o, error *e, const char *format, ...) ERROR_PRINTF(3, 4);

static bool refuse_value(const options *o, error *e, const char *format, ...)
{
    char expected[120];
    va_list args;
    va_start(args, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): started in the line above */
    vsnprintf(expected, sizeof expected, format, args);
    va_end(args);
    return error_input(e, NULL, 0, 0, "%s: --%s must be %s, not \"%s\"", o->about->name,
                       o->about->specs[o->current].name, expected, o->argument);
}

static bool number_within(const char *text, size_t length, double min, double max, double *value)
{
    double read = 0.0;
    const bool ok = number_parse(text, length, &read) == NUMBER_OK && read >= min && read <= max;
    *value = ok ? read : *value;
    return ok;
}

bool options_number(const options *o, double min, double max, double *value, error *e)
{
    return number_within(o->argument, strlen(o->argument), min, max, value) ||
           refuse_value(o, e, "a number from %g to %g", min, max);
}

bool options_numbers(const options *o, double low, double high, double *values, size_t max, size_t *count,
                     error *e)
{
    *count = 0;
    for (const char *text = o->argument; text != NULL;) {
        const size_t length = strcspn(text, ",");
        if (*count == max || !number_within(text, length, low, high, &values[*count])) {
            return refuse_value(o, e, "1 to %zu numbers from %g to %g, separated by commas", max, low, high);
        }
        *count += 1;
        text = text[length] == ',' ? text + length + 1 : NULL;
    }
    return true;
}

bool options_integer(const options *o, long min, long max, long *value, error *e)
{
    double read = 0.0;
    if (!number_within(o->argument, strlen(o->argument), (double)min, (double)max, &read) ||
        read != floor(read)) {
        return refuse_value(o, e, "a whole number from %ld to %ld", min, max);
    }
    *value = (long)read;
    return true;
}

const option_spec *options_find(const command_about *about, const char *name)
{
    const option_spec *spec = about->specs;
    while (strcmp(spec->name, name) != 0) {
        spec++;
    }
    return spec;
}

bool options_missing(const options *o, const char *name, error *e)
{
    const option_spec *spec = options_find(o->about, name);
    return error_input(e, NULL, 0, 0, "%s: --%s %s is missing; see `iqfoc %s --help`", o->about->name,
                       spec->name, spec->argument != NULL ? spec->argument : "", o->about->name);
}

bool options_at_most(const options *o, int most, error *e)
{
    if (o->argc - o->first > most) {
        return error_input(e, NULL, 0, 0, "%s: unexpected argument \"%s\"", o->about->name,
                           o->argv[o->first + most]);
    }
    return true;
}

bool options_recording(const options *o, error *e)
{
    return (o->argc > o->first || error_input(e, NULL, 0, 0, "%s: no recording is given. Usage: iqfoc %s %s",
                                              o->about->name, o->about->name, o->about->usage)) &&
           options_at_most(o, 1, e);
}

/* ---- all of them ---- */

static bool take_text(const options *o, option_texts *texts, error *e)
{
    if (texts->count == OPTION_TEXTS_MAX) {
        return error_input(e, NULL, 0, 0, "%s: --%s is given more than %d times", o->about->name,
                           o->about->specs[o->current].name, OPTION_TEXTS_MAX);
    }
    texts->of[texts->count++] = o->argument;
    return true;
}

static bool take_value(const options *o, const option_spec *p, error *e)
{
    if (p->text != NULL) {
        *p->text = o->argument;
        return !p->written || inputs_reserve(o->argument, e);
    } else if (p->flag != NULL) {
        *p->flag = true;
    } else if (p->texts != NULL) {
        return take_text(o, p->texts, e);
    } else if (p->integer != NULL) {
        return options_integer(o, (long)p->low, (long)p->high, p->integer, e);
    } else if (p->count != NULL) {
        return options_numbers(o, p->low, p->high, p->number, p->most, p->count, e);
    } else if (p->number != NULL) {
        return options_number(o, p->low, p->high, p->number, e);
    } else {
        return p->take(o, e);
    }
    return true;
}

bool options_read(options *o, error *e)
{
    int which;
    while ((which = options_next(o, e)) >= 0) {
        if (!take_value(o, &o->about->specs[which], e)) {
            return false;
        }
    }
    return which == OPTIONS_END;
}

bool options_complete(const options *o, error *e)
{
    if (!options_at_most(o, 0, e)) {
        return false;
    }
    for (const option_spec *spec = o->about->specs; spec->name != NULL; spec++) {
        if (spec->needed && *spec->text == NULL) {
            return options_missing(o, spec->name, e);
        }
    }
    return true;
}
