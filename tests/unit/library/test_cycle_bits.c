/* Every configuration of the control cycle to the last bit: the digests of golden.txt (tests/target/golden). */
#include "golden_cycle.h"
#include "hash.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static FILE *golden;
static uint32_t reported;

/* The next line of the file that is of a configuration. */
static void expect_next(const char *name, uint64_t digest)
{
    char line[80];
    uint64_t stored = 0;
    do {
        TEST_ASSERT_EQUAL_INT(2, fscanf(golden, "%79s %" SCNx64, line, &stored));
    } while (strncmp(line, "cycle/", 6) != 0);
    TEST_ASSERT_EQUAL_STRING(line, name);
    TEST_ASSERT_TRUE_MESSAGE(stored == digest, name);
    reported++;
}

static void test_cycle(void)
{
    golden = fopen("tests/target/golden/golden.txt", "r");
    TEST_ASSERT_NOT_NULL(golden);
    const uint32_t configurations = golden_cycle(expect_next);
    fclose(golden);
    /* One more line: six-step by a timer. */
    TEST_ASSERT_EQUAL_UINT32(configurations + 1, reported);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cycle);
    return UNITY_END();
}
