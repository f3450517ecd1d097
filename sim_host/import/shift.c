#include "shift.h"

#include "data/recording_columns.h"

#include <stdlib.h>
#include <string.h>

/* Voltages in the place of duties. */
static bool make_voltages(recording *r)
{
    if (r->u_V[0] == NULL) {
        double *made[3];
        for (int x = 0; x < 3; x++) {
            made[x] = malloc((r->rows + 1) * sizeof(double));
        }
        if (made[0] == NULL || made[1] == NULL || made[2] == NULL) {
            free(made[0]);
            free(made[1]);
            free(made[2]);
            return false;
        }
        for (size_t k = 0; k < r->rows; k++) {
            double u[3];
            recording_voltage(r, k, u);
            for (int x = 0; x < 3; x++) {
                made[x][k] = u[x];
            }
        }
        memcpy(r->u_V, made, sizeof made);
    }
    for (int x = 0; x < 3; x++) {
        free(r->duty[x]);
        r->duty[x] = NULL;
    }
    return true;
}

/* What was measured in row k becomes row `to`. */
static void move_row(recording *r, size_t to, size_t k)
{
    for (int id = 0; id < COL_COUNT; id++) {
        double **column = recording_column(r, (column_id)id);
        const bool is_command = id >= COL_U_A && id <= COL_D_C;
        if (column != NULL && *column != NULL && !is_command) {
            (*column)[to] = (*column)[k];
        }
    }
    r->line[to] = r->line[k];
    if (r->run != NULL) {
        r->run[to] = r->run[k];
    }
}

bool shift_commands(recording *r, long half_cycles)
{
    if (half_cycles == 0) {
        return true;
    }
    const bool is_half = half_cycles % 2 != 0;
    if (is_half && !make_voltages(r)) {
        return false;
    }
    /* Rows back to the nearer and the farther of the two commands. */
    const long far = half_cycles >= 0 ? (half_cycles + 1) / 2 : half_cycles / 2;
    const long near = is_half ? far - 1 : far;
    double *command[6];
    for (int c = 0; c < 6; c++) {
        double **from = c < 3 ? &r->u_V[c] : &r->duty[c - 3];
        command[c] = *from;
        *from = command[c] != NULL ? malloc((r->rows + 1) * sizeof(double)) : NULL;
        if (command[c] != NULL && *from == NULL) {
            *from = command[c];
            for (int d = 0; d < c; d++) {
                free(command[d]);
            }
            return false;
        }
    }
    size_t to = 0;
    for (size_t s = 0; s < r->stretches; s++) {
        const long count = (long)r->stretch[s].count;
        for (long j = 0; j < count; j++) {
            if (j - far < 0 || j - near < 0 || j - far >= count || j - near >= count) {
                continue;
            }
            const size_t k = r->stretch[s].first + (size_t)j;
            const size_t a = r->stretch[s].first + (size_t)(j - near);
            const size_t b = r->stretch[s].first + (size_t)(j - far);
            for (int c = 0; c < 6; c++) {
                double *out = c < 3 ? r->u_V[c] : r->duty[c - 3];
                if (out != NULL) {
                    out[to] = 0.5 * (command[c][a] + command[c][b]);
                }
            }
            move_row(r, to++, k);
        }
    }
    for (int c = 0; c < 6; c++) {
        free(command[c]);
    }
    r->rows = to;
    return recording_find_stretches(r);
}
