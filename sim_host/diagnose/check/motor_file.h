/*
 * Checks that the fitted values are close enough to the motor file to be of the same motor.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_MOTOR_FILE_H
#define SIM_HOST_DIAGNOSE_CHECK_MOTOR_FILE_H

#include "data/recording.h"
#include "model/averaged_drive.h"

/* False with one line in *e. */
bool check_motor_file(const averaged_drive *fitted, const averaged_drive *file, const recording *rec,
                      error *e);

#endif
