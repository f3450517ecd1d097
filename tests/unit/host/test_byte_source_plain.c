/* The program without zlib reads lines as with it, and refuses what is packed (data/byte_source_plain.c). */
#define _XOPEN_SOURCE 700 /* POSIX: pipe, dup2 */

#include "data/line_source.h"
#include "host_files.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void expect_lines(const char *path)
{
    line_source lines = {0};
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(line_source_open(&lines, path, &e), e.text);
    TEST_ASSERT_TRUE(line_source_next(&lines, &e));
    TEST_ASSERT_EQUAL_UINT(4, lines.length);
    TEST_ASSERT_EQUAL_MEMORY("one\n", lines.line, 4);
    TEST_ASSERT_TRUE(line_source_next(&lines, &e));
    TEST_ASSERT_EQUAL_UINT(3, lines.length);
    TEST_ASSERT_EQUAL_MEMORY("two", lines.line, 3);
    TEST_ASSERT_FALSE(line_source_next(&lines, &e));
    TEST_ASSERT_EQUAL_MESSAGE(STATUS_DONE, e.status, e.text);
    line_source_close(&lines);
}

static void test_plain_lines(void)
{
    expect_lines(scratch_text("lines.txt", "one\ntwo"));
}

static void test_a_pipe_is_read_to_its_end(void)
{
    int ends[2];
    const int stdin_was = dup(STDIN_FILENO);
    TEST_ASSERT_EQUAL_INT(0, pipe(ends));
    TEST_ASSERT_EQUAL_INT(7, write(ends[1], "one\ntwo", 7));
    close(ends[1]);
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    expect_lines("-");
    dup2(stdin_was, STDIN_FILENO);
    close(stdin_was);
}

static void test_a_packed_file_is_refused(void)
{
    line_source lines = {0};
    error e = {0};
    TEST_ASSERT_TRUE(line_source_open(&lines, "data/recordings/clean.csv.gz", &e));
    TEST_ASSERT_FALSE(line_source_next(&lines, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_EQUAL_STRING(
        "data/recordings/clean.csv.gz:1:1: is packed (gzip), and this program was built without zlib; "
        "unpack it first",
        e.text);
    line_source_close(&lines);
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_plain_lines);
    RUN_TEST(test_a_pipe_is_read_to_its_end);
    RUN_TEST(test_a_packed_file_is_refused);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
