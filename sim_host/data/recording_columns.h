/* The columns of a recording by name: one table for the reader and the writer. */
#ifndef SIM_HOST_DATA_RECORDING_COLUMNS_H
#define SIM_HOST_DATA_RECORDING_COLUMNS_H

#include "recording.h"

/* In the order in which they are written. `run` is apart: it holds integers. */
typedef enum column_id {
    COL_RUN,
    COL_T,
    COL_I_A,
    COL_I_B,
    COL_I_C,
    COL_THETA,
    COL_OMEGA,
    COL_U_A,
    COL_U_B,
    COL_U_C,
    COL_D_A,
    COL_D_B,
    COL_D_C,
    COL_U_DC,
    COL_MID_A,
    COL_MID_B,
    COL_MID_C,
    COL_THETA_MECH,
    COL_TEMP,
    COL_COUNT
} column_id;

/* "t_s", "i_a_A" ... */
const char *recording_column_name(column_id id);

/* The largest magnitude that a value of the column may have; and the smallest except 0, the same for all columns. */
double recording_column_most(column_id id);
#define RECORDING_LEAST 1e-100

/* The id of a name of this length, or COL_COUNT. */
column_id recording_column_find(const char *name, size_t length);

/* Where the recording keeps the column; NULL for COL_RUN. */
double **recording_column(recording *r, column_id id);

/* Drops the groups that are not whole where a recording can do without them, or where the other group is. */
void recording_columns_whole(bool have[COL_COUNT]);

/* Room for so many rows in each column that there is to be. False: out of memory; what there was stays. */
bool recording_columns_grow(recording *r, const bool have[COL_COUNT], size_t rows);

#endif
