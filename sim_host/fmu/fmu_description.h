/* Writes modelDescription.xml: variables, units and start values, read by a simulator before loading. */
#ifndef SIM_HOST_FMU_FMU_DESCRIPTION_H
#define SIM_HOST_FMU_FMU_DESCRIPTION_H

#include "fmu_model.h"

#include <stdio.h>

/* The name of the binary, without its ending. */
#define FMU_IDENTIFIER "iqfoc"

/* m: loaded; start values are its. */
void fmu_description_write(FILE *out, const fmu_model *m);

#endif
