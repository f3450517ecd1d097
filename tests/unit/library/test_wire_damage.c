/*
 * Damaged lines: bit errors, cuts, bursts and text mixed in, 20,000 streams. Nothing may be invented, and
 * nothing may be missing without a count.
 */
#include "recorder_line.h"

#include "reference.h"

#define STREAMS  20000
#define ROWS     120
#define SEED     UINT64_C(20131120)
#define LINE_MAX 8192

static uint8_t clean[LINE_MAX];
static size_t clean_length;
static uint8_t damaged[2 * LINE_MAX];

void setUp(void)
{
}

void tearDown(void)
{
}

/* One stream of ROWS rows as it leaves the target. */
static void make_clean(void)
{
    static int32_t source[LINE_CHANNELS];
    static int32_t memory[80];
    const iqfoc_recorder_config_t config = line_config(source);
    iqfoc_recorder_t recorder;
    TEST_ASSERT_EQUAL(IQFOC_OK, iqfoc_recorder_init(&recorder, &config, memory, 80));
    iqfoc_recorder_arm(&recorder);
    clean_length = 0;
    for (uint32_t cycle = 0; cycle <= ROWS; cycle++) {
        int32_t octet;
        if (cycle == ROWS) {
            iqfoc_recorder_stop(&recorder);
        }
        line_record(&recorder, source, cycle, 0);
        /* Three cycles a time, so that frames hold several rows. */
        while ((cycle % 3 == 2 || cycle == ROWS) && (octet = iqfoc_recorder_octet(&recorder)) >= 0) {
            clean[clean_length++] = (uint8_t)octet;
        }
    }
    TEST_ASSERT_TRUE(iqfoc_recorder_finished(&recorder));
}

static size_t below(uint64_t *random, size_t limit)
{
    return (size_t)(random_bits(random) % limit);
}

/* Removes `count` octets at `at`, and puts `text` there. Returns the new length. */
static size_t replace(size_t length, size_t at, size_t count, const void *text, size_t text_length)
{
    memmove(damaged + at + text_length, damaged + at + count, length - at - count);
    memcpy(damaged + at, text, text_length);
    return length - count + text_length;
}

/* Damages the line in one of its ways, one to four times over. Returns the new length. */
static size_t damage(uint64_t *random)
{
    static const char text[] = "\r\nE (4711) wifi: out of buffers \xC0 retry\r\n";
    size_t length = clean_length;
    memcpy(damaged, clean, length);
    const size_t times = 1 + below(random, 4);
    for (size_t k = 0; k < times && length > 100; k++) {
        const size_t at = below(random, length - 1);
        switch (below(random, 6)) {
        case 0: /* bit error */
            damaged[at] ^= (uint8_t)(1u << below(random, 8));
            break;
        case 1: { /* burst */
            const size_t end = at + 1 + below(random, 30);
            for (size_t n = at; n < end && n < length; n++) {
                damaged[n] = (uint8_t)random_bits(random);
            }
            break;
        }
        case 2: { /* octets dropped, as by an overrun receiver */
            const size_t most = length - at < 300 ? length - at : 300;
            length = replace(length, at, 1 + below(random, most), "", 0);
            break;
        }
        case 3: /* text of somebody else on the line */
            length = replace(length, at, 0, text, 1 + below(random, sizeof text - 1));
            break;
        case 4: /* end of the line */
            length = at + 1;
            break;
        default: /* an octet doubled */
            length = replace(length, at, 0, &damaged[at], 1);
            break;
        }
    }
    return length;
}

static void test_damaged_streams(void)
{
    static wire_reader reader;
    static line_rows rows;
    uint64_t random = SEED;
    unsigned long whole = 0;
    unsigned long rows_left = 0;
    make_clean();
    printf("seed %llu, %d streams of %zu octets\n", (unsigned long long)SEED, STREAMS, clean_length);
    for (int n = 0; n < STREAMS; n++) {
        memset(&reader, 0, sizeof reader);
        memset(&rows, 0, sizeof rows);
        size_t length = damage(&random);
        /* In pieces of any size, as a line delivers them. */
        for (size_t at = 0; at < length;) {
            size_t piece = 1 + below(&random, 700);
            piece = piece < length - at ? piece : length - at;
            TEST_ASSERT_TRUE(wire_read(&reader, damaged + at, piece, line_take, &rows));
            at += piece;
        }
        wire_close(&reader);
        TEST_ASSERT_EQUAL_MESSAGE(0, rows.false_values, "a row that was never sent");
        for (size_t k = 0; k < rows.count; k++) {
            TEST_ASSERT_TRUE_MESSAGE(rows.cycle[k] < ROWS, "a cycle that never was");
            TEST_ASSERT_TRUE_MESSAGE(k == 0 || rows.cycle[k] > rows.cycle[k - 1],
                                     "a row twice, or backwards");
            TEST_ASSERT_TRUE_MESSAGE(rows.after_gap[k] || rows.cycle[k] == rows.cycle[k - 1] + 1,
                                     "a stretch goes on over a gap");
        }
        const wire_counts *c = &reader.counts;
        /* Every row is here or counted: of all with the end frame, else of those between the first and the last that came. */
        if (reader.ended) {
            TEST_ASSERT_EQUAL(ROWS, rows.count + c->missing_rows);
        } else if (rows.count > 0) {
            TEST_ASSERT_EQUAL(rows.cycle[rows.count - 1] - rows.cycle[0] + 1, rows.count + c->missing_rows);
        }
        if (rows.count < ROWS) {
            TEST_ASSERT_TRUE_MESSAGE(c->damaged + c->lost_frames + c->headless_rows > 0 || !reader.ended,
                                     "rows are missing, and nothing says so");
        }
        whole += rows.count == ROWS;
        rows_left += rows.count;
    }
    printf("%lu streams lost no row, %.1f %% of all rows survived\n", whole,
           100.0 * (double)rows_left / ROWS / STREAMS);
    /* Resynchronising costs no more than the frames that were hit: seen 71 %. */
    TEST_ASSERT_TRUE((double)rows_left > 0.6 * ROWS * STREAMS);
    TEST_ASSERT_TRUE(whole < STREAMS / 2);
}

/* Noise alone: no row at all. */
static void test_noise(void)
{
    static wire_reader reader;
    static line_rows rows;
    uint64_t random = SEED + 1;
    for (int n = 0; n < 2000; n++) {
        memset(&reader, 0, sizeof reader);
        memset(&rows, 0, sizeof rows);
        for (size_t k = 0; k < 2000; k++) {
            damaged[k] = (uint8_t)random_bits(&random);
        }
        TEST_ASSERT_TRUE(wire_read(&reader, damaged, 2000, line_take, &rows));
        TEST_ASSERT_EQUAL(0, rows.count);
        TEST_ASSERT_TRUE(reader.counts.damaged > 0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_damaged_streams);
    RUN_TEST(test_noise);
    return UNITY_END();
}
