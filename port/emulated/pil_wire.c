/*
 * Frames of the processor in the loop (pil_wire.h).
 */
#include "pil_wire.h"

#include <string.h>

_Static_assert(sizeof(tuned_firmware_config_t) == PIL_TUNE_WORDS * sizeof(int32_t),
               "words and nothing between them");

/* Number of words of a type; -1 for a type that does not exist. */
static int32_t words_of(uint32_t type)
{
    switch (type) {
    case PIL_START:
        return PIL_CONFIG_WORDS;
    case PIL_CYCLE:
        return 2 + 2 * PIL_SAMPLE_WORDS;
    case PIL_STARTED:
        return 1;
    case PIL_COMMAND:
        return 6;
    case PIL_GARBLED:
    case PIL_ASK:
        return 0;
    case PIL_RECORD:
    case PIL_RECORD_ALARM:
        return 8;
    case PIL_TUNE:
        return PIL_TUNE_WORDS;
    case PIL_WATCHED:
        return 3;
    default:
        return -1;
    }
}

/* IEEE 802.3, four bits at a time. */
static uint32_t crc32_of(const uint8_t *bytes, uint32_t count)
{
    static const uint32_t table[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
        0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
    };
    uint32_t crc = UINT32_MAX;
    for (uint32_t k = 0; k < count; k++) {
        crc ^= bytes[k];
        crc = crc >> 4 ^ table[crc & 15];
        crc = crc >> 4 ^ table[crc & 15];
    }
    return ~crc;
}

static void word_put(uint8_t *bytes, uint32_t word)
{
    for (uint32_t k = 0; k < 4; k++) {
        bytes[k] = (uint8_t)(word >> (8 * k) & 0xFF);
    }
}

static uint32_t word_get(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

uint32_t pil_encode(const pil_frame_t *frame, uint8_t bytes[PIL_FRAME_MAX])
{
    bytes[0] = PIL_SYNC;
    bytes[1] = (uint8_t)frame->type;
    for (uint32_t k = 0; k < frame->words; k++) {
        word_put(&bytes[2 + 4 * k], (uint32_t)frame->data[k]);
    }
    const uint32_t end = 2 + 4 * frame->words;
    word_put(&bytes[end], crc32_of(&bytes[1], end - 1));
    return end + 4;
}

/* What the bytes so far are. */
static pil_decoded_t judge(const pil_decoder_t *decoder)
{
    if (decoder->bytes[0] != PIL_SYNC) {
        return PIL_DAMAGED;
    }
    if (decoder->count < 2) {
        return PIL_MORE;
    }
    const int32_t words = words_of(decoder->bytes[1]);
    if (words < 0) {
        return PIL_DAMAGED;
    }
    const uint32_t end = 2 + 4 * (uint32_t)words;
    if (decoder->count < end + 4) {
        return PIL_MORE;
    }
    return word_get(&decoder->bytes[end]) == crc32_of(&decoder->bytes[1], end - 1) ? PIL_WHOLE : PIL_DAMAGED;
}

pil_decoded_t pil_decode(pil_decoder_t *decoder, uint32_t byte, pil_frame_t *frame)
{
    decoder->bytes[decoder->count++] = (uint8_t)byte;
    const pil_decoded_t decoded = judge(decoder);
    if (decoded == PIL_MORE) {
        return PIL_MORE;
    }
    /* What was no frame is passed over: the next byte is looked at as if it began one. */
    decoder->count = 0;
    if (decoded == PIL_DAMAGED) {
        return PIL_DAMAGED;
    }
    frame->type = decoder->bytes[1];
    frame->words = (uint32_t)words_of(frame->type);
    for (uint32_t k = 0; k < frame->words; k++) {
        frame->data[k] = (int32_t)word_get(&decoder->bytes[2 + 4 * k]);
    }
    return PIL_WHOLE;
}

pil_frame_t pil_record_frame(uint32_t type, const pil_bases_t *b)
{
    const pil_frame_t frame = {type,
                               8,
                               {b->T_mantissa, b->T_shift, b->I_mantissa, b->I_shift, b->U_mantissa,
                                b->U_shift, b->omega_mantissa, b->omega_shift}};
    return frame;
}

void pil_record_read(const pil_frame_t *frame, pil_bases_t *bases)
{
    const int32_t *d = frame->data;
    const pil_bases_t read = {d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7]};
    *bases = read;
}

pil_frame_t pil_start_frame(const iqfoc_cycle_config_t *c)
{
    const pil_frame_t frame = {PIL_START,
                               PIL_CONFIG_WORDS,
                               {c->predictor.k_u,
                                c->predictor.k_r,
                                c->predictor.k_psi,
                                c->gains.kp_d,
                                c->gains.kp_q,
                                c->gains.ki_d,
                                c->gains.ki_q,
                                c->gains.anti_windup,
                                c->gains.x_d,
                                c->gains.x_q,
                                c->gains.emf,
                                (int32_t)c->feedback,
                                (int32_t)c->modulation,
                                (int32_t)c->safe_state,
                                c->span_max,
                                c->current_limit,
                                (int32_t)c->period_ticks,
                                (int32_t)c->tolerance_ticks,
                                (int32_t)c->stale_ticks,
                                (int32_t)c->deadline_ticks,
                                (int32_t)c->trips}};
    return frame;
}

void pil_start_read(const pil_frame_t *frame, iqfoc_cycle_config_t *config)
{
    const int32_t *d = frame->data;
    const iqfoc_cycle_config_t read = {
        .predictor = {.k_u = d[0], .k_r = d[1], .k_psi = d[2]},
        .gains = {.kp_d = d[3],
                  .kp_q = d[4],
                  .ki_d = d[5],
                  .ki_q = d[6],
                  .anti_windup = d[7],
                  .x_d = d[8],
                  .x_q = d[9],
                  .emf = d[10]},
        .feedback = (iqfoc_feedback_t)d[11],
        .modulation = (iqfoc_modulation_t)d[12],
        .safe_state = (iqfoc_safe_state_t)d[13],
        .span_max = d[14],
        .current_limit = d[15],
        .period_ticks = (uint32_t)d[16],
        .tolerance_ticks = (uint32_t)d[17],
        .stale_ticks = (uint32_t)d[18],
        .deadline_ticks = (uint32_t)d[19],
        .trips = (uint32_t)d[20],
    };
    *config = read;
}

#define FLAG_HAS_MEAN 1
#define FLAG_CLIPPED  2

static void sample_put(int32_t *d, const iqfoc_sample_t *s)
{
    d[0] = s->i.a;
    d[1] = s->i.b;
    d[2] = s->i.c;
    d[3] = s->i_mean.a;
    d[4] = s->i_mean.b;
    d[5] = s->i_mean.c;
    d[6] = s->theta;
    d[7] = s->speed;
    d[8] = s->u_dc;
    d[9] = (int32_t)s->time;
    d[10] = (s->has_mean ? FLAG_HAS_MEAN : 0) | (s->clipped ? FLAG_CLIPPED : 0);
}

static iqfoc_sample_t sample_get(const int32_t *d, iq24_t at)
{
    const iqfoc_sample_t s = {
        .i = {d[0], d[1], d[2]},
        .i_mean = {d[3], d[4], d[5]},
        .theta = d[6],
        .speed = d[7],
        .u_dc = d[8],
        .instant = at,
        .time = (uint32_t)d[9],
        .has_mean = (d[10] & FLAG_HAS_MEAN) != 0,
        .clipped = (d[10] & FLAG_CLIPPED) != 0,
    };
    return s;
}

pil_frame_t pil_cycle_frame(iqfoc_dq_t i_ref, const iqfoc_sample_t *valley, const iqfoc_sample_t *peak)
{
    pil_frame_t frame = {PIL_CYCLE, 2 + 2 * PIL_SAMPLE_WORDS, {i_ref.d, i_ref.q}};
    sample_put(&frame.data[2], valley);
    sample_put(&frame.data[2 + PIL_SAMPLE_WORDS], peak);
    return frame;
}

void pil_cycle_read(const pil_frame_t *frame, iqfoc_dq_t *i_ref, iqfoc_sample_t *valley, iqfoc_sample_t *peak)
{
    i_ref->d = frame->data[0];
    i_ref->q = frame->data[1];
    *valley = sample_get(&frame->data[2], 0);
    *peak = sample_get(&frame->data[2 + PIL_SAMPLE_WORDS], IQ24(0.5));
}

pil_frame_t pil_command_frame(const pil_result_t *r)
{
    const iqfoc_duties_t *duties = &r->command.duties;
    const pil_frame_t frame = {PIL_COMMAND,
                               6,
                               {duties->high.a, duties->high.b, duties->high.c, duties->scale,
                                r->command.gates ? 1 : 0, (int32_t)r->status}};
    return frame;
}

void pil_command_read(const pil_frame_t *frame, pil_result_t *result)
{
    const int32_t *d = frame->data;
    const pil_result_t read = {{{{d[0], d[1], d[2]}, d[3]}, d[4] != 0}, (uint32_t)d[5]};
    *result = read;
}

pil_frame_t pil_tune_frame(const tuned_firmware_config_t *config)
{
    pil_frame_t frame = {PIL_TUNE, PIL_TUNE_WORDS, {0}};
    memcpy(frame.data, config, sizeof *config);
    return frame;
}

void pil_tune_read(const pil_frame_t *frame, tuned_firmware_config_t *config)
{
    memcpy(config, frame->data, sizeof *config);
}

pil_frame_t pil_watched_frame(const pil_watched_t *w)
{
    const pil_frame_t frame = {PIL_WATCHED, 3, {w->group, (int32_t)w->since, w->amount_q16}};
    return frame;
}

void pil_watched_read(const pil_frame_t *frame, pil_watched_t *watched)
{
    const int32_t *d = frame->data;
    const pil_watched_t read = {d[0], (uint32_t)d[1], d[2]};
    *watched = read;
}
