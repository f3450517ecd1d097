/* The depth of TOML's keys (toml_depth.h): what is refused and where, and what is none of its business. */
#include "data/toml_depth.h"

#include <string.h>
#include <unity.h>

static long line;
static long column;

void setUp(void)
{
    line = 0;
    column = 0;
}

void tearDown(void)
{
}

static bool passes(const char *text)
{
    return toml_depth_check(text, strlen(text), &line, &column);
}

#define SIXTEEN "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p"

static void test_sixteen_parts_pass(void)
{
    TEST_ASSERT_TRUE(passes(""));
    TEST_ASSERT_TRUE(passes(SIXTEEN " = 1\n"));
    TEST_ASSERT_TRUE(passes("[" SIXTEEN "]\n" SIXTEEN " = {" SIXTEEN " = 1, " SIXTEEN " = 2}\n"));
}

static void test_the_seventeenth_is_refused_where_it_follows(void)
{
    TEST_ASSERT_FALSE(passes("[motor]\n" SIXTEEN ".q = 1\n"));
    TEST_ASSERT_EQUAL(2, line);
    TEST_ASSERT_EQUAL(32, column);
    TEST_ASSERT_FALSE(passes("[[" SIXTEEN " . 'q']]\n"));
    TEST_ASSERT_EQUAL(1, line);
    TEST_ASSERT_EQUAL(35, column);
    TEST_ASSERT_FALSE(passes("x = { y = 1, " SIXTEEN ".q = 1 }\n"));
    TEST_ASSERT_FALSE(passes("\"\xC3\xA4\"." SIXTEEN " = 1\n"));
    TEST_ASSERT_EQUAL(34, column); /* characters: two bytes of the first part are one */
}

static void test_dots_elsewhere_count_nothing(void)
{
    TEST_ASSERT_TRUE(passes("# " SIXTEEN ".q\n"));
    TEST_ASSERT_TRUE(passes("name = \"" SIXTEEN ".q\"\n"));
    TEST_ASSERT_TRUE(passes("name = 'C:\\" SIXTEEN ".q'\n"));
    TEST_ASSERT_TRUE(passes("name = \"\"\"\n" SIXTEEN ".q \" \\\"\"\"\" # x\n"));
    TEST_ASSERT_TRUE(passes("name = '''\n" SIXTEEN ".q''' # x\n"));
    TEST_ASSERT_TRUE(passes("\"" SIXTEEN ".q\" = 1\n"));
    TEST_ASSERT_TRUE(passes(
        "x = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1]\n"));
    TEST_ASSERT_TRUE(passes("x = [\n0.1,\n0.1,\n0.1\n]\n"));
}

static void test_what_follows_a_string_is_seen(void)
{
    TEST_ASSERT_FALSE(passes("name = \"x \\\\\"\n" SIXTEEN ".q = 1\n"));
    TEST_ASSERT_FALSE(passes("name = 'x \\'\n" SIXTEEN ".q = 1\n"));
    TEST_ASSERT_FALSE(passes("name = \"\"\"x\"\"\"\n" SIXTEEN ".q = 1\n"));
    TEST_ASSERT_FALSE(passes("name = \"\"\n" SIXTEEN ".q = 1\n"));
    TEST_ASSERT_FALSE(passes("name = \"without an end\n" SIXTEEN ".q = 1\n"));
}

static void test_a_cut_text_ends(void)
{
    TEST_ASSERT_TRUE(passes("\""));
    TEST_ASSERT_TRUE(passes("\"\"\""));
    TEST_ASSERT_TRUE(passes("'''\n"));
    TEST_ASSERT_TRUE(passes("\"\\"));
    TEST_ASSERT_TRUE(passes("#"));
    TEST_ASSERT_TRUE(toml_depth_check("a = '\0", 6, &line, &column));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sixteen_parts_pass);
    RUN_TEST(test_the_seventeenth_is_refused_where_it_follows);
    RUN_TEST(test_dots_elsewhere_count_nothing);
    RUN_TEST(test_what_follows_a_string_is_seen);
    RUN_TEST(test_a_cut_text_ends);
    return UNITY_END();
}
