/*
 * Finds and corrects a speed column that is filtered or lags the angle (model/late_speed.h). The columns show that without a fit. An
 * angle delay by part of a cycle looks the same, so only a lag of at least 1.5 cycles is named.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_SPEED_LAG_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_SPEED_LAG_H

#include "rows.h"

/*
 * Corrects the rows' speeds by the lag that the motor file has and, with `search`, by the one that the columns show. False: out of
 * memory.
 */
bool speed_lag_correct(diagnose_rows *r, const motor *file, bool search);

#endif
