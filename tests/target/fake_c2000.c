/*
 * Bank of memory in place of an F28004x or F2837xD (fake_c2000_bank.h).
 */
#include "fake_c2000_bank.h"

#include "chip.h"

#include <string.h>

fake_bank_t fake_bank;
fake_plant_t fake_plant;
uint16_t fake_active[3];
bool fake_armed[3];
static uint32_t lost_count;
static bool open;

static const c2000_family_t f28004x = C2000_F28004X;
static const c2000_family_t f2837xd = C2000_F2837XD;
static const c2000_family_t f2837xd_100_mhz = C2000_F2837XD_100_MHZ;

#define FAKE_CHIP(family_)                                                                                   \
    {                                                                                                        \
        .family = &(family_), .epwm = {fake_bank.epwm[0], fake_bank.epwm[1], fake_bank.epwm[2]},             \
        .adc = {fake_bank.adc[0], fake_bank.adc[1]},                                                         \
        .adc_result = {fake_bank.adc_result[0], fake_bank.adc_result[1]}, .eqep = fake_bank.eqep,            \
        .timer = fake_bank.timer, .clk = fake_bank.clk, .sys = fake_bank.sys,                                \
        .watchdog = fake_bank.watchdog, .flash = fake_bank.flash, .analog = fake_bank.analog,                \
        .gpio = fake_bank.gpio, .input_xbar = fake_bank.input_xbar, .pie = fake_bank.pie,                    \
        .pie_vectors = fake_bank.pie_vectors                                                                 \
    }
const c2000_chip_t fake_f28004x = FAKE_CHIP(f28004x);
const c2000_chip_t fake_f2837xd = FAKE_CHIP(f2837xd);
const c2000_chip_t fake_f2837xd_100_mhz = FAKE_CHIP(f2837xd_100_mhz);

void fake_reset(void)
{
    memset(&fake_bank, 0, sizeof fake_bank);
    memset(fake_active, 0, sizeof fake_active);
    memset(fake_armed, 0, sizeof fake_armed);
    fake_bank.analog[ANALOG_ANAREFCTL] = 0x0007; /* external references */
    fake_bank.clk[CLK_PERDIVSEL] = 0x0001;
    fake_bank.flash[FLASH_FRDCNTL] = 0x0F00;
    fake_bank.sys[SYS_PCLKCR0] = 0x0038;
    for (uint16_t leg = 0; leg < 3; leg++) {
        fake_bank.epwm[leg][EPWM_TBCTL] = 0x0083;
        /* Each module is linked to itself. */
        fake_bank.epwm[leg][EPWM_XLINK] = (uint16_t)(leg * 0x1111U);
        fake_bank.epwm[leg][EPWM_XLINK + 1] = (uint16_t)(leg * 0x1001U);
    }
    fake_writes_begin();
    lost_count = 0;
    open = false;
}

/* Is reg within a part of the bank? */
static bool within(const c2000_reg_t *reg, const uint16_t *bank, uint32_t from, uint32_t to)
{
    return reg >= bank + from && reg <= bank + to;
}

/* EALLOW-protected in the manuals' register tables. */
static bool is_protected(const c2000_reg_t *reg)
{
    for (int k = 0; k < 3; k++) {
        const uint16_t *epwm = fake_bank.epwm[k];
        if (within(reg, epwm, EPWM_GLDCTL, EPWM_XLINK + 1) || within(reg, epwm, EPWM_GLDCTL2, EPWM_GLDCTL2) ||
            within(reg, epwm, EPWM_TZSEL, EPWM_TZFRC)) {
            return true;
        }
    }
    for (int k = 0; k < 2; k++) {
        const uint16_t *adc = fake_bank.adc[k];
        if (within(reg, adc, ADC_CTL1, ADC_CTL2) || within(reg, adc, ADC_INTSEL1N2, ADC_SOCCTL(15) + 1)) {
            return true;
        }
    }
    return within(reg, fake_bank.clk, 0, 0x3F) || within(reg, fake_bank.sys, 0, 0x8F) ||
           within(reg, fake_bank.watchdog, 0, 0x3F) || within(reg, fake_bank.flash, 0, 0x1FF) ||
           within(reg, fake_bank.analog, 0, 0x7F) || within(reg, fake_bank.gpio, 0, 0x7F) ||
           within(reg, fake_bank.input_xbar, 0, 0x1F) || within(reg, fake_bank.pie_vectors, 0, 0x1FF);
}

/* What a module of the ePWM makes of a write. */
static void epwm_answer(int leg, uint32_t offset, uint16_t value)
{
    uint16_t *epwm = fake_bank.epwm[leg];
    if (offset == EPWM_CMPA && (epwm[EPWM_CMPCTL] & CMPCTL_A_IMMEDIATE) != 0) {
        fake_active[leg] = value;
    } else if (offset == EPWM_GLDCTL2) {
        for (int other = 0; other < 3; other++) {
            if (fake_bank.epwm[other][EPWM_XLINK + 1] >> 12 == leg) {
                fake_armed[other] = fake_armed[other] || (value & GLDCTL2_LOAD) != 0;
            }
        }
    } else if (offset == EPWM_TZFRC || offset == EPWM_TZCLR || offset == EPWM_TZOSTCLR) {
        epwm[offset] = 0;
        if (offset == EPWM_TZOSTCLR) {
            epwm[EPWM_TZOSTFLG] &= (uint16_t)~value;
        } else if (fake_plant.trips_missed > 0) {
            fake_plant.trips_missed--;
        } else if (offset == EPWM_TZFRC) {
            epwm[EPWM_TZFLG] |= value;
        } else {
            epwm[EPWM_TZFLG] &= (uint16_t)~value;
        }
    }
}

static void answer(c2000_reg_t *reg, uint16_t value)
{
    for (int leg = 0; leg < 3; leg++) {
        if (within(reg, fake_bank.epwm[leg], 0, 0xFF)) {
            epwm_answer(leg, (uint32_t)(reg - fake_bank.epwm[leg]), value);
        }
    }
    if (reg == fake_bank.clk + CLK_PLLMULT) {
        fake_bank.clk[CLK_PLLCTL1] |= PLLCTL1_ON;
        fake_bank.clk[CLK_PLLSTS] = fake_plant.locks_failed > 0 ? 0 : PLLSTS_LOCKED;
        fake_plant.locks_failed -= fake_plant.locks_failed > 0 ? 1 : 0;
    } else if (reg == fake_bank.clk + CLK_PLLCTL1 && (value & PLLCTL1_ON) == 0) {
        fake_bank.clk[CLK_PLLSTS] = 0;
    } else if (reg == fake_bank.eqep + EQEP_QCLR) {
        fake_bank.eqep[EQEP_QFLG] &= (uint16_t)~value;
        *reg = 0;
    } else if (reg == fake_bank.adc[0] + ADC_INTFLGCLR || reg == fake_bank.pie + PIE_ACK) {
        *reg = 0; /* writing 1 clears the flag */
    }
}

/* False if the protection loses it. */
static bool passes(const c2000_reg_t *reg)
{
    if (open || !is_protected(reg)) {
        return true;
    }
    lost_count++;
    return false;
}

void c2000_write(c2000_reg_t *reg, uint16_t value)
{
    if (passes(reg)) {
        fake_writes_note(reg, value);
        *reg = value;
        answer(reg, value);
    }
    if (reg == fake_plant.trips_at) {
        fake_trip_by(1);
    }
}

void c2000_write_long(c2000_reg_t *reg, uint32_t value)
{
    if (passes(reg)) {
        fake_writes_note(reg, value);
        reg[0] = (uint16_t)(value & 0xFFFF);
        reg[1] = (uint16_t)(value >> 16);
        answer(reg, reg[0]);
    }
}

uint16_t c2000_read(c2000_reg_t *reg)
{
    fake_writes_read();
    return *reg;
}

uint32_t c2000_read_long(c2000_reg_t *reg)
{
    fake_writes_read();
    return (uint32_t)reg[1] << 16 | reg[0];
}

void c2000_unprotect(void)
{
    open = !fake_plant.never_unprotects;
}

void c2000_protect(void)
{
    open = false;
}

void fake_trip_by(uint16_t source)
{
    for (int leg = 0; leg < 3; leg++) {
        uint16_t *epwm = fake_bank.epwm[leg];
        if ((epwm[EPWM_TZSEL] >> 8 & source) != 0) {
            epwm[EPWM_TZOSTFLG] |= source;
            epwm[EPWM_TZFLG] |= TZ_OST;
        }
    }
}

uint32_t fake_lost(void)
{
    return lost_count;
}

bool fake_is_open(void)
{
    return open;
}

uint32_t fake_long(const uint16_t *bank, uint32_t offset)
{
    return (uint32_t)bank[offset + 1] << 16 | bank[offset];
}
