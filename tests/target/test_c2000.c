/*
 * The port to the F28004x and F2837xD on the host: every bit that the timing needs, the order in which it is
 * set, and the trips.
 *
 * What this cannot show is that a chip does what the manuals say (SPRUI33, SPRUHM8); the port has not run on
 * silicon.
 */
#include "board.h"
#include "chip.h"
#include "fake_c2000_bank.h"
#include "first_drive.h"
#include "hal_c2000_inline.h"

#include "unity.h"

#include <math.h>

#define HALF 10000u /* 5 kHz at 100 MHz */

static const hal_c2000_board_t board = {
    .half_ticks = HALF,
    .i_offset_a = 2040,
    .i_offset_b = 2061,
    .i_per_count = IQ24(2.0 / 2048),
    .u_dc_per_count = IQ24(2.0 / 4096),
    .counts_per_turn = 4096,
    .pole_pairs = 3,
    .theta_offset = IQ24(0.125),
};
static const c2000_channels_t channels = {.i_a = 2, .u_dc = 5, .i_b = 3};
static iqfoc_hal_t hal;

void setUp(void)
{
    static const fake_plant_t none = {0};
    fake_plant = none;
    fake_reset();
    hal_c2000_start(&hal, &fake_f28004x, &board);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, fake_lost());
    TEST_ASSERT_FALSE(fake_is_open());
}

/* Words of 16 bits; the tables of the data sheets' memory maps. */
static void test_addresses(void)
{
    static const c2000_family_t family = C2000_F2837XD;
    static const c2000_chip_t chip =
        C2000_CHIP(family); /* NOLINT(performance-no-int-to-ptr): a register's address */
    TEST_ASSERT_EQUAL_HEX32(0x4100 + 0x6B, (uintptr_t)chip.epwm[1] + EPWM_CMPA);
    TEST_ASSERT_EQUAL_HEX32(0x4200 + 0x9B, (uintptr_t)chip.epwm[2] + EPWM_TZFRC);
    TEST_ASSERT_EQUAL_HEX32(0x0B22, (uintptr_t)chip.adc_result[1] + ADC_RESULT(2));
    TEST_ASSERT_EQUAL_HEX32(0x7416, (uintptr_t)chip.adc[0] + ADC_SOCCTL(3));
    TEST_ASSERT_EQUAL_HEX32(0x5115, (uintptr_t)chip.eqep + EQEP_QEPCTL);
    TEST_ASSERT_EQUAL_HEX32(0x0C0C, (uintptr_t)chip.timer + TIMER_TCR);
    TEST_ASSERT_EQUAL_HEX32(0x5D214, (uintptr_t)chip.clk + CLK_PLLMULT);
    TEST_ASSERT_EQUAL_HEX32(0x5D322, (uintptr_t)chip.sys + SYS_PCLKCR0);
    TEST_ASSERT_EQUAL_HEX32(0x7029, (uintptr_t)chip.watchdog + WD_WDCR);
    TEST_ASSERT_EQUAL_HEX32(0x5F980, (uintptr_t)chip.flash + FLASH_INTF_CTRL);
    TEST_ASSERT_EQUAL_HEX32(0x5D768, (uintptr_t)chip.analog + ANALOG_ANAREFCTL);
    TEST_ASSERT_EQUAL_HEX32(0x7C20, (uintptr_t)chip.gpio + GPIO_GPAGMUX1);
    TEST_ASSERT_EQUAL_HEX32(0x7900, (uintptr_t)chip.input_xbar + XBAR_INPUT1);
    TEST_ASSERT_EQUAL_HEX32(0x0CE2, (uintptr_t)chip.pie + PIE_IER(1));
    TEST_ASSERT_EQUAL_HEX32(0x0CF4, (uintptr_t)chip.pie + PIE_IER(10));
    TEST_ASSERT_EQUAL_HEX32(0x0D00 + 2 * 32, (uintptr_t)chip.pie_vectors + PIE_VECTOR_ADCA1);
    TEST_ASSERT_EQUAL_HEX32(0x0D00 + 2 * 105, (uintptr_t)chip.pie_vectors + PIE_VECTOR_ADCA2);
}

static void check_clock(const c2000_chip_t *chip, uint32_t multiplier, uint32_t waits, uint32_t banks,
                        uint16_t divider)
{
    const uint16_t *clk = fake_bank.clk;
    fake_reset();
    fake_bank.clk[CLK_PERDIVSEL] = 0x0042;
    TEST_ASSERT_EQUAL(C2000_OK, c2000_clock_start(chip));
    const int32_t flash = fake_last_write(fake_bank.flash + FLASH_FRDCNTL, 0x0F00, waits << 8);
    const int32_t bypass = fake_first_write(clk + CLK_PLLCTL1, PLLCTL1_USED, 0);
    const int32_t factor = fake_last_write(clk + CLK_PLLMULT, UINT32_MAX, multiplier);
    const int32_t slow = fake_last_write(clk + CLK_SYSDIVSEL, UINT32_MAX, 2);
    const int32_t used = fake_first_write(clk + CLK_PLLCTL1, PLLCTL1_USED, PLLCTL1_USED);
    const int32_t fast = fake_last_write(clk + CLK_SYSDIVSEL, UINT32_MAX, 1);
    TEST_ASSERT_TRUE(flash >= 0 && flash < bypass && bypass < factor && factor < slow && slow < used &&
                     used < fast);
    TEST_ASSERT_EQUAL_HEX16(PLLCTL1_ON | PLLCTL1_USED, clk[CLK_PLLCTL1]);
    TEST_ASSERT_EQUAL_HEX16(0x0068, fake_bank.watchdog[WD_WDCR]);
    TEST_ASSERT_EQUAL_HEX16(3, fake_bank.flash[FLASH_INTF_CTRL]);
    TEST_ASSERT_EQUAL_UINT32(waits, fake_long(fake_bank.flash, FLASH_FRDCNTL) >> 8 & 0xF);
    /* 10 MHz times the factor, by 2; the time base has 100 MHz. */
    TEST_ASSERT_EQUAL_UINT32(chip->family->clock_hz, 10000000 * multiplier / 2);
    TEST_ASSERT_EQUAL_UINT32(C2000_TICK_HZ, chip->family->clock_hz / chip->family->clocks_per_tick);
    TEST_ASSERT_EQUAL_HEX16(divider, clk[CLK_PERDIVSEL]);
    TEST_ASSERT_EQUAL_HEX32(banks, fake_long(fake_bank.flash, FLASH_FBFALLBACK));
    TEST_ASSERT_EQUAL_HEX32(1, fake_long(fake_bank.flash, FLASH_FPAC1));
    TEST_ASSERT_EQUAL_UINT32(0, fake_lost());
}

static void test_clock(void)
{
    check_clock(&fake_f28004x, 20, 4, 0xF, 0x0042); /* it has no divider: as it was */
    check_clock(&fake_f2837xd, 40, 3, 0x3, 0x0041);
    check_clock(&fake_f2837xd_100_mhz, 20, 1, 0x3, 0x0040);
    fake_reset();
    fake_plant.locks_failed = 4;
    TEST_ASSERT_EQUAL(C2000_OK, c2000_clock_start(&fake_f2837xd));
    fake_reset();
    fake_plant.locks_failed = 5;
    TEST_ASSERT_EQUAL(C2000_ERROR_CLOCK, c2000_clock_start(&fake_f2837xd));
    TEST_ASSERT_EQUAL(-1, fake_first_write(fake_bank.clk + CLK_PLLCTL1, PLLCTL1_USED, PLLCTL1_USED));
}

static void test_carrier(void)
{
    const uint16_t *sys = fake_bank.sys;
    fake_bank.sys[SYS_PCLKCR0 + 1] = 4; /* TBCLKSYNC: left on by a boot loader */
    TEST_ASSERT_EQUAL(C2000_OK, c2000_carrier_start(&fake_f28004x, HALF, 1001));
    const int32_t stop = fake_first_write(sys + SYS_PCLKCR0, PCLKCR0_TBCLKSYNC, 0);
    TEST_ASSERT_EQUAL_UINT32(0, fake_long(sys, SYS_PCLKCR0) & PCLKCR0_TBCLKSYNC);
    c2000_run(&fake_f28004x);
    const int32_t start = fake_last_write(sys + SYS_PCLKCR0, PCLKCR0_TBCLKSYNC, PCLKCR0_TBCLKSYNC);
    TEST_ASSERT_EQUAL_HEX32(PCLKCR0_TBCLKSYNC | 0x38,
                            fake_long(sys, SYS_PCLKCR0)); /* and the rest as it was */
    TEST_ASSERT_EQUAL_HEX32(7, fake_long(sys, SYS_PCLKCR2));
    for (uint32_t leg = 0; leg < 3; leg++) {
        const uint16_t *epwm = fake_bank.epwm[leg];
        const int32_t select = fake_first_write(epwm + EPWM_TZCTL, UINT32_MAX, 0x000A);
        const int32_t trip = fake_first_write(epwm + EPWM_TZFRC, UINT32_MAX, 4);
        const int32_t period = fake_last_write(epwm + EPWM_TBPRD, UINT32_MAX, HALF);
        TEST_ASSERT_TRUE(stop >= 0 && stop < select && select < trip && trip < period && period < start);
        TEST_ASSERT_EQUAL_HEX16(0x3100, epwm[EPWM_TZSEL]);
        TEST_ASSERT_EQUAL_HEX16(0x000A, epwm[EPWM_TZCTL]);
        TEST_ASSERT_EQUAL_HEX16(4, epwm[EPWM_TZFLG]);
        TEST_ASSERT_EQUAL_HEX16(0x800A, epwm[EPWM_TBCTL]);
        TEST_ASSERT_EQUAL_HEX16(0, epwm[EPWM_TBCTR]);
        TEST_ASSERT_EQUAL_HEX16(0, epwm[EPWM_CMPCTL]);
        TEST_ASSERT_EQUAL_UINT16(HALF, fake_active[leg]);
        TEST_ASSERT_EQUAL_HEX16(0x0021, epwm[EPWM_GLDCTL]);
        TEST_ASSERT_EQUAL_HEX16(0x0002, epwm[EPWM_GLDCFG]);
        TEST_ASSERT_EQUAL_HEX32(leg * 0x0011111UL, fake_long(epwm, EPWM_XLINK) & 0x000FFFFF);
        TEST_ASSERT_EQUAL_HEX32(0, fake_long(epwm, EPWM_XLINK) >> 28);
        TEST_ASSERT_EQUAL_HEX16(0x0060, epwm[EPWM_AQCTLA]);
        TEST_ASSERT_EQUAL_HEX16(0x000B, epwm[EPWM_DBCTL]);
        TEST_ASSERT_EQUAL_UINT16(101, epwm[EPWM_DBRED]); /* not shorter than asked for */
        TEST_ASSERT_EQUAL_UINT16(101, epwm[EPWM_DBFED]);
        TEST_ASSERT_EQUAL(-1, fake_first_write(epwm + EPWM_TZCLR, 0, 0)); /* set-up lets no output on */
    }
    TEST_ASSERT_EQUAL_HEX16(0xA900, fake_bank.epwm[0][EPWM_ETSEL]);
    TEST_ASSERT_EQUAL_HEX16(0x1100, fake_bank.epwm[0][EPWM_ETPS]);
}

static void test_what_does_not_fit_is_an_error(void)
{
    const c2000_channels_t none = {.i_a = 2, .u_dc = 16, .i_b = 3};
    TEST_ASSERT_EQUAL(C2000_ERROR_CARRIER, c2000_carrier_start(&fake_f28004x, 99, 1000));
    TEST_ASSERT_EQUAL(C2000_ERROR_CARRIER, c2000_carrier_start(&fake_f28004x, 65535, 1000));
    TEST_ASSERT_EQUAL(C2000_ERROR_DEAD_TIME, c2000_carrier_start(&fake_f28004x, HALF, 163831));
    TEST_ASSERT_EQUAL(C2000_OK, c2000_carrier_start(&fake_f28004x, HALF, 163830));
    TEST_ASSERT_EQUAL(C2000_ERROR_ENCODER, c2000_encoder_start(&fake_f28004x, 3));
    TEST_ASSERT_EQUAL(C2000_ERROR_ENCODER, c2000_encoder_start(&fake_f28004x, 65537));
    TEST_ASSERT_EQUAL(C2000_ERROR_CHANNEL, c2000_converters_start(&fake_f28004x, &none));
}

static void check_converters(const c2000_chip_t *chip, uint32_t window, uint16_t prescale, uint16_t reference)
{
    fake_reset();
    TEST_ASSERT_EQUAL(C2000_OK, c2000_converters_start(chip, &channels));
    const uint32_t a = 2u << 15 | (window - 1);
    const uint32_t u = 5u << 15 | (window - 1);
    const uint32_t b = 3u << 15 | (window - 1);
    TEST_ASSERT_EQUAL_HEX32(5u << 20 | a, fake_long(fake_bank.adc[0], ADC_SOCCTL(0)));
    TEST_ASSERT_EQUAL_HEX32(5u << 20 | u, fake_long(fake_bank.adc[0], ADC_SOCCTL(1)));
    TEST_ASSERT_EQUAL_HEX32(6u << 20 | a, fake_long(fake_bank.adc[0], ADC_SOCCTL(2)));
    TEST_ASSERT_EQUAL_HEX32(6u << 20 | u, fake_long(fake_bank.adc[0], ADC_SOCCTL(3)));
    TEST_ASSERT_EQUAL_HEX32(5u << 20 | b, fake_long(fake_bank.adc[1], ADC_SOCCTL(0)));
    TEST_ASSERT_EQUAL_HEX32(6u << 20 | b, fake_long(fake_bank.adc[1], ADC_SOCCTL(2)));
    TEST_ASSERT_EQUAL_HEX32(0, fake_long(fake_bank.adc[1], ADC_SOCCTL(1)));
    TEST_ASSERT_EQUAL_HEX16(0x6361, fake_bank.adc[0][ADC_INTSEL1N2]);
    TEST_ASSERT_EQUAL_HEX16(0, fake_bank.adc[1][ADC_INTSEL1N2]);
    TEST_ASSERT_EQUAL_HEX16(reference, fake_bank.analog[ANALOG_ANAREFCTL]);
    TEST_ASSERT_EQUAL_HEX32(3, fake_long(fake_bank.sys, SYS_PCLKCR13));
    for (int x = 0; x < 2; x++) {
        TEST_ASSERT_EQUAL_HEX16(0x0084, fake_bank.adc[x][ADC_CTL1]);
        TEST_ASSERT_EQUAL_HEX16(prescale, fake_bank.adc[x][ADC_CTL2]);
    }
    /* 100 ns, above the 75 ns of both data sheets. */
    TEST_ASSERT_EQUAL_UINT32(chip->family->clock_hz / 10000000, window);
    TEST_ASSERT_EQUAL_UINT32(0, fake_lost());
}

static void test_converters(void)
{
    check_converters(&fake_f28004x, 10, 2, 0);
    check_converters(&fake_f2837xd_100_mhz, 10, 2, 7);
    check_converters(&fake_f2837xd, 20, 6, 7); /* its references are pins: the register is not there */
}

static void test_encoder_and_timer(void)
{
    fake_bank.eqep[EQEP_QFLG] = 0xFFFF; /* what came while nothing was connected */
    TEST_ASSERT_EQUAL(C2000_OK, c2000_encoder_start(&fake_f28004x, 65536));
    TEST_ASSERT_FALSE(hal_c2000_encoder_faulty(&hal));
    fake_bank.eqep[EQEP_QFLG] = 0x0004;
    TEST_ASSERT_TRUE(hal_c2000_encoder_faulty(&hal));
    TEST_ASSERT_EQUAL_HEX16(0x9008, fake_bank.eqep[EQEP_QEPCTL]);
    TEST_ASSERT_EQUAL_UINT32(65535, fake_long(fake_bank.eqep, EQEP_QPOSMAX));
    TEST_ASSERT_TRUE(fake_last_write(fake_bank.eqep + EQEP_QPOSMAX, 0, 0) <
                     fake_last_write(fake_bank.eqep + EQEP_QEPCTL, 8, 8));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fake_long(fake_bank.timer, TIMER_PRD));
    TEST_ASSERT_EQUAL_HEX16(0x0820, fake_bank.timer[TIMER_TCR]);
    TEST_ASSERT_EQUAL_HEX32(1, fake_long(fake_bank.sys, SYS_PCLKCR4));
}

static void test_pins_and_interrupts(void)
{
    TEST_ASSERT_EQUAL(C2000_OK, c2000_converters_start(&fake_f2837xd, &channels));
    c2000_pins_start(&fake_f2837xd);
    const int32_t power = fake_last_write(fake_bank.adc[1] + ADC_CTL1, 0x80, 0x80);
    const int32_t line = fake_last_write(fake_bank.input_xbar + XBAR_INPUT1, UINT32_MAX, 12);
    const int32_t gates = fake_first_write(fake_bank.gpio + GPIO_GPAMUX1, 0xFFF, 0x555);
    TEST_ASSERT_TRUE(power >= 0 && line > power && gates > line);
    /* 500 us of 200 MHz, two clocks a read. */
    TEST_ASSERT_TRUE(fake_reads_between(power, gates) >= 50000);
    TEST_ASSERT_EQUAL_HEX32(0x00500555, fake_long(fake_bank.gpio, GPIO_GPAMUX1));
    TEST_ASSERT_EQUAL_HEX32(0x00500000, fake_long(fake_bank.gpio, GPIO_GPAGMUX1)); /* 10 and 11: function 5 */
    TEST_ASSERT_EQUAL_HEX32(0x03000000, fake_long(fake_bank.gpio, GPIO_GPAQSEL1));
    TEST_ASSERT_EQUAL_HEX32(0x0000103F, fake_long(fake_bank.gpio, GPIO_GPAPUD));
    c2000_interrupts_start(&fake_f2837xd, 0x81234, 0x85678);
    TEST_ASSERT_EQUAL_HEX32(0x81234, fake_long(fake_bank.pie_vectors, 0x40));
    TEST_ASSERT_EQUAL_HEX32(0x85678, fake_long(fake_bank.pie_vectors, 0xD2));
    TEST_ASSERT_EQUAL_HEX16(1, fake_bank.pie[PIE_IER(1)]);
    TEST_ASSERT_EQUAL_HEX16(2, fake_bank.pie[PIE_IER(10)]);
    TEST_ASSERT_EQUAL_HEX16(1, fake_bank.pie[PIE_CTRL]);
}

static iqfoc_command_t command_of(double a, double b, double c, bool gates)
{
    const iqfoc_command_t command = {
        .duties = {{(iq24_t)lround(a * IQ24_ONE), (iq24_t)lround(b * IQ24_ONE), (iq24_t)lround(c * IQ24_ONE)},
                   IQ24_ONE},
        .gates = gates};
    return command;
}

static void begin(void)
{
    TEST_ASSERT_EQUAL(C2000_OK, c2000_carrier_start(&fake_f28004x, HALF, 1000));
}

/* High for 2 (TBPRD - CMPA) of 2 TBPRD clocks; a value that is loaded at zero must be 1 or more. */
static void test_duties(void)
{
    for (int k = 0; k <= 1000; k++) {
        const double duty = k / 1000.0;
        const iqfoc_command_t command = command_of(duty, 1.0 - duty, 0.5, true);
        fake_reset();
        begin();
        iqfoc_hal_write(&hal, &command);
        for (int leg = 0; leg < 3; leg++) {
            const double want = leg == 0 ? duty : leg == 1 ? 1.0 - duty : 0.5;
            const uint32_t compare = fake_bank.epwm[leg][EPWM_CMPA];
            TEST_ASSERT_TRUE(compare >= 1 && compare <= HALF);
            TEST_ASSERT_DOUBLE_WITHIN((want > 1.0 - 0.5 / HALF ? 1.0 : 0.5) / HALF + 1e-7, want,
                                      (double)(HALF - compare) / HALF);
            TEST_ASSERT_TRUE(fake_armed[leg]);
        }
    }
}

static bool all_tripped(void)
{
    return (fake_bank.epwm[0][EPWM_TZFLG] & fake_bank.epwm[1][EPWM_TZFLG] & fake_bank.epwm[2][EPWM_TZFLG] &
            TZ_OST) != 0;
}

static bool none_tripped(void)
{
    return ((fake_bank.epwm[0][EPWM_TZFLG] | fake_bank.epwm[1][EPWM_TZFLG] | fake_bank.epwm[2][EPWM_TZFLG]) &
            TZ_OST) == 0;
}

static void test_gates(void)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5, true);
    const iqfoc_command_t off = command_of(0.0, 0.0, 0.0, false);
    begin();
    TEST_ASSERT_TRUE(all_tripped());
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_TRUE(none_tripped());
    /* On only after the compare values wait for the valley together, off before. */
    const int32_t load = fake_last_write(fake_bank.epwm[0] + EPWM_GLDCTL2, UINT32_MAX, 1);
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_TRUE(fake_last_write(fake_bank.epwm[leg] + EPWM_CMPA, 0, 0) < load);
        TEST_ASSERT_TRUE(load < fake_first_write(fake_bank.epwm[leg] + EPWM_TZCLR, UINT32_MAX, 4));
    }
    iqfoc_hal_write(&hal, &off);
    TEST_ASSERT_TRUE(all_tripped());
    TEST_ASSERT_TRUE(fake_last_write(fake_bank.epwm[2] + EPWM_TZFRC, UINT32_MAX, 4) <
                     fake_last_write(fake_bank.epwm[0] + EPWM_CMPA, 0, 0));
    TEST_ASSERT_FALSE(hal_c2000_broken(&hal)); /* what a command asked for is no fault */
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_TRUE(none_tripped());
}

/* No command brings the outputs back by itself. */
static void check_stays_off(void)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5, true);
    TEST_ASSERT_TRUE(hal_c2000_broken(&hal));
    for (int k = 0; k < 3; k++) {
        iqfoc_hal_write(&hal, &on);
        TEST_ASSERT_TRUE(all_tripped());
        TEST_ASSERT_TRUE(hal_c2000_broken(&hal));
    }
    hal_c2000_clear_break(&hal);
    TEST_ASSERT_FALSE(hal_c2000_broken(&hal));
    TEST_ASSERT_TRUE(all_tripped());
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_TRUE(none_tripped());
}

static void test_trips(void)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5, true);
    const uint16_t sources[3] = {0x01, 0x10, 0x20}; /* the break line, a lost clock, a halted core */
    begin();
    iqfoc_hal_write(&hal, &on);
    for (int k = 0; k < 3; k++) {
        fake_trip_by(sources[k]);
        TEST_ASSERT_TRUE(all_tripped());
        check_stays_off();
    }
    /* A line that no bit of TZSEL selects. */
    fake_trip_by(0x02);
    TEST_ASSERT_TRUE(none_tripped());
    /* The trip's flag without its source's, in one leg alone: all legs go off at the next command. */
    fake_bank.epwm[1][EPWM_TZFLG] = TZ_OST;
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_TRUE(all_tripped());
    check_stays_off();
    /* The same, cleared before the next command: no leg stays on. */
    fake_bank.epwm[1][EPWM_TZFLG] = TZ_OST;
    hal_c2000_clear_break(&hal);
    TEST_ASSERT_TRUE(all_tripped());
    iqfoc_hal_write(&hal, &on);
    TEST_ASSERT_TRUE(none_tripped());
    /* While a command holds the outputs off, a trip is seen by its source. */
    const iqfoc_command_t off = command_of(0.0, 0.0, 0.0, false);
    iqfoc_hal_write(&hal, &off);
    fake_trip_by(0x01);
    check_stays_off();
}

/* The break line while a command is written: outputs that were on stay off. */
static void test_trip_during_a_command(void)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5, true);
    begin();
    iqfoc_hal_write(&hal, &on);
    fake_plant.trips_at = fake_bank.epwm[0] + EPWM_GLDCTL2;
    iqfoc_hal_write(&hal, &on);
    fake_plant.trips_at = NULL;
    TEST_ASSERT_TRUE(all_tripped());
    check_stays_off();
}

static void instant(uint32_t count, bool down, uint32_t now, uint32_t encoder)
{
    fake_bank.epwm[0][EPWM_TBCTR] = (uint16_t)count;
    fake_bank.epwm[0][EPWM_TBSTS] = down ? 0 : 1;
    fake_bank.timer[TIMER_TIM] = (uint16_t)((UINT32_MAX - now) & 0xFFFF);
    fake_bank.timer[TIMER_TIM + 1] = (uint16_t)((UINT32_MAX - now) >> 16);
    fake_bank.eqep[EQEP_QPOSCNT] = (uint16_t)(encoder & 0xFFFF);
    fake_bank.eqep[EQEP_QPOSCNT + 1] = (uint16_t)(encoder >> 16);
}

/*
 * Sampling instant: the counter's way since valley or peak, in all four quarters; the timer counts the core's
 * clock.
 */
static void test_sampling_instant(void)
{
    const c2000_chip_t *const chips[2] = {&fake_f28004x, &fake_f2837xd};
    for (uint32_t ratio = 1; ratio <= 2; ratio++) {
        iqfoc_sample_t sample;
        hal_c2000_start(&hal, chips[ratio - 1], &board);
        instant(300, false, 1000000, 0);
        iqfoc_hal_read_valley(&hal, &sample);
        TEST_ASSERT_EQUAL_UINT32(1000000, iqfoc_hal_now(&hal));
        TEST_ASSERT_EQUAL_UINT32(1000000 - 300 * ratio, sample.time);
        TEST_ASSERT_EQUAL_INT32(0, sample.instant);
        instant(HALF - 200, true, 100, 0);
        iqfoc_hal_read_valley(&hal, &sample); /* late, past the peak */
        TEST_ASSERT_EQUAL_UINT32(100u - (HALF + 200) * ratio, sample.time);
        iqfoc_hal_read_peak(&hal, &sample);
        TEST_ASSERT_EQUAL_UINT32(100u - 200 * ratio, sample.time);
        TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 2, sample.instant);
        instant(150, false, 0, 0);
        iqfoc_hal_read_peak(&hal, &sample); /* late, past the valley */
        TEST_ASSERT_EQUAL_UINT32(0u - (HALF + 150) * ratio, sample.time);
    }
}

/* Valley and peak have results of their own: a late handler reads its own instant's. */
static void test_scaling_signs_and_clipping(void)
{
    iqfoc_sample_t sample;
    instant(0, false, 0, 0);
    fake_bank.adc_result[0][0] = 2040 + 1024;
    fake_bank.adc_result[1][0] = 2061 - 512;
    fake_bank.adc_result[0][1] = 2048;
    fake_bank.adc_result[0][2] = 2040 - 1024;
    fake_bank.adc_result[1][2] = 2061 + 512;
    fake_bank.adc_result[0][3] = 1024;
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_EQUAL_INT32(IQ24(1.0), sample.i.a);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), sample.i.b);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), sample.i.c);
    TEST_ASSERT_EQUAL_INT32(IQ24(1.0), sample.u_dc);
    TEST_ASSERT_FALSE(sample.clipped);
    iqfoc_hal_read_peak(&hal, &sample);
    TEST_ASSERT_EQUAL_INT32(IQ24(-1.0), sample.i.a);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5), sample.i.b);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5), sample.u_dc);
    fake_bank.adc_result[1][0] = 4;
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_TRUE(sample.clipped);
    fake_bank.adc_result[0][2] = 4090;
    iqfoc_hal_read_peak(&hal, &sample);
    TEST_ASSERT_TRUE(sample.clipped);
}

/* Both ways through the encoder's end: speed, and the angle moved back to the instant of sampling. */
static void test_angle_and_speed(void)
{
    const double per_valley[2] = {37.0, -37.0}; /* encoder counts a cycle */
    for (int way = 0; way < 2; way++) {
        hal_c2000_start(&hal, &fake_f28004x, &board);
        iqfoc_sample_t sample;
        double count = 100.0;
        for (int k = 0; k < 200; k++) {
            /* The handler is 1000 ticks late: 0.05 cycles. */
            const double seen = count + per_valley[way] * 0.05;
            instant(1000, false, 0, (uint32_t)lround(fmod(seen + 40960.0, 4096.0)) % 4096);
            iqfoc_hal_read_valley(&hal, &sample);
            count += per_valley[way];
        }
        count -= per_valley[way];
        const double speed = per_valley[way] * 3.0 / 4096.0;
        TEST_ASSERT_DOUBLE_WITHIN(3.0 / 4096.0 / HAL_SPEED_SPAN, speed, sample.speed / 16777216.0);
        const double theta = count * 3.0 / 4096.0 + 0.125;
        TEST_ASSERT_DOUBLE_WITHIN(1.5 * 3.0 / 4096.0, 0.0, remainder(sample.theta / 16777216.0 - theta, 1.0));
    }
}

static void test_offset_and_alignment(void)
{
    const iqfoc_abc_t offset = {IQ24(0.125), IQ24(-0.25), IQ24(0.125)};
    iqfoc_sample_t sample;
    instant(0, false, 0, 3000);
    fake_bank.adc_result[0][0] = 2040 + 128;
    fake_bank.adc_result[1][0] = 2061;
    hal_c2000_set_offset(&hal, offset);
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_EQUAL_INT32(0, sample.i.a);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.25), sample.i.b);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25), sample.i.c);
    hal_c2000_align(&hal, IQ24(0.25));
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_EQUAL_INT32(0, (sample.theta - IQ24(0.25)) & (IQ24_ONE - 1));
    instant(0, false, 0, 3000 + 4096 / 12); /* a quarter of an electrical turn on */
    iqfoc_hal_read_valley(&hal, &sample);
    TEST_ASSERT_DOUBLE_WITHIN(3.0 / 4096.0, 0.0, remainder(sample.theta / 16777216.0 - 0.5, 1.0));
}

/*
 * A whole cycle by the handlers: flags cleared after the work, the group of each acknowledged, the outputs
 * on.
 */
static void test_handlers(void)
{
    iqfoc_cycle_t cycle;
    begin();
    TEST_ASSERT_TRUE(first_drive_start(&cycle, 100000000, IQ24(0.1)));
    fake_bank.adc_result[0][0] = fake_bank.adc_result[0][2] = 2040;
    fake_bank.adc_result[1][0] = fake_bank.adc_result[1][2] = 2061;
    fake_bank.adc_result[0][1] = fake_bank.adc_result[0][3] = 2048;
    for (uint32_t k = 0; k < 4; k++) {
        const uint32_t valley = 2 * HALF * k;
        instant(100, false, valley + 100, 0);
        hal_c2000_valley(first_drive_methods, &cycle, &hal);
        const int32_t flag = fake_last_write(fake_bank.adc[0] + ADC_INTFLGCLR, UINT32_MAX, 1);
        TEST_ASSERT_TRUE(flag >= 0 && flag < fake_last_write(fake_bank.pie + PIE_ACK, UINT32_MAX, 0x0001));
        instant(HALF - 100, true, valley + HALF + 100, 0);
        hal_c2000_peak(first_drive_methods, &cycle, &hal);
        const int32_t second = fake_last_write(fake_bank.adc[0] + ADC_INTFLGCLR, UINT32_MAX, 2);
        TEST_ASSERT_TRUE(second > flag &&
                         second < fake_last_write(fake_bank.pie + PIE_ACK, UINT32_MAX, 0x0200));
    }
    TEST_ASSERT_EQUAL_HEX32(0, cycle.status & cycle.config->trips);
    TEST_ASSERT_TRUE(none_tripped());
    /* A clipped sample at the valley trips the cycle: off before the peak. */
    fake_bank.adc_result[1][0] = 4095;
    instant(100, false, 8 * HALF + 100, 0);
    hal_c2000_valley(first_drive_methods, &cycle, &hal);
    TEST_ASSERT_TRUE(all_tripped());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_addresses);
    RUN_TEST(test_clock);
    RUN_TEST(test_carrier);
    RUN_TEST(test_what_does_not_fit_is_an_error);
    RUN_TEST(test_converters);
    RUN_TEST(test_encoder_and_timer);
    RUN_TEST(test_pins_and_interrupts);
    RUN_TEST(test_duties);
    RUN_TEST(test_gates);
    RUN_TEST(test_trips);
    RUN_TEST(test_trip_during_a_command);
    RUN_TEST(test_sampling_instant);
    RUN_TEST(test_scaling_signs_and_clipping);
    RUN_TEST(test_angle_and_speed);
    RUN_TEST(test_offset_and_alignment);
    RUN_TEST(test_handlers);
    return UNITY_END();
}
