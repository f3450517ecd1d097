/* The recorder's line (wire_reader.h). */
#include "wire_reader.h"

#include "wire_crc.h"

#include <math.h>

#define VERSION      1
#define FRAME_HEADER 1
#define FRAME_ROWS   2
#define FRAME_END    3
#define FRAME_ANSWER 5
#define ANSWER_WORDS 10
#define ROWS_MAX     8

static uint32_t word_at(const wire_reader *r, size_t index)
{
    const uint8_t *p = &r->data[4 * index];
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* words: without the CRC. False if it is no valid header after all. */
static bool header_read(wire_reader *r, size_t words)
{
    wire_header h = {.stream = word_at(r, 1), .decimation = word_at(r, 4)};
    const uint32_t period_shift = word_at(r, 3);
    h.channels = word_at(r, 5);
    if (h.channels < 1 || h.channels > IQFOC_RECORDER_CHANNELS_MAX || words != 6 + 3 * h.channels ||
        h.decimation == 0 || word_at(r, 2) == 0 || period_shift > 62) {
        return false;
    }
    h.T_s = ldexp((double)word_at(r, 2), -(int)period_shift);
    for (size_t k = 0; k < h.channels; k++) {
        const uint32_t shift = word_at(r, 6 + 3 * k + 2);
        const double mantissa = (double)(int32_t)word_at(r, 6 + 3 * k + 1);
        if (shift > 62 || mantissa == 0.0) {
            return false;
        }
        h.channel[k].column = word_at(r, 6 + 3 * k);
        h.channel[k].scale = ldexp(mantissa, -(int)shift);
    }
    if (!r->header_known || r->header.stream != h.stream) {
        r->row_known = false;
        r->gap = true;
        r->last_lost = 0;
        r->stream_rows = 0;
        r->stream_missing = 0;
        r->ended = false;
    }
    r->header = h;
    r->header_known = true;
    return true;
}

static void lost_rows_count(wire_reader *r, uint32_t lost)
{
    if (lost > r->last_lost) {
        r->counts.lost_rows += lost - r->last_lost;
        r->last_lost = lost;
    }
}

static void missing_rows_count(wire_reader *r, unsigned long rows)
{
    r->counts.missing_rows += rows;
    r->stream_missing += rows;
}

/* The row before this one is `cycles` earlier: the number of missing rows between them. */
static unsigned long rows_between(const wire_reader *r, uint32_t cycles)
{
    return cycles < r->header.decimation ? 0 : cycles / r->header.decimation - 1;
}

static bool rows_read(wire_reader *r, size_t words, wire_take_row *take, void *context, bool *good)
{
    const uint32_t rows = word_at(r, 3);
    const size_t row_words = r->header.channels + 1;
    if (rows < 1 || rows > ROWS_MAX) {
        return false;
    }
    if (!r->header_known || r->header.stream != word_at(r, 1)) {
        r->counts.headless_rows += rows;
        r->gap = true;
        return true;
    }
    if (words != 4 + rows * row_words) {
        return false;
    }
    lost_rows_count(r, word_at(r, 2));
    for (uint32_t k = 0; k < rows && *good; k++) {
        const size_t first = 4 + k * row_words;
        const uint32_t cycle = word_at(r, first);
        const bool follows = r->row_known && cycle - r->last_cycle == r->header.decimation;
        missing_rows_count(r, r->row_known ? rows_between(r, cycle - r->last_cycle) : 0);
        r->stream_rows++;
        for (size_t c = 0; c < r->header.channels; c++) {
            r->row[c] = (int32_t)word_at(r, first + 1 + c);
        }
        const wire_row row = {cycle, r->row, r->gap || !follows};
        r->gap = false;
        r->row_known = true;
        r->last_cycle = cycle;
        *good = take(context, &r->header, &row);
    }
    return true;
}

/* Number of rows; the missing ones at both ends are not counted yet. */
static void end_read(wire_reader *r)
{
    lost_rows_count(r, word_at(r, 2));
    r->rows_sent = word_at(r, 3);
    const uint64_t taken = (uint64_t)r->rows_sent + word_at(r, 2);
    const uint64_t known = (uint64_t)r->stream_rows + r->stream_missing;
    missing_rows_count(r, taken > known ? (unsigned long)(taken - known) : 0);
    r->ended = true;
}

/* False if the trigger is none. */
static bool answer_read(wire_reader *r)
{
    if (word_at(r, 4) > IQFOC_RECORDER_FALLS) {
        return false;
    }
    const iqfoc_recorder_setting_t setting = {(iqfoc_recorder_trigger_t)word_at(r, 4),
                                              word_at(r, 5),
                                              word_at(r, 6),
                                              (int32_t)word_at(r, 7),
                                              (iq24_t)word_at(r, 8),
                                              word_at(r, 9)};
    r->answer = (wire_answer){word_at(r, 1), (int32_t)word_at(r, 2), word_at(r, 3), setting};
    r->answers++;
    return true;
}

static bool frame_read(wire_reader *r, wire_take_row *take, void *context, bool *good)
{
    if (r->octets < 8 || r->octets % 4 != 0) {
        return false;
    }
    const size_t words = r->octets / 4 - 1;
    if (wire_crc(r->data, 4 * words) != word_at(r, words)) {
        return false;
    }
    const uint32_t first = word_at(r, 0);
    if ((first & 0xFF) != VERSION) {
        r->version = first & 0xFF;
        return true;
    }
    if (r->sequence_known && first >> 16 != r->sequence) {
        r->counts.lost_frames += ((first >> 16) - r->sequence) & 0xFFFF;
        r->gap = true;
    }
    bool whole = false;
    switch (first >> 8 & 0xFF) {
    case FRAME_HEADER:
        whole = words >= 6 && header_read(r, words);
        break;
    case FRAME_ROWS:
        whole = words >= 4 && rows_read(r, words, take, context, good);
        break;
    case FRAME_END:
        whole = words == 4;
        if (whole && r->header_known && r->header.stream == word_at(r, 1)) {
            end_read(r);
        }
        break;
    case FRAME_ANSWER:
        whole = words == ANSWER_WORDS && answer_read(r);
        break;
    default:
        break;
    }
    r->sequence = ((first >> 16) + 1) & 0xFFFF;
    r->sequence_known = true;
    r->counts.frames += whole ? 1 : 0;
    return whole;
}

static void piece_end(wire_reader *r, bool damaged)
{
    r->counts.damaged += damaged ? 1 : 0;
    r->broken = false;
    r->in_escape = false;
    r->octets = 0;
}

/* At a frame mark: what came before it was a frame, or damage, or nothing. */
static bool piece_finish(wire_reader *r, wire_take_row *take, void *context)
{
    bool good = true;
    piece_end(r, r->broken || r->in_escape || (r->octets > 0 && !frame_read(r, take, context, &good)));
    return good;
}

bool wire_read(wire_reader *r, const uint8_t *octets, size_t count, wire_take_row *take, void *context)
{
    for (size_t k = 0; k < count; k++) {
        uint8_t octet = octets[k];
        if (octet == WIRE_END) {
            if (!piece_finish(r, take, context)) {
                return false;
            }
            continue;
        }
        if (octet == WIRE_ESCAPE && !r->in_escape) {
            r->in_escape = true;
            continue;
        }
        if (r->in_escape) {
            r->broken = r->broken || (octet != WIRE_ESCAPE_END && octet != WIRE_ESCAPE_ESC);
            octet = octet == WIRE_ESCAPE_END ? WIRE_END : WIRE_ESCAPE;
            r->in_escape = false;
        }
        if (r->octets == sizeof r->data) {
            r->broken = true;
        } else {
            r->data[r->octets++] = octet;
        }
    }
    return true;
}

void wire_close(wire_reader *r)
{
    piece_end(r, r->broken || r->in_escape || r->octets > 0);
}
