/*
 * Which error decides how probable the catalogue is (session_borne_out in sim_host/diagnose/session.h). The errors are made by
 * hand: the program is linked so that the measures return them.
 */
#include "diagnose/measure/errors.h"
#include "diagnose/measure/runs.h"
#include "diagnose/session.h"
#include "diagnose/weigh/borne_out.h"
#include "wrapped_floor.h"

#include "unity.h"

#include <math.h>

/* Percent of the current: of the motor file's model, and of the extended one. */
typedef struct percents {
    double nominal, extended;
} percents;

static percents one_cycle, open_loop;
static session w;

double __wrap_measure_open_loop(const diagnose_rows *r, const averaged_drive *drive,
                                double run[ROWS_MAX_GROUPS]);
double __wrap_measure_current(const diagnose_rows *r, size_t group, bool held_out_only);
double __wrap_measure_without_glitches(const diagnose_rows *r, const averaged_drive *drive);

double __wrap_measure_open_loop(const diagnose_rows *r, const averaged_drive *drive,
                                double run[ROWS_MAX_GROUPS])
{
    (void)r;
    TEST_ASSERT_NULL(run);
    return drive->R_ohm == 1.0 ? open_loop.nominal : open_loop.extended;
}

double __wrap_measure_without_glitches(const diagnose_rows *r, const averaged_drive *drive)
{
    (void)r;
    return drive->R_ohm == 1.0 ? one_cycle.nominal : one_cycle.extended;
}

double __wrap_measure_current(const diagnose_rows *r, size_t group, bool held_out_only)
{
    (void)r;
    TEST_ASSERT_TRUE(group == MEASURE_ALL && held_out_only);
    return 10.0;
}

void setUp(void)
{
    one_cycle = open_loop = (percents){.nominal = 5.0, .extended = 1.25};
    floor_A = 0.1; /* 1 % of 10 A */
    left_by_angle = 0.0;
    w = (session){.state = {.set = HYPOTHESIS_BIT(H_RESISTANCE)}};
    w.frame.nominal = (averaged_drive){.R_ohm = 1.0, .psi_f_Wb = 1.0, .i_knee_A = 1.0, .fe_tau_s = 1.0};
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        w.frame.scale[k] = 1.0;
    }
    w.state.z[P_R] = 0.5;
}

void tearDown(void)
{
}

#define LEFT(share)                                                                                          \
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, borne_out_probability(share), session_borne_out(&w, &w.rows))

/* Of the motor file's 25, 1.5625 are noise. */
static double share_of(double extended)
{
    return (extended * extended - 1.5625) / (25.0 - 1.5625);
}

static void the_error_that_is_explained_better_counts(void)
{
    LEFT(0.0);
    one_cycle.extended = 3.0;
    LEFT(0.0);
    open_loop.extended = 2.0;
    LEFT(share_of(2.0));
    one_cycle.extended = 1.5;
    LEFT(share_of(1.5));
}

static void an_error_of_the_noise_does_not_count(void)
{
    one_cycle.nominal = 1.2;
    open_loop.extended = 2.0;
    LEFT(share_of(2.0));
    open_loop.nominal = 1.2;
    LEFT(NAN);
    one_cycle.nominal = 5.0;
    one_cycle.extended = 2.0;
    LEFT(share_of(2.0));
    open_loop = (percents){.nominal = NAN, .extended = NAN};
    LEFT(share_of(2.0));
    open_loop.extended = 5.0;
    LEFT(share_of(2.0));
}

static void an_open_loop_error_that_rises_counts(void)
{
    open_loop.extended = 4.9;
    LEFT(0.0);
    open_loop.extended = 5.1;
    LEFT(share_of(5.1));
    open_loop.extended = NAN; /* the extended model alone diverges */
    LEFT(INFINITY);
    /* Not with an over-compensated dead time: noise decides the sign of a current near zero. */
    w.state.set |= HYPOTHESIS_BIT(H_COMPENSATED);
    w.state.z[P_V_DEAD] = -1.0;
    w.state.z[P_COMPENSATION] = 1.0;
    LEFT(0.0);
}

/* If it is more than both errors leave; of a set without a name only after corrections of rows. */
static void what_is_left_by_the_angle_counts(void)
{
    left_by_angle = 0.2;
    LEFT(0.2);
    one_cycle.extended = open_loop.extended = 4.0;
    LEFT(share_of(4.0));
    one_cycle.extended = open_loop.extended = 1.25;
    const diagnose_rows recorded = w.rows;
    left_by_angle = 2.0;
    w.state.set = HYPOTHESIS_BIT(H_SENSOR_ZONE);
    LEFT(1.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, borne_out_probability(2.0), session_borne_out(&w, &recorded));
    w.state.set = HYPOTHESIS_BIT(H_RESISTANCE);
    one_cycle.nominal = open_loop.nominal = 1.2;
    LEFT(NAN);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_error_that_is_explained_better_counts);
    RUN_TEST(an_error_of_the_noise_does_not_count);
    RUN_TEST(an_open_loop_error_that_rises_counts);
    RUN_TEST(what_is_left_by_the_angle_counts);
    return UNITY_END();
}
