/*
 * The recorder octet by octet: for any data, and any timing of line and cycle, the octets on the line follow
 * docs/recorder-format.md. The model in this test keeps rows in a list and makes a frame as a whole.
 */
#include "bits.h"

#include "iqfoc/recorder.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

enum { ROWS_MOST = 64, WORDS_MOST = 6 + 3 * 16 + 8 * 17 + 1, OCTETS_MOST = 8 * WORDS_MOST + 2 };

static int32_t source[IQFOC_RECORDER_CHANNELS_MAX];
static int32_t memory[ROWS_MOST * 17 + 16];
static iqfoc_recorder_config_t config;
static iqfoc_recorder_t recorder;
static uint64_t seed;

/* ---- The model ---- */

typedef struct row {
    uint32_t cycle;
    int32_t value[IQFOC_RECORDER_CHANNELS_MAX];
} row;

static struct {
    enum { IDLE, ARMED, RUNNING, DRAINING } phase;
    row waiting[ROWS_MOST];
    uint32_t count, capacity, before;
    uint32_t cycle, still_to_take, lost, sent, stream, sequence, since_header;
    uint32_t last_status;
    int32_t last_level;
    int32_t status; /* bits of all cycles since the last row */
    bool seen_one, header_due, ended;
    uint8_t octet[OCTETS_MOST];
    size_t octets, next;
    uint32_t rows_in_frame;
    bool is_end;
} model;

/* The first rows are the reader's, or fall out. */
static void forget(uint32_t rows)
{
    model.count -= rows;
    memmove(model.waiting, model.waiting + rows, model.count * sizeof *model.waiting);
}

static void model_init(uint32_t words)
{
    memset(&model, 0, sizeof model);
    model.capacity = words / (config.channel_count + 1);
    model.before = (uint32_t)bits_floor((int64_t)model.capacity * config.pre_share, IQ24_ONE);
}

static void model_arm(void)
{
    const uint32_t stream = model.stream + 1;
    const uint32_t sequence = model.sequence;
    const uint32_t capacity = model.capacity;
    const uint32_t before = model.before;
    memset(&model, 0, sizeof model);
    model.stream = stream;
    model.sequence = sequence;
    model.capacity = capacity;
    model.before = before;
    model.header_due = true;
    model.phase = config.trigger == IQFOC_RECORDER_NOW ? RUNNING : ARMED;
}

static int32_t value_of(uint32_t channel)
{
    const int32_t *const from = config.channels[channel].source;
    return from == &recorder.status ? model.status : *from;
}

static bool model_event(uint32_t status)
{
    const int32_t level = value_of(config.channel);
    const bool rises = model.last_level < config.level && level >= config.level;
    const bool falls = model.last_level > config.level && level <= config.level;
    const bool comes_up = (status & ~model.last_status & config.status_bits) != 0;
    const bool known = model.seen_one;
    model.seen_one = true;
    model.last_level = level;
    model.last_status = status;
    return known && ((config.trigger == IQFOC_RECORDER_STATUS && comes_up) ||
                     (config.trigger == IQFOC_RECORDER_RISES && rises) ||
                     (config.trigger == IQFOC_RECORDER_FALLS && falls));
}

static void model_row(void)
{
    if (model.phase == ARMED && model.before == 0) {
        model.status = 0;
        return;
    }
    if (model.phase == ARMED && model.count >= model.before) {
        forget(1);
    }
    if (model.count < model.capacity) {
        row *r = &model.waiting[model.count++];
        r->cycle = model.cycle;
        for (uint32_t c = 0; c < config.channel_count; c++) {
            r->value[c] = value_of(c);
        }
        model.status = 0;
    } else {
        model.lost++;
    }
    if (model.still_to_take > 0 && --model.still_to_take == 0) {
        model.phase = DRAINING;
    }
}

static void model_take(uint32_t status)
{
    if (model.phase != ARMED && model.phase != RUNNING) {
        return;
    }
    model.status |= (int32_t)status;
    if (model_event(status) && model.phase == ARMED) {
        model.still_to_take = model.capacity - model.count;
        model.phase = RUNNING;
    }
    if (model.cycle % config.decimation == 0) {
        model_row();
    }
    model.cycle++;
}

static uint32_t crc_of(const uint32_t *word, size_t words)
{
    uint32_t crc = UINT32_MAX;
    for (size_t bit = 0; bit < 32 * words; bit++) {
        const uint32_t data = word[bit / 32] >> (bit % 32) & 1;
        crc = (crc & 1) != data ? (crc >> 1) ^ UINT32_C(0xEDB88320) : crc >> 1;
    }
    return ~crc;
}

static void model_send(const uint32_t *word, size_t words)
{
    model.octets = 0;
    model.next = 0;
    model.octet[model.octets++] = 0xC0;
    for (size_t k = 0; k < 4 * words; k++) {
        const uint8_t one = (uint8_t)(word[k / 4] >> (8 * (k % 4)) & 0xFF);
        if (one == 0xC0 || one == 0xDB) {
            model.octet[model.octets++] = 0xDB;
        }
        model.octet[model.octets++] = one == 0xC0 ? 0xDC : one == 0xDB ? 0xDD : one;
    }
    model.octet[model.octets++] = 0xC0;
}

static void model_frame(void)
{
    uint32_t word[WORDS_MOST];
    size_t words = 1;
    uint32_t type = 3;
    model.rows_in_frame = 0;
    model.is_end = false;
    word[words++] = model.stream;
    if (model.header_due || model.since_header == 32) {
        type = 1;
        model.header_due = false;
        model.since_header = 0;
        word[words++] = config.period_mantissa;
        word[words++] = config.period_shift;
        word[words++] = config.decimation;
        word[words++] = config.channel_count;
        for (uint32_t c = 0; c < config.channel_count; c++) {
            word[words++] = config.channels[c].column;
            word[words++] = (uint32_t)config.channels[c].mantissa;
            word[words++] = config.channels[c].shift;
        }
    } else if (model.count > 0) {
        type = 2;
        model.since_header++;
        model.rows_in_frame = model.count < 8 ? model.count : 8;
        word[words++] = model.lost;
        word[words++] = model.rows_in_frame;
        for (uint32_t k = 0; k < model.rows_in_frame; k++) {
            word[words++] = model.waiting[k].cycle;
            for (uint32_t c = 0; c < config.channel_count; c++) {
                word[words++] = (uint32_t)model.waiting[k].value[c];
            }
        }
    } else {
        model.is_end = true;
        word[words++] = model.lost;
        word[words++] = model.sent;
    }
    word[0] = 1 | type << 8 | (model.sequence & 0xFFFF) << 16;
    word[words] = crc_of(word, words);
    model_send(word, words + 1);
}

static int32_t model_octet(void)
{
    if (model.next == model.octets) {
        const bool reads = model.phase == RUNNING || model.phase == DRAINING;
        if (!reads || model.ended || (model.phase == RUNNING && model.count == 0)) {
            return -1;
        }
        model_frame();
    }
    const int32_t octet = model.octet[model.next++];
    if (model.next == model.octets) {
        forget(model.rows_in_frame);
        model.sent += model.rows_in_frame;
        model.sequence++;
        model.ended = model.is_end;
    }
    return octet;
}

/* ---- Both side by side ---- */

void setUp(void)
{
    memset(&recorder, 0, sizeof recorder);
}

void tearDown(void)
{
}

static void any_config(uint64_t kind)
{
    memset(&config, 0, sizeof config);
    config.channel_count = (uint32_t)bits_random(&seed, 1, kind % 4 == 0 ? 16 : 3);
    for (uint32_t c = 0; c < config.channel_count; c++) {
        const iqfoc_recorder_channel_t channel = {&source[c], (uint32_t)bits_random(&seed, 0, 0xDB),
                                                  bits_random(&seed, 1, INT32_MAX),
                                                  (uint32_t)bits_random(&seed, 0, 62)};
        config.channels[c] = channel;
    }
    if (kind % 2 == 0) {
        config.channels[config.channel_count - 1].source = &recorder.status;
    }
    config.decimation = (uint32_t)bits_random(&seed, 1, kind % 3 == 0 ? 5 : 1);
    config.period_mantissa = (uint32_t)bits_random(&seed, 1, INT32_MAX);
    config.period_shift = (uint32_t)bits_random(&seed, 0, 62);
    config.trigger = (iqfoc_recorder_trigger_t)(kind / 2 % 4);
    config.status_bits = (uint32_t)bits_random(&seed, 1, 15);
    config.channel = (uint32_t)bits_random(&seed, 0, (int64_t)config.channel_count - 1);
    config.level = bits_random(&seed, -2, 2);
    config.pre_share = kind % 5 == 0 ? 0 : kind % 5 == 1 ? IQ24_ONE - 1 : bits_random(&seed, 0, IQ24_ONE - 1);
}

/* Small numbers about the level, marks of the wire, and any. */
static int32_t any_value(void)
{
    static const uint32_t marks[4] = {0xC0DBDCDD, 0xDBDBDBDB, 0xC0C0C0C0, 0xDDDC00C0};
    const uint64_t draw = random_bits(&seed);
    return draw % 4 == 0  ? (int32_t)(marks[draw >> 8 & 3])
           : draw % 4 < 3 ? (int32_t)(draw >> 8 & 7) - 3
                          : bits_random(&seed, INT32_MIN, INT32_MAX);
}

static void one_step(int line)
{
    const int takes = bits_random(&seed, 0, 2);
    for (int k = 0; k < takes; k++) {
        for (uint32_t c = 0; c < config.channel_count; c++) {
            source[c] = any_value();
        }
        const uint32_t status = (uint32_t)bits_random(&seed, 0, 20) % 16;
        iqfoc_recorder_take(&recorder, status);
        model_take(status);
    }
    const int octets = bits_random(&seed, 0, line);
    for (int k = 0; k < octets; k++) {
        TEST_ASSERT_EQUAL_INT32(model_octet(), iqfoc_recorder_octet(&recorder));
        TEST_ASSERT_EQUAL(model.ended, iqfoc_recorder_finished(&recorder));
    }
}

static void one_stream(uint64_t kind)
{
    const int line = kind % 7 == 0 ? 9 : (int)(8 * config.channel_count + 30);
    const int steps = bits_random(&seed, 0, kind % 11 == 0 ? 900 : 120);
    iqfoc_recorder_arm(&recorder);
    model_arm();
    for (int k = 0; k < steps; k++) {
        one_step(line);
    }
    if (kind % 3 != 1) {
        return; /* armed again in the middle of whatever it is doing */
    }
    iqfoc_recorder_stop(&recorder);
    model.phase = DRAINING;
    while (!model.ended) {
        one_step(line);
    }
    TEST_ASSERT_TRUE(iqfoc_recorder_finished(&recorder));
    TEST_ASSERT_EQUAL_INT32(-1, iqfoc_recorder_octet(&recorder));
}

static void every_octet_is_the_formats(void)
{
    seed = 20261121;
    for (uint64_t n = 0; n < 600; n++) {
        any_config(n);
        const uint32_t row_words = config.channel_count + 1;
        const uint32_t words = row_words * (uint32_t)bits_random(&seed, 2, n % 3 == 0 ? 3 : ROWS_MOST - 1) +
                               (uint32_t)bits_random(&seed, 0, (int64_t)row_words - 1);
        TEST_ASSERT_EQUAL(IQFOC_OK, iqfoc_recorder_init(&recorder, &config, memory, words));
        model_init(words);
        iqfoc_recorder_take(&recorder, 1); /* idle: nothing is taken, sent or to be stopped */
        iqfoc_recorder_stop(&recorder);
        TEST_ASSERT_EQUAL_INT32(-1, iqfoc_recorder_octet(&recorder));
        TEST_ASSERT_FALSE(iqfoc_recorder_finished(&recorder));
        for (uint64_t stream = 0; stream < 4; stream++) {
            one_stream(n + stream);
        }
    }
}

/* What init takes, at the ends of each range. */
static iqfoc_error_t init_with(uint32_t words)
{
    return iqfoc_recorder_init(&recorder, &config, memory, words);
}

static void ends_of_the_ranges(void)
{
    seed = 1;
    any_config(0);
    config.channel_count = IQFOC_RECORDER_CHANNELS_MAX;
    for (uint32_t c = 0; c < config.channel_count; c++) {
        const iqfoc_recorder_channel_t channel = {&source[c], 1, -1, 62};
        config.channels[c] = channel;
    }
    config.decimation = 1;
    config.period_mantissa = 1;
    config.period_shift = 62;
    config.channel = 15;
    config.pre_share = IQ24_ONE - 1;
    TEST_ASSERT_EQUAL(IQFOC_OK, init_with(34));
    TEST_ASSERT_EQUAL(IQFOC_ERROR_MEMORY, init_with(33));
    for (int trigger = IQFOC_RECORDER_NOW; trigger <= IQFOC_RECORDER_FALLS; trigger++) {
        config.trigger = (iqfoc_recorder_trigger_t)trigger;
        TEST_ASSERT_EQUAL(IQFOC_OK, init_with(34));
    }
    config.period_shift = 63;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_PERIOD, init_with(34));
    config.period_shift = 0;
    config.channels[15].shift = 63;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_CHANNELS, init_with(34));
    config.channels[15].shift = 0;
    config.pre_share = -1;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_TRIGGER, init_with(34));
    config.pre_share = 0;
    config.channel = 16;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_TRIGGER, init_with(34));
    config.channel = 0;
    config.channel_count = 1;
    TEST_ASSERT_EQUAL(IQFOC_OK, init_with(4));
    TEST_ASSERT_EQUAL(IQFOC_ERROR_NULL, iqfoc_recorder_init(NULL, &config, memory, 4));
    TEST_ASSERT_EQUAL(IQFOC_ERROR_NULL, iqfoc_recorder_init(&recorder, NULL, memory, 4));
}

/* The sequence of frames wraps at 16 bits. */
static void the_sequence_wraps(void)
{
    seed = 2;
    any_config(2);
    config.channel_count = 1;
    config.channel = 0;
    config.trigger = IQFOC_RECORDER_NOW;
    TEST_ASSERT_EQUAL(IQFOC_OK, init_with(8));
    model_init(8);
    iqfoc_recorder_arm(&recorder);
    model_arm();
    recorder.sequence = 0xFFFE;
    model.sequence = 0xFFFE;
    for (int k = 0; k < 200; k++) {
        one_step(60);
    }
    TEST_ASSERT_TRUE(model.sequence > 0x10000);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_octet_is_the_formats);
    RUN_TEST(ends_of_the_ranges);
    RUN_TEST(the_sequence_wraps);
    return UNITY_END();
}
