/*
 * The scope of a board: the recorder's octets as they come, in an instance of its own that keeps what it knows of the line from one
 * call to the next.
 */
#include "page.h"

#include "record/wire_reader.h"

#include <stdio.h>

enum { OCTETS_AT_ONCE = 4096 };

static uint8_t octets[OCTETS_AT_ONCE];
static wire_reader reader;

/* By the wire's numbers (iqfoc/recorder.h), 0 unused. */
static const char *const column_names[] = {NULL,          "i_a_A",         "i_b_A",
                                           "i_c_A",       "i_alpha_A",     "i_beta_A",
                                           "theta_e_rad", "omega_e_rad_s", "u_a_V",
                                           "u_b_V",       "u_c_V",         "u_alpha_V",
                                           "u_beta_V",    "d_a",           "d_b",
                                           "d_c",         "u_dc_V",        "i_mid_a_A",
                                           "i_mid_b_A",   "i_mid_c_A",     "theta_mech_rad",
                                           "temp_C"};

enum { COLUMN_NAMES = sizeof column_names / sizeof *column_names };

__attribute__((export_name("page_live_octets"))) uint8_t *page_live_octets(void)
{
    return octets;
}

/* A row: whether it follows the one before, its cycle, its values. */
static bool take(void *context, const wire_header *header, const wire_row *row)
{
    json_t *values = json_array();
    json_array_append_new(values, json_number(row->after_gap ? 0.0 : 1.0));
    json_array_append_new(values, json_number((double)row->cycle));
    for (size_t k = 0; k < header->channels; k++) {
        json_array_append_new(values, json_number((double)row->value[k] * header->channel[k].scale));
    }
    json_array_append_new(context, values);
    return true;
}

static json_t *columns_of(const wire_header *header)
{
    json_t *names = json_array();
    for (size_t k = 0; k < header->channels; k++) {
        const uint32_t column = header->channel[k].column;
        json_array_append_new(
            names, json_string(column > 0 && column < COLUMN_NAMES ? column_names[column] : "unknown"));
    }
    return names;
}

/*
 * So many octets at page_live_octets: {"cycle_s", "row_s", "columns", "rows", "frames", "damaged", "lost", "missing", "ended"}. The last rows of
 * one stream and the first of the next may come together; the header is then the next one's.
 */
PAGE_CALL(page_live_take)(int count)
{
    error e = {0};
    json_t *rows = json_array();
    (void)wire_read(&reader, octets, count > 0 ? (size_t)count : 0, take, rows);
    const bool ok = reader.version == 0 ||
                    error_input(&e, NULL, 0, 0, "the stream has format version %u; expected version 1",
                                (unsigned)reader.version);
    const wire_counts *c = &reader.counts;
    return page_answer(ok,
                       json_pack("{s:f, s:f, s:o, s:o, s:I, s:I, s:I, s:I, s:b}", "cycle_s",
                                 reader.header.T_s, "row_s", reader.header.T_s * reader.header.decimation,
                                 "columns", columns_of(&reader.header), "rows", rows, "frames",
                                 (json_int_t)c->frames, "damaged", (json_int_t)c->damaged, "lost",
                                 (json_int_t)c->lost_frames, "missing", (json_int_t)c->missing_rows, "ended",
                                 reader.ended ? 1 : 0),
                       &e);
}
