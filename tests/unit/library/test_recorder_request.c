/*
 * Requests to the recorder over its line, and its status channel: the request is made here from the words of docs/recorder-format.md, and
 * what comes back is read by the host's own reader.
 */
#include "recorder_line.h"
#include "reference.h"

#include "iqfoc/recorder.h"
#include "wire_request.h"

#include "unity.h"

enum { ROWS = 100, OCTETS_MAX = 2 + 8 * 8 };

static int32_t source[LINE_CHANNELS];
static int32_t memory[ROWS * (LINE_CHANNELS + 1)];
static iqfoc_recorder_config_t config;
static iqfoc_recorder_t recorder;
static wire_reader reader;
static line_rows rows;
static uint32_t cycle;

typedef struct request {
    uint8_t octet[OCTETS_MAX];
    size_t count;
} request;

void setUp(void)
{
    config = line_config(source);
    cycle = 0;
    memset(&reader, 0, sizeof reader);
    memset(&rows, 0, sizeof rows);
}

void tearDown(void)
{
}

static void start(void)
{
    TEST_ASSERT_EQUAL(IQFOC_OK,
                      iqfoc_recorder_init(&recorder, &config, memory, sizeof memory / sizeof *memory));
    iqfoc_recorder_arm(&recorder);
}

static void take(uint32_t status)
{
    line_record(&recorder, source, cycle++, status);
}

/* As a firmware's background does, with at most `most` octets to the host. */
static void background(size_t most)
{
    if (iqfoc_recorder_requested(&recorder)) {
        const uint32_t before = recorder.stream;
        (void)iqfoc_recorder_obey(&recorder);
        cycle = recorder.stream == before ? cycle : 0;
    }
    for (size_t k = 0; k < most; k++) {
        const int32_t octet = iqfoc_recorder_octet(&recorder);
        if (octet < 0) {
            return;
        }
        const uint8_t one = (uint8_t)octet;
        TEST_ASSERT_TRUE(wire_read(&reader, &one, 1, line_take, &rows));
    }
}

static uint32_t below(uint64_t *seed, uint64_t count)
{
    return (uint32_t)(random_bits(seed) % count);
}

static uint32_t remainder_of(const uint32_t *words, size_t count)
{
    uint32_t crc = UINT32_MAX;
    for (size_t bit = 0; bit < 32 * count; bit++) {
        const uint32_t in = words[bit / 32] >> (bit % 32) & 1;
        crc = ((crc ^ in) & 1) != 0 ? crc >> 1 ^ 0xEDB88320 : crc >> 1;
    }
    return ~crc;
}

static void put(request *r, uint32_t octet)
{
    if (octet == 0xC0 || octet == 0xDB) {
        r->octet[r->count++] = 0xDB;
        r->octet[r->count++] = octet == 0xC0 ? 0xDC : 0xDD;
    } else {
        r->octet[r->count++] = (uint8_t)octet;
    }
}

/* words[7] is filled in. */
static request request_of(uint32_t words[8])
{
    request r = {.count = 0};
    words[7] = remainder_of(words, 7);
    r.octet[r.count++] = 0xC0;
    for (size_t k = 0; k < 32; k++) {
        put(&r, words[k / 4] >> (8 * (k % 4)) & 0xFF);
    }
    r.octet[r.count++] = 0xC0;
    return r;
}

static void send(const request *r)
{
    for (size_t k = 0; k < r->count; k++) {
        iqfoc_recorder_receive(&recorder, r->octet[k]);
    }
}

static void ask(uint32_t sequence, uint32_t trigger, uint32_t bits, uint32_t channel, int32_t level,
                int32_t share, uint32_t decimation)
{
    uint32_t words[8] = {
        1 | 4 << 8 | sequence << 16, trigger, bits, channel, (uint32_t)level, (uint32_t)share, decimation, 0};
    const request r = request_of(words);
    send(&r);
    TEST_ASSERT_TRUE(recorder.request_waits);
}

/* Each trigger by a request: answered at once, with a header, while the recorder waits; then the rows around the event. */
static void test_armed_by_a_request(void)
{
    start();
    background(SIZE_MAX);
    ask(0xC0DB, IQFOC_RECORDER_STATUS, 0x10, 1, -5, IQ24(0.25), 2);
    background(SIZE_MAX);
    TEST_ASSERT_EQUAL(1, reader.answers);
    TEST_ASSERT_EQUAL_UINT32(2, reader.answer.stream);
    TEST_ASSERT_EQUAL_INT32(IQFOC_OK, reader.answer.error);
    TEST_ASSERT_EQUAL_HEX32(0xC0DB, reader.answer.sequence);
    const iqfoc_recorder_setting_t is = reader.answer.setting;
    TEST_ASSERT_TRUE(is.trigger == IQFOC_RECORDER_STATUS && is.status_bits == 0x10 && is.channel == 1 &&
                     is.level == -5 && is.pre_share == IQ24(0.25) && is.decimation == 2);
    TEST_ASSERT_TRUE(reader.header_known && reader.header.stream == 2 && reader.header.decimation == 2);
    for (uint32_t k = 0; k < 1000; k++) {
        take(k == 401 ? 0x10 : 0x20);
        background(SIZE_MAX);
    }
    /* 25 rows before the event, every other cycle, then 75. */
    TEST_ASSERT_TRUE(iqfoc_recorder_finished(&recorder) && reader.ended);
    TEST_ASSERT_EQUAL(ROWS, rows.count);
    for (uint32_t k = 0; k < ROWS; k++) {
        TEST_ASSERT_EQUAL_UINT32(402 - 50 + 2 * k, rows.cycle[k]);
    }
    TEST_ASSERT_EQUAL(0, rows.false_values);
    TEST_ASSERT_TRUE(reader.counts.damaged == 0 && reader.counts.lost_frames == 0 &&
                     reader.counts.missing_rows == 0);
}

static void test_stopped_and_begun_again(void)
{
    config.trigger = IQFOC_RECORDER_STATUS;
    config.status_bits = 1;
    start();
    take(0);
    background(SIZE_MAX);
    TEST_ASSERT_EQUAL(0, reader.counts.frames);
    ask(1, IQFOC_RECORDER_NOW, 0, 0, 0, 0, 1);
    for (uint32_t k = 0; k < 50; k++) {
        background(SIZE_MAX);
        take(0);
    }
    ask(2, 4, 0, 99, 0, -1, 0); /* of a stop nothing else matters */
    background(SIZE_MAX);
    take(0);
    background(SIZE_MAX);
    TEST_ASSERT_TRUE(reader.ended && iqfoc_recorder_finished(&recorder));
    TEST_ASSERT_EQUAL(50, rows.count);
    TEST_ASSERT_EQUAL(2, reader.answers);
    TEST_ASSERT_EQUAL_UINT32(2, reader.answer.sequence);
    TEST_ASSERT_TRUE(reader.answer.setting.trigger == IQFOC_RECORDER_NOW);
    ask(3, IQFOC_RECORDER_NOW, 0, 0, 0, 0, 1);
    background(SIZE_MAX);
    take(0);
    background(SIZE_MAX);
    TEST_ASSERT_EQUAL(51, rows.count);
    TEST_ASSERT_EQUAL_UINT32(3, reader.header.stream);
}

/* What iqfoc_recorder_init refuses a request cannot have either: answered, and nothing else changes. */
static void test_refused(void)
{
    static const struct {
        uint32_t trigger, channel;
        int32_t share;
        uint32_t decimation;
        iqfoc_error_t error;
    } wrong[] = {
        {5, 0, 0, 1, IQFOC_ERROR_TRIGGER},
        {UINT32_MAX, 0, 0, 1, IQFOC_ERROR_TRIGGER},
        {IQFOC_RECORDER_RISES, LINE_CHANNELS, 0, 1, IQFOC_ERROR_TRIGGER},
        {IQFOC_RECORDER_RISES, 0, IQ24_ONE, 1, IQFOC_ERROR_TRIGGER},
        {IQFOC_RECORDER_RISES, 0, -1, 1, IQFOC_ERROR_TRIGGER},
        {IQFOC_RECORDER_FALLS, 0, 0, 0, IQFOC_ERROR_PERIOD},
    };
    start();
    for (uint32_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        ask(n, wrong[n].trigger, 1, wrong[n].channel, 1, wrong[n].share, wrong[n].decimation);
        TEST_ASSERT_EQUAL(wrong[n].error, iqfoc_recorder_obey(&recorder));
        background(SIZE_MAX);
        take(0);
        TEST_ASSERT_EQUAL(n + 1, reader.answers);
        TEST_ASSERT_EQUAL_INT32(wrong[n].error, reader.answer.error);
        TEST_ASSERT_TRUE(reader.answer.stream == 1 && reader.answer.setting.trigger == IQFOC_RECORDER_NOW &&
                         reader.answer.setting.status_bits == 0);
    }
    background(SIZE_MAX);
    TEST_ASSERT_EQUAL(sizeof wrong / sizeof *wrong, rows.count);
    TEST_ASSERT_EQUAL(IQFOC_OK, iqfoc_recorder_obey(&recorder)); /* none waits */
    TEST_ASSERT_EQUAL(0, recorder.frames_owed);
}

/* At any octet of the outgoing line: the frame under way is sent whole, and nothing counts as damaged. */
static void test_a_request_waits_for_the_frame(void)
{
    for (size_t at = 0; at < 400; at++) {
        setUp();
        start();
        for (uint32_t k = 0; k < 20; k++) {
            take(0);
        }
        background(at);
        ask(7, IQFOC_RECORDER_NOW, 0, 0, 0, 0, 3);
        for (uint32_t k = 0; k < 30; k++) {
            background(SIZE_MAX);
            take(0);
        }
        background(SIZE_MAX);
        TEST_ASSERT_TRUE(reader.counts.damaged == 0 && reader.counts.lost_frames == 0 && reader.answers == 1);
        TEST_ASSERT_EQUAL_UINT32(3, reader.header.decimation);
        TEST_ASSERT_EQUAL(0, rows.false_values);
    }
}

/* Any one or two wrong bits, any cut, any repeated octet, and noise: no request comes of it. */
static void test_damaged_requests(void)
{
    uint32_t words[8] = {1 | 4 << 8 | 9 << 16, IQFOC_RECORDER_RISES, 0, 1, 0x00C0DB55, IQ24(0.5), 1, 0};
    const request whole = request_of(words);
    start();
    for (size_t a = 0; a < 8 * whole.count; a++) {
        for (size_t b = a; b < 8 * whole.count; b++) {
            request r = whole;
            r.octet[a / 8] ^= (uint8_t)(1U << (a % 8));
            r.octet[b / 8] ^= a == b ? 0 : (uint8_t)(1U << (b % 8));
            iqfoc_recorder_receive(&recorder, 0xC0);
            send(&r);
            /* A mark that is no mark any more is another line's: the rest of the request may still be whole. */
            const bool inside = a >= 8 && b < 8 * (whole.count - 1);
            TEST_ASSERT_TRUE_MESSAGE(!inside || !recorder.request_waits, "a wrong bit was taken");
            recorder.request_waits = false;
            iqfoc_recorder_receive(&recorder, 0xC0);
            recorder.request_waits = false;
        }
    }
    for (size_t k = 1; k < whole.count - 1; k++) {
        request cut = whole;
        memmove(&cut.octet[k], &cut.octet[k + 1], whole.count - k - 1);
        cut.count--;
        send(&cut);
        TEST_ASSERT_FALSE(recorder.request_waits);
    }
    uint64_t seed = 20261125;
    for (uint32_t k = 0; k < 1000000; k++) {
        iqfoc_recorder_receive(&recorder, below(&seed, 256));
        TEST_ASSERT_FALSE(recorder.request_waits);
    }
    send(&whole);
    send(&whole);
    TEST_ASSERT_TRUE(recorder.request_waits);
}

/* The host writes what the format says. */
static void test_the_host_writes_the_format(void)
{
    uint64_t seed = 11;
    for (uint32_t k = 0; k < 20000; k++) {
        const iqfoc_recorder_setting_t s = {
            (iqfoc_recorder_trigger_t)below(&seed, 4), below(&seed, UINT32_MAX),       below(&seed, 16),
            (int32_t)below(&seed, UINT32_MAX),         (iq24_t)below(&seed, IQ24_ONE), below(&seed, 99)};
        const bool stop = k % 7 == 0;
        uint32_t words[8] = {1 | 4 << 8 | (k & 0xFFFF) << 16, stop ? 4 : (uint32_t)s.trigger,
                             stop ? 0 : s.status_bits,        stop ? 0 : s.channel,
                             stop ? 0 : (uint32_t)s.level,    stop ? 0 : (uint32_t)s.pre_share,
                             stop ? 0 : s.decimation,         0};
        const request r = request_of(words);
        uint8_t octets[WIRE_REQUEST_MAX];
        TEST_ASSERT_EQUAL(r.count, wire_request(k, stop ? NULL : &s, octets));
        TEST_ASSERT_EQUAL_MEMORY(r.octet, octets, r.count);
    }
}

/* Status bits of each cycle reach a row, whatever the decimation and whether rows are lost. */
static void test_status_channel(void)
{
    const iqfoc_recorder_channel_t channel = IQFOC_RECORDER_STATUS_CHANNEL(recorder);
    config.channels[0] = channel;
    config.channel_count = 1;
    config.decimation = 4;
    TEST_ASSERT_EQUAL(IQFOC_OK, iqfoc_recorder_init(&recorder, &config, memory, 10));
    iqfoc_recorder_arm(&recorder);
    for (uint32_t k = 0; k < 13; k++) {
        iqfoc_recorder_take(&recorder, UINT32_C(1) << k | UINT32_C(0x80000000));
    }
    const uint32_t expected[4] = {0x80000001, 0x8000001E, 0x800001E0, 0x80001E00};
    for (uint32_t k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_HEX32(expected[k], (uint32_t)memory[2 * k + 1]);
    }
    for (uint32_t k = 13; k < 28; k++) { /* a fifth row, then two are lost */
        iqfoc_recorder_take(&recorder, UINT32_C(1) << k);
    }
    TEST_ASSERT_EQUAL_HEX32(0x1E000, (uint32_t)memory[9]);
    TEST_ASSERT_EQUAL_UINT32(2, recorder.lost);
    TEST_ASSERT_EQUAL_HEX32(0xFFE0000, (uint32_t)recorder.status);
    for (uint32_t k = 0; k < 1000; k++) {
        (void)iqfoc_recorder_octet(&recorder);
    }
    iqfoc_recorder_take(&recorder, UINT32_C(1) << 28);
    TEST_ASSERT_EQUAL_HEX32(0x1FFE0000, (uint32_t)memory[1]);
    iqfoc_recorder_arm(&recorder);
    iqfoc_recorder_take(&recorder, 2);
    TEST_ASSERT_EQUAL_HEX32(2, (uint32_t)memory[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_armed_by_a_request);
    RUN_TEST(test_stopped_and_begun_again);
    RUN_TEST(test_refused);
    RUN_TEST(test_a_request_waits_for_the_frame);
    RUN_TEST(test_damaged_requests);
    RUN_TEST(test_the_host_writes_the_format);
    RUN_TEST(test_status_channel);
    return UNITY_END();
}
