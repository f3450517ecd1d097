/* The one hash is that of golden.txt's lines, and changes with each of them (tests/target/golden/golden_hash.h). */
#include "golden_hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

enum { MOST = 200 };

typedef struct line {
    char name[80];
    uint64_t digest;
} line;

static line lines[MOST];
static int count;

void setUp(void)
{
    FILE *in = fopen("tests/target/golden/golden.txt", "r");
    TEST_ASSERT_NOT_NULL(in);
    count = 0;
    /* What comes behind is the closed loop's, which is no part of the vectors. */
    while (count < MOST && fscanf(in, "%79s %" SCNx64, lines[count].name, &lines[count].digest) == 2 &&
           strcmp(lines[count].name, "closed_loop") != 0) {
        count++;
    }
    fclose(in);
}

void tearDown(void)
{
}

static uint64_t hash_of_lines(void)
{
    uint64_t hash = GOLDEN_HASH_START;
    for (int n = 0; n < count; n++) {
        golden_hash_add(&hash, lines[n].name, lines[n].digest);
    }
    return hash;
}

static void test_the_stored_hash_is_that_of_the_file(void)
{
    char message[80];
    snprintf(message, sizeof message, "GOLDEN_HASH is to be %016" PRIx64, hash_of_lines());
    TEST_ASSERT_GREATER_THAN(60, count);
    TEST_ASSERT_TRUE_MESSAGE(hash_of_lines() == GOLDEN_HASH, message);
}

static void test_each_line_counts(void)
{
    for (int n = 0; n < count; n++) {
        const line was = lines[n];
        lines[n].digest ^= UINT64_C(1) << (n % 64);
        TEST_ASSERT_TRUE(hash_of_lines() != GOLDEN_HASH);
        lines[n] = was;
        lines[n].name[0]++;
        TEST_ASSERT_TRUE(hash_of_lines() != GOLDEN_HASH);
        lines[n] = was;
    }
}

static int at;

static void expect_next(const char *name, uint64_t digest)
{
    TEST_ASSERT_LESS_THAN(count, at);
    TEST_ASSERT_EQUAL_STRING(lines[at].name, name);
    TEST_ASSERT_TRUE_MESSAGE(lines[at].digest == digest, name);
    at++;
}

static void test_this_build_computes_it(void)
{
    at = 0;
    TEST_ASSERT_TRUE(golden_hash(expect_next) == GOLDEN_HASH);
    TEST_ASSERT_EQUAL_INT(count, at);
    TEST_ASSERT_TRUE(golden_hash(NULL) == GOLDEN_HASH);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_stored_hash_is_that_of_the_file);
    RUN_TEST(test_each_line_counts);
    RUN_TEST(test_this_build_computes_it);
    return UNITY_END();
}
