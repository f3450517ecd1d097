/*
 * The checklist of docs/porting.md for the STM32G474's port.
 */
#include "port_check.h"
#include "rig_stm32g4.h"

#include "unity.h"

static const port_rig *rig;

void setUp(void)
{
    rig = rig_stm32g4_start();
}

void tearDown(void)
{
}

static void test_current_scaling_signs_and_order(void)
{
    port_check_current_scaling_signs_and_order(rig);
}

static void test_dc_link(void)
{
    port_check_dc_link(rig);
}

static void test_angle_and_speed(void)
{
    port_check_angle_and_speed(rig);
}

static void test_sampling_instant(void)
{
    port_check_sampling_instant(rig);
}

static void test_update_instant(void)
{
    port_check_update_instant(rig);
}

static void test_duties_and_order(void)
{
    port_check_duties_and_order(rig);
}

static void test_gates(void)
{
    port_check_gates(rig);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_current_scaling_signs_and_order);
    RUN_TEST(test_dc_link);
    RUN_TEST(test_angle_and_speed);
    RUN_TEST(test_sampling_instant);
    RUN_TEST(test_update_instant);
    RUN_TEST(test_duties_and_order);
    RUN_TEST(test_gates);
    return UNITY_END();
}
