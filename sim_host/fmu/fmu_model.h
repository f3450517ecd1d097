/*
 * What an FMU computes: the plant, or the library's control cycle around it, cycle by cycle as `iqfoc simulate` runs them
 * (drive/), but at the pace of a simulator that may stop anywhere in between.
 *
 * Inputs and tunable parameters are taken over at each carrier valley and held until the next. Where the simulator steps by
 * whole control cycles, the currents are those of `iqfoc simulate` bit for bit; a stop within a cycle splits the exact
 * solution there, and moves them by rounding.
 */
#ifndef SIM_HOST_FMU_FMU_MODEL_H
#define SIM_HOST_FMU_FMU_MODEL_H

#include "fmu_setup.h"

#include "drive/drive_run.h"
#include "drive/firmware_host.h"

/* The longest step and the longest settling, in control cycles: a call must return. */
enum { FMU_CYCLES_MOST = 10000000 };

/* The drive's position within a control cycle. */
typedef enum fmu_stage {
    FMU_AT_VALLEY, /* between two cycles: the next has not begun */
    FMU_TO_PEAK,
    FMU_TO_VALLEY
} fmu_stage;

/* Holds addresses of its own parts: it stays where it is. A copy may be copied back (fmi3SetFMUState). */
typedef struct fmu_model {
    fmu_setup setup;
    plant_config as_filed; /* motor file, scenario's sensors, effects; parameters not yet taken */
    double value[FMU_VARIABLES];
    bool begun;
    double start_s; /* the simulator's time at its start */
    scenario_run run;
    drive_firmware firmware;
    drive_host host;
    drive_loop loop;
    drive_row row;    /* of the cycle that runs */
    iqfoc_dq_t i_ref; /* likewise */
    long k;           /* its number; the first behind the settling is 0 */
    fmu_stage stage;
    bool retuned; /* a parameter was set since the last valley */
} fmu_model;

/* Start values of all variables, from a setup that was read; the model owns it from now on. */
bool fmu_model_load(fmu_model *m, const fmu_setup *setup, error *e);

void fmu_model_free(fmu_model *m);

/* Back to the state after loading. */
void fmu_model_reset(fmu_model *m);

/*
 * False with *e set if the value is none that a drive can have; the old one then stays. Ahead of the start, values that must
 * fit each other are looked at by fmu_model_begin.
 */
bool fmu_model_set(fmu_model *m, fmu_id id, double value, error *e);

/* The settling cycles, with the parameters and the inputs' first values. The simulator's clock then shows start_s. */
bool fmu_model_begin(fmu_model *m, double start_s, error *e);

/* Whether the simulator's time t_s is near enough for one step. */
bool fmu_model_reaches(const fmu_model *m, double t_s);

/* To the simulator's time t_s, not before the present one. False with *e set if the firmware stopped the drive. */
bool fmu_model_advance(fmu_model *m, double t_s, error *e);

#endif
