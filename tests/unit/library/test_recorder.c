/* The recorder: ring, triggers, decimation, and that every loss is visible; read back by the host's own reader. */
#include "recorder_line.h"

#include "iqfoc/recorder.h"

#include "unity.h"

static int32_t source[LINE_CHANNELS];
static int32_t memory[400];
static iqfoc_recorder_config_t config;
static iqfoc_recorder_t recorder;
static wire_reader reader;
static line_rows rows;
static uint32_t cycle;

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
    TEST_ASSERT_EQUAL(IQFOC_OK, iqfoc_recorder_init(&recorder, &config, memory, 400)); /* 100 rows */
    iqfoc_recorder_arm(&recorder);
}

static void take(uint32_t status)
{
    line_record(&recorder, source, cycle++, status);
}

/* Lets at most `most` octets over the line. */
static void drain(size_t most)
{
    for (size_t k = 0; k < most; k++) {
        const int32_t octet = iqfoc_recorder_octet(&recorder);
        if (octet < 0) {
            return;
        }
        TEST_ASSERT_TRUE(octet <= 255);
        const uint8_t one = (uint8_t)octet;
        TEST_ASSERT_TRUE(wire_read(&reader, &one, 1, line_take, &rows));
    }
}

static void check_undamaged(void)
{
    wire_close(&reader);
    TEST_ASSERT_EQUAL(0, reader.counts.damaged);
    TEST_ASSERT_EQUAL(0, reader.counts.lost_frames);
    TEST_ASSERT_EQUAL(0, reader.counts.headless_rows);
    TEST_ASSERT_EQUAL(0, rows.false_values);
}

/* rows.cycle[0 ...] = first, first + step, ... and one stretch. */
static void check_series(uint32_t first, uint32_t step, size_t count)
{
    TEST_ASSERT_EQUAL(count, rows.count);
    for (size_t k = 0; k < count; k++) {
        TEST_ASSERT_EQUAL_UINT32(first + (uint32_t)k * step, rows.cycle[k]);
        TEST_ASSERT_EQUAL(k == 0, rows.after_gap[k]);
    }
}

static void test_refuses_by_name(void)
{
    iqfoc_recorder_t untouched;
    memset(&untouched, 0x5A, sizeof untouched);
    recorder = untouched;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_NULL, iqfoc_recorder_init(&recorder, &config, NULL, 400));
    TEST_ASSERT_EQUAL(IQFOC_ERROR_MEMORY, iqfoc_recorder_init(&recorder, &config, memory, 7));
    config.channel_count = 0;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_CHANNELS, iqfoc_recorder_init(&recorder, &config, memory, 400));
    config.channel_count = IQFOC_RECORDER_CHANNELS_MAX + 1;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_CHANNELS, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.channels[2].source = NULL;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_CHANNELS, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.channels[1].mantissa = 0;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_CHANNELS, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.channels[0].shift = 63;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_CHANNELS, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.decimation = 0;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_PERIOD, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.period_mantissa = 0;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_PERIOD, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.trigger = (iqfoc_recorder_trigger_t)9;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_TRIGGER, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.pre_share = IQ24_ONE;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_TRIGGER, iqfoc_recorder_init(&recorder, &config, memory, 400));
    setUp();
    config.channel = LINE_CHANNELS;
    TEST_ASSERT_EQUAL(IQFOC_ERROR_TRIGGER, iqfoc_recorder_init(&recorder, &config, memory, 400));
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &recorder, sizeof recorder);
}

/* Every speed of the line from too fast to just enough, the ring wrapping many times. */
static void test_stream_at_every_speed(void)
{
    for (size_t octets_per_cycle = 33; octets_per_cycle < 200; octets_per_cycle += 7) {
        setUp();
        start();
        for (int k = 0; k < 1000; k++) {
            take(0);
            drain(octets_per_cycle);
        }
        iqfoc_recorder_stop(&recorder);
        take(0); /* no longer recorded */
        drain(SIZE_MAX);
        TEST_ASSERT_TRUE(iqfoc_recorder_finished(&recorder));
        check_undamaged();
        check_series(0, 1, 1000);
        TEST_ASSERT_TRUE(reader.ended);
        TEST_ASSERT_EQUAL_UINT32(1000, reader.rows_sent);
        TEST_ASSERT_EQUAL(0, reader.counts.lost_rows);
        TEST_ASSERT_EQUAL(LINE_CHANNELS, reader.header.channels);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, 2e-4, reader.header.T_s);
        TEST_ASSERT_EQUAL(-1, iqfoc_recorder_octet(&recorder));
    }
}

/* A line too slow: missing rows are counted, and a gap is at their place. */
static void test_slow_line_loses_nothing_unseen(void)
{
    for (size_t octets_per_cycle = 3; octets_per_cycle < 16; octets_per_cycle++) {
        setUp();
        start();
        for (int k = 0; k < 2000; k++) {
            take(0);
            drain(octets_per_cycle);
        }
        iqfoc_recorder_stop(&recorder);
        drain(SIZE_MAX);
        check_undamaged();
        TEST_ASSERT_TRUE(reader.counts.lost_rows > 0);
        TEST_ASSERT_EQUAL(2000, rows.count + reader.counts.lost_rows);
        TEST_ASSERT_EQUAL_UINT32(rows.count, reader.rows_sent);
        size_t missing = 0;
        for (size_t k = 1; k < rows.count; k++) {
            const uint32_t step = rows.cycle[k] - rows.cycle[k - 1];
            TEST_ASSERT_EQUAL(step != 1, rows.after_gap[k]);
            missing += step - 1;
        }
        missing += 1999 - rows.cycle[rows.count - 1];
        TEST_ASSERT_EQUAL(reader.counts.lost_rows, missing);
        TEST_ASSERT_EQUAL(reader.counts.lost_rows, reader.counts.missing_rows);
    }
}

static void test_decimation(void)
{
    config.decimation = 7;
    start();
    for (int k = 0; k < 700; k++) {
        take(0);
        drain(50);
    }
    iqfoc_recorder_stop(&recorder);
    drain(SIZE_MAX);
    check_undamaged();
    check_series(0, 7, 100);
}

static void test_status_trigger_with_share_before(void)
{
    const double shares[4] = {0.0, 0.25, 0.5, 0.99};
    for (int s = 0; s < 4; s++) {
        setUp();
        config.trigger = IQFOC_RECORDER_STATUS;
        config.status_bits = 0x12;
        config.pre_share = (iq24_t)(shares[s] * IQ24_ONE);
        start();
        take(0x10); /* up from the beginning: no event */
        for (int k = 1; k < 350; k++) {
            take(0x11);
            drain(100);
        }
        TEST_ASSERT_EQUAL(0, rows.count);
        take(0x13); /* cycle 350 */
        for (int k = 0; k < 300; k++) {
            take(0x00);
            drain(100);
        }
        drain(SIZE_MAX);
        TEST_ASSERT_TRUE(iqfoc_recorder_finished(&recorder));
        check_undamaged();
        /* 0.99 of 100 rows is 98 whole ones: 0.99 is not an IQ24. */
        const uint32_t before = (uint32_t)(100.0 * (config.pre_share / 16777216.0));
        check_series(350 - before, 1, 100);
    }
}

static void test_level_triggers(void)
{
    for (int way = 0; way < 2; way++) {
        setUp();
        config.trigger = way == 0 ? IQFOC_RECORDER_RISES : IQFOC_RECORDER_FALLS;
        config.channel = 1;
        config.level = 1000;
        config.pre_share = IQ24(0.1);
        start();
        const int32_t side = way == 0 ? -1 : 1;
        for (int k = 0; k < 300; k++) {
            source[0] = line_value(cycle, 0);
            source[1] = 1000 + side * (cycle < 200 ? 5 : -5);
            source[2] = line_value(cycle, 2);
            iqfoc_recorder_take(&recorder, 0);
            cycle++;
        }
        drain(SIZE_MAX);
        TEST_ASSERT_EQUAL(100, rows.count);
        TEST_ASSERT_EQUAL_UINT32(200 - 10, rows.cycle[0]);
    }
}

/* Never triggered: stopping sends the rows recorded before, and an end. */
static void test_stop_before_the_trigger(void)
{
    config.trigger = IQFOC_RECORDER_STATUS;
    config.status_bits = 1;
    config.pre_share = IQ24(0.5);
    start();
    for (int k = 0; k < 30; k++) {
        take(0);
    }
    iqfoc_recorder_stop(&recorder);
    drain(SIZE_MAX);
    check_undamaged();
    check_series(0, 1, 30);
    TEST_ASSERT_TRUE(reader.ended);
}

static void test_armed_again_is_another_stream(void)
{
    start();
    for (int k = 0; k < 20; k++) {
        take(0);
    }
    iqfoc_recorder_stop(&recorder);
    drain(SIZE_MAX);
    cycle = 0;
    iqfoc_recorder_arm(&recorder);
    TEST_ASSERT_FALSE(iqfoc_recorder_finished(&recorder));
    take(0);
    iqfoc_recorder_stop(&recorder);
    drain(SIZE_MAX);
    check_undamaged();
    TEST_ASSERT_EQUAL(21, rows.count);
    TEST_ASSERT_TRUE(rows.after_gap[20]);
    TEST_ASSERT_EQUAL_UINT32(0, rows.cycle[20]);
}

/* Joining in the middle: nothing before the next header, all after it. */
static void test_late_listener(void)
{
    start();
    for (int k = 0; k < 500; k++) {
        take(0);
        if (cycle < 105) {
            while (iqfoc_recorder_octet(&recorder) >= 0) {
            }
        }
        drain(SIZE_MAX);
    }
    iqfoc_recorder_stop(&recorder);
    drain(SIZE_MAX);
    TEST_ASSERT_EQUAL(0, reader.counts.damaged);
    TEST_ASSERT_TRUE(reader.counts.headless_rows > 0);
    TEST_ASSERT_EQUAL(0, rows.false_values);
    TEST_ASSERT_EQUAL(500 - 104, rows.count + reader.counts.headless_rows);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_refuses_by_name);
    RUN_TEST(test_stream_at_every_speed);
    RUN_TEST(test_slow_line_loses_nothing_unseen);
    RUN_TEST(test_decimation);
    RUN_TEST(test_status_trigger_with_share_before);
    RUN_TEST(test_level_triggers);
    RUN_TEST(test_stop_before_the_trigger);
    RUN_TEST(test_armed_again_is_another_stream);
    RUN_TEST(test_late_listener);
    return UNITY_END();
}
