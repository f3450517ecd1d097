/*
 * The checklist of docs/porting.md for the STM32G474's port, and the checklist itself: mistakes that are planted
 * behind it must fail at their line and nowhere before.
 */
#include "port_check.h"
#include "rig_stm32g4.h"

#include "unity.h"

#include <string.h>

static port_rig planted;

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_every_line(void)
{
    for (int k = 0; k < PORT_CHECK_ITEMS; k++) {
        const char *what = port_check_items[k].run(rig_stm32g4_start);
        TEST_ASSERT_NULL_MESSAGE(what, what);
    }
    TEST_ASSERT_EQUAL_INT(0, port_check_all(rig_stm32g4_start, stdout));
}

/* A rig that shows the port's doing otherwise than it is, as a mistake in the port would. */
static void exchanged_currents(const double i_pu[3])
{
    const double other[3] = {i_pu[1], i_pu[0], i_pu[2]};
    rig_stm32g4()->set_current(other);
}

static void other_way(double turns)
{
    rig_stm32g4()->set_angle(-turns);
}

static void other_link(double u_pu)
{
    rig_stm32g4()->set_dc_link(1.1 * u_pu);
}

static bool exchanged_legs(int leg)
{
    return rig_stm32g4()->leg_high(leg == 0 ? 1 : leg == 1 ? 0 : 2);
}

static bool inverted_leg(int leg)
{
    return !rig_stm32g4()->leg_high(leg);
}

static bool always_on(void)
{
    return true;
}

static uint32_t other_period(void)
{
    return rig_stm32g4()->period_ticks() / 2;
}

static int plant; /* which mistake */

static const port_rig *start(void)
{
    planted = *rig_stm32g4_start();
    planted.set_current = plant == 0 ? exchanged_currents : planted.set_current;
    planted.set_dc_link = plant == 1 ? other_link : planted.set_dc_link;
    planted.set_angle = plant == 2 ? other_way : planted.set_angle;
    planted.period_ticks = plant == 3 ? other_period : planted.period_ticks;
    planted.leg_high = plant == 4 ? inverted_leg : plant == 5 ? exchanged_legs : planted.leg_high;
    planted.outputs_on = plant == 6 ? always_on : planted.outputs_on;
    return &planted;
}

static void test_planted_mistakes_fail(void)
{
    for (plant = 0; plant < PORT_CHECK_ITEMS; plant++) {
        for (int k = 0; k <= plant; k++) {
            const char *what = port_check_items[k].run(start);
            if (k == plant) {
                TEST_ASSERT_NOT_NULL_MESSAGE(what, port_check_items[k].name);
                TEST_ASSERT_TRUE(strlen(what) > 10);
            } else if (plant != 5 || k < 4) {
                TEST_ASSERT_NULL_MESSAGE(what, what);
            }
        }
        TEST_ASSERT_TRUE(port_check_all(start, stdout) > 0);
    }
}

/* ---- Two phases exchanged, by name; a mean that is not there ---- */

static int stays; /* the phase that is right */

static int other_phase(int x)
{
    return x == stays ? x : 3 - stays - x;
}

static bool exchanged_pair_of_legs(int leg)
{
    return rig_stm32g4()->leg_high(other_phase(leg));
}

static void exchanged_pair_of_currents(const double i_pu[3])
{
    const double other[3] = {i_pu[other_phase(0)], i_pu[other_phase(1)], i_pu[other_phase(2)]};
    rig_stm32g4()->set_current(other);
}

static const port_rig *start_exchanged(void)
{
    planted = *rig_stm32g4_start();
    planted.set_current = exchanged_pair_of_currents;
    planted.leg_high = exchanged_pair_of_legs;
    return &planted;
}

static void test_exchanged_phases_are_named(void)
{
    static const char *const names[3] = {"B and C", "C and A", "A and B"};
    for (stays = 0; stays < 3; stays++) {
        TEST_ASSERT_NOT_NULL(strstr(port_check_items[0].run(start_exchanged), names[stays]));
        TEST_ASSERT_NOT_NULL(strstr(port_check_items[5].run(start_exchanged), names[stays]));
    }
}

static bool says_mean;

/* port_check.c calls this one in place of the port's. */
void planted_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample);
void planted_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    iqfoc_hal_read_valley(hal, sample);
    sample->has_mean = sample->has_mean || says_mean;
}

static void test_mean_that_is_not_there(void)
{
    says_mean = true;
    const char *what = port_check_items[0].run(rig_stm32g4_start);
    says_mean = false;
    TEST_ASSERT_NOT_NULL(what);
    TEST_ASSERT_NOT_NULL(strstr(what, "has_mean is true"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_line);
    RUN_TEST(test_planted_mistakes_fail);
    RUN_TEST(test_exchanged_phases_are_named);
    RUN_TEST(test_mean_that_is_not_there);
    return UNITY_END();
}
