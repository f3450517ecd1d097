/* Patterns as JSON, as text, and as the firmware's table (patterns.h). */
#include "patterns.h"

#include "patterns_table.h"

#include "base/out_file.h"
#include "base/text_out.h"
#include "base/vector.h"

#include <math.h>

static const double DEGREES = 360.0 / VEC_TWO_PI;

static json_t *angles_json(const pattern_shape *s)
{
    json_t *all = json_array();
    for (int k = 0; k < s->angles && all != NULL; k++) {
        all = json_appended(all, json_real(s->angle[k] * DEGREES));
    }
    return all;
}

static json_t *rows_json(const patterns_result *r)
{
    json_t *all = json_array();
    for (int n = 0; n < r->rows && all != NULL; n++) {
        const patterns_row *row = &r->row[n];
        const double f_Hz = r->asked.six_step_Hz * patterns_index(n);
        json_t *one =
            json_pack("{s:f, s:o, s:i, s:b, s:f, s:o, s:o}", "index", patterns_index(n), "frequency_Hz",
                      json_number(f_Hz > 0.0 ? f_Hz : NAN), "start", row->shape.start, "joined", row->joined,
                      "distortion", row->distortion, "space_vectors", json_number(row->space_vectors),
                      "angles_deg", angles_json(&row->shape));
        all = json_appended(all, one);
    }
    return all;
}

static json_t *patterns_of(const patterns_result *r, size_t count)
{
    json_t *all = json_array();
    for (size_t n = 0; n < count && all != NULL; n++) {
        json_t *one = json_pack("{s:i, s:i, s:f, s:o}", "pulses", r[n].asked.pulses, "jumps", r[n].jumps,
                                "index_error", r[n].index_error, "rows", rows_json(&r[n]));
        all = json_appended(all, one);
    }
    return all;
}

json_t *patterns_json(const patterns_result *r, size_t count)
{
    const patterns_request *a = &r->asked;
    return json_pack("{s:i, s:o, s:s, s:f, s:f, s:f, s:o}", "schema", 1, "motor",
                     a->m != NULL ? json_string(a->m->name) : json_null(), "distortion_of",
                     a->m != NULL ? "rated current" : "fundamental flux", "load_angle_deg",
                     r->load_angle_rad * DEGREES, "on_time_s", a->on_time_s, "dead_time_s", a->dead_time_s,
                     "patterns", patterns_of(r, count));
}

static void print_row(const patterns_result *r, int n, FILE *out)
{
    const patterns_row *row = &r->row[n];
    fprintf(out, "  %-8.2f", patterns_index(n));
    if (r->asked.six_step_Hz > 0.0) {
        fprintf(out, "%8.4g", r->asked.six_step_Hz * patterns_index(n));
    }
    fprintf(out, "%10.2f", 100.0 * row->distortion);
    if (isnan(row->space_vectors)) {
        fprintf(out, "%15s", "-");
    } else {
        fprintf(out, "%15.2f", 100.0 * row->space_vectors);
    }
    fprintf(out, "%7s ", row->shape.start > 0 ? "+" : "-");
    for (int k = 0; k < row->shape.angles; k++) {
        fprintf(out, "%8.2f", row->shape.angle[k] * DEGREES);
    }
    fputc('\n', out);
}

static void print_one(const patterns_result *r, FILE *out)
{
    const motor *m = r->asked.m;
    const int last = r->rows - 1;
    fprintf(out, "%s%s%d pulses a turn, index 0.30 to %.2f of six-step\n", m != NULL ? m->name : "",
            m != NULL ? ": " : "", r->asked.pulses, patterns_index(last));
    fprintf(out, "  distortion in %% of the %s\n\n", m != NULL ? "rated current" : "fundamental flux");
    fprintf(out, "  %-8s%s%10s%15s%7s   angles, degrees\n", "index",
            r->asked.six_step_Hz > 0.0 ? "      Hz" : "", "pattern", "space vectors", "start");
    for (int n = 0; n < last; n += 10) {
        print_row(r, n, out);
    }
    print_row(r, last, out);
    fprintf(out, "\n  jumps of the angles: %d%s", r->jumps, r->jumps > 0 ? ", above index" : "");
    for (int n = 0; n < last; n++) {
        if (!r->row[n].joined) {
            fprintf(out, " %.2f", patterns_index(n));
        }
    }
    fprintf(out, "\n  interpolation between the other rows: index error %.2g at most\n", r->index_error);
}

void patterns_print(const patterns_result *r, size_t count, FILE *out)
{
    for (size_t n = 0; n < count; n++) {
        fputs(n > 0 ? "\n" : "", out);
        print_one(&r[n], out);
    }
}

static void put_table(const patterns_result *r, FILE *out)
{
    const int pulses = r->asked.pulses;
    iqfoc_pattern_row_t row[PATTERNS_ROWS];
    iqfoc_pattern_t table;
    patterns_table(r, row, &table);
    fprintf(out, "\nstatic const iqfoc_pattern_row_t iqfoc_pattern_%d_rows[%d] = {\n", pulses, r->rows);
    for (int n = 0; n < r->rows; n++) {
        fprintf(out, "    {%d, %d, {", (int)row[n].start, (int)row[n].joined);
        for (int k = 0; k < table.angles; k++) {
            fprintf(out, "%s%ld", k > 0 ? ", " : "", (long)row[n].angle[k]);
        }
        fprintf(out, "}}, /* %.2f */\n", patterns_index(n));
    }
    fprintf(
        out,
        "};\n\nstatic const iqfoc_pattern_t iqfoc_pattern_%d = {iqfoc_pattern_%d_rows, %d, %d, %ld, %ld};\n",
        pulses, pulses, (int)table.rows, (int)table.angles, (long)table.index_low,
        (long)table.rows_per_index);
}

bool patterns_header(const patterns_result *r, size_t count, const char *directory, error *e)
{
    char path[1100];
    out_file f;
    (void)snprintf(path, sizeof path, "%s/iqfoc_pattern.h", directory);
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    fputs("/*\n * Written by iqfoc patterns", out);
    if (r->asked.m != NULL) {
        fputs(" for ", out);
        text_out_comment(out, r->asked.m->name);
    }
    fputs(": optimal pulse patterns for iqfoc/pattern.h, which says what the numbers\n"
          " * are. iqfoc_pattern_N has N pulses a turn.\n */\n"
          "#ifndef IQFOC_PATTERN_TABLES_H\n#define IQFOC_PATTERN_TABLES_H\n\n#include \"iqfoc/pattern.h\"\n",
          out);
    for (size_t n = 0; n < count; n++) {
        put_table(&r[n], out);
    }
    fputs("\n#endif\n", out);
    return out_file_commit(&f, e);
}
