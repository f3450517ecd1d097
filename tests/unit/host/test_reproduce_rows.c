/*
 * The comparison's rows as text and as JSON.
 */
/* POSIX: open_memstream. */
#define _POSIX_C_SOURCE 200809L

#include "reproduce/rows.h"

#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static comparison rows;
static char *text;
static size_t size;

void setUp(void)
{
    text = NULL;
    comparison_add(&rows, (comparison_row){"2019", "Table 1", "mean", "standard", "5000 rpm", "%", 0.73,
                                           0.735, 0.7351, "shared note"});
    comparison_add(&rows, (comparison_row){"2019", "Table 1", "prediction", "quasi-discrete", "8000 rpm", "%",
                                           0.76, 0.8, 0.8, "shared note"});
    comparison_add(&rows,
                   (comparison_row){"2019", "own", "difference", "", "8000 rpm", "A", NAN, 0.0, 3e-7, ""});
}

void tearDown(void)
{
    comparison_free(&rows);
    free(text);
}

static const char *printed(void)
{
    FILE *out = open_memstream(&text, &size);
    comparison_print(&rows, out);
    fclose(out);
    return text;
}

static void test_table_is_aligned_and_shares_its_notes(void)
{
    TEST_ASSERT_EQUAL_STRING(
        "\n"
        "2019, Table 1\n"
        "  quantity    method          condition  unit  paper  double    IQ24  ratio\n"
        "  mean        standard        5000 rpm   %      0.73   0.735  0.7351  1.007 [1]\n"
        "  prediction  quasi-discrete  8000 rpm   %      0.76     0.8     0.8  1.053 [1]\n"
        "  [1] shared note\n"
        "\n"
        "2019, own\n"
        "  quantity    method  condition  unit  paper  double       IQ24  ratio\n"
        "  difference          8000 rpm   A         -       0  3.000e-07  -\n",
        printed());
}

static void test_long_note_is_broken_at_blanks(void)
{
    char note[256] = "";
    for (int n = 0; n < 30; n++) {
        strcat(note, "seven77 ");
    }
    comparison_add(&rows, (comparison_row){"2016", "x", "q", "", "c", "", 1.0, 1.0, 1.0, note});
    const char *line = strstr(printed(), "  [1] seven77");
    TEST_ASSERT_NOT_NULL(line);
    while (*line != '\0') {
        const size_t length = strcspn(line, "\n");
        TEST_ASSERT_TRUE(length <= 100);
        line += length + 1;
    }
}

static void test_json_parts_rows_with_and_without_a_paper(void)
{
    json_t *json = comparison_json(&rows);
    const json_t *of_papers = json_object_get(json, "rows");
    const json_t *own = json_object_get(json, "own");
    TEST_ASSERT_EQUAL_UINT(2, json_array_size(of_papers));
    TEST_ASSERT_EQUAL_UINT(1, json_array_size(own));
    const json_t *row = json_array_get(of_papers, 1);
    TEST_ASSERT_EQUAL_STRING("quasi-discrete", json_string_value(json_object_get(row, "method")));
    TEST_ASSERT_EQUAL_DOUBLE(0.76, json_number_value(json_object_get(row, "paper_value")));
    TEST_ASSERT_TRUE(json_is_null(json_object_get(json_array_get(own, 0), "paper_value")));
    json_free(json);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_table_is_aligned_and_shares_its_notes);
    RUN_TEST(test_long_note_is_broken_at_blanks);
    RUN_TEST(test_json_parts_rows_with_and_without_a_paper);
    return UNITY_END();
}
