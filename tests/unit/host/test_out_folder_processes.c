/*
 * Output folders when a signal ends the program, and when two programs write into one folder at once.
 */
#define _XOPEN_SOURCE 700

#include "out_folder_fixture.h"

#include <signal.h>

/* Ctrl-C while the files are being written: finished ones, one that is open, and the folders. */
static void die_within(const char *path)
{
    const pid_t child = fork();
    if (child == 0) {
        out_file file;
        char name[500];
        if (!out_folder_open(&f, path, &e)) {
            _exit(98);
        }
        stage("finished", "x");
        snprintf(name, sizeof name, "%s/open", f.stage);
        if (out_file_open(&file, name, &e)) {
            raise(SIGINT);
        }
        _exit(99);
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE_MESSAGE(WIFSIGNALED(status), "the child must die of the signal");
    TEST_ASSERT_EQUAL(SIGINT, WTERMSIG(status));
}

static void test_a_signal_leaves_nothing_behind(void)
{
    die_within(scratch_path("a/b/c"));
    TEST_ASSERT_EQUAL(0, scratch_count());
    make_folder("out");
    scratch_text("out/finished", "old");
    die_within(scratch_path("out"));
    expect_content("out/finished", "old");
    TEST_ASSERT_EQUAL(1, count_out());
    remove_one("out/finished");
    remove_one("out");
}

/* A signal after the folder is in place must not take it away again. */
static void test_a_signal_afterwards_takes_nothing(void)
{
    const pid_t child = fork();
    if (child == 0) {
        if (out_folder_open(&f, scratch_path("a/out"), &e)) {
            stage("report", "whole");
            if (out_folder_close(&f, true, &e)) {
                raise(SIGTERM);
            }
        }
        _exit(99);
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE(WIFSIGNALED(status));
    expect_content("a/out/report", "whole");
    remove_one("a/out/report");
    remove_one("a/out");
    remove_one("a");
}

/* A child that has staged files in "out", or in a file's place, and is killed as nothing can be prepared for. */
static void kill_within(bool folder)
{
    const pid_t child = fork();
    if (child == 0) {
        out_file file;
        if (folder && out_folder_open(&f, scratch_path("out"), &e)) {
            stage("finished", "x");
            kill(getpid(), SIGKILL);
        } else if (!folder && out_file_open(&file, scratch_path("out/file"), &e)) {
            kill(getpid(), SIGKILL);
        }
        _exit(99);
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE(WIFSIGNALED(status));
}

static void write_one(const char *text)
{
    open_out();
    stage("kept", text);
    close_out();
}

static void test_what_a_killed_process_left_goes_with_the_next(void)
{
    kill_within(true); /* there is no such folder: the stage is next to it */
    TEST_ASSERT_EQUAL(1, scratch_count());
    write_one("first");
    TEST_ASSERT_EQUAL(1, scratch_count());
    kill_within(true);
    kill_within(false); /* the file's maker has removed the stage already */
    TEST_ASSERT_EQUAL(2, count_out());
    scratch_text("out/.iqfoc.1-0.mine", "a name like ours, and the user's");
    make_folder("out/.iqfoc.x-0");
    write_one("second");
    TEST_ASSERT_EQUAL(3, count_out());
    expect_content("out/kept", "second");
    remove_one("out/.iqfoc.1-0.mine");
    remove_one("out/.iqfoc.x-0");
    remove_one("out/kept");
    remove_one("out");
}

/* Whoever still works keeps what he has written. */
static void test_what_a_living_process_writes_stays(void)
{
    int go[2];
    int ready[2];
    TEST_ASSERT_EQUAL(0, pipe(go) + pipe(ready));
    make_folder("out");
    const pid_t child = fork();
    if (child == 0) {
        char nothing = 0;
        close(go[1]);
        open_out();
        stage("others", "whole");
        const bool went = write(ready[1], &nothing, 1) == 1 && read(go[0], &nothing, 1) == 0;
        _exit(went && out_folder_close(&f, true, &e) ? 0 : 99);
    }
    char nothing;
    close(go[0]);
    TEST_ASSERT_EQUAL(1, read(ready[0], &nothing, 1));
    write_one("own");
    TEST_ASSERT_EQUAL(2, count_out());
    close(go[1]);
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_EQUAL(0, status);
    close(ready[0]);
    close(ready[1]);
    expect_content("out/others", "whole");
    expect_content("out/kept", "own");
    remove_one("out/others");
    remove_one("out/kept");
    remove_one("out");
}

/* As a process leaves it that is killed between two renames: of its three files one is in place, and one has just been saved. */
static void test_a_killed_process_renames_are_finished(void)
{
    make_folder("out");
    make_folder("out/.iqfoc.4711-0.whole");
    scratch_text("out/.iqfoc.4711-0.whole/.was.a", "old");
    scratch_text("out/a", "new");
    scratch_text("out/b", "old");
    TEST_ASSERT_EQUAL(0, link(scratch_path("out/b"), scratch_path("out/.iqfoc.4711-0.whole/.was.b")));
    scratch_text("out/.iqfoc.4711-0.whole/b", "new");
    scratch_text("out/.iqfoc.4711-0.whole/c", "new");
    write_one("own");
    TEST_ASSERT_EQUAL(4, count_out());
    expect_content("out/a", "new");
    expect_content("out/b", "new");
    expect_content("out/c", "new");
    expect_content("out/kept", "own");
    remove_one("out/a");
    remove_one("out/b");
    remove_one("out/c");
    remove_one("out/kept");
    remove_one("out");
}

enum { FILES = 60, ROUNDS = 8 };

/* Says "ready" on one pipe when all is staged, and goes on when the other one is closed: both at once. */
static void write_round(const char *text, int ready, int go)
{
    error failed = {0};
    if (!out_folder_open(&f, scratch_path("out"), &failed)) {
        fprintf(stderr, "%s\n", failed.text);
        _exit(98);
    }
    for (int n = 0; n < FILES; n++) {
        char path[500];
        snprintf(path, sizeof path, "%s/%d", f.stage, n);
        FILE *file = fopen(path, "w"); /* out_file would wait for the disk each time */
        if (file == NULL || fputs(text, file) < 0 || fclose(file) != 0) {
            _exit(97);
        }
    }
    char nothing = 0;
    if (write(ready, &nothing, 1) != 1 || read(go, &nothing, 1) != 0) {
        _exit(95);
    }
    if (!out_folder_close(&f, true, &failed)) {
        fprintf(stderr, "%s\n", failed.text);
        _exit(96);
    }
}

/* Two programs at once, over and over: after each round all files are from the one or all from the other. */
static void test_two_at_once_leave_the_files_of_one(void)
{
    for (int round = 0; round < ROUNDS; round++) {
        pid_t child[2];
        int ready[2];
        int go[2];
        TEST_ASSERT_EQUAL(0, pipe(ready) + pipe(go));
        for (int k = 0; k < 2; k++) {
            child[k] = fork();
            if (child[k] == 0) {
                close(go[1]);
                write_round(k == 0 ? "one" : "other", ready[1], go[0]);
                _exit(0);
            }
        }
        close(ready[1]);
        close(go[0]);
        for (int k = 0; k < 2; k++) {
            char nothing;
            TEST_ASSERT_EQUAL(1, read(ready[0], &nothing, 1));
        }
        close(go[1]);
        close(ready[0]);
        for (int k = 0; k < 2; k++) {
            int status = 0;
            TEST_ASSERT_EQUAL(child[k], waitpid(child[k], &status, 0));
            TEST_ASSERT_EQUAL(0, status);
        }
        char *first = scratch_read("out/0");
        TEST_ASSERT_NOT_NULL(first);
        TEST_ASSERT_EQUAL(FILES, count_out());
        for (int n = 0; n < FILES; n++) {
            char name[40];
            snprintf(name, sizeof name, "out/%d", n);
            expect_content(name, first);
            if (round % 4 == 3) {
                remove_one(name);
            }
        }
        if (round % 4 == 3) {
            remove_one("out"); /* some rounds begin without the folder */
        }
        free(first);
    }
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_a_signal_leaves_nothing_behind);
    RUN_TEST(test_a_signal_afterwards_takes_nothing);
    RUN_TEST(test_what_a_killed_process_left_goes_with_the_next);
    RUN_TEST(test_what_a_living_process_writes_stays);
    RUN_TEST(test_a_killed_process_renames_are_finished);
    RUN_TEST(test_two_at_once_leave_the_files_of_one);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
