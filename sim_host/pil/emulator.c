/* The child process of an emulator (emulator.h). */
#define _GNU_SOURCE /* for SOCK_CLOEXEC and prctl's PR_SET_PDEATHSIG: Linux */
#include "emulator.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* Exit status of a child whose program could not be started, as a shell's. */
#define NOT_FOUND 127

/* In the child: becomes the emulator. Never returns. */
static void become(int line, pid_t parent, const char *const argv[])
{
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent || nowhere < 0 || dup2(line, 0) < 0 ||
        dup2(line, 1) < 0 || dup2(nowhere, 2) < 0) {
        _exit(NOT_FOUND);
    }
    (void)execvp(argv[0], (char *const *)argv); /* which it does not write to */
    _exit(NOT_FOUND);
}

bool emulator_start(emulator *m, const char *name, const char *const argv[], error *e)
{
    int ends[2];
    m->name = name;
    m->pid = 0;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        return error_failure(e, errno, "%s: no line to the emulator", name);
    }
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid == 0) {
        become(ends[1], parent, argv);
    }
    const int fork_errno = errno;
    (void)close(ends[1]);
    m->line = ends[0];
    if (pid < 0) {
        (void)close(ends[0]);
        return error_failure(e, fork_errno, "%s: the emulator cannot be started", name);
    }
    m->pid = pid;
    return true;
}

/* Waits for the child's end; nothing is left of it then. False if it does not come in time. */
static bool ended(emulator *m, double most_s, int *status)
{
    for (int k = 0; k < (int)(most_s * 100.0); k++) {
        if (waitpid(m->pid, status, WNOHANG) == m->pid) {
            m->pid = 0;
            (void)close(m->line);
            return true;
        }
        (void)poll(NULL, 0, 10);
    }
    return false;
}

/* The child's end, in words; the child is gone afterwards. */
static bool gone(emulator *m, error *e)
{
    int status = 0;
    /* Its line is closed: it ends by itself, or it is made to. */
    if (!ended(m, 0.5, &status)) {
        (void)kill(m->pid, SIGKILL);
        (void)ended(m, EMULATOR_SILENCE_MAX_S, &status);
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == NOT_FOUND) {
        return error_failure(e, 0, "%s: the emulator cannot be started; is QEMU installed?", m->name);
    }
    if (WIFEXITED(status)) {
        return error_failure(e, 0, "%s: the image ended with status %d in the middle of the run", m->name,
                             WEXITSTATUS(status));
    }
    return error_failure(e, 0, "%s: the emulator was ended by signal %d", m->name, WTERMSIG(status));
}

/* Waits until the line is ready; false with *e set after too long a silence. */
static bool ready(emulator *m, short events, error *e)
{
    struct pollfd wait = {.fd = m->line, .events = events};
    int got;
    do {
        got = poll(&wait, 1, (int)(EMULATOR_SILENCE_MAX_S * 1000.0));
    } while (got < 0 && errno == EINTR);
    if (got > 0) {
        return true;
    }
    const char *name = m->name;
    emulator_stop(m);
    return error_failure(e, 0, "%s: the image did not answer for %.0f s", name, EMULATOR_SILENCE_MAX_S);
}

bool emulator_send(emulator *m, const uint8_t *bytes, size_t count, error *e)
{
    while (count > 0) {
        if (!ready(m, POLLOUT, e)) {
            return false;
        }
        const ssize_t sent = send(m->line, bytes, count, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && (errno == EAGAIN || errno == EINTR)) {
            continue;
        }
        if (sent <= 0) {
            return gone(m, e);
        }
        bytes += sent;
        count -= (size_t)sent;
    }
    return true;
}

bool emulator_receive(emulator *m, uint8_t *bytes, size_t count, size_t *received, error *e)
{
    for (;;) {
        if (!ready(m, POLLIN, e)) {
            return false;
        }
        const ssize_t got = recv(m->line, bytes, count, MSG_DONTWAIT);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            continue;
        }
        if (got <= 0) {
            return gone(m, e);
        }
        *received = (size_t)got;
        return true;
    }
}

bool emulator_finish(emulator *m, error *e)
{
    if (m->pid == 0) {
        return true;
    }
    int status = 0;
    (void)shutdown(m->line, SHUT_WR);
    if (!ended(m, EMULATOR_SILENCE_MAX_S, &status)) {
        emulator_stop(m);
        return error_failure(e, 0, "%s: the image did not end when the run was over", m->name);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        return error_failure(e, 0, "%s: the image ended with status %d after the run", m->name,
                             WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status));
    }
    return true;
}

void emulator_stop(emulator *m)
{
    if (m->pid != 0) {
        (void)kill(m->pid, SIGKILL);
        (void)waitpid(m->pid, NULL, 0);
        (void)close(m->line);
        m->pid = 0;
    }
}
