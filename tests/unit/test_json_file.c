/* The JSON that the commands write: shortest reals, order kept, read back by jansson to the same values. */
#include "base/json_file.h"
#include "host_files.h"

#include <stdlib.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_layout(void)
{
    json_t *value = json_pack("{s:i, s:s, s:[f, f], s:[{s:f, s:n}], s:{}, s:[], s:b}", "schema", 1, "name",
                              "a \"quoted\" \\ name", "ci95", 4.11, 4.0, "causes", "value", 0.1, "none",
                              "empty", "list", "flag", 1);
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(json_file_write(scratch_path("a.json"), value, &e), e.text);
    char *text = scratch_read("a.json");
    TEST_ASSERT_EQUAL_STRING("{\n"
                             "  \"schema\": 1,\n"
                             "  \"name\": \"a \\\"quoted\\\" \\\\ name\",\n"
                             "  \"ci95\": [4.11, 4.0],\n"
                             "  \"causes\": [\n"
                             "    {\n"
                             "      \"value\": 0.1,\n"
                             "      \"none\": null\n"
                             "    }\n"
                             "  ],\n"
                             "  \"empty\": {},\n"
                             "  \"list\": [],\n"
                             "  \"flag\": true\n"
                             "}\n",
                             text);
    free(text);

    json_error_t why;
    json_t *back = json_load_file(scratch_path("a.json"), 0, &why);
    TEST_ASSERT_NOT_NULL_MESSAGE(back, why.text);
    TEST_ASSERT_TRUE(json_equal(value, back));
    json_decref(back);
    json_decref(value);
}

static void test_failures(void)
{
    error e = {0};
    TEST_ASSERT_FALSE(json_file_write(scratch_path("b.json"), NULL, &e));
    TEST_ASSERT_EQUAL(STATUS_FAILED, e.status);
    TEST_ASSERT_NULL(scratch_read("b.json"));

    json_t *value = json_object();
    error missing = {0};
    TEST_ASSERT_FALSE(json_file_write(scratch_path("none/c.json"), value, &missing));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, missing.status);
    json_decref(value);
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_layout);
    RUN_TEST(test_failures);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
