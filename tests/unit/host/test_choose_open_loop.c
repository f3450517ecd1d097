/*
 * When causes raise the open-loop error of an operating point (session_raises_open_loop in sim_host/diagnose/choose/session.h). The
 * errors are made by hand: the program is linked so that the measures return them.
 */
#include "diagnose/choose/session.h"
#include "diagnose/measure/errors.h"
#include "diagnose/measure/runs.h"
#include "wrapped_floor.h"

#include "unity.h"

#include <math.h>

enum { POINTS = 2 };

/* Percent of each operating point's current, of the motor file's model and of the extended one. */
static double nominal[POINTS], extended[POINTS];
static double current[POINTS];

double __wrap_measure_open_loop(const diagnose_rows *r, const averaged_drive *drive,
                                double run[ROWS_MAX_GROUPS]);
double __wrap_measure_current(const diagnose_rows *r, size_t group, bool held_out_only);

double __wrap_measure_open_loop(const diagnose_rows *r, const averaged_drive *drive,
                                double run[ROWS_MAX_GROUPS])
{
    (void)r;
    const double *from = drive->R_ohm == 1.0 ? nominal : extended;
    for (size_t g = 0; g < POINTS; g++) {
        run[g] = from[g];
    }
    return run[0] + run[1];
}

double __wrap_measure_current(const diagnose_rows *r, size_t group, bool held_out_only)
{
    (void)r;
    (void)held_out_only;
    return group == MEASURE_ALL ? 10.0 : current[group];
}

void setUp(void)
{
    nominal[0] = nominal[1] = 5.0;
    extended[0] = extended[1] = 1.0;
    current[0] = current[1] = 10.0;
    floor_A = 0.1; /* 1 % of 10 A */
}

void tearDown(void)
{
}

static bool raises(void)
{
    static session w;
    w = (session){.state = {.set = HYPOTHESIS_BIT(H_RESISTANCE)}, .rows = {.groups = POINTS}};
    w.frame.nominal = (averaged_drive){.R_ohm = 1.0, .psi_f_Wb = 1.0, .i_knee_A = 1.0, .fe_tau_s = 1.0};
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        w.frame.scale[k] = 1.0;
    }
    w.state.z[P_R] = 0.5;
    return session_raises_open_loop(&w);
}

static void an_error_that_falls_everywhere_raises_nothing(void)
{
    TEST_ASSERT_FALSE(raises());
}

/* A tenth and the noise floor are allowed, whatever the other point gains. */
static void one_point_is_enough(void)
{
    extended[1] = 6.4;
    TEST_ASSERT_FALSE(raises());
    extended[1] = 6.6;
    TEST_ASSERT_TRUE(raises());
    extended[1] = 1.0;
    extended[0] = 6.6;
    TEST_ASSERT_TRUE(raises());
}

/* The floor is in percent of the point's own current. */
static void less_current_allows_more(void)
{
    extended[1] = 7.4;
    TEST_ASSERT_TRUE(raises());
    current[1] = 5.0;
    TEST_ASSERT_FALSE(raises());
    extended[1] = 7.6;
    TEST_ASSERT_TRUE(raises());
}

static void a_simulation_that_diverges_does_not_count(void)
{
    extended[1] = 1e5;
    TEST_ASSERT_FALSE(raises());
    extended[1] = NAN;
    TEST_ASSERT_FALSE(raises());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_error_that_falls_everywhere_raises_nothing);
    RUN_TEST(one_point_is_enough);
    RUN_TEST(less_current_allows_more);
    RUN_TEST(a_simulation_that_diverges_does_not_count);
    return UNITY_END();
}
