/*
 * iqfoc: finds the command and hands over. The command line is described in interfaces.md; each command
 * documents its own options under --help.
 *
 * The process never calls setlocale: it runs in the "C" locale, so that no number ever has a decimal comma.
 */
#include "base/build.h"
#include "command_table.h"
#include "help.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static bool is(const char *given, const char *letter, const char *word)
{
    return strcmp(given, letter) == 0 || strcmp(given, word) == 0;
}

static int run(int argc, char **argv)
{
    error e = {0};
    if (argc > 1 && is(argv[1], "-h", "--help")) {
        help_overview();
        return STATUS_DONE;
    }
    if (argc > 1 && is(argv[1], "-V", "--version")) {
        const bool known = build_commit[0] != '\0';
        printf("iqfoc %s%s%s%s\n", build_version, known ? " (commit " : "", build_commit, known ? ")" : "");
        return STATUS_DONE;
    }
    if (argc > 1 && argv[1][0] == '-') {
        error_input(&e, NULL, 0, 0, "unknown option %s ahead of the command; expected --help or --version",
                    argv[1]);
        return error_print(&e);
    }
    const command *chosen = command_find(argc > 1 ? argv[1] : NULL, &e);
    return chosen != NULL ? chosen->run(argc - 1, argv + 1) : error_print(&e);
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
