/* The recorder: its writer and its reader, for memories of a few sizes. Its state is any that its own counts allow. */
#include "any.h"

#include "iqfoc/recorder.h"

#include <stddef.h>

#define ROWS_MOST 9 /* one more than a frame holds */

static int32_t memory[ROWS_MOST * (IQFOC_RECORDER_CHANNELS_MAX + 1)];
static int32_t variable;

static iqfoc_recorder_config_t any_recording(uint32_t channels)
{
    iqfoc_recorder_config_t config;
    variable = any();
    for (uint32_t k = 0; k < IQFOC_RECORDER_CHANNELS_MAX; k++) {
        config.channels[k].source = &variable;
        config.channels[k].column = any_count(0, UINT32_MAX);
        config.channels[k].mantissa = any();
        config.channels[k].shift = any_count(0, UINT32_MAX);
    }
    config.channel_count = channels;
    config.decimation = any_count(0, UINT32_MAX);
    config.period_mantissa = any_count(0, UINT32_MAX);
    config.period_shift = any_count(0, UINT32_MAX);
    config.trigger = (iqfoc_recorder_trigger_t)any_within(0, 3);
    config.status_bits = any_count(0, UINT32_MAX);
    config.channel = any_count(0, UINT32_MAX);
    config.level = any();
    config.pre_share = any();
    return config;
}

/* Recorder, set-up: any configuration, any length of memory. */
void prove_recorder_init(void)
{
    const iqfoc_recorder_config_t config = any_recording(any_count(0, UINT32_MAX));
    iqfoc_recorder_t r;
    (void)iqfoc_recorder_init(&r, &config, memory, any_count(0, sizeof memory / sizeof memory[0]));
    (void)iqfoc_recorder_init(&r, NULL, memory, 0);
}

/* The writer: 1, 2 and 16 channels, 2 to 9 rows; any configuration that is not refused, from any state. */
void prove_recorder_take(void)
{
    static const uint32_t channels[3] = {1, 2, IQFOC_RECORDER_CHANNELS_MAX};
    for (uint32_t n = 0; n < 3; n++) {
        for (uint32_t rows = 2; rows <= ROWS_MOST; rows++) {
            const iqfoc_recorder_config_t config = any_recording(channels[n]);
            iqfoc_recorder_t r;
            if (iqfoc_recorder_init(&r, &config, memory, rows * (channels[n] + 1)) == IQFOC_OK) {
                iqfoc_recorder_arm(&r);
                r.phase = any_count(0, 3);
                r.written = any_count(0, UINT32_MAX);
                r.write_slot = any_count(0, rows - 1);
                r.cycle = any_count(0, UINT32_MAX);
                r.until_next = any_count(0, UINT32_MAX);
                r.still_to_take = any_count(0, rows);
                r.last_status = any_count(0, UINT32_MAX);
                r.last_level = any();
                r.before_known = any_bool();
                r.status = any();
                r.lost = any_count(0, UINT32_MAX);
                r.read = any_count(0, UINT32_MAX);
                r.read_slot = any_count(0, rows - 1);
                iqfoc_recorder_take(&r, any_count(0, UINT32_MAX));
                iqfoc_recorder_stop(&r);
            }
        }
    }
}

/* The reader: the same memories; any frame at any octet, any rows to wait. */
void prove_recorder_octet(void)
{
    static const uint32_t channels[3] = {1, 2, IQFOC_RECORDER_CHANNELS_MAX};
    for (uint32_t n = 0; n < 3; n++) {
        for (uint32_t rows = 2; rows <= ROWS_MOST; rows++) {
            const iqfoc_recorder_config_t config = any_recording(channels[n]);
            iqfoc_recorder_t r;
            if (iqfoc_recorder_init(&r, &config, memory, rows * (channels[n] + 1)) != IQFOC_OK) {
                continue;
            }
            const uint32_t in_frame = rows < 8 ? rows : 8;
            const uint32_t words[6] = {0, 6 + 3 * channels[n], 4 + in_frame * (channels[n] + 1), 4, 0, 10};
            for (uint32_t type = 0; type < 6; type++) {
                iqfoc_recorder_arm(&r);
                r.phase = any_count(0, 3);
                r.stream = any_count(0, UINT32_MAX);
                r.written = any_count(0, UINT32_MAX);
                r.lost = any_count(0, UINT32_MAX);
                r.read = any_count(0, UINT32_MAX);
                r.read_slot = any_count(0, rows - 1);
                r.sequence = any_count(0, UINT32_MAX);
                r.frame_type = type;
                r.frame_words = words[type];
                r.frame_rows = any_count(1, in_frame);
                r.frame_lost = any_count(0, UINT32_MAX);
                r.rows_sent = any_count(0, UINT32_MAX);
                r.frames_to_header = any_count(0, 32);
                r.word = any_count(0, UINT32_MAX);
                r.word_index = any_count(0, words[type] + 1);
                r.octet_index = any_count(0, 3);
                r.escaped = any_bool() ? 0 : any_count(0, 255);
                r.crc = any_count(0, UINT32_MAX);
                r.end_sent = any_bool();
                r.frames_owed = any_count(0, 2);
                r.request_waits = any_bool();
                r.request_error = any();
                r.request_sequence = any_count(0, UINT32_MAX);
                (void)iqfoc_recorder_octet(&r);
                (void)iqfoc_recorder_finished(&r);
            }
        }
    }
}

/* A request: any octets, any words; the recorder as the configuration allows it. */
void prove_recorder_request(void)
{
    const iqfoc_recorder_config_t config = any_recording(2);
    iqfoc_recorder_t r;
    if (iqfoc_recorder_init(&r, &config, memory, ROWS_MOST * 3) != IQFOC_OK) {
        return;
    }
    for (uint32_t k = 0; k < IQFOC_RECORDER_REQUEST_WORDS; k++) {
        r.request[k] = any_count(0, UINT32_MAX);
    }
    r.request_octets = any_count(0, 4 * IQFOC_RECORDER_REQUEST_WORDS);
    r.request_escape = any_bool();
    r.request_broken = any_bool();
    r.request_waits = any_bool();
    r.phase = any_count(0, 3);
    r.stream = any_count(0, UINT32_MAX);
    iqfoc_recorder_receive(&r, any_count(0, 255));
    (void)iqfoc_recorder_requested(&r);
    (void)iqfoc_recorder_obey(&r);
}
