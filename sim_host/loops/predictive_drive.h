/*
 * Firmware with a predictive current controller behind the same calls as the control cycle: deadbeat or
 * finite control set, each with any of the three predictors. All that runs at valley and peak is the
 * library's fixed point.
 */
#ifndef SIM_HOST_LOOPS_PREDICTIVE_DRIVE_H
#define SIM_HOST_LOOPS_PREDICTIVE_DRIVE_H

#include "drive/firmware.h"

#include "data/motor.h"

#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/extension.h"
#include "iqfoc/finite_set.h"
#include "iqfoc/predictor.h"

typedef enum predictor_kind { PREDICTOR_EULER, PREDICTOR_QUASI_DISCRETE, PREDICTOR_EXACT } predictor_kind;

const char *predictor_kind_text(predictor_kind kind);

typedef struct predictive_drive {
    predictor_kind kind;
    int32_t horizon; /* 0: deadbeat with PWM; 1 ... 3: finite control set */
    iq24_t weight;   /* of a leg's switching, finite control set only */
    iq24_t learning; /* gain of the drift; 0: plain deadbeat */
    iqfoc_deadbeat_drift_t drift;
    bool extended; /* the corrections below are made */
    iqfoc_extension_t extension;
    iqfoc_predictor_t predictor; /* these two at zero current */
    iqfoc_exact_winding_t winding;
    iqfoc_exact_law_t law; /* at the inductance that the current leaves */
    iq24_t k_psi;
    iqfoc_dq_t i_ref;
    iqfoc_ab_t u_now, u_next; /* of the cycle that runs and of the next */
    int32_t state;            /* finite set: of the next */
    iqfoc_command_t command;
    uint32_t nodes; /* predicted currents in all */
    uint32_t decisions;
} predictive_drive;

/* assumed: the motor as the firmware believes it to be. False where it does not fit the library's ranges. */
bool predictive_drive_init(predictive_drive *p, const motor *assumed, predictor_kind kind, error *e);

/* For deadbeat only, what the file's extensions put right: samples, dead time, the exact predictor's L. */
bool predictive_drive_extend(predictive_drive *p, const motor *assumed, error *e);

drive_firmware predictive_drive_firmware(predictive_drive *p);

#endif
