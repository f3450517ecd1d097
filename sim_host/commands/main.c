/*
 * iqfoc: the main program; it runs the command named by the first argument. docs/interfaces.md describes the command line,
 * --help of each command its options.
 *
 * The process never calls setlocale: it runs in the "C" locale, so numbers never have a decimal comma.
 */
#define _XOPEN_SOURCE 700 /* POSIX: open; SIGXFSZ */

#include "base/confine.h"
#include "base/inputs.h"
#include "base/memory.h"
#include "command_table.h"
#include "help.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/*
 * If stdout or stderr is closed, the first opened file would get its number, and messages would be written into that file:
 * open /dev/null for them. A file above the size limit is reported as an error, as a full disk is; it does not kill the process.
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
        help_version();
        return STATUS_DONE;
    }
    if (argc > 1 && argv[1][0] == '-') {
        error_input(&e, NULL, 0, 0, "unknown option %s before the command; expected --help or --version",
                    argv[1]);
        return error_print(&e);
    }
    const command *chosen = command_find(argc > 1 ? argv[1] : NULL, &e);
    if (chosen == NULL) {
        return error_print(&e);
    }
    confine(chosen->needs);
    inputs_watch();
    return chosen->run(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    prepare();
    memory_end_when_out();
    const int status = run(argc, argv);
    /* A full disk behind `iqfoc ... > file` is seen only here. */
    if (status != STATUS_FAILED && status != STATUS_UNUSABLE && (fflush(stdout) != 0 || ferror(stdout))) {
        error e = {0};
        error_failure(&e, errno, "stdout: cannot be written");
        return error_print(&e);
    }
    return status;
}
