/*
 * A whole scenario: its runs one after the other, as one recording.
 */
#ifndef SIM_HOST_DRIVE_DRIVE_SCENARIO_H
#define SIM_HOST_DRIVE_DRIVE_SCENARIO_H

#include "drive_recording.h"

typedef struct drive_scenario {
    const motor *motor; /* the firmware's parameters: from drive_scenario_motor */
    const scenario *scenario;
    const plant_config *plant; /* what the drive is: of drive_scenario_plant, and effects applied to it */
    long seed;                 /* of the sensors' noise and of random effects */
    const drive_firmware *firmware;
    /* Called for each run, from 1, in which the firmware set sticky status bits; NULL: nobody is. */
    void (*note)(void *context, size_t run, uint32_t status);
    void *context;
} drive_scenario;

/*
 * The motor file as a scenario's firmware uses it: with two updates a carrier period a control cycle is half of one, and
 * f_pwm_Hz is the frequency of control cycles.
 */
motor drive_scenario_motor(const motor *m, const scenario *s);

/* For a command that knows duties of whole carrier periods and the measured angle only: false with *e set for another scenario. */
bool drive_scenario_plain(const scenario *s, const char *path, error *e);

/* The ideal drive of a motor file, with a scenario's sensors; a control cycle long as in drive_scenario_motor. */
plant_config drive_scenario_plant(const motor *m, const scenario *s);

/* Of the noise in run n (from 0), where the user gave `seed`. */
uint64_t drive_scenario_seed(long seed, size_t n);

/* Begins the recording and fills it. False with *e set; the recording is then still to be freed. */
bool drive_scenario_run(const drive_scenario *all, drive_recording *out, error *e);

#endif
