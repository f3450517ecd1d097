/* The recorder's ring, and its encoder octet by octet (include/iqfoc/recorder.h, docs/recorder-format.md). */
#include "iqfoc/recorder.h"

#include <stddef.h>

enum { IDLE, ARMED, RUNNING, DRAINING };

/* Frames. */
#define VERSION      1
#define FRAME_HEADER 1
#define FRAME_ROWS   2
#define FRAME_END    3
#define FRAME_ASK    4 /* a request, to the target */
#define FRAME_ANSWER 5
#define ROWS_MAX     8  /* in a frame */
#define HEADER_EVERY 32 /* row frames */
#define HEADER_WORDS 6  /* and three for each channel */
#define ROWS_WORDS   4  /* and the rows */
#define END_WORDS    4
#define ANSWER_WORDS 10

/* Of a request, after the triggers. */
#define REQUEST_STOP 4

/* Octets with a meaning of their own, as in RFC 1055. */
#define OCTET_END        0xC0
#define OCTET_ESCAPE     0xDB
#define OCTET_ESCAPE_END 0xDC
#define OCTET_ESCAPE_ESC 0xDD

static bool channels_valid(const iqfoc_recorder_config_t *config)
{
    if (config->channel_count < 1 || config->channel_count > IQFOC_RECORDER_CHANNELS_MAX) {
        return false;
    }
    for (uint32_t k = 0; k < config->channel_count; k++) {
        const iqfoc_recorder_channel_t *channel = &config->channels[k];
        if (channel->source == NULL || channel->mantissa == 0 || channel->shift > 62) {
            return false;
        }
    }
    return true;
}

static bool trigger_valid(const iqfoc_recorder_setting_t *setting, uint32_t channel_count)
{
    const bool known = setting->trigger == IQFOC_RECORDER_NOW || setting->trigger == IQFOC_RECORDER_STATUS ||
                       setting->trigger == IQFOC_RECORDER_RISES || setting->trigger == IQFOC_RECORDER_FALLS;
    return known && setting->channel < channel_count && setting->pre_share >= 0 &&
           setting->pre_share < IQ24_ONE;
}

/* pre_share < 1 leaves at least one row for the trigger itself. */
static void setting_take(iqfoc_recorder_t *recorder, const iqfoc_recorder_setting_t *setting)
{
    recorder->setting = *setting;
    recorder->pre_rows = (uint32_t)(((uint64_t)recorder->capacity * (uint32_t)setting->pre_share) >> 24);
}

iqfoc_error_t iqfoc_recorder_init(iqfoc_recorder_t *recorder, const iqfoc_recorder_config_t *config,
                                  int32_t *memory, uint32_t words)
{
    if (recorder == NULL || config == NULL || memory == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!channels_valid(config)) {
        return IQFOC_ERROR_CHANNELS;
    }
    if (config->period_mantissa == 0 || config->period_shift > 62 || config->decimation == 0) {
        return IQFOC_ERROR_PERIOD;
    }
    const iqfoc_recorder_setting_t setting = {config->trigger, config->status_bits, config->channel,
                                              config->level,   config->pre_share,   config->decimation};
    if (!trigger_valid(&setting, config->channel_count)) {
        return IQFOC_ERROR_TRIGGER;
    }
    const uint32_t row_words = config->channel_count + 1;
    const uint32_t capacity = words / row_words;
    if (capacity < 2) {
        return IQFOC_ERROR_MEMORY;
    }
    const iqfoc_recorder_t fresh = {
        .config = config, .memory = memory, .row_words = row_words, .capacity = capacity};
    *recorder = fresh;
    setting_take(recorder, &setting);
    return IQFOC_OK;
}

void iqfoc_recorder_arm(iqfoc_recorder_t *recorder)
{
    recorder->phase = IDLE;
    recorder->stream++;
    recorder->written = 0;
    recorder->write_slot = 0;
    recorder->cycle = 0;
    recorder->until_next = 0;
    recorder->still_to_take = 0;
    recorder->last_status = 0;
    recorder->before_known = false;
    recorder->status = 0;
    recorder->lost = 0;
    recorder->read = 0;
    recorder->read_slot = 0;
    recorder->frame_type = 0;
    recorder->rows_sent = 0;
    recorder->frames_to_header = 0;
    recorder->escaped = 0;
    recorder->end_sent = false;
    recorder->phase = recorder->setting.trigger == IQFOC_RECORDER_NOW ? RUNNING : ARMED;
}

void iqfoc_recorder_stop(iqfoc_recorder_t *recorder)
{
    if (recorder->phase != IDLE) {
        recorder->phase = DRAINING;
    }
}

static uint32_t slot_after(const iqfoc_recorder_t *recorder, uint32_t slot)
{
    return slot + 1 == recorder->capacity ? 0 : slot + 1;
}

/* ---- The writer ---- */

/* A trigger is a bit that becomes 1, or a level that is crossed. A bit that was 1 before is no event. */
static bool triggered(iqfoc_recorder_t *recorder, uint32_t status)
{
    const iqfoc_recorder_setting_t *setting = &recorder->setting;
    const uint32_t came_up = status & ~recorder->last_status & setting->status_bits;
    const int32_t level = *recorder->config->channels[setting->channel].source;
    const bool known = recorder->before_known;
    const int32_t before = recorder->last_level;
    recorder->last_status = status;
    recorder->last_level = level;
    recorder->before_known = true;
    switch (setting->trigger) {
    case IQFOC_RECORDER_STATUS:
        return known && came_up != 0;
    case IQFOC_RECORDER_RISES:
        return known && before < setting->level && level >= setting->level;
    case IQFOC_RECORDER_FALLS:
        return known && before > setting->level && level <= setting->level;
    case IQFOC_RECORDER_NOW:
    default:
        return false;
    }
}

/* Precondition: there is room. The row is complete before `written` says so. */
static void row_store(iqfoc_recorder_t *recorder)
{
    const iqfoc_recorder_config_t *config = recorder->config;
    volatile int32_t *row = &recorder->memory[recorder->write_slot * recorder->row_words];
    row[0] = iq24_wrap((int64_t)recorder->cycle);
    for (uint32_t k = 0; k < config->channel_count; k++) {
        row[k + 1] = *config->channels[k].source;
    }
    recorder->status = 0;
    recorder->write_slot = slot_after(recorder, recorder->write_slot);
    recorder->written = recorder->written + 1;
}

/* Counters wrap, and the low half is their difference. Widened so that the wrap does not trip the sanitizer. */
static uint32_t rows_waiting(const iqfoc_recorder_t *recorder)
{
    return (uint32_t)(((uint64_t)recorder->written - recorder->read) & UINT32_MAX);
}

void iqfoc_recorder_take(iqfoc_recorder_t *recorder, uint32_t status)
{
    const uint32_t phase = recorder->phase;
    if (phase != ARMED && phase != RUNNING) {
        return;
    }
    recorder->status = iq24_wrap((int64_t)((uint32_t)recorder->status | status));
    const bool event = triggered(recorder, status);
    if (phase == ARMED && event) {
        recorder->still_to_take = recorder->capacity - rows_waiting(recorder);
        recorder->phase = RUNNING; /* from here on the rows are the reader's to take */
    }
    if (recorder->until_next == 0) {
        recorder->until_next = recorder->setting.decimation;
        if (recorder->phase == ARMED && rows_waiting(recorder) >= recorder->pre_rows) {
            if (recorder->pre_rows == 0) {
                recorder->status = 0;
                recorder->until_next--;
                recorder->cycle++;
                return;
            }
            /* The oldest goes. The reader does not look while it is armed. */
            recorder->read_slot = slot_after(recorder, recorder->read_slot);
            recorder->read = recorder->read + 1;
        }
        if (rows_waiting(recorder) < recorder->capacity) {
            row_store(recorder);
        } else {
            recorder->lost = recorder->lost + 1;
        }
        if (recorder->still_to_take != 0 && --recorder->still_to_take == 0) {
            recorder->phase = DRAINING;
        }
    }
    recorder->until_next--;
    recorder->cycle++;
}

/* ---- The reader: a frame is a list of words, lowest octet first, then the CRC ---- */

/* IEEE 802.3, reflected, four bits at a time. */
static uint32_t crc_after(uint32_t crc, uint32_t octet)
{
    static const uint32_t table[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
        0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
    };
    crc ^= octet;
    crc = (crc >> 4) ^ table[crc & 15];
    return (crc >> 4) ^ table[crc & 15];
}

static uint32_t header_word(const iqfoc_recorder_t *recorder, uint32_t index)
{
    const iqfoc_recorder_config_t *config = recorder->config;
    const uint32_t head[HEADER_WORDS] = {0,
                                         recorder->stream,
                                         config->period_mantissa,
                                         config->period_shift,
                                         recorder->setting.decimation,
                                         config->channel_count};
    if (index < HEADER_WORDS) {
        return head[index];
    }
    const iqfoc_recorder_channel_t *channel = &config->channels[(index - HEADER_WORDS) / 3];
    const uint32_t words[3] = {channel->column, (uint32_t)channel->mantissa, channel->shift};
    return words[(index - HEADER_WORDS) % 3];
}

static uint32_t rows_word(const iqfoc_recorder_t *recorder, uint32_t index)
{
    const uint32_t head[ROWS_WORDS] = {0, recorder->stream, recorder->frame_lost, recorder->frame_rows};
    if (index < ROWS_WORDS) {
        return head[index];
    }
    uint32_t slot = recorder->read_slot + (index - ROWS_WORDS) / recorder->row_words;
    if (slot >= recorder->capacity) {
        slot -= recorder->capacity;
    }
    return (uint32_t)
        recorder->memory[slot * recorder->row_words + (index - ROWS_WORDS) % recorder->row_words];
}

static uint32_t answer_word(const iqfoc_recorder_t *recorder, uint32_t index)
{
    const iqfoc_recorder_setting_t *setting = &recorder->setting;
    const uint32_t words[ANSWER_WORDS] = {0,
                                          recorder->stream,
                                          (uint32_t)recorder->request_error,
                                          recorder->request_sequence,
                                          (uint32_t)setting->trigger,
                                          setting->status_bits,
                                          setting->channel,
                                          (uint32_t)setting->level,
                                          (uint32_t)setting->pre_share,
                                          setting->decimation};
    return words[index];
}

static uint32_t frame_word(const iqfoc_recorder_t *recorder, uint32_t index)
{
    if (index == recorder->frame_words) {
        return ~recorder->crc;
    }
    if (index == 0) {
        return VERSION | recorder->frame_type << 8 | (recorder->sequence & 0xFFFF) << 16;
    }
    if (recorder->frame_type == FRAME_HEADER) {
        return header_word(recorder, index);
    }
    if (recorder->frame_type == FRAME_ROWS) {
        return rows_word(recorder, index);
    }
    if (recorder->frame_type == FRAME_ANSWER) {
        return answer_word(recorder, index);
    }
    return index == 1 ? recorder->stream : index == 2 ? recorder->frame_lost : recorder->rows_sent;
}

/* Chooses the next frame of the rows. False: nothing to send. */
static bool frame_of_rows(iqfoc_recorder_t *recorder)
{
    const uint32_t phase = recorder->phase; /* before the rows are counted: after DRAINING none is added */
    if (phase != RUNNING && phase != DRAINING) {
        return false;
    }
    const uint32_t waiting = rows_waiting(recorder);
    if ((waiting == 0 && phase == RUNNING) || recorder->end_sent) {
        return false;
    }
    recorder->frame_lost = recorder->lost;
    if (recorder->frames_to_header == 0) {
        recorder->frame_type = FRAME_HEADER;
        recorder->frame_words = HEADER_WORDS + 3 * recorder->config->channel_count;
    } else if (waiting != 0) {
        recorder->frame_type = FRAME_ROWS;
        recorder->frame_rows = waiting < ROWS_MAX ? waiting : ROWS_MAX;
        recorder->frame_words = ROWS_WORDS + recorder->frame_rows * recorder->row_words;
    } else {
        recorder->frame_type = FRAME_END;
        recorder->frame_words = END_WORDS;
    }
    return true;
}

/* Chooses the next frame. False: nothing to send. */
static bool frame_begin(iqfoc_recorder_t *recorder)
{
    if (recorder->request_waits) {
        return false;
    }
    if (recorder->frames_owed == 2) {
        recorder->frame_type = FRAME_ANSWER;
        recorder->frame_words = ANSWER_WORDS;
    } else if (recorder->frames_owed == 1) {
        recorder->frame_type = FRAME_HEADER;
        recorder->frame_words = HEADER_WORDS + 3 * recorder->config->channel_count;
    } else if (!frame_of_rows(recorder)) {
        return false;
    }
    recorder->word_index = 0;
    recorder->octet_index = 0;
    recorder->crc = UINT32_MAX;
    recorder->word = frame_word(recorder, 0);
    return true;
}

static void frame_finish(iqfoc_recorder_t *recorder)
{
    if (recorder->frame_type == FRAME_ANSWER) {
        recorder->frames_owed = 1;
    } else if (recorder->frame_type == FRAME_HEADER && recorder->frames_owed == 1) {
        recorder->frames_owed = 0; /* the rows begin with a header of their own */
    } else if (recorder->frame_type == FRAME_HEADER) {
        recorder->frames_to_header = HEADER_EVERY;
    } else if (recorder->frame_type == FRAME_ROWS) {
        for (uint32_t k = 0; k < recorder->frame_rows; k++) {
            recorder->read_slot = slot_after(recorder, recorder->read_slot);
        }
        recorder->rows_sent += recorder->frame_rows;
        recorder->read = recorder->read + recorder->frame_rows; /* only now may the writer use them again */
        recorder->frames_to_header--;
    } else {
        recorder->end_sent = true;
    }
    recorder->sequence++;
    recorder->frame_type = 0;
}

int32_t iqfoc_recorder_octet(iqfoc_recorder_t *recorder)
{
    if (recorder->escaped != 0) {
        const uint32_t second = recorder->escaped;
        recorder->escaped = 0;
        return (int32_t)second;
    }
    if (recorder->frame_type == 0) {
        return frame_begin(recorder) ? OCTET_END : -1;
    }
    if (recorder->word_index > recorder->frame_words) {
        frame_finish(recorder);
        return OCTET_END;
    }
    const uint32_t octet = (recorder->word >> (8 * recorder->octet_index)) & 0xFF;
    if (recorder->word_index < recorder->frame_words) {
        recorder->crc = crc_after(recorder->crc, octet);
    }
    if (++recorder->octet_index == 4) {
        recorder->octet_index = 0;
        recorder->word_index++;
        if (recorder->word_index <= recorder->frame_words) {
            recorder->word = frame_word(recorder, recorder->word_index);
        }
    }
    if (octet == OCTET_END || octet == OCTET_ESCAPE) {
        recorder->escaped = octet == OCTET_END ? OCTET_ESCAPE_END : OCTET_ESCAPE_ESC;
        return OCTET_ESCAPE;
    }
    return (int32_t)octet;
}

bool iqfoc_recorder_finished(const iqfoc_recorder_t *recorder)
{
    return recorder->end_sent && recorder->frame_type == 0 && recorder->frames_owed == 0;
}

/* ---- Requests ---- */

/* Whether what came between two marks is a request, whole. */
static bool request_whole(const iqfoc_recorder_t *recorder)
{
    const uint32_t words = IQFOC_RECORDER_REQUEST_WORDS - 1;
    uint32_t crc = UINT32_MAX;
    for (uint32_t k = 0; k < 4 * words; k++) {
        crc = crc_after(crc, (recorder->request[k / 4] >> (8 * (k % 4))) & 0xFF);
    }
    return !recorder->request_broken && !recorder->request_escape &&
           recorder->request_octets == 4 * IQFOC_RECORDER_REQUEST_WORDS && recorder->request[words] == ~crc &&
           (recorder->request[0] & 0xFFFF) == (VERSION | FRAME_ASK << 8);
}

static void request_put(iqfoc_recorder_t *recorder, uint32_t octet)
{
    const uint32_t at = recorder->request_octets;
    if (at == 4 * IQFOC_RECORDER_REQUEST_WORDS) {
        recorder->request_broken = true;
        return;
    }
    const uint32_t before = at % 4 == 0 ? 0 : recorder->request[at / 4];
    recorder->request[at / 4] = before | octet << (8 * (at % 4));
    recorder->request_octets = at + 1;
}

void iqfoc_recorder_receive(iqfoc_recorder_t *recorder, uint32_t octet)
{
    if (recorder->request_waits) {
        return;
    }
    if (octet == OCTET_END) {
        recorder->request_waits = request_whole(recorder);
        recorder->request_octets = 0;
        recorder->request_escape = false;
        recorder->request_broken = false;
    } else if (recorder->request_escape) {
        recorder->request_escape = false;
        recorder->request_broken =
            recorder->request_broken || (octet != OCTET_ESCAPE_END && octet != OCTET_ESCAPE_ESC);
        request_put(recorder, octet == OCTET_ESCAPE_END ? OCTET_END : OCTET_ESCAPE);
    } else if (octet == OCTET_ESCAPE) {
        recorder->request_escape = true;
    } else {
        request_put(recorder, octet & 0xFF);
    }
}

bool iqfoc_recorder_requested(const iqfoc_recorder_t *recorder)
{
    return recorder->request_waits && recorder->frame_type == 0 && recorder->escaped == 0;
}

iqfoc_error_t iqfoc_recorder_obey(iqfoc_recorder_t *recorder)
{
    if (!recorder->request_waits) {
        return IQFOC_OK;
    }
    const uint32_t *words = recorder->request;
    const uint32_t trigger = words[1];
    const iqfoc_recorder_setting_t setting = {
        trigger <= IQFOC_RECORDER_FALLS ? (iqfoc_recorder_trigger_t)trigger : IQFOC_RECORDER_NOW,
        words[2],
        words[3],
        iq24_wrap((int64_t)words[4]),
        iq24_wrap((int64_t)words[5]),
        words[6]};
    iqfoc_error_t error = IQFOC_OK;
    if (trigger == REQUEST_STOP) {
        iqfoc_recorder_stop(recorder);
    } else if (trigger > REQUEST_STOP || !trigger_valid(&setting, recorder->config->channel_count)) {
        error = IQFOC_ERROR_TRIGGER;
    } else if (setting.decimation == 0) {
        error = IQFOC_ERROR_PERIOD;
    } else {
        setting_take(recorder, &setting);
        iqfoc_recorder_arm(recorder);
    }
    recorder->request_error = (int32_t)error;
    recorder->request_sequence = words[0] >> 16;
    recorder->frames_owed = 2;
    recorder->request_waits = false;
    return error;
}
