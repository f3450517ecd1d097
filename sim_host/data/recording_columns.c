/* Columns by name, by place and by size (recording_columns.h). */
#include "recording_columns.h"

#include <stdlib.h>
#include <string.h>

typedef struct column {
    const char *name;
    size_t offset; /* of the double * within recording */
    double most;   /* beyond this, either sign, it is no such quantity: interfaces.md gives the reasons */
} column;

#define AT(member) offsetof(recording, member)

static const column columns[COL_COUNT] = {
    [COL_RUN] = {"run", AT(run), 2147483647},
    [COL_T] = {"t_s", AT(t_s), 1e16},
    [COL_I_A] = {"i_a_A", AT(i_A[0]), 1e6},
    [COL_I_B] = {"i_b_A", AT(i_A[1]), 1e6},
    [COL_I_C] = {"i_c_A", AT(i_A[2]), 1e6},
    [COL_THETA] = {"theta_e_rad", AT(theta_e_rad), 1e9},
    [COL_OMEGA] = {"omega_e_rad_s", AT(omega_e_rad_s), 1e6},
    [COL_U_A] = {"u_a_V", AT(u_V[0]), 1e6},
    [COL_U_B] = {"u_b_V", AT(u_V[1]), 1e6},
    [COL_U_C] = {"u_c_V", AT(u_V[2]), 1e6},
    [COL_D_A] = {"d_a", AT(duty[0]), 1e6},
    [COL_D_B] = {"d_b", AT(duty[1]), 1e6},
    [COL_D_C] = {"d_c", AT(duty[2]), 1e6},
    [COL_U_DC] = {"u_dc_V", AT(u_dc_V), 1e6},
    [COL_MID_A] = {"i_a_mid_A", AT(i_mid_A[0]), 1e6},
    [COL_MID_B] = {"i_b_mid_A", AT(i_mid_A[1]), 1e6},
    [COL_MID_C] = {"i_c_mid_A", AT(i_mid_A[2]), 1e6},
    [COL_THETA_MECH] = {"theta_mech_rad", AT(theta_mech_rad), 1e9},
    [COL_TEMP] = {"temp_C", AT(temp_C), 1e5},
};

const char *recording_column_name(column_id id)
{
    return columns[id].name;
}

double recording_column_most(column_id id)
{
    return columns[id].most;
}

column_id recording_column_find(const char *name, size_t length)
{
    for (int id = 0; id < COL_COUNT; id++) {
        if (strlen(columns[id].name) == length && memcmp(columns[id].name, name, length) == 0) {
            return (column_id)id;
        }
    }
    return COL_COUNT;
}

double **recording_column(recording *r, column_id id)
{
    return id == COL_RUN ? NULL : (double **)(void *)((char *)r + columns[id].offset);
}

bool recording_columns_grow(recording *r, const bool have[COL_COUNT], size_t rows)
{
    for (int id = COL_RUN + 1; id < COL_COUNT; id++) {
        double **place = recording_column(r, (column_id)id);
        double *grown = have[id] ? realloc(*place, rows * sizeof *grown) : *place;
        if (have[id] && grown == NULL) {
            return false;
        }
        *place = grown;
    }
    long *run = have[COL_RUN] ? realloc(r->run, rows * sizeof *run) : r->run;
    if (have[COL_RUN] && run == NULL) {
        return false;
    }
    r->run = run;
    return true;
}

static bool all_three(const bool have[COL_COUNT], column_id first)
{
    return have[first] && have[first + 1] && have[first + 2];
}

static void drop_three(bool have[COL_COUNT], column_id first)
{
    have[first] = have[first + 1] = have[first + 2] = false;
}

void recording_columns_whole(bool have[COL_COUNT])
{
    if (!all_three(have, COL_U_A)) {
        drop_three(have, COL_U_A);
    }
    if (!all_three(have, COL_D_A) || !have[COL_U_DC]) {
        drop_three(have, COL_D_A);
    }
    if (!have[COL_MID_A] || !have[COL_MID_B]) {
        drop_three(have, COL_MID_A);
    }
}
