/*
 * The checklist of docs/porting.md for the port to the F28004x and F2837xD, and mistakes that are planted in
 * its registers: each must fail at its line and at none before.
 */
#include "fake_c2000_bank.h"
#include "port_check.h"
#include "rig_c2000.h"

#include "unity.h"

#include <string.h>

/* port_check.c calls this one in place of the port's (tests/target/CMakeLists.txt). */
void planted_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample);
void planted_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    iqfoc_hal_read_valley(hal, sample);
}

void setUp(void)
{
    static const fake_plant_t none = {0};
    fake_plant = none;
    rig_c2000_plant = NULL;
    rig_c2000_chip = &fake_f28004x;
}

void tearDown(void)
{
}

static void test_every_line(void)
{
    const c2000_chip_t *const chips[3] = {&fake_f28004x, &fake_f2837xd, &fake_f2837xd_100_mhz};
    for (int family = 0; family < 3; family++) {
        rig_c2000_chip = chips[family];
        for (int k = 0; k < PORT_CHECK_ITEMS; k++) {
            const char *what = port_check_items[k].run(rig_c2000_start);
            TEST_ASSERT_NULL_MESSAGE(what, what);
            TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, fake_lost(), "a write to a protected register is lost");
            TEST_ASSERT_FALSE_MESSAGE(fake_is_open(), "registers are left unprotected");
        }
        TEST_ASSERT_EQUAL_INT(0, port_check_all(rig_c2000_start, stdout));
    }
}

/* The items of the checklist. */
enum { CURRENTS, DC_LINK, ANGLE, INSTANT, UPDATE, DUTIES, GATES };

/* What set-up would have written by mistake. leg 3: all of them. */
typedef struct mistake {
    const char *name;
    int item;
    int leg;
    uint32_t offset;
    uint16_t value;
} mistake_t;

static const mistake_t mistakes[] = {
    {"action qualifier: clear up, set down", UPDATE, 3, EPWM_AQCTLA, 0x0090},
    {"action qualifier: set up, never clear", DUTIES, 1, EPWM_AQCTLA, 0x0020},
    {"compare acts at once", UPDATE, 0, EPWM_CMPCTL, 0x0010},
    {"compare loads at the period", UPDATE, 0, EPWM_GLDCTL, 0x0023},
    {"compare loads at zero and at period", UPDATE, 0, EPWM_GLDCTL, 0x0025},
    {"module B is not linked to A", DUTIES, 1, EPWM_XLINK + 1, 0x1001},
    {"module C is not linked to A", DUTIES, 2, EPWM_XLINK + 1, 0x2002},
    {"dead band: active low", UPDATE, 3, EPWM_DBCTL, 0x0007},
    {"dead band: low side not inverted", UPDATE, 3, EPWM_DBCTL, 0x0003},
    {"dead band: not used", UPDATE, 3, EPWM_DBCTL, 0x0000},
    {"trip makes the outputs high", GATES, 3, EPWM_TZCTL, 0x0005},
    {"trip leaves the low sides", GATES, 2, EPWM_TZCTL, 0x000E},
    {"clock of the time base divided", CURRENTS, 1, EPWM_TBCTL, 0x808A},
    {"counts up only", CURRENTS, 0, EPWM_TBCTL, 0x8008},
    {"another period", CURRENTS, 2, EPWM_TBPRD, 999},
    {"no conversion at the valley", CURRENTS, 0, EPWM_ETSEL, 0xA000},
    {"no conversion at the peak", CURRENTS, 0, EPWM_ETSEL, 0x0900},
    {"every third event converts", CURRENTS, 0, EPWM_ETPS, 0x3300},
};

static const mistake_t *planted;

static void plant_in_epwm(void)
{
    for (int leg = 0; leg < 3; leg++) {
        if (planted->leg == leg || planted->leg == 3) {
            fake_bank.epwm[leg][planted->offset] = planted->value;
        }
    }
}

/* Fails at `item` and at none before. */
static void expect_at(int item, const char *name)
{
    for (int k = 0; k <= item; k++) {
        const char *what = port_check_items[k].run(rig_c2000_start);
        if (k < item) {
            TEST_ASSERT_NULL_MESSAGE(what, name);
        } else {
            TEST_ASSERT_NOT_NULL_MESSAGE(what, name);
            TEST_ASSERT_TRUE(strlen(what) > 10);
        }
    }
}

static void test_mistakes_in_the_epwm(void)
{
    rig_c2000_plant = plant_in_epwm;
    for (uint32_t k = 0; k < sizeof mistakes / sizeof mistakes[0]; k++) {
        planted = &mistakes[k];
        expect_at(planted->item, planted->name);
    }
}

static void other_channel(void)
{
    fake_bank.adc[1][ADC_SOCCTL(0)] = 0x0009;
    fake_bank.adc[1][ADC_SOCCTL(0) + 1] = 0x0051; /* channel 2, not 3 */
}

static void link_from_the_valley_alone(void)
{
    fake_bank.adc[0][ADC_SOCCTL(1) + 1] = 0; /* no trigger */
}

static void converter_off(void)
{
    fake_bank.adc[1][ADC_CTL1] = CTL1_INT_AT_END;
}

static void peak_by_the_valley(void)
{
    fake_bank.adc[0][ADC_SOCCTL(2) + 1] = 0; /* no trigger for the peak's current */
}

static void encoder_never_wraps(void)
{
    fake_bank.eqep[EQEP_QEPCTL] = 0x8008;
}

static void encoder_counts_another_turn(void)
{
    fake_bank.eqep[EQEP_QPOSMAX] = 4000;
}

static void timer_stands(void)
{
    fake_bank.timer[TIMER_TCR] = TCR_STOP;
}

static void test_mistakes_elsewhere(void)
{
    static const struct {
        const char *name;
        int item;
        void (*plant)(void);
    } cases[] = {
        {"another channel", CURRENTS, other_channel},
        {"the DC link is not converted", DC_LINK, link_from_the_valley_alone},
        {"a converter is off", CURRENTS, converter_off},
        {"no conversion at the peak", CURRENTS, peak_by_the_valley},
        {"the encoder does not wrap", ANGLE, encoder_never_wraps},
        {"the encoder has another number of lines", ANGLE, encoder_counts_another_turn},
        {"the timer is stopped", INSTANT, timer_stands},
    };
    for (uint32_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        rig_c2000_plant = cases[k].plant;
        expect_at(cases[k].item, cases[k].name);
    }
}

static void test_protection_is_noticed(void)
{
    fake_plant.never_unprotects = true;
    expect_at(CURRENTS, "protected registers");
    TEST_ASSERT_TRUE(fake_lost() > 0);
}

/* The core's clock in place of the time base's. */
static void test_other_ratio_of_clocks(void)
{
    c2000_family_t family = *fake_f2837xd.family;
    c2000_chip_t chip = fake_f2837xd;
    family.clocks_per_tick = 1;
    chip.family = &family;
    rig_c2000_chip = &fake_f2837xd;
    rig_c2000_hal_chip = &chip;
    expect_at(INSTANT, "ratio of the clocks");
    rig_c2000_hal_chip = NULL;
}

/* The erratum: one write of a trip is missed. */
static void test_a_missed_trip_is_repeated(void)
{
    const iqfoc_command_t on = {{{IQ24_ONE / 2, IQ24_ONE / 2, IQ24_ONE / 2}, IQ24_ONE}, true};
    iqfoc_command_t off = on;
    const port_rig *rig = rig_c2000_start();
    off.gates = false;
    fake_plant.trips_missed = 2;
    iqfoc_hal_write(rig->hal, &on);
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_EQUAL_HEX16(0, fake_bank.epwm[leg][EPWM_TZFLG] & TZ_OST);
    }
    fake_plant.trips_missed = 2;
    iqfoc_hal_write(rig->hal, &off);
    TEST_ASSERT_FALSE(rig->outputs_on());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_line);
    RUN_TEST(test_mistakes_in_the_epwm);
    RUN_TEST(test_mistakes_elsewhere);
    RUN_TEST(test_protection_is_noticed);
    RUN_TEST(test_other_ratio_of_clocks);
    RUN_TEST(test_a_missed_trip_is_repeated);
    return UNITY_END();
}
