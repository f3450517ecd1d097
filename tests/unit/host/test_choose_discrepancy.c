/*
 * What the named effects leave by the electrical angle (sim_host/diagnose/weigh/discrepancy.h), on innovations made by hand: white noise
 * of unit variance, and vectors that turn with the angle. The program is linked so that an observer returns them.
 */
#include "diagnose/weigh/discrepancy.h"

#include "unity.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROWS = 1500, POINTS = 2, BLOCKS = 6, ALL = BLOCKS * ROWS };

static cycle_row row[ALL];
static row_block block[BLOCKS];
static size_t chosen[BLOCKS];
static diagnose_rows rows;
static coordinate_frame frame;
static fit_data data;
static fit_state state;
/* The extended drive leaves a vector of that order; the motor file's model an offset of that length in addition. */
static int order;
static double left, explained;
static uint32_t drawn, seed;

void __wrap_observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                           const row_block *b, double gain, double gate, double *innovation, double *seen);
averaged_node *__wrap_rows_nodes(const diagnose_rows *r, const averaged_drive *drive);

/* Uniform, of unit variance: a hash of how many were drawn. */
static double noise(void)
{
    uint32_t x = ++drawn * UINT32_C(0x9e3779b9);
    x = (x ^ (x >> 16)) * UINT32_C(0x85ebca6b);
    x = (x ^ (x >> 13)) * UINT32_C(0xc2b2ae35);
    return sqrt(12.0) * ((double)(x ^ (x >> 16)) / 4294967296.0 - 0.5);
}

/* Both drives see the same noise. */
void __wrap_observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                           const row_block *b, double gain, double gate, double *innovation, double *seen)
{
    (void)nodes;
    (void)gain;
    (void)gate;
    (void)seen;
    const double offset = drive->R_ohm == 1.0 ? explained : 0.0;
    drawn = 2 * (uint32_t)b->first + 2 * ALL * seed;
    for (size_t j = 0; j < b->count; j++) {
        const double at = order * atan2(r->row[b->first + j].sin_theta, r->row[b->first + j].cos_theta);
        innovation[3 * j] = noise() + left * cos(at) + offset;
        innovation[3 * j + 1] = noise() + left * sin(at);
        innovation[3 * j + 2] = 0.0;
    }
}

averaged_node *__wrap_rows_nodes(const diagnose_rows *r, const averaged_drive *drive)
{
    (void)r;
    (void)drive;
    return calloc(1, sizeof(averaged_node));
}

void setUp(void)
{
    for (size_t k = 0; k < ALL; k++) {
        row[k].cos_theta = cos(0.0737 * (double)k);
        row[k].sin_theta = sin(0.0737 * (double)k);
    }
    for (size_t b = 0; b < BLOCKS; b++) {
        block[b] = (row_block){.first = b * ROWS, .count = ROWS, .group = b % POINTS};
        chosen[b] = b;
    }
    rows = (diagnose_rows){.rows = ALL, .row = row, .blocks = BLOCKS, .block = block, .groups = POINTS};
    frame.nominal = (averaged_drive){.R_ohm = 1.0};
    data = (fit_data){.rows = &rows, .frame = &frame, .block = chosen, .blocks = BLOCKS, .longest = ROWS};
    for (size_t g = 0; g < POINTS; g++) {
        state.noise[g] = (group_noise){.gain = 0.3, .white = {1.0, 0.0, 1.0}};
    }
    order = 3;
    left = 0.0;
    explained = 0.5;
}

void tearDown(void)
{
}

static double share(void)
{
    const averaged_drive drive = {.R_ohm = 2.0};
    return discrepancy_share(&data, &state, &drive, &rows);
}

static void white_noise_leaves_nothing(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, share());
}

/* Of 9000 rows, less what noise may do: two standard deviations of chi square with 100 numbers. */
static void a_vector_that_turns_is_left_in_proportion(void)
{
    static const int orders[] = {-12, -5, 0, 3, 12};
    for (size_t k = 0; k < sizeof orders / sizeof *orders; k++) {
        order = orders[k];
        for (left = 0.2; left < 0.9; left += 0.3) {
            const double offset =
                ALL * explained * explained + (order == 0 ? 2.0 * ALL * left * explained : 0.0);
            const double wanted = (ALL * left * left - 2.0 * sqrt(200.0)) / offset;
            /* Three standard deviations: the product of a vector with white noise moves both squares. */
            const double by_noise = 3.0 * (2.0 * left * sqrt(ALL) + sqrt(200.0)) / offset;
            TEST_ASSERT_DOUBLE_WITHIN(by_noise + 0.1 * wanted, wanted, share());
        }
    }
}

/* Worth 40 in chi square. The noise of all orders may be worth 28, so that of 40 they leave 12, and that of -3 to 3 is worth 15. */
static void a_small_vector_of_a_low_order_is_seen(void)
{
    enum { DRAWS = 30 };
    left = sqrt(40.0 / ALL);
    for (order = -3; order <= 3; order++) {
        double sum = 0.0;
        for (seed = 0; seed < DRAWS && order != 0; seed++) {
            sum += ALL * explained * explained * share();
        }
        printf("  order %d: %.1f\n", order, sum / DRAWS);
        TEST_ASSERT_TRUE(order == 0 || sum > 20.0 * DRAWS);
    }
    seed = 0;
}

static void an_order_beyond_the_last_is_not_seen(void)
{
    order = 13;
    left = 0.5;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, share());
}

static void a_drive_that_explains_nothing_has_no_share(void)
{
    left = 0.5;
    explained = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, share());
}

/* At standstill all orders are one: they take what is constant, once. */
static void a_rotor_at_standstill_is_one_vector(void)
{
    for (size_t k = 0; k < ALL; k++) {
        row[k].cos_theta = 1.0;
        row[k].sin_theta = 0.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, share());
    left = 0.5;
    const double wanted = 0.25 / (0.25 + 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, wanted, share());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(white_noise_leaves_nothing);
    RUN_TEST(a_vector_that_turns_is_left_in_proportion);
    RUN_TEST(a_small_vector_of_a_low_order_is_seen);
    RUN_TEST(an_order_beyond_the_last_is_not_seen);
    RUN_TEST(a_drive_that_explains_nothing_has_no_share);
    RUN_TEST(a_rotor_at_standstill_is_one_vector);
    return UNITY_END();
}
