/* The JSON that the commands write: shortest reals, order kept, read back to the same values. */
#include "base/json_file.h"
#include "host_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
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

    json_complaint why;
    json_t *back = json_read(scratch_path("a.json"), &why);
    TEST_ASSERT_NOT_NULL_MESSAGE(back, why.text);
    TEST_ASSERT_TRUE(json_equal(value, back));
    json_free(back);
    json_free(value);
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
    json_free(value);
}

/* A part that could not be made leaves nothing of the whole, nor does a form that has no such letter. */
static void test_what_cannot_be_made_is_null(void)
{
    TEST_ASSERT_NULL(json_real(NAN));
    TEST_ASSERT_NULL(json_pack("{s:f, s:o}", "value", INFINITY, "list", json_array()));
    TEST_ASSERT_NULL(json_pack("[s, n]", NULL));
    TEST_ASSERT_NULL(json_pack("{s:x}", "key"));
    TEST_ASSERT_NULL(json_pack("{s:o}", "key", NULL));
    TEST_ASSERT_EQUAL_INT(-1, json_array_append_new(NULL, json_null()));
    TEST_ASSERT_EQUAL_INT(-1, json_object_set_new(NULL, "key", json_null()));

    json_t *value = json_pack("{s:o*, s:o*, s:I, s:i}", "left_out", NULL, "kept", json_number(NAN), "large",
                              (json_int_t)1 << 53, "small", -1);
    TEST_ASSERT_NULL(json_object_get(value, "left_out"));
    TEST_ASSERT_TRUE(json_is_null(json_object_get(value, "kept")));
    TEST_ASSERT_EQUAL_DOUBLE(9007199254740992.0, json_number_value(json_object_get(value, "large")));
    TEST_ASSERT_NULL(json_array_get(value, 0));
    TEST_ASSERT_NULL(json_string_value(json_object_get(value, "small")));
    TEST_ASSERT_EQUAL_INT(-1, json_array_append_new(value, json_null()));
    TEST_ASSERT_EQUAL_INT(-1, json_object_update(value, NULL));

    json_t *more = json_pack("{s:b, s:i}", "new", 0, "small", 7);
    TEST_ASSERT_EQUAL_INT(0, json_object_update(value, more));
    TEST_ASSERT_FALSE(json_is_true(json_object_get(value, "new")));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, json_number_value(json_object_get(value, "small")));
    json_free(more);
    json_free(value);
}

/* Control characters, other alphabets, and bytes that are no text. */
static void test_every_text_is_printed_as_json(void)
{
    json_t *value = json_pack("[s, s, s]", "\t\n\x01\x7F</script>", "\xC3\xA9 \xE2\x82\xAC", "a\xFFz\xC3");
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(json_file_write(scratch_path("t.json"), value, &e), e.text);
    char *text = scratch_read("t.json");
    TEST_ASSERT_EQUAL_STRING("[\"\\t\\n\\u0001\x7F</script>\", \"\xC3\xA9 \xE2\x82\xAC\", "
                             "\"a\xEF\xBF\xBDz\xEF\xBF\xBD\"]\n",
                             text);
    free(text);
    json_free(value);
}

static void expect_unreadable(const char *text, long line, const char *words)
{
    json_complaint wrong;
    TEST_ASSERT_NULL(
        json_read(text != NULL ? scratch_text("u.json", text) : scratch_path("none.json"), &wrong));
    TEST_ASSERT_EQUAL_INT(line, wrong.line);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(wrong.text, words), wrong.text);
}

static void test_what_is_no_json_is_complained_of_with_its_line(void)
{
    expect_unreadable(NULL, 0, "cannot be read: No such file");
    expect_unreadable("", 1, "syntax error");
    expect_unreadable("{\n  \"a\": 1,\n  \"b\": oh\n}\n", 3, "invalid literal");
    expect_unreadable("[1, 2", 1, "unexpected end of input");
    expect_unreadable("[1,\n1e999]", 2, "1e999");
    expect_unreadable("[1]\n\n x", 3, "syntax error");
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_layout);
    RUN_TEST(test_failures);
    RUN_TEST(test_what_cannot_be_made_is_null);
    RUN_TEST(test_every_text_is_printed_as_json);
    RUN_TEST(test_what_is_no_json_is_complained_of_with_its_line);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
