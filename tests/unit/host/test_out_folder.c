/*
 * An output folder appears whole or not at all; what was in it stays until then, and the user's own files for
 * good.
 */
#define _XOPEN_SOURCE 700

#include "out_folder_fixture.h"

static void test_a_new_folder_is_absent_until_it_is_closed(void)
{
    open_out();
    stage("a", "first");
    stage("b", "second");
    expect_none("out");
    close_out();
    expect_content("out/a", "first");
    expect_content("out/b", "second");
    TEST_ASSERT_EQUAL(2, count_out());
    TEST_ASSERT_EQUAL(1, scratch_count());
    remove_one("out/a");
    remove_one("out/b");
    remove_one("out");
}

static void test_a_new_folder_has_the_mode_the_umask_gives(void)
{
    const mode_t mask = umask(027);
    open_out();
    close_out();
    umask(mask);
    struct stat status;
    TEST_ASSERT_EQUAL(0, stat(scratch_path("out"), &status));
    TEST_ASSERT_EQUAL_HEX(0750, status.st_mode & 0777);
    remove_one("out");
}

static void test_a_failure_leaves_no_folder_and_no_parents(void)
{
    make_folder("there");
    TEST_ASSERT_TRUE_MESSAGE(out_folder_open(&f, scratch_path("there/a/b/c//"), &e), e.text);
    stage("file", "half");
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
    expect_none("there/a");
    remove_one("there");
}

static void test_parents_are_made(void)
{
    TEST_ASSERT_TRUE_MESSAGE(out_folder_open(&f, scratch_path("a/b/c//"), &e), e.text);
    stage("file", "whole");
    close_out();
    expect_content("a/b/c/file", "whole");
    remove_one("a/b/c/file");
    remove_one("a/b/c");
    remove_one("a/b");
    remove_one("a");
}

static void test_a_folder_that_exists_keeps_what_is_not_written(void)
{
    make_folder("out");
    scratch_text("out/mine", "precious");
    scratch_text("out/report", "old");
    chmod(scratch_path("out/report"), 0640);
    open_out();
    stage("report", "new");
    stage("figure", "drawn");
    expect_content("out/report", "old");
    expect_none("out/figure");
    close_out();
    expect_content("out/mine", "precious");
    expect_content("out/report", "new");
    expect_content("out/figure", "drawn");
    TEST_ASSERT_EQUAL(3, count_out());
    struct stat status;
    TEST_ASSERT_EQUAL(0, stat(scratch_path("out/report"), &status));
    TEST_ASSERT_EQUAL_HEX(0640, status.st_mode & 07777);
    remove_one("out/mine");
    remove_one("out/report");
    remove_one("out/figure");
    remove_one("out");
}

static void test_a_failure_leaves_the_folder_as_it_was(void)
{
    make_folder("out");
    scratch_text("out/report", "old");
    open_out();
    stage("report", "new");
    stage("figure", "drawn");
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
    expect_content("out/report", "old");
    TEST_ASSERT_EQUAL(1, count_out());
    remove_one("out/report");
    remove_one("out");
}

/* The names are put in place in whatever order the folder lists them: "a" and "c" must be as before with "b"
 * in the way, which no order can pass. */
static void test_a_name_that_is_taken_by_a_folder_stops_all(void)
{
    make_folder("out");
    make_folder("out/b");
    scratch_text("out/a", "old");
    open_out();
    stage("a", "new");
    stage("b", "new");
    stage("c", "new");
    TEST_ASSERT_FALSE(out_folder_close(&f, true, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, scratch_path("out/b")), e.text);
    expect_content("out/a", "old");
    expect_none("out/c");
    TEST_ASSERT_EQUAL(2, count_out());
    remove_one("out/a");
    remove_one("out/b");
    remove_one("out");
}

/* Found only when the file is moved: the link's folder is another file system. */
static void test_a_move_that_fails_is_taken_back(void)
{
    struct stat here;
    struct stat there;
    if (stat("/dev/shm", &there) != 0 || stat(scratch_path(""), &here) != 0 || here.st_dev == there.st_dev) {
        TEST_IGNORE_MESSAGE("no second file system here");
    }
    char far_away[] = "/dev/shm/iqfoc-test-XXXXXX";
    const int descriptor = mkstemp(far_away);
    TEST_ASSERT_TRUE(descriptor >= 0);
    close(descriptor);
    make_folder("out");
    TEST_ASSERT_EQUAL(0, symlink(far_away, scratch_path("out/b")));
    scratch_text("out/a", "old a");
    scratch_text("out/c", "old c");
    open_out();
    stage("a", "new");
    stage("b", "new");
    stage("c", "new");
    stage("d", "new");
    TEST_ASSERT_FALSE(out_folder_close(&f, true, &e));
    TEST_ASSERT_EQUAL(STATUS_FAILED, e.status);
    expect_content("out/a", "old a");
    expect_content("out/c", "old c");
    expect_content("out/b", "");
    expect_none("out/d");
    TEST_ASSERT_EQUAL(3, count_out());
    remove(far_away);
    remove_one("out/a");
    remove_one("out/b");
    remove_one("out/c");
    remove_one("out");
}

static void test_a_link_stays_and_its_file_is_replaced(void)
{
    make_folder("out");
    scratch_text("target", "old");
    TEST_ASSERT_EQUAL(0, symlink("../target", scratch_path("out/link")));
    open_out();
    stage("link", "new");
    close_out();
    struct stat status;
    TEST_ASSERT_EQUAL(0, lstat(scratch_path("out/link"), &status));
    TEST_ASSERT_TRUE(S_ISLNK(status.st_mode));
    expect_content("target", "new");
    remove_one("out/link");
    remove_one("out");
    remove_one("target");
}

static void test_a_folder_that_appeared_meanwhile_is_written_into(void)
{
    open_out();
    stage("report", "new");
    make_folder("out");
    scratch_text("out/other", "of another program");
    close_out();
    expect_content("out/report", "new");
    expect_content("out/other", "of another program");
    TEST_ASSERT_EQUAL(1, scratch_count());
    remove_one("out/report");
    remove_one("out/other");
    remove_one("out");
}

static void expect_users_folder_named(const char *name)
{
    e = (error){0};
    TEST_ASSERT_TRUE_MESSAGE(out_folder_open(&f, scratch_path(name), &e), e.text);
    error_failure(&e, 0, "%s/x: no; %s/y: neither", f.stage, f.stage);
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
    char expected[900];
    const char *path = scratch_path(name);
    snprintf(expected, sizeof expected, "%s/x: no; %s/y: neither", path, path);
    TEST_ASSERT_EQUAL_STRING(expected, e.text);
}

static void test_messages_name_the_users_folder(void)
{
    expect_users_folder_named("out");
    expect_users_folder_named("a-name-that-is-longer-than-the-one-of-the-stage/below/it");
}

static void test_a_file_named_separately_goes_with_the_others(void)
{
    open_out();
    const char *path = out_folder_place(&f, scratch_path("out/x.json"), &e);
    TEST_ASSERT_NOT_NULL(path);
    TEST_ASSERT_EQUAL_STRING_LEN(f.stage, path, strlen(f.stage));
    TEST_ASSERT_EQUAL_STRING("/x.json", path + strlen(f.stage));
    static const char *const elsewhere[] = {"-", "out.json", "outside/x.json"};
    for (size_t n = 0; n < sizeof elsewhere / sizeof elsewhere[0]; n++) {
        TEST_ASSERT_EQUAL_PTR(elsewhere[n], out_folder_place(&f, elsewhere[n], &e));
    }
    const char *beside = scratch_path("outside.json");
    TEST_ASSERT_EQUAL_PTR(beside, out_folder_place(&f, beside, &e));
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
    TEST_ASSERT_EQUAL_PTR("out/x", out_folder_place(&f, "out/x", &e)); /* nothing is open */
}

/* The first that a rename can replace says where; one file alone needs no stage. */
static void test_the_folder_of_files_named_one_by_one(void)
{
    make_folder("out");
    char in_out[500];
    char too[500];
    snprintf(in_out, sizeof in_out, "%s", scratch_path("out/a"));
    snprintf(too, sizeof too, "%s", scratch_path("out/b"));
    const char *const together[] = {NULL, "-", "/dev/null", in_out, too, "c"};
    TEST_ASSERT_TRUE_MESSAGE(out_folder_open_for(&f, together, 6, &e), e.text);
    TEST_ASSERT_EQUAL_STRING(scratch_path("out"), f.path);
    TEST_ASSERT_NOT_EQUAL(0, strcmp(too, out_folder_place(&f, too, &e)));
    TEST_ASSERT_EQUAL_PTR(together[5], out_folder_place(&f, together[5], &e));
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
    const char *const alone[] = {NULL, in_out, NULL};
    const char *const no_files[] = {"-", "/dev/null"};
    const char *const nowhere[] = {"missing/x", in_out};
    TEST_ASSERT_TRUE(out_folder_open_for(&f, alone, 3, &e) && f.path[0] == '\0');
    TEST_ASSERT_TRUE(out_folder_open_for(&f, no_files, 2, &e) && f.path[0] == '\0');
    TEST_ASSERT_TRUE(out_folder_open_for(&f, nowhere, 2, &e) && f.path[0] == '\0');
    remove_one("out");
}

/* A device is written as it comes, wherever it is; and a name without a folder is one in the folder ".". */
static void test_places_of_devices_and_plain_names(void)
{
    out_folder here = {.path = ".", .stage = "stage"};
    const char *device = "/dev/null";
    out_folder devices = {.path = "/dev", .stage = "stage"};
    TEST_ASSERT_EQUAL_STRING("stage/plan.toml", out_folder_place(&here, "plan.toml", &e));
    TEST_ASSERT_EQUAL_STRING("stage/plan.toml", out_folder_place(&here, "./plan.toml", &e));
    TEST_ASSERT_EQUAL_STRING("none/plan.toml", out_folder_place(&here, "none/plan.toml", &e));
    TEST_ASSERT_EQUAL_PTR(device, out_folder_place(&devices, device, &e));
}

static void test_no_folder_is_no_failure(void)
{
    TEST_ASSERT_TRUE(out_folder_open(&f, NULL, &e));
    TEST_ASSERT_NULL(f.stage);
    TEST_ASSERT_TRUE(out_folder_close(&f, true, &e));
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
}

static void expect_refused(const char *path, const char *words)
{
    e = (error){0};
    TEST_ASSERT_FALSE(out_folder_open(&f, path, &e));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, words), e.text);
    TEST_ASSERT_FALSE(out_folder_close(&f, false, &e));
}

static void test_what_cannot_be_opened_is_named(void)
{
    scratch_text("file", "");
    expect_refused("", "needs a name");
    expect_refused(scratch_path("file"), "is not a directory");
    expect_refused(scratch_path("file/sub"), "is not a directory");
    expect_refused("/proc/self/iqfoc", "/proc/self/iqfoc: cannot be written");
    TEST_ASSERT_EQUAL(0, symlink("nowhere", scratch_path("dangling")));
    expect_refused(scratch_path("dangling"), "is not a directory");
    remove_one("dangling");
    remove_one("file");
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_a_new_folder_is_absent_until_it_is_closed);
    RUN_TEST(test_a_new_folder_has_the_mode_the_umask_gives);
    RUN_TEST(test_a_failure_leaves_no_folder_and_no_parents);
    RUN_TEST(test_parents_are_made);
    RUN_TEST(test_a_folder_that_exists_keeps_what_is_not_written);
    RUN_TEST(test_a_failure_leaves_the_folder_as_it_was);
    RUN_TEST(test_a_name_that_is_taken_by_a_folder_stops_all);
    RUN_TEST(test_a_move_that_fails_is_taken_back);
    RUN_TEST(test_a_link_stays_and_its_file_is_replaced);
    RUN_TEST(test_a_folder_that_appeared_meanwhile_is_written_into);
    RUN_TEST(test_messages_name_the_users_folder);
    RUN_TEST(test_a_file_named_separately_goes_with_the_others);
    RUN_TEST(test_the_folder_of_files_named_one_by_one);
    RUN_TEST(test_places_of_devices_and_plain_names);
    RUN_TEST(test_no_folder_is_no_failure);
    RUN_TEST(test_what_cannot_be_opened_is_named);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
