/* Memory that runs out within a measure is noted in rows.no_memory: its result is then not used. */
#include "diagnose/identify/fit.h"
#include "diagnose/measure/errors.h"
#include "diagnose/measure/floor.h"
#include "diagnose/measure/glitches.h"
#include "diagnose/measure/lines.h"
#include "diagnose_bench.h"

#include <limits.h>
#include <stdlib.h>
#include <unity.h>

/* The allocation that fails, counted from 0; LONG_MAX: none. */
static long failing = LONG_MAX;
static long allocations;

void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);

void *__wrap_calloc(size_t count, size_t size)
{
    return allocations++ == failing ? NULL : __real_calloc(count, size);
}

static recording made;
static motor file;
static diagnose_rows rows;
static fit_data data;
static fit_state state;
static coordinate_frame frame;
static bool no_memory;

void setUp(void)
{
    error e = {0};
    const bench b = {.m = bench_motor(), .noise_A = 0.017, .seed = 20261124};
    file = b.m;
    made = bench_record(&b);
    rows = (diagnose_rows){0};
    data = (fit_data){0};
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, &made, &file, &e), e.text);
    frame = coordinates_of(&file, &rows);
    TEST_ASSERT_TRUE_MESSAGE(fit_data_make(&data, &rows, &frame, 100000, &e), e.text);
    TEST_ASSERT_TRUE(fit_of_nominal(&data, &state));
    rows.no_memory = &no_memory;
}

void tearDown(void)
{
    fit_data_free(&data);
    rows_free(&rows);
    recording_free(&made);
}

/* What a measure gave: 0 where it is all in the flag. */
typedef bool measure(void);

static bool one_cycle(void)
{
    return measure_one_cycle(&rows, &frame.nominal, MEASURE_ALL, true) > 0.0;
}

static bool floor_by_errors(void)
{
    /* A filter that does not trust the model: then the errors are asked. */
    for (size_t g = 0; g < rows.groups; g++) {
        state.noise[g].gain = 0.9;
    }
    double noise_A = 0.0;
    return measure_floor(&rows, &state, &frame.nominal, &noise_A) > 0.0;
}

static bool glitches(void)
{
    (void)measure_glitches(&data, &state);
    return true;
}

static bool lines(void)
{
    diagnosis_structure found;
    return measure_lines(&data, &state, 1.0, &found);
}

/* With each of its allocations failed in turn the measure fails or notes it; with none it does neither. */
static void every_failure_is_noted(measure *of)
{
    failing = LONG_MAX;
    allocations = 0;
    no_memory = false;
    TEST_ASSERT_TRUE(of());
    TEST_ASSERT_FALSE(no_memory);
    const long all = allocations;
    TEST_ASSERT_GREATER_THAN(0, all);
    for (long n = 0; n < all; n++) {
        failing = n;
        allocations = 0;
        no_memory = false;
        const bool held = of();
        TEST_ASSERT_TRUE(!held || no_memory);
    }
    failing = LONG_MAX;
}

static void one_cycle_notes_it(void)
{
    every_failure_is_noted(one_cycle);
}

static void floor_notes_it(void)
{
    every_failure_is_noted(floor_by_errors);
}

static void glitches_note_it(void)
{
    every_failure_is_noted(glitches);
}

static void lines_note_it(void)
{
    every_failure_is_noted(lines);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_cycle_notes_it);
    RUN_TEST(floor_notes_it);
    RUN_TEST(glitches_note_it);
    RUN_TEST(lines_note_it);
    return UNITY_END();
}
