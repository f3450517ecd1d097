/*
 * iqfoc: finds the command and hands over. The command line is described in interfaces.md; each command
 * documents its own options under --help.
 *
 * The process never calls setlocale: it runs in the "C" locale, so that no number ever has a decimal comma.
 */
#define _XOPEN_SOURCE 700 /* POSIX: open; SIGXFSZ */

#include "base/build.h"
#include "base/confine.h"
#include "command_table.h"
#include "help.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/*
 * A caller who closed stdout or stderr would have its number given to the first file that is opened, and words for him written into
 * that. And a file that outgrows what its user may write is a failure that is told, as a full disk is, not a death.
 */
static void prepare(void)
{
    int file = open("/dev/null", O_RDONLY);
    while (file >= 0 && file <= STDERR_FILENO) {
        file = open("/dev/null", O_RDONLY);
    }
    if (file >= 0) {
        close(file);
    }
    (void)signal(SIGXFSZ, SIG_IGN);
}

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
    if (chosen == NULL) {
        return error_print(&e);
    }
    confine(chosen->needs);
    return chosen->run(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    prepare();
    const int status = run(argc, argv);
    /* A full disk behind `iqfoc ... > file` shows only here. */
    if (status == STATUS_DONE && (fflush(stdout) != 0 || ferror(stdout))) {
        error e = {0};
        error_failure(&e, errno, "stdout: cannot be written");
        return error_print(&e);
    }
    return status;
}
