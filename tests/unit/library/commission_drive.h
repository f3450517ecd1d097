/*
 * Drives drawn at random for tests of the self-commissioning: a switching plant with a dead time, 12-bit converters, noise, offsets and a
 * free shaft at any angle. The same seed draws the same drive.
 */
#ifndef TESTS_UNIT_COMMISSION_DRIVE_H
#define TESTS_UNIT_COMMISSION_DRIVE_H

#include "hal_host.h"

#include "iqfoc/commission.h"

/* What is compared with the truth. */
enum {
    DRAWN_R,
    DRAWN_V_DEAD,
    DRAWN_L_D,
    DRAWN_L_Q,
    DRAWN_PSI,
    DRAWN_O_A,
    DRAWN_O_B,
    DRAWN_O_C,
    DRAWN_VALUES
};
extern const char *const drawn_names[DRAWN_VALUES];

typedef struct drawn_drive {
    motor motor; /* of the true values */
    per_unit base;
    plant plant;
    iqfoc_commission_config_t config;
    iqfoc_commission_t commission;
    iqfoc_sample_t sample;      /* of the last valley */
    iqfoc_command_t command;    /* of the last step */
    iqfoc_abc_t duties;         /* in force in the last cycle */
    iqfoc_abc_t duties_next;    /* from the next valley on */
    double truth[DRAWN_VALUES]; /* per unit */
    double highest_A;           /* of any phase at any valley or peak, true */
    double highest_rad_s;       /* electrical speed, true */
} drawn_drive;

/* Draws drive number n of a seed and begins its commissioning. */
void drawn_begin(drawn_drive *d, uint64_t seed, uint64_t n);

/* One cycle: valley, step, peak, up to the next valley. */
void drawn_cycle(drawn_drive *d);

/* Result k with its half width, per unit. */
void drawn_result(const drawn_drive *d, int k, double *value, double *half);

#endif
