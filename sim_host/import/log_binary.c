/* Packed binary rows (log_binary.h). */
#include "log_binary.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

const char *const binary_kind_words[BINARY_KINDS] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
static const size_t kind_bytes[BINARY_KINDS] = {1, 1, 2, 2, 4, 4, 4, 8};

enum {
    SLIP_END = 0xC0,
    SLIP_ESC = 0xDB,
    SLIP_ESC_END = 0xDC,
    SLIP_ESC_ESC = 0xDD,
    ROW_MOST = 8 * BINARY_FIELDS_MOST
};

typedef struct binary_reader {
    const binary_format *format;
    const char *path;
    error *e;
    size_t row_bytes;
    unsigned char row[ROW_MOST + 1];
    size_t length; /* of the row so far; ROW_MOST + 1: longer */
    bool escaped;
    uint64_t offset, row_at; /* bytes from the log's start: now, and where the row began */
    size_t frames;           /* that have ended */
    uint64_t wrong_at;       /* the first frame of another length, if there is one, and its length */
    size_t wrong_length, wrong_frame;
    size_t rows, room;
    double *value[BINARY_FIELDS_MOST];
} binary_reader;

static double number_of(const unsigned char *bytes, binary_kind kind, bool big_endian)
{
    const size_t n = kind_bytes[kind];
    uint64_t raw = 0;
    for (size_t k = 0; k < n; k++) {
        raw |= (uint64_t)bytes[big_endian ? n - 1 - k : k] << (8 * k);
    }
    const uint64_t half = n > 0 ? UINT64_C(1) << (8 * n - 1) : 0;
    switch (kind) {
    case BINARY_I8:
    case BINARY_I16:
    case BINARY_I32:
        return raw < half ? (double)raw : -(double)(2 * half - raw);
    case BINARY_F32: {
        const uint32_t low = (uint32_t)raw;
        float f;
        memcpy(&f, &low, sizeof f);
        return (double)f;
    }
    case BINARY_F64: {
        double f;
        memcpy(&f, &raw, sizeof f);
        return f;
    }
    default:
        return (double)raw;
    }
}

static bool make_room(binary_reader *r)
{
    if (r->rows < r->room) {
        return true;
    }
    const size_t room = 2 * r->room + 1024;
    for (size_t n = 0; n < r->format->fields; n++) {
        double *longer = realloc(r->value[n], room * sizeof *longer);
        if (longer == NULL) {
            return error_failure(r->e, 0, "%s: out of memory", r->path);
        }
        r->value[n] = longer;
    }
    r->room = room;
    return true;
}

static bool take_row(binary_reader *r)
{
    const unsigned char *bytes = r->row;
    if (!make_room(r)) {
        return false;
    }
    for (size_t n = 0; n < r->format->fields; n++) {
        const double value = number_of(bytes, r->format->field[n].kind, r->format->big_endian);
        if (!isfinite(value)) {
            return error_input(r->e, r->path, 0, 0, "row %zu at byte %llu: %s is not a finite number",
                               r->rows + 1, (unsigned long long)r->row_at, r->format->field[n].name);
        }
        r->value[n][r->rows] = value;
        bytes += kind_bytes[r->format->field[n].kind];
    }
    r->rows++;
    return true;
}

static bool refuse_frame(binary_reader *r)
{
    return error_input(
        r->e, r->path, 0, 0, "frame %zu at byte %llu has %s%zu bytes, expected %zu (the fields of [format])",
        r->wrong_frame, (unsigned long long)r->wrong_at, r->wrong_length > ROW_MOST ? "more than " : "",
        r->wrong_length > ROW_MOST ? (size_t)ROW_MOST : r->wrong_length, r->row_bytes);
}

/* A frame is whole. One of another length may only be the first. */
static bool end_frame(binary_reader *r)
{
    const size_t length = r->length;
    r->length = 0;
    if (length == 0) {
        return true;
    }
    r->frames++;
    if (length == r->row_bytes) {
        return take_row(r);
    }
    r->wrong_at = r->row_at;
    r->wrong_length = length;
    r->wrong_frame = r->frames;
    return r->frames == 1 || refuse_frame(r);
}

static void put(binary_reader *r, unsigned char byte)
{
    if (r->length == 0) {
        r->row_at = r->offset;
    }
    if (r->length <= ROW_MOST) {
        r->row[r->length < ROW_MOST ? r->length : ROW_MOST] = byte;
        r->length++;
    }
}

static bool take_slip(binary_reader *r, unsigned char byte)
{
    if (byte == SLIP_END) {
        r->escaped = false;
        return end_frame(r);
    }
    if (r->escaped) {
        r->escaped = false;
        put(r, byte == SLIP_ESC_END ? SLIP_END : (byte == SLIP_ESC_ESC ? SLIP_ESC : byte));
        return byte == SLIP_ESC_END || byte == SLIP_ESC_ESC || r->frames == 0 ||
               error_input(r->e, r->path, 0, 0,
                           "byte %llu: 0x%02X after 0xDB, expected 0xDC or 0xDD; is the log framed by SLIP?",
                           (unsigned long long)r->offset, byte);
    }
    if (byte == SLIP_ESC) {
        r->escaped = true;
        return true;
    }
    put(r, byte);
    return true;
}

static bool take_fixed(binary_reader *r, unsigned char byte)
{
    put(r, byte);
    return r->length < r->row_bytes || end_frame(r);
}

static bool read_rows(binary_reader *r)
{
    line_source s;
    char *bytes = NULL;
    size_t count = 0;
    bool ok = line_source_open(&s, r->path, r->e);
    while (ok && line_source_block(&s, &bytes, &count, r->e)) {
        for (size_t k = 0; ok && k < count; k++) {
            if (r->offset >= (uint64_t)r->format->skip) {
                const unsigned char byte = (unsigned char)bytes[k];
                ok = r->format->slip ? take_slip(r, byte) : take_fixed(r, byte);
            }
            r->offset++;
        }
    }
    line_source_close(&s);
    return ok && r->e->status == STATUS_DONE;
}

bool log_binary_open(log_table *t, const char *path, const binary_format *format, error *e)
{
    *t = (log_table){.path = path};
    binary_reader *r = calloc(1, sizeof *r);
    const char *name[BINARY_FIELDS_MOST];
    const double *value[BINARY_FIELDS_MOST];
    if (r == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    r->format = format;
    r->path = path;
    r->e = e;
    for (size_t n = 0; n < format->fields; n++) {
        r->row_bytes += kind_bytes[format->field[n].kind];
    }
    bool ok = read_rows(r);
    if (ok && r->rows == 0) {
        ok = r->wrong_frame > 0 ? refuse_frame(r)
                                : error_input(e, path, 0, 0, "no row: %llu bytes, and one has %zu",
                                              (unsigned long long)r->offset, r->row_bytes);
    }
    for (size_t n = 0; n < format->fields; n++) {
        name[n] = format->field[n].name;
        value[n] = r->value[n];
    }
    ok = ok && log_table_hold(t, path, format->fields, name, value, r->rows, e);
    for (size_t n = 0; n < format->fields; n++) {
        free(r->value[n]);
    }
    free(r);
    return ok;
}
