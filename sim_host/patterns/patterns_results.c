/* Patterns as JSON, as text, and as the firmware's table (patterns.h). */
#include "patterns.h"

#include "base/out_file.h"
#include "base/text_out.h"
#include "base/vector.h"

#include <math.h>

static const double DEGREES = 360.0 / VEC_TWO_PI;

static json_t *angles_json(const pattern_shape *s)
{
    json_t *all = json_array();
    for (int k = 0; k < s->angles && all != NULL; k++) {
        if (json_array_append_new(all, json_real(s->angle[k] * DEGREES)) != 0) {
            json_free(all);
            return NULL;
        }
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
        if (json_array_append_new(all, one) != 0) {
            json_free(all);
            return NULL;
        }
    }
    return all;
}

static json_t *patterns_of(const patterns_result *r, size_t count)
{
    json_t *all = json_array();
    for (size_t n = 0; n < count && all != NULL; n++) {
        json_t *one = json_pack("{s:i, s:i, s:f, s:o}", "pulses", r[n].asked.pulses, "jumps", r[n].jumps,
                                "index_error", r[n].index_error, "rows", rows_json(&r[n]));
        if (json_array_append_new(all, one) != 0) {
            json_free(all);
            return NULL;
        }
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

static long iq24(double x)
{
    return lround(x * 16777216.0);
}

static void put_table(const patterns_result *r, FILE *out)
{
    const int pulses = r->asked.pulses;
    const int angles = (pulses - 1) / 2;
    fprintf(out,
            "\nenum {\n    IQFOC_PATTERN_%d_ANGLES = %d,\n    IQFOC_PATTERN_%d_ROWS = %d,\n"
            "    IQFOC_PATTERN_%d_INDEX_LOW = %ld, /* IQ24: row 0 */\n"
            "    IQFOC_PATTERN_%d_INDEX_HIGH = %ld /* IQ24: the last row */\n};\n\n",
            pulses, angles, pulses, r->rows, pulses, iq24(patterns_index(0)), pulses,
            iq24(patterns_index(r->rows - 1)));
    fprintf(out,
            "typedef struct iqfoc_pattern_%d_row {\n"
            "    int32_t start;  /* level of the leg after angle 0: 1 high, -1 low */\n"
            "    int32_t joined; /* 1: interpolate to the next row; 0: the angles jump */\n"
            "    int32_t angle[IQFOC_PATTERN_%d_ANGLES]; /* turns in IQ24, rising, 0 to 1/4 */\n"
            "} iqfoc_pattern_%d_row;\n\n"
            "static const iqfoc_pattern_%d_row iqfoc_pattern_%d[IQFOC_PATTERN_%d_ROWS] = {\n",
            pulses, pulses, pulses, pulses, pulses, pulses);
    for (int n = 0; n < r->rows; n++) {
        const patterns_row *row = &r->row[n];
        fprintf(out, "    {%d, %d, {", row->shape.start, row->joined);
        for (int k = 0; k < angles; k++) {
            fprintf(out, "%s%ld", k > 0 ? ", " : "", iq24(row->shape.angle[k] / VEC_TWO_PI));
        }
        fprintf(out, "}}, /* %.2f */\n", patterns_index(n));
    }
    fputs("};\n", out);
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
    fputs(": optimal pulse patterns. iqfoc_pattern_N has N pulses a turn.\n *\n"
          " * A row has the switching angles of leg a in the first quarter of a turn, at one modulation "
          "index: the\n"
          " * amplitude of the fundamental over that of six-step (2/pi of the DC link). The rows are "
          "evenly spaced.\n"
          " * The level of the leg changes at each angle, at 0 and at 1/2; u(1/2 - x) = u(x), u(1/2 + x) = "
          "-u(x).\n"
          " * The fundamental of the leg is the sine of the angle. Legs b and c are 1/3 and 2/3 of a turn "
          "later.\n */\n"
          "#ifndef IQFOC_PATTERN_H\n#define IQFOC_PATTERN_H\n\n#include <stdint.h>\n",
          out);
    for (size_t n = 0; n < count; n++) {
        put_table(&r[n], out);
    }
    fputs("\n#endif\n", out);
    return out_file_commit(&f, e);
}
