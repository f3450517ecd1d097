/*
 * What a confined process may still do, and what it may not: each tried in a child of its own.
 */
#define _GNU_SOURCE /* kill, prctl, ptrace: Linux */

#include "base/confine.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

enum { DONE = 0, REFUSED = 1, OTHERWISE = 2 };

static int verdict(bool done)
{
    return done ? DONE : errno == EPERM ? REFUSED : OTHERWISE;
}

static int starts_a_program(void)
{
    char name[] = "true";
    char *const arguments[] = {name, NULL};
    (void)execvp(name, arguments); /* ends with 0, if it begins */
    return verdict(false);
}

static int begins_a_process(void)
{
    const pid_t child = fork();
    if (child == 0) {
        _exit(0);
    }
    return verdict(child > 0 && waitpid(child, NULL, 0) == child);
}

static int opens_a_socket(void)
{
    return verdict(socket(AF_INET, SOCK_STREAM, 0) >= 0);
}

static int opens_a_pair(void)
{
    int ends[2];
    return verdict(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
}

static int signals_its_parent(void)
{
    return verdict(kill(getppid(), 0) == 0);
}

static int is_traced(void)
{
    return verdict(ptrace(PTRACE_TRACEME, 0, NULL, NULL) == 0);
}

/* What a program that may have been given another's rights does first; gnuplot ends where it may not. */
static int becomes_its_caller(void)
{
    return verdict(setgid(getgid()) == 0 && setuid(getuid()) == 0);
}

static int gets_rights(void)
{
    return prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 0 ? DONE : REFUSED;
}

static void *nothing(void *argument)
{
    return argument;
}

static int begins_a_thread(void)
{
    pthread_t thread;
    return verdict(pthread_create(&thread, NULL, nothing, NULL) == 0 && pthread_join(thread, NULL) == 0);
}

static int writes_a_file(void)
{
    FILE *file = tmpfile();
    return verdict(file != NULL && fputs("text", file) >= 0 && fclose(file) == 0);
}

static int dies_of_its_own_signal(void)
{
    signal(SIGTERM, SIG_DFL);
    raise(SIGTERM);
    return OTHERWISE;
}

/* How `act` ends in a process that has been confined to `first`, then to `then`. */
static int outcome(int (*act)(void), unsigned first, unsigned then)
{
    const pid_t child = fork();
    if (child == 0) {
        confine(first);
        confine(then);
        _exit(act());
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

#define BOTH (CONFINE_MAY_START | CONFINE_MAY_CONNECT)

/* Whether this kernel, or what plays it, and this build take the filter at all. */
static bool is_confined(void)
{
    return outcome(opens_a_socket, CONFINE_TO_FILES, CONFINE_TO_FILES) == REFUSED;
}

static bool may_start_anyway(void)
{
    return outcome(starts_a_program, CONFINE_TO_FILES, CONFINE_TO_FILES) == DONE; /* the sanitizers' build */
}

static void test_what_is_given_up(void)
{
    if (!is_confined()) {
        TEST_IGNORE_MESSAGE("no filter of system calls here");
    }
    TEST_ASSERT_EQUAL(REFUSED, outcome(opens_a_socket, CONFINE_MAY_START, CONFINE_MAY_START));
    TEST_ASSERT_EQUAL(REFUSED, outcome(opens_a_pair, CONFINE_TO_FILES, CONFINE_TO_FILES));
    TEST_ASSERT_EQUAL(REFUSED, outcome(gets_rights, BOTH, BOTH));
    TEST_ASSERT_EQUAL(DONE, outcome(starts_a_program, CONFINE_MAY_START, CONFINE_MAY_START));
    TEST_ASSERT_EQUAL(DONE, outcome(opens_a_socket, CONFINE_MAY_CONNECT, CONFINE_MAY_CONNECT));
    /* Given up for good: what is asked for later does not bring it back. */
    TEST_ASSERT_EQUAL(REFUSED, outcome(opens_a_socket, CONFINE_TO_FILES, BOTH));
    TEST_ASSERT_EQUAL(REFUSED, outcome(opens_a_socket, BOTH, CONFINE_TO_FILES));
}

static void test_no_program_is_started(void)
{
    if (!is_confined() || may_start_anyway()) {
        TEST_IGNORE_MESSAGE("no filter of system calls here, or a sanitizer that needs its programs");
    }
    int (*const acts[])(void) = {starts_a_program, begins_a_process, signals_its_parent, is_traced,
                                 becomes_its_caller};
    for (size_t k = 0; k < sizeof acts / sizeof acts[0]; k++) {
        TEST_ASSERT_EQUAL(REFUSED, outcome(acts[k], CONFINE_TO_FILES, CONFINE_TO_FILES));
        TEST_ASSERT_EQUAL(REFUSED, outcome(acts[k], CONFINE_MAY_CONNECT, CONFINE_MAY_CONNECT));
        TEST_ASSERT_EQUAL(REFUSED, outcome(acts[k], BOTH, CONFINE_TO_FILES));
        TEST_ASSERT_EQUAL(DONE, outcome(acts[k], BOTH, BOTH));
    }
}

static void test_what_stays(void)
{
    TEST_ASSERT_EQUAL(DONE, outcome(begins_a_thread, CONFINE_TO_FILES, CONFINE_TO_FILES));
    TEST_ASSERT_EQUAL(DONE, outcome(writes_a_file, CONFINE_TO_FILES, CONFINE_TO_FILES));
    TEST_ASSERT_EQUAL(-SIGTERM, outcome(dies_of_its_own_signal, CONFINE_TO_FILES, CONFINE_TO_FILES));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_is_given_up);
    RUN_TEST(test_no_program_is_started);
    RUN_TEST(test_what_stays);
    return UNITY_END();
}
