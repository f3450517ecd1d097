/* The options of a command, and the words that somebody who mistyped one meant. */
#include "base/suggest.h"
#include "commands/options.h"

#include <string.h>
#include <unity.h>

enum { OPT_MOTOR, OPT_OUT, OPT_RPM, OPT_SEED, OPT_QUICK };

static struct {
    const char *motor, *out;
    option_texts notes;
    double rpm[2];
    size_t speeds;
    long seed;
    bool quick;
} asked;

static const option_spec specs[] = {
    [OPT_MOTOR] = {"motor", 0, "M.toml", "the motor file", .text = &asked.motor, .needed = true},
    [OPT_OUT] = {"output", 'o', "F", "where to", .text = &asked.out},
    [OPT_RPM] = {"rpm", 0, "N[,N...]", "speeds", .number = asked.rpm, .count = &asked.speeds, .most = 2,
                 .low = -10.0, .high = 10.0},
    [OPT_SEED] = {"seed", 0, "N", "of the noise", .integer = &asked.seed, .low = 1, .high = 9},
    [OPT_QUICK] = {"quick", 'q', NULL, "a switch", .flag = &asked.quick},
    {"note", 'n', "TEXT", "repeatable", .texts = &asked.notes},
    {.name = NULL},
};

static const command_about about = {"try", "[options]", "A command for this test.", specs};

void setUp(void)
{
    memset(&asked, 0, sizeof asked);
}

void tearDown(void)
{
}

static int count_arguments(char **argv)
{
    int count = 0;
    while (argv[count] != NULL) {
        count++;
    }
    return count;
}

static void test_every_form_of_an_option(void)
{
    char *argv[] = {"try",     "first",          "--motor", "m.toml", "-oout.csv",
                    "--quick", "--rpm=1,2.5,-3", "second",  NULL};
    error e = {0};
    options o = options_begin(&about, count_arguments(argv), argv);
    TEST_ASSERT_EQUAL(OPT_MOTOR, options_next(&o, &e));
    TEST_ASSERT_EQUAL_STRING("m.toml", o.argument);
    TEST_ASSERT_EQUAL(OPT_OUT, options_next(&o, &e));
    TEST_ASSERT_EQUAL_STRING("out.csv", o.argument);
    TEST_ASSERT_EQUAL(OPT_QUICK, options_next(&o, &e));
    TEST_ASSERT_EQUAL(OPT_RPM, options_next(&o, &e));
    double rpm[4];
    size_t count = 0;
    TEST_ASSERT_TRUE(options_numbers(&o, -1e6, 1e6, rpm, 4, &count, &e));
    TEST_ASSERT_EQUAL(3, count);
    TEST_ASSERT_TRUE(rpm[0] == 1.0 && rpm[1] == 2.5 && rpm[2] == -3.0);
    TEST_ASSERT_EQUAL(OPTIONS_END, options_next(&o, &e));
    TEST_ASSERT_EQUAL(6, o.first);
    TEST_ASSERT_EQUAL_STRING("first", argv[o.first]);
    TEST_ASSERT_EQUAL_STRING("second", argv[o.first + 1]);
    TEST_ASSERT_TRUE(options_at_most(&o, 2, &e));
    TEST_ASSERT_FALSE(o.helped);
    TEST_ASSERT_FALSE(options_at_most(&o, 1, &e));
    TEST_ASSERT_EQUAL_STRING("try: unexpected argument \"second\"", e.text);
}

/* A second command line in one process starts from the beginning. */
static void test_parsing_can_be_repeated(void)
{
    for (int i = 0; i < 2; i++) {
        char *argv[] = {"try", "x", "-q", NULL};
        error e = {0};
        options o = options_begin(&about, 3, argv);
        TEST_ASSERT_EQUAL(OPT_QUICK, options_next(&o, &e));
        TEST_ASSERT_EQUAL(OPTIONS_END, options_next(&o, &e));
    }
}

static void expect_refused(const char *a, const char *b, const char *text)
{
    char first[64] = "";
    char second[64] = "";
    strcpy(first, a);
    strcpy(second, b != NULL ? b : "");
    char *argv[] = {"try", first, b != NULL ? second : NULL, NULL};
    error e = {0};
    options o = options_begin(&about, count_arguments(argv), argv);
    TEST_ASSERT_EQUAL_MESSAGE(OPTIONS_ERROR, options_next(&o, &e), a);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_EQUAL_STRING(text, e.text);
}

static void test_what_is_no_option_of_ours(void)
{
    expect_refused("--motr", "m", "try: unknown option --motr; did you mean --motor?");
    expect_refused("--motr=m", NULL, "try: unknown option --motr; did you mean --motor?");
    expect_refused("--nonsense", NULL, "try: unknown option --nonsense; `iqfoc try --help` lists them");
    expect_refused("-x", NULL, "try: unknown option -x; `iqfoc try --help` lists them");
    expect_refused("--motor", NULL, "try: --motor needs a value: M.toml");
    expect_refused("-o", NULL, "try: --output needs a value: F");
    expect_refused("--quick=1", NULL, "try: --quick takes no value");
}

static void expect_value_refused(const char *value, bool integer, const char *text)
{
    char argument[64];
    strcpy(argument, value);
    char *argv[] = {"try", "--seed", argument, NULL};
    error e = {0};
    options o = options_begin(&about, 3, argv);
    TEST_ASSERT_EQUAL(OPT_SEED, options_next(&o, &e));
    long whole = 42;
    double number = 42.0;
    TEST_ASSERT_FALSE_MESSAGE(
        integer ? options_integer(&o, 0, 100, &whole, &e) : options_number(&o, 0.5, 2.0, &number, &e), value);
    TEST_ASSERT_EQUAL_STRING(text, e.text);
    TEST_ASSERT_TRUE(whole == 42 && number == 42.0);
}

static void test_values_out_of_range(void)
{
    expect_value_refused("abc", true, "try: --seed must be a whole number from 0 to 100, not \"abc\"");
    expect_value_refused("1.5", true, "try: --seed must be a whole number from 0 to 100, not \"1.5\"");
    expect_value_refused("101", true, "try: --seed must be a whole number from 0 to 100, not \"101\"");
    expect_value_refused("", true, "try: --seed must be a whole number from 0 to 100, not \"\"");
    expect_value_refused("3", false, "try: --seed must be a number from 0.5 to 2, not \"3\"");
    expect_value_refused("nan", false, "try: --seed must be a number from 0.5 to 2, not \"nan\"");
    expect_value_refused("1,2", false, "try: --seed must be a number from 0.5 to 2, not \"1,2\"");
}

static void test_a_missing_option_is_named(void)
{
    char *argv[] = {"try", NULL};
    error e = {0};
    options o = options_begin(&about, 1, argv);
    TEST_ASSERT_EQUAL(OPTIONS_END, options_next(&o, &e));
    TEST_ASSERT_FALSE(options_missing(&o, "motor", &e));
    TEST_ASSERT_EQUAL_STRING("try: --motor M.toml is missing; see `iqfoc try --help`", e.text);
}

/* Reads a command line into variables of every kind; false with its error text in e. */
static bool read_request(char **argv, error *e)
{
    options o = options_begin(&about, count_arguments(argv), argv);
    return options_read(&o, e) && options_complete(&o, e);
}

static void test_values_go_to_their_places(void)
{
    char *argv[] = {"try", "--motor", "m", "-of", "--rpm", "-2,10", "--seed", "9", "-q", NULL};
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(read_request(argv, &e), e.text);
    TEST_ASSERT_EQUAL_STRING("m", asked.motor);
    TEST_ASSERT_EQUAL_STRING("f", asked.out);
    TEST_ASSERT_EQUAL(2, asked.speeds);
    TEST_ASSERT_TRUE(asked.rpm[0] == -2.0 && asked.rpm[1] == 10.0 && asked.seed == 9 && asked.quick);
}

static void expect_request_refused(const char *option, const char *value, const char *text)
{
    char first[16];
    char second[16];
    strcpy(first, option);
    strcpy(second, value);
    char *argv[] = {"try", first, second, NULL};
    error e = {0};
    TEST_ASSERT_FALSE_MESSAGE(read_request(argv, &e), option);
    TEST_ASSERT_EQUAL_STRING(text, e.text);
}

static void test_a_request_that_is_not_whole(void)
{
    expect_request_refused("-o", "f", "try: --motor M.toml is missing; see `iqfoc try --help`");
    expect_request_refused("-q", "f", "try: unexpected argument \"f\"");
    expect_request_refused("--seed", "0", "try: --seed must be a whole number from 1 to 9, not \"0\"");
    expect_request_refused(
        "--rpm", "1,2,3",
        "try: --rpm must be 1 to 2 numbers from -10 to 10, separated by commas, not \"1,2,3\"");
}

static void test_an_equals_sign_after_a_letter(void)
{
    char *argv[] = {"try", "--motor", "m", "-o=f", "-q", NULL};
    char *apart[] = {"try", "--motor", "m", "-o", "=f", NULL};
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(read_request(argv, &e), e.text);
    TEST_ASSERT_EQUAL_STRING("f", asked.out);
    TEST_ASSERT_TRUE_MESSAGE(read_request(apart, &e), e.text);
    TEST_ASSERT_EQUAL_STRING("=f", asked.out);
}

static void test_a_repeatable_option(void)
{
    char *argv[OPTION_TEXTS_MAX + 3] = {"try"};
    for (int n = 1; n <= OPTION_TEXTS_MAX + 1; n++) {
        argv[n] = n % 2 == 1 ? "-na" : "-nb";
    }
    error e = {0};
    options o = options_begin(&about, OPTION_TEXTS_MAX + 1, argv);
    TEST_ASSERT_TRUE_MESSAGE(options_read(&o, &e), e.text);
    TEST_ASSERT_EQUAL(OPTION_TEXTS_MAX, asked.notes.count);
    TEST_ASSERT_EQUAL_STRING("a", asked.notes.of[0]);
    TEST_ASSERT_EQUAL_STRING("b", asked.notes.of[OPTION_TEXTS_MAX - 1]);
    asked.notes.count = 0;
    o = options_begin(&about, OPTION_TEXTS_MAX + 2, argv);
    TEST_ASSERT_FALSE(options_read(&o, &e));
    TEST_ASSERT_EQUAL_STRING("try: --note is given more than 32 times", e.text);
}

static void test_one_recording(void)
{
    char *argv[] = {"try", "a.csv", "b.csv", NULL};
    error e = {0};
    options o = options_begin(&about, 1, argv);
    TEST_ASSERT_TRUE(options_read(&o, &e));
    TEST_ASSERT_FALSE(options_recording(&o, &e));
    TEST_ASSERT_EQUAL_STRING("try: no recording is given. Usage: iqfoc try [options]", e.text);
    o = options_begin(&about, 2, argv);
    TEST_ASSERT_TRUE(options_read(&o, &e) && options_recording(&o, &e));
    TEST_ASSERT_EQUAL_STRING("a.csv", argv[o.first]);
    e = (error){0};
    o = options_begin(&about, 3, argv);
    TEST_ASSERT_TRUE(options_read(&o, &e));
    TEST_ASSERT_FALSE(options_recording(&o, &e));
    TEST_ASSERT_EQUAL_STRING("try: unexpected argument \"b.csv\"", e.text);
}

static void test_suggestions(void)
{
    const char *const known[] = {"psi_f_Wb", "R_ohm", "L_d_H", "L_q_H"};
    TEST_ASSERT_EQUAL_STRING("psi_f_Wb", suggest("psi_f_wb", known, 4));
    TEST_ASSERT_EQUAL_STRING("R_ohm", suggest("R_omh", known, 4));
    TEST_ASSERT_EQUAL_STRING("L_d_H", suggest("Ld_H", known, 4));
    TEST_ASSERT_NULL(suggest("inertia", known, 4));
    TEST_ASSERT_NULL(suggest("psi", known, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_form_of_an_option);
    RUN_TEST(test_parsing_can_be_repeated);
    RUN_TEST(test_what_is_no_option_of_ours);
    RUN_TEST(test_values_out_of_range);
    RUN_TEST(test_a_missing_option_is_named);
    RUN_TEST(test_values_go_to_their_places);
    RUN_TEST(test_a_request_that_is_not_whole);
    RUN_TEST(test_an_equals_sign_after_a_letter);
    RUN_TEST(test_a_repeatable_option);
    RUN_TEST(test_one_recording);
    RUN_TEST(test_suggestions);
    return UNITY_END();
}
