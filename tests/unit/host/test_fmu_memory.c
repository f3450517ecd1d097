/*
 * An FMU whose files are read while memory runs out: an error, and the simulator's process goes on (sim_host/fmu/fmu_setup.h).
 * Each allocation of the TOML reader fails once, by the linker's wrap of operator new.
 */
#include "fmu/fmu_setup.h"
#include "host_files.h"

#include "unity.h"

#include <stdint.h>
#include <string.h>

static long allocated, failing;

void *__real__Znwm(size_t size);
void *__wrap__Znwm(size_t size);

/* Throws, as the library's own does, for a size that there cannot be. */
void *__wrap__Znwm(size_t size)
{
    allocated++;
    return __real__Znwm(allocated == failing ? SIZE_MAX / 2 : size);
}

void setUp(void)
{
}

void tearDown(void)
{
}

static const char motor_text[] =
    "name = \"Compressor\"\n[motor]\npole_pairs = 3\nR_ohm = 0.9\nL_d_H = 0.008\nL_q_H = 0.011\npsi_f_Wb = "
    "0.2\n"
    "I_rated_A_rms = 6\nn_max_rpm = 6000\n[inverter]\nf_pwm_Hz = 4000\nu_dc_V = 565\n";
static const char setup_text[] = "kind = \"drive\"\nseed = 1\nscenario = false\ntoken = \"t\"\n";

static bool read_with(long fails, error *e)
{
    fmu_setup s;
    memset(e, 0, sizeof *e);
    allocated = 0;
    failing = fails;
    const bool ok = fmu_setup_read(&s, scratch_path(""), e);
    if (ok) {
        fmu_setup_free(&s);
    }
    return ok;
}

static void each_allocation_that_fails_is_an_error(void)
{
    error e;
    (void)scratch_text("motor.toml", motor_text);
    (void)scratch_text("setup.toml", setup_text);
    TEST_ASSERT_TRUE_MESSAGE(read_with(0, &e), e.text);
    const long all = allocated;
    TEST_ASSERT_TRUE(all > 20);
    for (long n = 1; n <= all; n++) {
        /* toml++'s reader of numbers takes a lack of memory for a wrong number. */
        TEST_ASSERT_FALSE(read_with(n, &e));
        TEST_ASSERT_TRUE_MESSAGE(
            strstr(e.text, "out of memory") != NULL || strstr(e.text, "not TOML") != NULL, e.text);
    }
    printf("  %ld allocations, each an error\n", all);
    TEST_ASSERT_TRUE_MESSAGE(read_with(0, &e), e.text);
}

int main(void)
{
    UNITY_BEGIN();
    (void)scratch_begin();
    RUN_TEST(each_allocation_that_fails_is_an_error);
    scratch_end();
    return UNITY_END();
}
