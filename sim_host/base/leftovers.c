/* The list of what has to go, and the signals that make it go (leftovers.h). */
#define _XOPEN_SOURCE 700 /* POSIX: sigaction, sigprocmask, unlink, rmdir */

#include "leftovers.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct leftover {
    struct leftover *next;
    char path[];
} leftover;

/*
 * The signal handler may look at any time: an entry is whole before it is linked in, and out before it is
 * freed. The fences keep the compiler from reordering that.
 */
static leftover *volatile newest;

static const int watched[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

enum { WATCHED = sizeof watched / sizeof watched[0] };

static sigset_t mask_before;

void leftovers_remove(void)
{
    for (const leftover *l = newest; l != NULL; l = l->next) {
        if (unlink(l->path) != 0) {
            rmdir(l->path);
        }
    }
}

static void remove_and_die(int signal_number)
{
    leftovers_remove();
    /* Delivered when this handler returns: the caller sees that a signal ended the process. */
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

static sigset_t watched_set(void)
{
    sigset_t set;
    sigemptyset(&set);
    for (int n = 0; n < WATCHED; n++) {
        sigaddset(&set, watched[n]);
    }
    return set;
}

static void watch_signals(void)
{
    for (int n = 0; n < WATCHED; n++) {
        struct sigaction action;
        if (sigaction(watched[n], NULL, &action) == 0 && action.sa_handler == SIG_DFL) {
            /* One of them at a time: two would both walk through the list. */
            action = (struct sigaction){.sa_handler = remove_and_die, .sa_mask = watched_set()};
            sigaction(watched[n], &action, NULL);
        }
    }
}

void leftovers_add(const char *path)
{
    const size_t size = strlen(path) + 1;
    leftover *l = malloc(sizeof *l + size);
    if (l == NULL) {
        return;
    }
    watch_signals();
    memcpy(l->path, path, size);
    l->next = newest;
    atomic_signal_fence(memory_order_seq_cst);
    newest = l;
    atomic_signal_fence(memory_order_seq_cst);
}

static bool is_in(const char *path, const char *folder)
{
    const size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

void leftovers_forget(const char *path)
{
    leftover *before = NULL;
    for (leftover *l = newest, *next; l != NULL; l = next) {
        next = l->next;
        if (strcmp(l->path, path) != 0 && !is_in(l->path, path)) {
            before = l;
            continue;
        }
        if (before == NULL) {
            newest = next;
        } else {
            before->next = next;
        }
        atomic_signal_fence(memory_order_seq_cst);
        free(l);
    }
}

void leftovers_signals_wait(void)
{
    const sigset_t set = watched_set();
    sigprocmask(SIG_BLOCK, &set, &mask_before);
}

void leftovers_signals_go_on(void)
{
    sigprocmask(SIG_SETMASK, &mask_before, NULL);
}
