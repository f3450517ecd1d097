/*
 * Firmware with finite-set control, with the same calls as the control cycle. The control cycle has a modulator and
 * no finite-set control. This firmware combines iqfoc/finite_set.h with any of the three predictors, all in IQ24.
 */
#ifndef SIM_HOST_LOOPS_FINITE_SET_DRIVE_H
#define SIM_HOST_LOOPS_FINITE_SET_DRIVE_H

#include "drive/firmware.h"

#include "data/motor.h"

#include "iqfoc/finite_set.h"
#include "iqfoc/methods.h"
#include "iqfoc/predictor.h"

typedef struct finite_set_drive {
    iqfoc_model_t model; /* Euler, quasi-discrete or exact */
    int32_t horizon;     /* 1 ... 3 */
    iq24_t weight;       /* of a leg's switching */
    iqfoc_predictor_t predictor;
    iqfoc_exact_law_t law;
    int32_t state; /* of the next cycle */
    iqfoc_command_t command;
    uint32_t nodes; /* predicted currents in all */
    uint32_t decisions;
} finite_set_drive;

/* assumed: the firmware's motor. False if it does not fit the library's ranges. */
bool finite_set_drive_init(finite_set_drive *p, const motor *assumed, iqfoc_model_t model, error *e);

drive_firmware finite_set_drive_firmware(finite_set_drive *p);

#endif
