/*
 * F28004x and F2837xD for the porting checklist (rig_c2000.h): counter, action qualifier, shadow registers,
 * converters, encoder, as the manuals describe them, by what is in the registers.
 */
#include "rig_c2000.h"

#include "board.h"
#include "fake_c2000_bank.h"
#include "hal_c2000.h"

#include <math.h>

#define HALF 1000u /* 50 kHz at 100 MHz */

static const hal_c2000_board_t board = {
    .half_ticks = HALF,
    .i_offset_a = 2031,
    .i_offset_b = 2069,
    .i_per_count = IQ24(2.0 / 2048),
    .u_dc_per_count = IQ24(2.0 / 4096),
    .counts_per_turn = 4096,
    .pole_pairs = 3,
    .theta_offset = 0,
};
static const c2000_channels_t channels = {.i_a = 2, .u_dc = 5, .i_b = 3};

const c2000_chip_t *rig_c2000_chip = &fake_f28004x;
const c2000_chip_t *rig_c2000_hal_chip;
void (*rig_c2000_plant)(void);

static iqfoc_hal_t own_hal;
static uint32_t half; /* ticks from valley to peak */
static double current[3];
static double dc_link;
static double phase;     /* of the carrier period */
static uint64_t periods; /* since the start */
static bool level[3];    /* of the action qualifiers' outputs */

/* ---- Converters ---- */

static uint16_t converted(double value, double full_scale, double offset)
{
    return (uint16_t)lround(fmin(fmax(value / full_scale * 2048.0 + offset, 0.0), 4095.0));
}

/* What is wired to an input. */
static uint16_t input(int converter, uint32_t channel)
{
    if (converter == 0 && channel == channels.i_a) {
        return converted(current[0], 2.0, 2031.0);
    }
    if (converter == 0 && channel == channels.u_dc) {
        return converted(dc_link, 1.0, 0.0);
    }
    return converter == 1 && channel == channels.i_b ? converted(current[1], 2.0, 2069.0) : 0;
}

static void convert(uint32_t trigger)
{
    for (int x = 0; x < 2; x++) {
        const bool runs = (fake_bank.adc[x][ADC_CTL1] & CTL1_POWERED) != 0 &&
                          (fake_long(fake_bank.sys, SYS_PCLKCR13) >> x & 1) != 0;
        for (uint32_t number = 0; runs && number < 16; number++) {
            const uint32_t control = fake_long(fake_bank.adc[x], ADC_SOCCTL(number));
            if ((control >> 20 & 0x1F) == trigger) {
                fake_bank.adc_result[x][number] = input(x, control >> 15 & 0xF);
            }
        }
    }
}

/* SOCASEL and SOCBSEL: 1 zero, 2 period, 3 both. */
static void trigger(uint32_t event)
{
    const uint32_t etsel = fake_bank.epwm[0][EPWM_ETSEL];
    const uint32_t etps = fake_bank.epwm[0][EPWM_ETPS];
    if ((etsel & 0x0800) != 0 && (etsel >> 8 & event) != 0 && (etsel >> 8 & 4) == 0 && (etps >> 8 & 3) == 1) {
        convert(SOC_BY_EPWM1_A);
    }
    if ((etsel & 0x8000) != 0 && (etsel >> 12 & event) != 0 && (etsel >> 12 & 4) == 0 &&
        (etps >> 12 & 3) == 1) {
        convert(SOC_BY_EPWM1_B);
    }
}

/* ---- Carrier ---- */

/* Global load: GLDMODE 0 zero, 1 period, 2 both; else CMPCTL's LOADAMODE with the same codes. */
static void load(int leg, uint32_t event)
{
    const uint16_t *epwm = fake_bank.epwm[leg];
    const bool global = (epwm[EPWM_GLDCTL] & 1) != 0 && (epwm[EPWM_GLDCFG] & GLDCFG_CMPA) != 0;
    const uint32_t mode = global ? epwm[EPWM_GLDCTL] >> 1 & 0xFU : epwm[EPWM_CMPCTL] & 3U;
    const bool once = global && (epwm[EPWM_GLDCTL] & 0x20) != 0;
    if (mode < 3 && ((mode + 1) & event) != 0 && (!once || fake_armed[leg])) {
        fake_active[leg] = epwm[EPWM_CMPA];
        fake_armed[leg] = false;
    }
}

/* The event with the highest priority that has an action decides. Codes: 1 clear, 2 set. */
static void act(int leg, const uint32_t *shifts, int count)
{
    for (int k = 0; k < count; k++) {
        const uint32_t action = (uint32_t)fake_bank.epwm[leg][EPWM_AQCTLA] >> shifts[k] & 3;
        if (action != 0) {
            level[leg] = action == 2;
            return;
        }
    }
}

enum { ZRO = 0, PRD = 2, CAU = 4, CAD = 6 };

/*
 * The counter arrives at a tick of the period: 0 ... 2 half - 1. On the way up CAU, ZRO, CAD; down CAD, PRD,
 * CAU.
 */
static void arrive(uint32_t tick)
{
    for (int leg = 0; leg < 3; leg++) {
        const uint32_t compare = fake_active[leg];
        if (tick == 0) {
            static const uint32_t matched[] = {CAU, ZRO, CAD};
            static const uint32_t plain[] = {ZRO};
            act(leg, compare == 0 ? matched : plain, compare == 0 ? 3 : 1);
            load(leg, 1);
        } else if (tick == half) {
            static const uint32_t matched[] = {CAD, PRD, CAU};
            static const uint32_t plain[] = {PRD};
            act(leg, compare >= half ? matched : plain, compare >= half ? 3 : 1);
            load(leg, 2);
        } else if (compare < half && (tick == compare || tick == 2 * half - compare)) {
            const uint32_t shift = tick < half ? CAU : CAD;
            act(leg, &shift, 1);
        }
    }
    if (tick == 0 || tick == half) {
        trigger(tick == 0 ? 1 : 2);
    }
}

/* Does the time base count, as this rig reads phase? */
static bool counts(void)
{
    bool all = (fake_long(fake_bank.sys, SYS_PCLKCR0) & PCLKCR0_TBCLKSYNC) != 0 &&
               (fake_long(fake_bank.sys, SYS_PCLKCR2) & PCLKCR2_EPWM_1_2_3) == PCLKCR2_EPWM_1_2_3;
    for (int leg = 0; leg < 3; leg++) {
        all = all && (fake_bank.epwm[leg][EPWM_TBCTL] & 0x1F83) == TBCTL_UP_DOWN &&
              fake_bank.epwm[leg][EPWM_TBPRD] == half;
    }
    return all;
}

static void go_to(double to)
{
    if (!counts()) {
        return;
    }
    const uint32_t from = (uint32_t)lround(phase * 2.0 * half);
    const uint32_t ticks = (uint32_t)lround(to * 2.0 * half);
    const bool wraps = to < phase;
    for (uint32_t tick = from + 1; tick <= (wraps ? 2 * half - 1 : ticks); tick++) {
        arrive(tick);
    }
    for (uint32_t tick = 0; wraps && tick <= ticks; tick++) {
        arrive(tick);
    }
    periods += wraps ? 1 : 0;
    phase = to;
    for (int leg = 0; leg < 3; leg++) {
        fake_bank.epwm[leg][EPWM_TBCTR] = (uint16_t)(ticks <= half ? ticks : 2 * half - ticks);
        fake_bank.epwm[leg][EPWM_TBSTS] = ticks < half ? TBSTS_COUNTS_UP : 0;
    }
    const bool runs =
        (fake_bank.timer[TIMER_TCR] & TCR_STOP) == 0 && fake_long(fake_bank.timer, TIMER_PRD) == UINT32_MAX;
    const uint32_t clocks = (uint32_t)(periods * 2 * half + ticks) * rig_c2000_chip->family->clocks_per_tick;
    const uint32_t down = UINT32_MAX - (runs ? clocks : 0);
    fake_bank.timer[TIMER_TIM] = (uint16_t)(down & 0xFFFF);
    fake_bank.timer[TIMER_TIM + 1] = (uint16_t)(down >> 16);
}

static void set_current(const double i_pu[3])
{
    for (int x = 0; x < 3; x++) {
        current[x] = i_pu[x];
    }
}

static void set_dc_link(double u_pu)
{
    dc_link = u_pu;
}

/* Modulo QPOSMAX + 1, if the position counter is set up so. */
static void set_angle(double turns)
{
    const double shaft = turns / board.pole_pairs;
    const double whole = (double)fake_long(fake_bank.eqep, EQEP_QPOSMAX) + 1.0;
    const bool runs =
        (fake_bank.eqep[EQEP_QEPCTL] & 0x3008) == 0x1008 && fake_bank.eqep[EQEP_QDECCTL] >> 14 == 0;
    const uint32_t count = runs ? (uint32_t)lround((shaft - floor(shaft)) * whole) % (uint32_t)whole : 0;
    fake_bank.eqep[EQEP_QPOSCNT] = (uint16_t)(count & 0xFFFF);
    fake_bank.eqep[EQEP_QPOSCNT + 1] = (uint16_t)(count >> 16);
}

/*
 * DBCTL: IN_MODE 00 takes A for both; POLSEL's low bit inverts A, its high bit B; the low side is the other
 * one.
 */
static bool leg_high(int leg)
{
    const uint16_t dead_band = fake_bank.epwm[leg][EPWM_DBCTL];
    const bool high = level[leg] != ((dead_band >> 2 & 1) != 0);
    const bool low = level[leg] != ((dead_band >> 3 & 1) != 0);
    return (dead_band & 0x33) == 3 && high && !low;
}

/* A leg is off if it is tripped, and its trip makes both outputs low. */
static bool outputs_on(void)
{
    for (int leg = 0; leg < 3; leg++) {
        if ((fake_bank.epwm[leg][EPWM_TZFLG] & TZ_OST) == 0 ||
            (fake_bank.epwm[leg][EPWM_TZCTL] & 0xF) != 0xA) {
            return true;
        }
    }
    return false;
}

static uint32_t period_ticks(void)
{
    return 2 * half * rig_c2000_chip->family->clocks_per_tick;
}

const port_rig *rig_c2000_attach(iqfoc_hal_t *hal, uint32_t half_ticks)
{
    static port_rig rig = {
        .set_current = set_current,
        .set_dc_link = set_dc_link,
        .set_angle = set_angle,
        .go_to = go_to,
        .leg_high = leg_high,
        .outputs_on = outputs_on,
        .period_ticks = period_ticks,
        .current_step_pu = 2.0 / 2048,
        .angle_step = 3.0 / 4096,
    };
    rig.hal = hal;
    half = half_ticks;
    phase = 0.0;
    periods = 5;
    dc_link = 1.0;
    for (int leg = 0; leg < 3; leg++) {
        level[leg] = false;
        current[leg] = 0.0;
    }
    return &rig;
}

const port_rig *rig_c2000_start(void)
{
    fake_reset();
    (void)c2000_carrier_start(rig_c2000_chip, HALF, 1000);
    (void)c2000_encoder_start(rig_c2000_chip, board.counts_per_turn);
    (void)c2000_converters_start(rig_c2000_chip, &channels);
    hal_c2000_start(&own_hal, rig_c2000_hal_chip != NULL ? rig_c2000_hal_chip : rig_c2000_chip, &board);
    c2000_run(rig_c2000_chip);
    if (rig_c2000_plant != NULL) {
        rig_c2000_plant();
    }
    const port_rig *const rig = rig_c2000_attach(&own_hal, HALF);
    arrive(0);
    go_to(0.0);
    return rig;
}
