/*
 * The one study of the induction machine: the errors of each method over its speed (induction_table.h), which
 * `iqfoc sweep --induction` prints.
 */
#ifndef SIM_HOST_INDUCTION_INDUCTION_STUDY_H
#define SIM_HOST_INDUCTION_INDUCTION_STUDY_H

#include "base/error.h"

/* Prints the table, and writes it as JSON if json_path is not NULL; "-" is standard output, without the table. */
bool induction_study(const char *json_path, error *e);

#endif
