/* The parts of the import: names of other programs, lines of every encoding, tables of every layout. */
#include "data/foreign_names.h"
#include "host_files.h"
#include "import/log_table.h"
#include "import/quantity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static log_table t;

void setUp(void)
{
    t = (log_table){0};
}

void tearDown(void)
{
    log_table_close(&t);
}

/* ---- names ---- */

static void expect_name(const char *name, const char *key, const char *unit, bool mechanical)
{
    const foreign_name found = foreign_name_find(name, strlen(name));
    if (key == NULL) {
        TEST_ASSERT_NULL_MESSAGE(found.key, name);
        return;
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(found.key, name);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(key, found.key, name);
    if (unit == NULL) {
        TEST_ASSERT_NULL_MESSAGE(found.unit, name);
    } else {
        TEST_ASSERT_NOT_NULL_MESSAGE(found.unit, name);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(unit, found.unit, name);
    }
    TEST_ASSERT_EQUAL_MESSAGE(mechanical, found.mechanical, name);
}

static void test_names_of_other_programs(void)
{
    expect_name("Ia", "i_a_A", NULL, false);
    expect_name("I_A", "i_a_A", NULL, false);
    expect_name("Ia [mA]", "i_a_A", "mA", false);
    expect_name("ia_mA", "i_a_A", "mA", false);
    expect_name("Ia/A", "i_a_A", "A", false);
    expect_name("Phase current C (A)", "i_c_A", "A", false);
    expect_name("axis0.motor.current_control.Iq_measured", "i_q_A", NULL, false);
    expect_name("Speed [1/min]", "omega_e_rad_s", "rpm", true);
    expect_name("omega_rad/s", "omega_e_rad_s", "rad/s", false);
    expect_name("Angle (\xC2\xB0)", "theta_e_rad", "deg", false);
    expect_name("enc", "theta_e_rad", "count", true);
    expect_name("time [\xC2\xB5s]", "t_s", "us", false);
    expect_name("U_ab [V]", "u_ab_V", "V", false);
    expect_name("Iq_ref", NULL, NULL, false);
    expect_name("Iax", NULL, NULL, false);
    expect_name("", NULL, NULL, false);
    expect_name("[mA]", NULL, NULL, false);
    expect_name("---", NULL, NULL, false);
}

/* Whatever the dictionary says must be a key and a unit that a map can have. */
static void test_what_names_mean_fits_a_map(void)
{
    static const char *const tried[] = {
        "mstoday", "erpm", "encoder_position", "enc", "rpm",   "Drehzahl", "ccr1", "Vbus", "i_alpha",
        "theta",   "temp", "shaft_angle",      "Vab", "phase", "segment"};
    for (size_t n = 0; n < sizeof tried / sizeof *tried; n++) {
        const foreign_name found = foreign_name_find(tried[n], strlen(tried[n]));
        TEST_ASSERT_NOT_NULL_MESSAGE(found.key, tried[n]);
        const quantity q = quantity_find(found.key);
        TEST_ASSERT_TRUE_MESSAGE(q != QUANTITY_COUNT, tried[n]);
        if (found.unit != NULL) {
            TEST_ASSERT_NOT_NULL_MESSAGE(quantity_unit_find(quantity_dimension(q), found.unit), tried[n]);
        }
    }
    TEST_ASSERT_EQUAL(QUANTITY_COUNT, quantity_find("i_x_A"));
    TEST_ASSERT_NULL(quantity_unit_find(DIMENSION_CURRENT, "V"));
}

/* ---- fields ---- */

static void expect_fields(const char *line, char delimiter, const char *joined)
{
    static log_field fields[LOG_FIELDS_MOST];
    char copy[200];
    char got[400] = "";
    strcpy(copy, line);
    const int count = log_line_split(copy, strlen(copy), delimiter, fields);
    for (int n = 0; n < count; n++) {
        strncat(got, fields[n].text, fields[n].length);
        strcat(got, "|");
    }
    TEST_ASSERT_EQUAL_STRING_MESSAGE(joined, count < 0 ? "no end" : got, line);
}

static void test_fields_of_a_line(void)
{
    expect_fields("a,b,c", ',', "a|b|c|");
    expect_fields(" a , b c ,", ',', "a|b c||");
    expect_fields("", ',', "|");
    expect_fields("a\t\tb", '\t', "a||b|");
    expect_fields("  a  \t b ", ' ', "a|b|");
    expect_fields("\"a,b\",\"c\"\"d\" ,e", ',', "a,b|c\"d|e|");
    expect_fields("\"1,5\";2", ';', "1,5|2|");
    expect_fields("a,\"b", ',', "no end");
    static char many[2 * LOG_FIELDS_MOST + 2];
    static log_field fields[LOG_FIELDS_MOST];
    memset(many, ',', sizeof many);
    TEST_ASSERT_EQUAL(-2, log_line_split(many, LOG_FIELDS_MOST, ',', fields));
    TEST_ASSERT_EQUAL(LOG_FIELDS_MOST, log_line_split(many, LOG_FIELDS_MOST - 1, ',', fields));
}

static void test_numbers_with_either_mark(void)
{
    double value = 0.0;
    log_field f = {"-1,5e-3", 7, 0};
    TEST_ASSERT_TRUE(log_field_number(&f, ',', &value) && value == -1.5e-3);
    TEST_ASSERT_FALSE(log_field_number(&f, '.', &value));
    f = (log_field){"1.5", 3, 0};
    TEST_ASSERT_TRUE(log_field_number(&f, '.', &value) && value == 1.5);
    TEST_ASSERT_FALSE(log_field_number(&f, ',', &value)); /* a thousand's point would be 1.500 */
    f = (log_field){"1.234,5", 7, 0};
    TEST_ASSERT_FALSE(log_field_number(&f, ',', &value));
}

/* ---- tables ---- */

static void read_all(const char *path, error *e)
{
    const log_format unknown = LOG_FORMAT_UNKNOWN;
    bool wanted[LOG_FIELDS_MOST] = {true, true};
    TEST_ASSERT_TRUE_MESSAGE(log_table_open(&t, path, &unknown, e), e->text);
    TEST_ASSERT_TRUE_MESSAGE(log_table_read(&t, wanted, e), e->text);
}

static void expect_table(const char *text, char delimiter, char decimal, const char *first, size_t rows,
                         double last)
{
    error e = {0};
    log_table_close(&t);
    read_all(scratch_text("log", text), &e);
    TEST_ASSERT_EQUAL_MESSAGE(delimiter, t.format.delimiter, text);
    TEST_ASSERT_EQUAL_MESSAGE(decimal, t.format.decimal, text);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(first, t.name[0], text);
    TEST_ASSERT_EQUAL_MESSAGE(rows, t.rows, text);
    TEST_ASSERT_TRUE_MESSAGE(t.value[1][rows - 1] == last, text);
}

static void test_layouts_are_found(void)
{
    expect_table("a,b\n1,2\n3,4.5\n", ',', '.', "a", 2, 4.5);
    expect_table("a;b\n1,5;2,5\n", ';', ',', "a", 1, 2.5);
    expect_table("a;b;c\n1;2;3\n", ';', '.', "a", 1, 2.0);
    expect_table("a\tb\n1,5\t2\n", '\t', ',', "a", 1, 2.0);
    expect_table("a   b\n 1   2.5\n", ' ', '.', "a", 1, 2.5);
    expect_table("Bench 3, drive 7\nDate: 2026-01-02\n\nt;i\n[s];[A]\n0;1\n1;2\n", ';', '.', "t", 2, 2.0);
    TEST_ASSERT_TRUE(t.head.has_units);
    TEST_ASSERT_EQUAL_STRING("[A]", t.unit[1]);
    /* A header of letters that are units, too, is the header where nothing else can be. */
    expect_table("s,A\n0,1\n", ',', '.', "s", 1, 1.0);
    TEST_ASSERT_FALSE(t.head.has_units);
    expect_table("1,2\n3,4\n", ',', '.', "1", 2, 4.0);
    TEST_ASSERT_FALSE(t.head.has_header);
    expect_table("t,i,state\n0,1,run\n1,2,\n", ',', '.', "t", 2, 2.0);
}

/* More than the blocks of the reader, with characters of two UTF-16 units that their ends cut. */
static void test_a_long_log_in_utf16(void)
{
    enum { ROWS = 60000 };
    char *bytes = malloc(ROWS * 40);
    size_t length = 0;
    TEST_ASSERT_NOT_NULL(bytes);
    for (int k = -1; k < ROWS; k++) {
        char row[40];
        snprintf(row, sizeof row, k < 0 ? "a;b" : "%d;%d", k, 2 * k);
        for (const char *c = row; *c != '\0'; c++) {
            bytes[length++] = *c;
            bytes[length++] = 0;
        }
        /* ";" and U+1D11E, then a line's end; one byte more in the first row would shift all by one. */
        memcpy(bytes + length, ";\0\x34\xD8\x1E\xDD\n\0", 8);
        length += 8;
    }
    const log_format said = {ENCODING_UTF16LE, 0, 0, -1};
    bool wanted[LOG_FIELDS_MOST] = {true, true};
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(log_table_open(&t, scratch_file("long", bytes, length), &said, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(log_table_read(&t, wanted, &e), e.text);
    TEST_ASSERT_EQUAL(ROWS, t.rows);
    TEST_ASSERT_TRUE(t.value[1][ROWS - 1] == 2.0 * (ROWS - 1));
    TEST_ASSERT_EQUAL_STRING("\xF0\x9D\x84\x9E", t.name[2]);
    TEST_ASSERT_EQUAL(ROWS + 1, t.line[ROWS - 1]);
    free(bytes);
}

/* Lines that end in CR alone are lines, however long the file. */
static void test_a_long_log_of_carriage_returns(void)
{
    enum { ROWS = 200000 };
    char *text = malloc(ROWS * 16);
    TEST_ASSERT_NOT_NULL(text);
    size_t length = (size_t)sprintf(text, "a,b\r");
    for (int k = 0; k < ROWS; k++) {
        length += (size_t)sprintf(text + length, "%d,%d\r", k, k % 7);
    }
    error e = {0};
    read_all(scratch_file("cr", text, length), &e);
    TEST_ASSERT_EQUAL(ROWS, t.rows);
    TEST_ASSERT_TRUE(t.value[0][ROWS - 1] == ROWS - 1);
    free(text);
}

/* Bytes at random are refused, and quickly. */
static void test_bytes_at_random(void)
{
    unsigned state = 99; /* seed; a linear congruential generator */
    char *bytes = malloc(3000000);
    TEST_ASSERT_NOT_NULL(bytes);
    for (size_t i = 0; i < 3000000; i++) {
        state = state * 1664525u + 1013904223u;
        bytes[i] = (char)(state >> 16);
    }
    const log_format unknown = LOG_FORMAT_UNKNOWN;
    for (int encoding = 0; encoding < ENCODING_COUNT; encoding++) {
        log_format said = unknown;
        said.encoding = (log_encoding)encoding;
        error e = {0};
        bool wanted[LOG_FIELDS_MOST] = {true};
        const bool ok = log_table_open(&t, scratch_file("bytes", bytes, 3000000), &said, &e) &&
                        log_table_read(&t, wanted, &e);
        TEST_ASSERT_FALSE(ok);
        TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
        log_table_close(&t);
    }
    free(bytes);
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_names_of_other_programs);
    RUN_TEST(test_what_names_mean_fits_a_map);
    RUN_TEST(test_fields_of_a_line);
    RUN_TEST(test_numbers_with_either_mark);
    RUN_TEST(test_layouts_are_found);
    RUN_TEST(test_a_long_log_in_utf16);
    RUN_TEST(test_a_long_log_of_carriage_returns);
    RUN_TEST(test_bytes_at_random);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
