/* iqfoc help: the list of commands, one command's help, man pages and completions. */
#include "base/build.h"
#include "base/terminal.h"
#include "help.h"

#include <stdio.h>
#include <string.h>

static bool man;
static const char *shell;

static const option_spec specs[] = {
    {"man", 0, NULL, "print the manual page instead of the help: iqfoc help --man diagnose | man -l -",
     .flag = &man},
    {"completion", 0, "bash|zsh|fish", "print the completion script for that shell", .text = &shell},
    {.name = NULL}};

const command_about about_help = {
    "help", "[COMMAND] [--man | --completion bash|zsh|fish]",
    "Lists the commands, or explains one. Prints manual pages and shell completions,\n"
    "made from the tables that define the options.",
    specs};

void help_version(void)
{
    const bool known = build_commit[0] != '\0';
    printf("iqfoc %s%s%s%s\n", build_version, known ? " (commit " : "", build_commit, known ? ")" : "");
}

void help_overview(void)
{
    printf("usage: iqfoc <command> [options]\n\n");
    for (int n = 0; n < COMMANDS; n++) {
        printf("  %s%-12s%s%s\n", terminal_bold(stdout), command_table[n].about->name, terminal_plain(stdout),
               command_table[n].summary);
    }
    printf("\n`iqfoc help <command>` explains a command.\n"
           "Exit status: 0 done, 2 unusable input or command line, 1 failure of the program itself.\n");
}

static bool print_completion(error *e)
{
    static const char *const names[] = {"bash", "zsh", "fish"};
    static help_completion *const print[] = {help_bash, help_zsh, help_fish};
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        if (strcmp(shell, names[n]) == 0) {
            print[n]();
            return true;
        }
    }
    return error_input(e, NULL, 0, 0, "help: --completion %s: expected bash, zsh or fish", shell);
}

static bool run(const options *o, error *e)
{
    const char *name = o->first < o->argc ? o->argv[o->first] : NULL;
    const command *of = name != NULL ? command_find(name, e) : NULL;
    if (!options_at_most(o, 1, e) || (name != NULL && of == NULL)) {
        return false;
    }
    if (shell != NULL) {
        return print_completion(e);
    }
    if (man) {
        help_man(of);
    } else if (of == NULL) {
        help_overview();
    } else {
        options_print_help(of->about);
    }
    return true;
}

int cmd_help(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_help, argc, argv);
    const bool ok = options_read(&o, &e) && (o.helped || run(&o, &e));
    return ok ? STATUS_DONE : error_print(&e);
}
