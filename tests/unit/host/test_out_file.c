/* An output file appears whole or not at all, and the old file stays until then. */
#define _XOPEN_SOURCE 700

#include "base/out_file.h"
#include "host_files.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void expect_content(const char *name, const char *text)
{
    char *found = scratch_read(name);
    TEST_ASSERT_EQUAL_STRING(text, found);
    free(found);
}

static void write_and_commit(const char *path, const char *text)
{
    error e = {0};
    out_file f;
    TEST_ASSERT_TRUE_MESSAGE(out_file_open(&f, path, &e), e.text);
    fputs(text, f.stream);
    TEST_ASSERT_TRUE_MESSAGE(out_file_commit(&f, &e), e.text);
}

static void test_new_file_is_absent_until_commit(void)
{
    error e = {0};
    out_file f;
    TEST_ASSERT_TRUE(out_file_open(&f, scratch_path("new"), &e));
    fputs("half", f.stream);
    fflush(f.stream);
    TEST_ASSERT_EQUAL(-1, access(scratch_path("new"), F_OK));
    TEST_ASSERT_TRUE(out_file_commit(&f, &e));
    expect_content("new", "half");
    TEST_ASSERT_NULL(f.stream);
    remove(scratch_path("new"));
}

static void test_abandon_leaves_the_old_file_and_nothing_else(void)
{
    scratch_text("old", "precious");
    const size_t before = scratch_count();
    error e = {0};
    out_file f;
    TEST_ASSERT_TRUE(out_file_open(&f, scratch_path("old"), &e));
    fputs("half", f.stream);
    TEST_ASSERT_EQUAL(before + 1, scratch_count());
    out_file_abandon(&f);
    TEST_ASSERT_EQUAL(before, scratch_count());
    expect_content("old", "precious");
    out_file_abandon(&f); /* twice does no harm */
    remove(scratch_path("old"));
}

static void test_replacing_keeps_the_mode(void)
{
    scratch_text("mode", "old");
    chmod(scratch_path("mode"), 0640);
    write_and_commit(scratch_path("mode"), "new");
    struct stat status;
    TEST_ASSERT_EQUAL(0, stat(scratch_path("mode"), &status));
    TEST_ASSERT_EQUAL_HEX(0640, status.st_mode & 07777);
    expect_content("mode", "new");
    remove(scratch_path("mode"));
}

static void test_a_new_file_has_the_mode_the_umask_gives(void)
{
    const mode_t mask = umask(027);
    write_and_commit(scratch_path("fresh"), "x");
    umask(mask);
    struct stat status;
    TEST_ASSERT_EQUAL(0, stat(scratch_path("fresh"), &status));
    TEST_ASSERT_EQUAL_HEX(0640, status.st_mode & 07777);
    remove(scratch_path("fresh"));
}

static void test_a_link_stays_and_its_file_is_replaced(void)
{
    scratch_text("target", "old");
    TEST_ASSERT_EQUAL(0, symlink("target", scratch_path("link")));
    write_and_commit(scratch_path("link"), "new");
    struct stat status;
    TEST_ASSERT_EQUAL(0, lstat(scratch_path("link"), &status));
    TEST_ASSERT_TRUE(S_ISLNK(status.st_mode));
    expect_content("target", "new");
    remove(scratch_path("link"));
    remove(scratch_path("target"));
}

/* Ctrl-C in the middle of a long simulation. */
static void test_a_signal_leaves_nothing_behind(void)
{
    scratch_text("kept", "precious");
    const size_t before = scratch_count();
    const pid_t child = fork();
    if (child == 0) {
        error e = {0};
        out_file f;
        if (out_file_open(&f, scratch_path("kept"), &e) && scratch_count() == before + 1) {
            raise(SIGTERM);
        }
        _exit(99);
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE_MESSAGE(WIFSIGNALED(status), "the child must die of the signal");
    TEST_ASSERT_EQUAL(SIGTERM, WTERMSIG(status));
    TEST_ASSERT_EQUAL(before, scratch_count());
    expect_content("kept", "precious");
    remove(scratch_path("kept"));
}

static void expect_refused(const char *path, const char *part_of_text)
{
    error e = {0};
    out_file f;
    TEST_ASSERT_FALSE(out_file_open(&f, path, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, part_of_text), e.text);
    TEST_ASSERT_NULL(f.stream);
}

static void test_what_cannot_be_opened_is_named(void)
{
    expect_refused(scratch_path("no/such/directory"), "No such file or directory");
    expect_refused(scratch_path(""), "is a directory");
    expect_refused("", "needs a name");
}

static void test_a_device_is_written_in_place(void)
{
    write_and_commit("/dev/null", "gone");
    struct stat status;
    TEST_ASSERT_EQUAL(0, stat("/dev/null", &status));
    TEST_ASSERT_TRUE(S_ISCHR(status.st_mode));
}

static void test_a_full_disk_is_a_failure(void)
{
    if (access("/dev/full", W_OK) != 0) {
        TEST_IGNORE_MESSAGE("no /dev/full here");
    }
    error e = {0};
    out_file f;
    TEST_ASSERT_TRUE(out_file_open(&f, "/dev/full", &e));
    fputs("does not fit", f.stream);
    TEST_ASSERT_FALSE(out_file_commit(&f, &e));
    TEST_ASSERT_EQUAL(STATUS_FAILED, e.status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "/dev/full"), e.text);
}

static void test_an_error_is_one_line_and_the_first_stays(void)
{
    error e = {0};
    TEST_ASSERT_FALSE(error_input(&e, "m.toml", 3, 7, "two\nlines and an \x1b[31mescape"));
    TEST_ASSERT_EQUAL_STRING("m.toml:3:7: two?lines and an ?[31mescape", e.text);
    error_failure(&e, 0, "later");
    error bytes = {0};
    error_input(&bytes, NULL, 0, 0, "\xC3\xA9 \xFF \xC2\x9B \xE2\x82 \xF0\x9F\x98\x80");
    TEST_ASSERT_EQUAL_STRING("\xC3\xA9 ? ?? ?? \xF0\x9F\x98\x80", bytes.text);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);

    error long_one = {0};
    char name[2000];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    error_input(&long_one, name, 1, 1, "%s", name);
    TEST_ASSERT_EQUAL(sizeof long_one.text - 1, strlen(long_one.text));
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_new_file_is_absent_until_commit);
    RUN_TEST(test_abandon_leaves_the_old_file_and_nothing_else);
    RUN_TEST(test_replacing_keeps_the_mode);
    RUN_TEST(test_a_new_file_has_the_mode_the_umask_gives);
    RUN_TEST(test_a_link_stays_and_its_file_is_replaced);
    RUN_TEST(test_a_signal_leaves_nothing_behind);
    RUN_TEST(test_what_cannot_be_opened_is_named);
    RUN_TEST(test_a_device_is_written_in_place);
    RUN_TEST(test_a_full_disk_is_a_failure);
    RUN_TEST(test_an_error_is_one_line_and_the_first_stays);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
