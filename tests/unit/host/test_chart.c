/*
 * Charts as a page holds them: numbers come back from pieces, 16 and 32 bits as exact as promised, text cannot end its
 * script, and what memory could not hold is an error.
 */
/* POSIX: mkstemp, open_memstream. */
#define _POSIX_C_SOURCE 200809L

#include "base/json.h"
#include "report/chart.h"
#include "report/chart_column.h"

#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *text;
static size_t size;

void setUp(void)
{
    text = NULL;
}

void tearDown(void)
{
    free(text);
    text = NULL;
}

/* What was written, read. */
static json_t *parsed(void)
{
    char path[] = "/tmp/iqfoc-chart-XXXXXX";
    json_complaint wrong = {0};
    const int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT((int)size, (int)write(file, text, size));
    close(file);
    json_t *read = json_read(path, &wrong);
    unlink(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(read, wrong.text);
    return read;
}

static json_t *written(void (*write)(FILE *, const chart_column *), const double *value, size_t count)
{
    const chart_column c = {value, 1, count};
    free(text); /* of an earlier call of the same test */
    FILE *out = open_memstream(&text, &size);
    write(out, &c);
    fclose(out);
    json_t *read = parsed();
    return read;
}

/* The n-th group of `bytes` bytes of a base64 text, little-endian. */
static uint64_t bits_of(const char *base64, size_t n, size_t bytes)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint64_t bits = 0;
    for (size_t k = 0; k < bytes; k++) {
        const size_t at = n * bytes + k;
        unsigned long group = 0;
        for (size_t letter = 0; letter < 4; letter++) {
            const char *found = strchr(letters, base64[at / 3 * 4 + letter]);
            group = group << 6 | (found != NULL && *found != '\0' ? (unsigned long)(found - letters) : 0);
        }
        bits |= (uint64_t)(group >> (16 - 8 * (at % 3)) & 0xFF) << (8 * k);
    }
    return bits;
}

static void test_even_stretches_are_pieces(void)
{
    static double t_s[9000];
    for (size_t n = 0; n < 9000; n++) {
        /* Two stretches of stamps with six decimals, of a step that has more. */
        t_s[n] = nearbyint((n < 5000 ? 0.0 : 3.0) * 1e6 + 1e6 / 16000.0 * (double)n) / 1e6;
    }
    json_t *read = written(chart_column_x, t_s, 9000);
    size_t at = 0;
    json_t *pieces = json_object_get(read, "pieces");
    TEST_ASSERT_NOT_NULL(pieces);
    TEST_ASSERT_TRUE(json_array_size(pieces) < 9000 / 8);
    for (size_t k = 0; k < json_array_size(pieces); k++) {
        json_t *piece = json_array_get(pieces, k);
        const double first = json_number_value(json_array_get(piece, 0));
        const double step = json_number_value(json_array_get(piece, 1));
        for (json_int_t n = 0; n < (json_int_t)json_number_value(json_array_get(piece, 2)); n++, at++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-2 * 6.3e-5, t_s[at], first + (double)n * step);
        }
    }
    TEST_ASSERT_EQUAL_size_t(9000, at);
    json_free(read);
}

static void test_an_uneven_axis_is_its_doubles(void)
{
    const double x[] = {0.1, 0.4, 0.5, 2.0, 2.125, 7.0, 1e9, 1e10, 1e300, 1.1e300};
    json_t *read = written(chart_column_x, x, 10);
    const char *base64 = json_string_value(json_object_get(read, "f8"));
    TEST_ASSERT_NOT_NULL(base64);
    for (size_t n = 0; n < 10; n++) {
        const uint64_t bits = bits_of(base64, n, 8);
        TEST_ASSERT_EQUAL_MEMORY(&bits, &x[n], sizeof bits);
    }
    json_free(read);
}

static void test_few_values_are_floats_and_gaps_stay(void)
{
    const double y[] = {1.0 / 3.0, -2e-7, NAN, INFINITY, 5e38};
    json_t *read = written(chart_column_y, y, 5);
    const char *base64 = json_string_value(json_object_get(read, "f4"));
    TEST_ASSERT_NOT_NULL(base64);
    for (size_t n = 0; n < 5; n++) {
        const uint32_t bits = (uint32_t)bits_of(base64, n, 4);
        float value;
        memcpy(&value, &bits, sizeof value);
        if (n < 2) {
            TEST_ASSERT_DOUBLE_WITHIN(6e-8 * fabs(y[n]), y[n], (double)value);
        } else {
            TEST_ASSERT_TRUE(n == 4 ? value == 0.0F : isnan(value));
        }
    }
    json_free(read);
}

static void test_many_values_are_within_half_a_step(void)
{
    enum { COUNT = CHART_EXACT + 1 };
    static double y[COUNT];
    for (size_t n = 0; n < COUNT; n++) {
        y[n] = n % 100 == 7 ? NAN : 3.0 + 40.0 * sin(0.01 * (double)n);
    }
    json_t *read = written(chart_column_y, y, COUNT);
    const char *base64 = json_string_value(json_object_get(read, "i2"));
    const double middle = json_number_value(json_object_get(read, "middle"));
    const double step = json_number_value(json_object_get(read, "step"));
    TEST_ASSERT_NOT_NULL(base64);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 40.0 / 32767.0, step);
    for (size_t n = 0; n < COUNT; n++) {
        const int16_t steps = (int16_t)bits_of(base64, n, 2);
        if (isnan(y[n])) {
            TEST_ASSERT_EQUAL_INT(-32768, steps);
        } else {
            TEST_ASSERT_DOUBLE_WITHIN(0.51 * step, y[n], middle + steps * step);
        }
    }
    json_free(read);
}

static void test_gaps_alone_are_a_column_too(void)
{
    static double y[CHART_EXACT + 1];
    for (size_t n = 0; n <= CHART_EXACT; n++) {
        y[n] = NAN;
    }
    json_free(written(chart_column_y, y, CHART_EXACT + 1));
    json_free(written(chart_column_x, y, 0));
}

static void test_text_cannot_leave_its_script(void)
{
    chart_data d = chart_data_of(2);
    const char *const names[] = {"a\n\"b\"", "\\</script><script>alert(1)</script>"};
    chart_data_add(&d, (double[]){0.0, 1.0});
    chart_data_add(&d, (double[]){1.0, 2.0});
    const chart drawn = {.x_label = "</script><!--",
                         .y_label = "y & 'z'",
                         .name = names,
                         .names = 2,
                         .series = {{.label = "<b>\xc2\xb5</b>", .data = &d, .column = 1}}};
    FILE *out = open_memstream(&text, &size);
    TEST_ASSERT_TRUE(chart_write(out, &drawn, 1));
    fclose(out);
    chart_data_free(&d);
    TEST_ASSERT_NULL(strpbrk(text, "<>&'"));
    json_t *read = parsed();
    json_t *first = json_array_get(json_object_get(read, "charts"), 0);
    TEST_ASSERT_EQUAL_STRING("</script><!--",
                             json_string_value(json_object_get(json_object_get(first, "x"), "label")));
    TEST_ASSERT_EQUAL_STRING(names[1], json_string_value(json_array_get(json_object_get(first, "names"), 1)));
    json_t *series = json_array_get(json_object_get(first, "series"), 0);
    TEST_ASSERT_EQUAL_STRING("<b>\xc2\xb5</b>", json_string_value(json_object_get(series, "label")));
    json_free(read);
}

static void test_a_column_stands_once(void)
{
    chart_data d = chart_data_of(3);
    for (int n = 0; n < 5; n++) {
        chart_data_add(&d, (double[]){n, 2.0 * n, 3.0 * n});
    }
    const chart drawn[2] = {
        {.series = {{.label = "one", .data = &d, .column = 1}, {.label = "two", .data = &d, .column = 2}}},
        {.series = {{.label = "one again", .data = &d, .column = 1}}}};
    FILE *out = open_memstream(&text, &size);
    TEST_ASSERT_TRUE(chart_write(out, drawn, 2));
    fclose(out);
    chart_data_free(&d);
    json_t *read = parsed();
    TEST_ASSERT_EQUAL_size_t(3, json_array_size(json_object_get(read, "columns")));
    TEST_ASSERT_EQUAL_size_t(2, json_array_size(json_object_get(read, "charts")));
    json_free(read);
}

static void test_lost_data_are_reported(void)
{
    const chart_data d = {.columns = 2, .lost = true};
    const chart drawn = {.series = {{.label = "lost", .data = &d, .column = 1}}};
    FILE *out = open_memstream(&text, &size);
    TEST_ASSERT_FALSE(chart_write(out, &drawn, 1));
    fclose(out);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_even_stretches_are_pieces);
    RUN_TEST(test_an_uneven_axis_is_its_doubles);
    RUN_TEST(test_few_values_are_floats_and_gaps_stay);
    RUN_TEST(test_many_values_are_within_half_a_step);
    RUN_TEST(test_gaps_alone_are_a_column_too);
    RUN_TEST(test_text_cannot_leave_its_script);
    RUN_TEST(test_a_column_stands_once);
    RUN_TEST(test_lost_data_are_reported);
    return UNITY_END();
}
