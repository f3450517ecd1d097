/* The recorder over the cycles of a run, with the line that it sends to; and a recording of its stream. */
#include "iqfoc/recorder.h"

#include "drive/firmware_host.h"
#include "handles.h"
#include "record_rows.h"
#include "tuned_firmware.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.283185307179586

enum { COLUMNS = 22 /* numbers of the wire, 0 unused */ };

static const char *const column_name[COLUMNS] = {[IQFOC_RECORDER_I_A] = "i_a_A",
                                                 [IQFOC_RECORDER_I_B] = "i_b_A",
                                                 [IQFOC_RECORDER_I_C] = "i_c_A",
                                                 [IQFOC_RECORDER_THETA_E] = "theta_e_rad",
                                                 [IQFOC_RECORDER_OMEGA_E] = "omega_e_rad_s",
                                                 [IQFOC_RECORDER_D_A] = "d_a",
                                                 [IQFOC_RECORDER_D_B] = "d_b",
                                                 [IQFOC_RECORDER_D_C] = "d_c",
                                                 [IQFOC_RECORDER_U_DC] = "u_dc_V",
                                                 [IQFOC_RECORDER_I_MID_A] = "i_a_mid_A",
                                                 [IQFOC_RECORDER_I_MID_B] = "i_b_mid_A",
                                                 [IQFOC_RECORDER_I_MID_C] = "i_c_mid_A"};

struct py_recorder {
    per_unit base;
    iqfoc_recorder_config_t config;
    iqfoc_recorder_t recorder;
    int32_t *memory;
    int32_t value[COLUMNS]; /* of the present cycle: the channels' sources */
    uint32_t octets_per_cycle;
    uint8_t *stream;
    size_t octets, capacity;
    bool cut; /* no memory for more octets */
};

uint32_t py_recorder_column(const char *name)
{
    for (uint32_t k = 1; k < COLUMNS; k++) {
        if (column_name[k] != NULL && strcmp(column_name[k], name) == 0) {
            return k;
        }
    }
    return 0;
}

uint32_t py_status_bit(const char *name)
{
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        char text[160];
        if (strcmp(drive_status_text(bit, text, sizeof text), name) == 0) {
            return bit;
        }
    }
    return strcmp(name, "ALARM") == 0 ? TUNED_FIRMWARE_ALARM : 0;
}

/* Host units of 1.0 of a column. */
static double unit_of(const per_unit *base, uint32_t column)
{
    switch (column) {
    case IQFOC_RECORDER_THETA_E:
        return TWO_PI;
    case IQFOC_RECORDER_OMEGA_E:
        return TWO_PI / base->T_s;
    case IQFOC_RECORDER_U_DC:
        return base->U_V;
    case IQFOC_RECORDER_D_A:
    case IQFOC_RECORDER_D_B:
    case IQFOC_RECORDER_D_C:
        return 1.0;
    default:
        return base->I_A;
    }
}

/* x as mantissa / 2^shift, below 2^31 and with all of its bits. */
static void split(double x, uint32_t *mantissa, uint32_t *shift)
{
    int exponent;
    (void)frexp(x, &exponent);
    *shift = (uint32_t)(exponent < 31 ? 31 - exponent : 0);
    *mantissa = (uint32_t)fmin(nearbyint(ldexp(x, (int)*shift)), 2147483647.0);
}

static bool configure(py_recorder *r, const py_recorder_choice *choice, error *e)
{
    iqfoc_recorder_config_t *c = &r->config;
    *c = (iqfoc_recorder_config_t){.channel_count = (uint32_t)choice->columns,
                                   .decimation = choice->decimation,
                                   .trigger = (iqfoc_recorder_trigger_t)choice->trigger,
                                   .status_bits = choice->status_bits,
                                   .channel = choice->trigger_column,
                                   .pre_share = iq24_from_double(choice->pre_share)};
    split(r->base.T_s, &c->period_mantissa, &c->period_shift);
    for (size_t k = 0; k < choice->columns; k++) {
        const uint32_t column = choice->column[k];
        uint32_t mantissa, shift;
        split(unit_of(&r->base, column), &mantissa, &shift);
        c->channels[k] = (iqfoc_recorder_channel_t){&r->value[column], column, (int32_t)mantissa, shift + 24};
    }
    c->level = iq24_from_double(choice->level / unit_of(&r->base, choice->column[c->channel]));
    const uint32_t words = choice->rows * (c->channel_count + 1);
    r->memory = calloc(words, sizeof *r->memory);
    if (r->memory == NULL) {
        return error_failure(e, 0, "out of memory for %u rows", (unsigned)choice->rows);
    }
    const iqfoc_error_t refused = iqfoc_recorder_init(&r->recorder, c, r->memory, words);
    return refused == IQFOC_OK ||
           error_failure(e, 0, "the library refused the recorder's configuration: iqfoc_error_t %d",
                         (int)refused);
}

py_recorder *py_recorder_new(const motor *m, const py_recorder_choice *choice, error *e)
{
    py_recorder *r = calloc(1, sizeof *r);
    if (r == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    r->base = per_unit_of(m);
    r->octets_per_cycle = choice->octets_per_cycle;
    if (!configure(r, choice, e)) {
        py_recorder_free(r);
        return NULL;
    }
    iqfoc_recorder_arm(&r->recorder);
    return r;
}

void py_recorder_free(py_recorder *r)
{
    if (r != NULL) {
        free(r->memory);
        free(r->stream);
        free(r);
    }
}

static bool room(py_recorder *r)
{
    if (r->octets == r->capacity) {
        const size_t more = r->capacity == 0 ? 65536 : 2 * r->capacity;
        uint8_t *grown = realloc(r->stream, more);
        r->cut = grown == NULL;
        if (grown == NULL) {
            return false;
        }
        r->stream = grown;
        r->capacity = more;
    }
    return true;
}

/* At most `most` octets; 0: all that wait. */
static void send(py_recorder *r, uint32_t most)
{
    int32_t octet;
    for (uint32_t n = 0; (most == 0 || n < most) && room(r); n++) {
        octet = iqfoc_recorder_octet(&r->recorder);
        if (octet < 0) {
            return;
        }
        r->stream[r->octets++] = (uint8_t)octet;
    }
}

void py_recorder_take(py_recorder *r, const drive_row *row, const plant_sensors *sensors)
{
    const iqfoc_sample_t valley = hal_host_sample(&row->valley, sensors, &r->base, 0);
    const iqfoc_sample_t peak = hal_host_sample(&row->peak, sensors, &r->base, IQ24(0.5));
    int32_t *v = r->value;
    v[IQFOC_RECORDER_I_A] = valley.i.a;
    v[IQFOC_RECORDER_I_B] = valley.i.b;
    v[IQFOC_RECORDER_I_C] = valley.i.c;
    v[IQFOC_RECORDER_THETA_E] = valley.theta;
    v[IQFOC_RECORDER_OMEGA_E] = valley.speed;
    v[IQFOC_RECORDER_U_DC] = valley.u_dc;
    v[IQFOC_RECORDER_I_MID_A] = peak.i.a;
    v[IQFOC_RECORDER_I_MID_B] = peak.i.b;
    v[IQFOC_RECORDER_I_MID_C] = peak.i.c;
    for (int x = 0; x < 3; x++) {
        v[(int)IQFOC_RECORDER_D_A + x] = iq24_from_double(row->duty[x]);
    }
    iqfoc_recorder_take(&r->recorder, row->answer.status);
    send(r, r->octets_per_cycle);
}

void py_recorder_arm(py_recorder *r)
{
    iqfoc_recorder_arm(&r->recorder);
}

void py_recorder_stop(py_recorder *r)
{
    iqfoc_recorder_stop(&r->recorder);
    send(r, 0);
}

bool py_recorder_finished(const py_recorder *r)
{
    return iqfoc_recorder_finished(&r->recorder);
}

uint32_t py_recorder_lost(const py_recorder *r)
{
    return r->recorder.lost;
}

const uint8_t *py_recorder_stream(const py_recorder *r, size_t *count)
{
    *count = r->octets;
    return r->cut ? NULL : r->stream;
}

recording *py_recording_stream(const char *label, const uint8_t *octets, size_t count, char *note,
                               size_t size, error *e)
{
    record_rows rows = {.run = 0};
    wire_reader *reader = calloc(1, sizeof *reader);
    if (reader == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    bool ok = wire_read(reader, octets, count, record_rows_take, &rows);
    wire_close(reader);
    const wire_counts *c = &reader->counts;
    if (!ok) {
        *e = rows.e;
    } else if (reader->version != 0) {
        ok = error_input(e, label, 0, 0, "the stream has format version %u; expected version 1",
                         (unsigned)reader->version);
    } else if (rows.recording.rows == 0) {
        ok = error_input(e, label, 0, 0, "no row received: %lu frames, %lu damaged, %lu lost", c->frames,
                         c->damaged, c->lost_frames);
    } else {
        ok = recording_find_stretches(&rows.recording) || error_failure(e, 0, "out of memory");
    }
    snprintf(note, size,
             "%lu frames, %lu damaged, %lu lost; %lu rows lost on the target, %lu missing in all%s",
             c->frames, c->damaged, c->lost_frames, c->lost_rows, c->missing_rows,
             reader->ended ? "" : "; no end frame");
    free(reader);
    return py_recording_keep(&rows.recording, label, ok, e);
}
