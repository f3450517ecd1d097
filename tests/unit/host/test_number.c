/* Numbers as text are exact both ways, and nothing but a decimal number is read as one. */
#include "base/number.h"

#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static number_result parse(const char *text, double *value)
{
    return number_parse(text, strlen(text), value);
}

static void expect_text(const char *expected, double value)
{
    char text[NUMBER_TEXT_SIZE];
    TEST_ASSERT_EQUAL(strlen(expected), number_text(value, text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void test_text_is_the_shortest(void)
{
    expect_text("0.1", 0.1);
    expect_text("0.0052", 5.2e-3);
    expect_text("750", 750.0);
    expect_text("-2.2250738585072014e-308", -2.2250738585072014e-308);
}

/* Every bit pattern that is finite, at random. */
static void test_text_reads_back_to_the_same_bits(void)
{
    uint64_t state = 0x9E3779B97F4A7C15u; /* seed; xorshift64 */
    for (int n = 0; n < 200000; n++) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        double value;
        memcpy(&value, &state, sizeof value);
        if (!isfinite(value)) {
            continue;
        }
        char text[NUMBER_TEXT_SIZE];
        double back = 0.0;
        TEST_ASSERT_EQUAL_MESSAGE(NUMBER_OK, number_parse(text, number_text(value, text), &back), text);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&value, &back, sizeof value, text);
    }
}

static void test_what_is_read(void)
{
    double value = 0.0;
    TEST_ASSERT_EQUAL(NUMBER_OK, parse("+1.5e3", &value));
    TEST_ASSERT_TRUE(value == 1500.0);
    TEST_ASSERT_EQUAL(NUMBER_OK, parse("-.5", &value));
    TEST_ASSERT_TRUE(value == -0.5);
    TEST_ASSERT_EQUAL(NUMBER_OK, parse("007", &value));
    TEST_ASSERT_TRUE(value == 7.0);
}

static void test_what_is_refused(void)
{
    static const struct {
        const char *text;
        number_result expected;
    } cases[] = {
        {"", NUMBER_EMPTY},
        {"abc", NUMBER_NOT_A_NUMBER},
        {"1,5", NUMBER_NOT_A_NUMBER},
        {"1.5V", NUMBER_NOT_A_NUMBER},
        {"1.5 ", NUMBER_NOT_A_NUMBER},
        {" 1.5", NUMBER_NOT_A_NUMBER},
        {"0x10", NUMBER_NOT_A_NUMBER},
        {"+-1", NUMBER_NOT_A_NUMBER},
        {"+", NUMBER_NOT_A_NUMBER},
        {"-", NUMBER_NOT_A_NUMBER},
        {"1e", NUMBER_NOT_A_NUMBER},
        {"1.2.3", NUMBER_NOT_A_NUMBER},
        {"nan", NUMBER_NOT_FINITE},
        {"NaN", NUMBER_NOT_FINITE},
        {"-inf", NUMBER_NOT_FINITE},
        {"1e999", NUMBER_NOT_REPRESENTABLE},
        {"1e-999", NUMBER_NOT_REPRESENTABLE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double value = 42.0;
        TEST_ASSERT_EQUAL_MESSAGE(cases[i].expected, parse(cases[i].text, &value), cases[i].text);
        TEST_ASSERT_TRUE_MESSAGE(value == 42.0, "value was touched");
        TEST_ASSERT_TRUE(strlen(number_complaint(cases[i].expected)) > 0);
    }
}

static void test_the_locale_does_not_matter(void)
{
    if (setlocale(LC_ALL, "de_DE.UTF-8") == NULL && setlocale(LC_ALL, "de_DE") == NULL) {
        TEST_IGNORE_MESSAGE("no locale with a decimal comma is installed here");
    }
    double value = 0.0;
    TEST_ASSERT_EQUAL(NUMBER_OK, parse("1.5", &value));
    TEST_ASSERT_TRUE(value == 1.5);
    expect_text("1.5", 1.5);
    setlocale(LC_ALL, "C");
}

static void test_a_dash_for_what_is_no_number(void)
{
    char text[NUMBER_TEXT_SIZE];
    TEST_ASSERT_EQUAL_STRING("80", number_or_dash(80.0, 3, text));
    TEST_ASSERT_EQUAL_STRING("2.46", number_or_dash(2.4567, 3, text));
    TEST_ASSERT_EQUAL_STRING("-1e+300", number_or_dash(-1e300, 9, text));
    TEST_ASSERT_EQUAL_STRING("2.46 %", number_percent(2.4567, text));
    TEST_ASSERT_EQUAL_STRING("-1e+300 %", number_percent(-1e300, text));
    TEST_ASSERT_EQUAL_STRING("not measured", number_percent(-NAN, text));
    TEST_ASSERT_EQUAL_STRING("not measured", number_percent(INFINITY, text));
    TEST_ASSERT_EQUAL_STRING("-", number_or_dash(INFINITY, 3, text));
    TEST_ASSERT_EQUAL_STRING("-", number_or_dash(-INFINITY, 3, text));
    TEST_ASSERT_EQUAL_STRING("-", number_or_dash(NAN, 3, text));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_dash_for_what_is_no_number);
    RUN_TEST(test_text_is_the_shortest);
    RUN_TEST(test_text_reads_back_to_the_same_bits);
    RUN_TEST(test_what_is_read);
    RUN_TEST(test_what_is_refused);
    RUN_TEST(test_the_locale_does_not_matter);
    return UNITY_END();
}
