/* Pages of manual in the macros of man(7) (help.h). */
#include "help.h"

#include "base/build.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* Text as it is: a leading dot or quote would be a request, and a hyphen is to be one that can be copied. */
static void put(const char *text, size_t length)
{
    for (size_t k = 0; k < length; k++) {
        const bool starts = k == 0 || text[k - 1] == '\n';
        if (starts && (text[k] == '.' || text[k] == '\'')) {
            fputs("\\&", stdout);
        }
        if (text[k] == '\\') {
            fputs("\\e", stdout);
        } else if (text[k] == '-') {
            fputs("\\-", stdout);
        } else {
            putchar(text[k]);
        }
    }
}

static void put_text(const char *text)
{
    put(text, strlen(text));
}

static void put_upper(const char *text)
{
    for (; *text != '\0'; text++) {
        putchar(toupper((unsigned char)*text));
    }
}

/* Of the program, or of the command `part`. */
static void title(const char *part)
{
    fputs(".TH IQFOC", stdout);
    if (part != NULL) {
        fputs("\\-", stdout);
        put_upper(part);
    }
    printf(" 1 \"\" \"iqfoc %s\"\n.SH NAME\niqfoc%s%s \\- ", build_version, part != NULL ? "\\-" : "",
           part != NULL ? part : "");
}

static void option(const option_spec *spec)
{
    fputs(".TP\n", stdout);
    if (spec->letter != 0) {
        printf("\\fB\\-%c\\fR, ", spec->letter);
    }
    fputs("\\fB\\-\\-", stdout);
    put_text(spec->name);
    fputs("\\fR", stdout);
    if (spec->argument != NULL) {
        fputs(" \\fI", stdout);
        put_text(spec->argument);
        fputs("\\fR", stdout);
    }
    putchar('\n');
    put_text(spec->help);
    putchar('\n');
}

static void status(void)
{
    fputs(".SH EXIT STATUS\n0 done, whatever the verdict; 2 for input or usage that cannot be used, with one "
          "line on "
          "stderr;\n1 for a failure of the program itself.\n",
          stdout);
}

static void of_program(void)
{
    title(NULL);
    fputs("current control of drives with few PWM cycles per revolution\n.SH SYNOPSIS\n"
          "\\fBiqfoc\\fR \\fIcommand\\fR [\\fIoptions\\fR]\n.br\n\\fBiqfoc\\fR \\-\\-help | "
          "\\-\\-version\n.SH COMMANDS\n",
          stdout);
    for (int n = 0; n < COMMANDS; n++) {
        printf(".TP\n\\fBiqfoc\\-%s\\fR(1)\n", command_table[n].about->name);
        put_text(command_table[n].summary);
        putchar('\n');
    }
    status();
    fputs(".SH ENVIRONMENT\n.TP\n\\fBNO_COLOR\\fR\nIf set and not empty, nothing is coloured.\n", stdout);
}

void help_man(const command *of)
{
    if (of == NULL) {
        of_program();
        return;
    }
    const command_about *about = of->about;
    title(about->name);
    put_text(of->summary);
    printf("\n.SH SYNOPSIS\n\\fBiqfoc %s\\fR ", about->name);
    put_text(about->usage);
    fputs("\n.SH DESCRIPTION\n", stdout);
    put_text(about->description);
    fputs("\n.SH OPTIONS\n", stdout);
    for (const option_spec *spec = about->specs; spec->name != NULL; spec++) {
        option(spec);
    }
    option(&options_help);
    status();
    fputs(".SH SEE ALSO\n\\fBiqfoc\\fR(1)\n", stdout);
}
