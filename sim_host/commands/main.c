/*
 * iqfoc: finds the command and hands over. The command line is described in interfaces.md; each command
 * documents its own options under --help.
 *
 * The process never calls setlocale: it runs in the "C" locale, so that no number ever has a decimal comma.
 */
#include "base/error.h"
#include "base/suggest.h"
#include "command.h"
#include "iqfoc/version.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct command {
    const command_about *about;
    const char *summary;
    int (*run)(int argc, char **argv);
} command;

static const command commands[] = {
    {&about_reproduce, "the papers' tables beside this project's values, with the figures as plots",
     cmd_reproduce},
    {&about_simulate, "run the firmware code against the switching-level drive, write a recording",
     cmd_simulate},
#ifdef IQFOC_FMU
    {&about_export_fmu, "the drive, or its plant alone, as a model for another simulator (FMI 3.0)",
     cmd_export_fmu},
#endif
    {&about_record, "what the firmware's recorder sends over a serial line, as a recording", cmd_record},
    {&about_sweep, "errors of each method over the switching-to-fundamental frequency ratio", cmd_sweep},
    {&about_loops, "what better feedback and better prediction do to a closed loop", cmd_loops},
    {&about_import, "a recording from the log of another program", cmd_import},
    {&about_diagnose, "what the model gets wrong about a recording, why, and what mending it gains",
     cmd_diagnose},
    {&about_plan, "the recording to make, by how well it lets the causes be told apart", cmd_plan},
    {&about_tune, "a current controller with its margins at every speed, from what a diagnosis knows",
     cmd_tune},
    {&about_watch, "trials of the firmware's watch on its model", cmd_watch},
    {&about_golden, "one hash that shows this build to compute what every other does", cmd_golden},
};

enum { COMMANDS = sizeof commands / sizeof commands[0] };

static int print_overview(void)
{
    printf("usage: iqfoc <command> [options]\n\n");
    for (int n = 0; n < COMMANDS; n++) {
        printf("  %-12s%s\n", commands[n].about->name, commands[n].summary);
    }
    printf("\n`iqfoc <command> --help` documents each. `iqfoc --version` prints the version.\n"
           "Exit status: 0 done, 2 for input or usage that cannot be used, 1 for a failure of the program "
           "itself.\n");
    return STATUS_DONE;
}

static int refuse(const char *given)
{
    const char *names[COMMANDS];
    for (int i = 0; i < COMMANDS; i++) {
        names[i] = commands[i].about->name;
    }
    error e = {0};
    const char *meant = given != NULL ? suggest(given, names, COMMANDS) : NULL;
    if (given == NULL) {
        error_input(&e, NULL, 0, 0, "expected a command; `iqfoc --help` lists them");
    } else if (meant != NULL) {
        error_input(&e, NULL, 0, 0, "unknown command \"%s\"; did you mean %s?", given, meant);
    } else {
        error_input(&e, NULL, 0, 0, "unknown command \"%s\"; `iqfoc --help` lists them", given);
    }
    return error_print(&e);
}

static int run(int argc, char **argv)
{
    if (argc < 2) {
        return refuse(NULL);
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        return print_overview();
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("iqfoc " IQFOC_VERSION_STRING);
        return STATUS_DONE;
    }
    for (int n = 0; n < COMMANDS; n++) {
        if (strcmp(argv[1], commands[n].about->name) == 0) {
            return commands[n].run(argc - 1, argv + 1);
        }
    }
    return refuse(argv[1]);
}

int main(int argc, char **argv)
{
    const int status = run(argc, argv);
    /* A full disk behind `iqfoc ... > file` shows only here. */
    if (status == STATUS_DONE && (fflush(stdout) != 0 || ferror(stdout))) {
        error e = {0};
        error_failure(&e, errno, "stdout: cannot be written");
        return error_print(&e);
    }
    return status;
}
