/*
 * The test's side of the bank of memory (fake_c2000.h).
 */
#ifndef TESTS_TARGET_FAKE_C2000_BANK_H
#define TESTS_TARGET_FAKE_C2000_BANK_H

#include "c2000.h"
#include "fake_writes.h"

typedef struct fake_bank {
    uint16_t epwm[3][0x100];
    uint16_t adc[2][0x80];
    uint16_t adc_result[2][0x20];
    uint16_t eqep[0x40];
    uint16_t timer[8];
    uint16_t clk[0x40];
    uint16_t sys[0x90];
    uint16_t watchdog[0x40];
    uint16_t flash[0x200];
    uint16_t analog[0x80];
    uint16_t gpio[0x80];
    uint16_t input_xbar[0x20];
    uint16_t pie[0x20];
    uint16_t pie_vectors[0x200];
} fake_bank_t;

extern fake_bank_t fake_bank;
extern const c2000_chip_t fake_f28004x;
extern const c2000_chip_t fake_f2837xd;
extern const c2000_chip_t fake_f2837xd_100_mhz;

/* Values after reset. */
void fake_reset(void);

/* A mistake of the port or of the chip, planted behind it; fake_reset leaves it. */
typedef struct fake_plant {
    bool never_unprotects; /* every protected write is lost */
    uint32_t trips_missed; /* of the next writes to TZFRC and TZCLR, each (the erratum misses single ones) */
    uint32_t locks_failed; /* of the PLL */
    c2000_reg_t *trips_at; /* a write to this register comes together with the break line */
} fake_plant_t;
extern fake_plant_t fake_plant;

/* The compare values that act, behind the shadow registers; and which modules wait to load theirs once. */
extern uint16_t fake_active[3];
extern bool fake_armed[3];

/* A one-shot trip by its source's bit in TZOSTFLG, for all legs that TZSEL selects it for. */
void fake_trip_by(uint16_t source);

/* Writes that the protection lost since the reset; and is a sequence still unprotected? */
uint32_t fake_lost(void);
bool fake_is_open(void);

/* A register of 32 bits. */
uint32_t fake_long(const uint16_t *bank, uint32_t offset);

#endif
