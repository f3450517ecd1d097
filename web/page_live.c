/*
 * The scope of a board: the recorder's octets as they come, in an instance of its own that keeps what it knows of the line from one
 * call to the next; and the requests that go to the board.
 */
#include "page.h"

#include "drive/firmware.h"
#include "record/wire_reader.h"
#include "record/wire_request.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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
                                           "temp_C",      "status"};

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

/* The board's last answer to a request; `level` in the column's unit. */
static json_t *answer_of(const wire_reader *r)
{
    const wire_answer *a = &r->answer;
    const iqfoc_recorder_setting_t *s = &a->setting;
    const double scale = s->channel < r->header.channels ? r->header.channel[s->channel].scale : 0.0;
    return json_pack("{s:I, s:I, s:i, s:I, s:i, s:I, s:I, s:f, s:f, s:I}", "count", (json_int_t)r->answers,
                     "stream", (json_int_t)a->stream, "error", (int)a->error, "sequence",
                     (json_int_t)a->sequence, "trigger", (int)s->trigger, "status_bits",
                     (json_int_t)s->status_bits, "channel", (json_int_t)s->channel, "level", s->level * scale,
                     "pre_share", (double)s->pre_share / IQ24_ONE, "decimation", (json_int_t)s->decimation);
}

/* The names of the status bits: [[bit, name] ...]. */
static json_t *status_names(void)
{
    json_t *names = json_array();
    for (uint32_t k = 0; k < 32; k++) {
        char text[64];
        const uint32_t bit = UINT32_C(1) << k;
        if (strcmp(drive_status_text(bit, text, sizeof text), "none") != 0) {
            json_array_append_new(names, json_pack("[I, s]", (json_int_t)bit, text));
        }
    }
    return names;
}

/*
 * So many octets at page_live_octets: {"cycle_s", "row_s", "columns", "rows", "frames", "damaged", "lost", "missing", "ended", "stream",
 * "answer", "status_names"}. The last rows of one stream and the first of the next may come together; the header is then the next one's.
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
                       json_pack("{s:f, s:f, s:o, s:o, s:I, s:I, s:I, s:I, s:b, s:I, s:o, s:o}", "cycle_s",
                                 reader.header.T_s, "row_s", reader.header.T_s * reader.header.decimation,
                                 "columns", columns_of(&reader.header), "rows", rows, "frames",
                                 (json_int_t)c->frames, "damaged", (json_int_t)c->damaged, "lost",
                                 (json_int_t)c->lost_frames, "missing", (json_int_t)c->missing_rows, "ended",
                                 reader.ended ? 1 : 0, "stream", (json_int_t)reader.header.stream, "answer",
                                 answer_of(&reader), "status_names", status_names()),
                       &e);
}

static double within(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/*
 * A request for the board: {"octets": [...]}. trigger: iqfoc_recorder_trigger_t, 4: stop. level: in the unit of the channel, for which
 * the board's header must have come.
 */
PAGE_CALL(page_live_ask)
(int sequence, int trigger, unsigned status_bits, int channel, double level, double pre_share, int decimation)
{
    error e = {0};
    const bool known = trigger == (int)IQFOC_RECORDER_NOW || trigger >= 4 || reader.header_known;
    const bool ok =
        known || error_input(&e, NULL, 0, 0,
                             "no header of the board yet: its columns are not known; start it by \"now\"");
    const size_t at = channel >= 0 && (size_t)channel < reader.header.channels ? (size_t)channel : 0;
    const double scale = reader.header_known ? reader.header.channel[at].scale : 1.0;
    const iqfoc_recorder_setting_t setting = {(iqfoc_recorder_trigger_t)(trigger & 3),
                                              status_bits,
                                              (uint32_t)at,
                                              (int32_t)lround(within(level / scale, INT32_MIN, INT32_MAX)),
                                              (iq24_t)within(pre_share * IQ24_ONE, 0.0, IQ24_ONE - 1.0),
                                              decimation < 1 ? 1 : (uint32_t)decimation};
    uint8_t out[WIRE_REQUEST_MAX];
    const size_t count = wire_request((uint32_t)sequence, trigger >= 4 ? NULL : &setting, out);
    json_t *list = json_array();
    for (size_t k = 0; k < count; k++) {
        json_array_append_new(list, json_number(out[k]));
    }
    return page_answer(ok, json_pack("{s:o}", "octets", list), &e);
}
