/* The writer: a row is built in memory from shortest round-trip texts (number.h) and written at once. */
#include "recording.h"

#include "../base/number.h"
#include "../base/out_file.h"
#include "recording_columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* i_c is left out if it was not measured, so that no reader of the file takes it for a third sensor. */
static bool is_written(const recording *r, column_id id, const double *column)
{
    return id == COL_RUN ? r->run != NULL : column != NULL && (id != COL_I_C || r->i_c_measured);
}

static void put_header(FILE *out, const column_id *ids, size_t count, const char *comment,
                       const pwm_updates *pwm)
{
    while (comment != NULL && *comment != '\0') {
        const size_t length = strcspn(comment, "\n");
        fprintf(out, "# %.*s\n", (int)length, comment);
        comment += length + (comment[length] == '\n' ? 1 : 0);
    }
    char pwm_lines[200] = "";
    if (pwm != NULL) {
        pwm_updates_comment(pwm, pwm_lines, sizeof pwm_lines);
    }
    for (const char *line = pwm_lines; *line != '\0';) {
        const size_t length = strcspn(line, "\n") + 1;
        fprintf(out, "# %.*s", (int)length, line);
        line += length;
    }
    for (size_t c = 0; c < count; c++) {
        fprintf(out, "%s%s", c == 0 ? "" : ",", recording_column_name(ids[c]));
    }
    fputc('\n', out);
}

static void put_row(FILE *out, const recording *r, size_t k, const column_id *ids, double *const *columns,
                    size_t count)
{
    char row[COL_COUNT * NUMBER_TEXT_SIZE];
    size_t length = 0;
    for (size_t c = 0; c < count; c++) {
        if (ids[c] == COL_RUN) {
            length += (size_t)snprintf(row + length, NUMBER_TEXT_SIZE, "%ld", r->run[k]);
        } else {
            length += number_text(columns[c][k], row + length);
        }
        row[length++] = c + 1 < count ? ',' : '\n';
    }
    fwrite(row, 1, length, out);
}

/* What no recording may hold is not written either, wherever it comes from: scales of a map, sensors of a scenario. */
static bool check_values(const recording *r, const column_id *ids, double *const *columns, size_t count,
                         const char *path, error *e)
{
    for (size_t c = 0; c < count; c++) {
        const double most = recording_column_most(ids[c]);
        for (size_t k = 0; ids[c] != COL_RUN && k < r->rows; k++) {
            const double x = columns[c][k];
            if (!(fabs(x) <= most)) {
                return error_input(e, path, 0, 0,
                                   "not written: %s in row %zu is %s; expected a number from %g to %g",
                                   recording_column_name(ids[c]), k + 1,
                                   isfinite(x) ? "absurd" : "no finite number", -most, most);
            }
        }
    }
    return true;
}

bool recording_write(const char *path, const recording *r, const char *comment, error *e)
{
    recording columns_of = *r; /* a copy, as recording_column wants a struct that it may change */
    column_id ids[COL_COUNT];
    double *columns[COL_COUNT];
    size_t count = 0;
    for (int id = 0; id < COL_COUNT; id++) {
        double **place = recording_column(&columns_of, (column_id)id);
        double *column = place != NULL ? *place : NULL;
        if (is_written(r, (column_id)id, column)) {
            ids[count] = (column_id)id;
            columns[count++] = column;
        }
    }

    out_file f;
    if (!check_values(r, ids, columns, count, path, e) || !out_file_open(&f, path, e)) {
        return false;
    }
    put_header(f.stream, ids, count, comment, r->pwm_stated ? &r->pwm : NULL);
    for (size_t k = 0; k < r->rows; k++) {
        put_row(f.stream, r, k, ids, columns, count);
    }
    return out_file_commit(&f, e);
}
