/*
 * What the tests of output folders share: a folder "out" in the scratch directory, and the files staged for it.
 */
#ifndef TESTS_UNIT_OUT_FOLDER_FIXTURE_H
#define TESTS_UNIT_OUT_FOLDER_FIXTURE_H

#include "base/out_file.h"
#include "base/out_folder.h"
#include "host_files.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <unity.h>

static error e;
static out_folder f;

/* Every test starts without the folder "out" and ends so; "out" is all that it makes. */
void setUp(void)
{
    e = (error){0};
    f = (out_folder){0};
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, scratch_count(), "a test has left something behind");
}

static inline void expect_content(const char *name, const char *text)
{
    char *found = scratch_read(name);
    TEST_ASSERT_NOT_NULL_MESSAGE(found, name);
    TEST_ASSERT_EQUAL_STRING(text, found);
    free(found);
}

static inline void expect_none(const char *name)
{
    TEST_ASSERT_EQUAL_MESSAGE(-1, access(scratch_path(name), F_OK), name);
}

static inline void make_folder(const char *name)
{
    TEST_ASSERT_EQUAL(0, mkdir(scratch_path(name), 0777));
}

static inline void remove_one(const char *name)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, remove(scratch_path(name)), name);
}

static inline void open_out(void)
{
    TEST_ASSERT_TRUE_MESSAGE(out_folder_open(&f, scratch_path("out"), &e), e.text);
    TEST_ASSERT_NOT_EQUAL(0, strcmp(f.stage, scratch_path("out")));
}

static inline void stage(const char *name, const char *text)
{
    char path[500];
    out_file file;
    snprintf(path, sizeof path, "%s/%s", f.stage, name);
    TEST_ASSERT_TRUE_MESSAGE(out_file_open(&file, path, &e), e.text);
    fputs(text, file.stream);
    TEST_ASSERT_TRUE_MESSAGE(out_file_commit(&file, &e), e.text);
}

static inline void close_out(void)
{
    TEST_ASSERT_TRUE_MESSAGE(out_folder_close(&f, true, &e), e.text);
    TEST_ASSERT_EQUAL_STRING("", f.path);
}

/* How many names there are in "out". */
static inline size_t count_out(void)
{
    char command[500];
    snprintf(command, sizeof command, "exit $(ls -A '%s' | wc -l)", scratch_path("out"));
    return (size_t)WEXITSTATUS(system(command));
}

#endif
