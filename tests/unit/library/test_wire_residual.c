/*
 * Probability that a damaged frame is accepted, as the recorder's header, docs/recorder-format.md and the emulated
 * board's header state it: by enumeration of the fewest wrong bits, and by counting how evenly all other damage is
 * distributed.
 */
#include "pil_wire.h"
#include "recorder_line.h"
#include "reference.h"

#include "unity.h"

#define SEED UINT64_C(20190820)

/* Longest frames in bits, CRC included: WIRE_WORDS_MAX words; all of PIL_FRAME_MAX but the sync byte. */
#define RECORDER_BITS ((size_t)32 * WIRE_WORDS_MAX)
#define PIL_BITS      ((size_t)8 * (PIL_FRAME_MAX - 1))
#define POLYNOMIAL    0xEDB88320U

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- What the check sees of a wrong bit ---- */

/*
 * Wrong bits together show as the exclusive or of what each shows; a result of 0 is undetected. From the frame's end
 * on.
 */
static uint32_t syndrome[RECORDER_BITS];

static void make_syndromes(void)
{
    for (uint32_t k = 0; k < 32; k++) {
        syndrome[k] = 1U << k; /* in the CRC itself */
    }
    uint32_t s = POLYNOMIAL;
    for (size_t k = 32; k < RECORDER_BITS; k++) {
        syndrome[k] = s;
        s = (s & 1) != 0 ? s >> 1 ^ POLYNOMIAL : s >> 1;
    }
}

/* The CRC-32 once more, by octets. */
static uint32_t crc_of(const uint8_t *octets, size_t count)
{
    static uint32_t table[256];
    for (uint32_t k = 0; table[255] == 0 && k < 256; k++) {
        uint32_t entry = k;
        for (int bit = 0; bit < 8; bit++) {
            entry = (entry & 1) != 0 ? entry >> 1 ^ POLYNOMIAL : entry >> 1;
        }
        table[k] = entry;
    }
    uint32_t crc = UINT32_MAX;
    for (size_t k = 0; k < count; k++) {
        crc = crc >> 8 ^ table[(crc ^ octets[k]) & 255];
    }
    return ~crc;
}

/* The table above is that of this CRC: a bit turned in a frame shows as it says. */
static void test_a_wrong_bit_shows_as_computed(void)
{
    static uint8_t frame[RECORDER_BITS / 8 - 4];
    for (size_t k = 0; k < sizeof frame; k++) {
        frame[k] = (uint8_t)(k * 37);
    }
    const uint32_t right = crc_of(frame, sizeof frame);
    for (size_t k = 0; k < 8 * sizeof frame; k++) {
        const size_t from_end = 8 * sizeof frame - 1 - k;
        frame[k / 8] ^= (uint8_t)(1U << k % 8);
        TEST_ASSERT_EQUAL_HEX32(syndrome[32 + from_end], right ^ crc_of(frame, sizeof frame));
        frame[k / 8] ^= (uint8_t)(1U << k % 8);
    }
}

enum { SLOTS = 32768 };

static uint32_t slot_value[SLOTS];

/* Puts a value into the open table; false if it is there already. */
static bool is_new(uint32_t value)
{
    uint32_t at = value * 2654435761U >> 17;
    while (slot_value[at] != 0 && slot_value[at] != value) {
        at = (at + 1) % SLOTS;
    }
    const bool fresh = slot_value[at] == 0;
    slot_value[at] = value;
    return fresh;
}

static bool is_there(uint32_t value)
{
    uint32_t at = value * 2654435761U >> 17;
    while (slot_value[at] != 0 && slot_value[at] != value) {
        at = (at + 1) % SLOTS;
    }
    return slot_value[at] != 0;
}

/* No one, two or three wrong bits of the recorder's longest frame, in any places, give 0. */
static void test_the_recorder_sees_any_three_bits(void)
{
    memset(slot_value, 0, sizeof slot_value);
    for (size_t k = 0; k < RECORDER_BITS; k++) {
        TEST_ASSERT_NOT_EQUAL(0, syndrome[k]);
        TEST_ASSERT_TRUE_MESSAGE(is_new(syndrome[k]), "two wrong bits that nobody sees");
    }
    for (size_t a = 0; a < RECORDER_BITS; a++) {
        for (size_t b = 0; b < a; b++) {
            if (is_there(syndrome[a] ^ syndrome[b])) {
                TEST_FAIL_MESSAGE("three wrong bits that nobody sees");
            }
        }
    }
}

static int compare(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a;
    const uint32_t y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Nor any four of the emulated board's: no two pairs look alike, and no pair looks like one bit. */
static void test_the_board_sees_any_four_bits(void)
{
    static uint32_t pair[PIL_BITS * (PIL_BITS - 1) / 2 + PIL_BITS];
    size_t pairs = 0;
    for (size_t a = 0; a < PIL_BITS; a++) {
        pair[pairs++] = syndrome[a];
        for (size_t b = 0; b < a; b++) {
            pair[pairs++] = syndrome[a] ^ syndrome[b];
        }
    }
    qsort(pair, pairs, sizeof *pair, compare);
    for (size_t k = 1; k < pairs; k++) {
        TEST_ASSERT_TRUE(pair[k] != 0 && pair[k] != pair[k - 1]);
    }
}

/* ---- Any other damage ---- */

/* Turns over, shifts or overwrites a part longer than the CRC, or flips four bits and more. */
static void spoil(uint8_t *frame, size_t octets, uint64_t *random)
{
    const size_t length = 5 + (size_t)(random_bits(random) % 60);
    const size_t at = (size_t)(random_bits(random) % (octets - length));
    switch (random_bits(random) % 3) {
    case 0: /* noise */
        for (size_t k = at; k < at + length; k++) {
            frame[k] = (uint8_t)random_bits(random);
        }
        break;
    case 1: /* an octet lost here and one too many there, as when an escape is hit and another made */
        memmove(&frame[at], &frame[at + 1], length - 1);
        frame[at + length - 1] = (uint8_t)random_bits(random);
        break;
    default: /* scattered bits */
        for (size_t k = 0; k < length; k++) {
            const size_t bit = (size_t)(random_bits(random) % (8 * octets));
            frame[bit / 8] ^= (uint8_t)(1U << bit % 8);
        }
    }
}

enum { DAMAGED = 200000, LOW_BITS = 12 };

/*
 * Of 32 bits that a damaged frame's CRC must agree in, each agrees by chance, independently of the others: of all damaged frames
 * 2^-k agree in the lowest k, and so 2^-32 in all.
 */
static void test_other_damage_falls_evenly(void)
{
    static uint8_t whole[RECORDER_BITS / 8];
    static uint8_t frame[RECORDER_BITS / 8];
    const size_t octets = sizeof whole - 4;
    size_t agree[LOW_BITS + 1] = {0};
    size_t unseen = 0;
    uint64_t random = SEED;
    for (size_t k = 0; k < octets; k++) {
        whole[k] = (uint8_t)random_bits(&random);
    }
    const uint32_t right = crc_of(whole, octets);
    for (int n = 0; n < 4; n++) {
        whole[octets + (size_t)n] = (uint8_t)(right >> 8 * n);
    }
    for (int n = 0; n < DAMAGED; n++) {
        memcpy(frame, whole, sizeof whole);
        while (memcmp(frame, whole, sizeof whole) == 0) {
            spoil(frame, sizeof frame, &random);
        }
        const uint8_t *sent = &frame[octets];
        const uint32_t seen = crc_of(frame, octets) ^ ((uint32_t)sent[0] | (uint32_t)sent[1] << 8 |
                                                       (uint32_t)sent[2] << 16 | (uint32_t)sent[3] << 24);
        unseen += seen == 0;
        for (int k = 1; k <= LOW_BITS; k++) {
            agree[k] += (seen & ((1U << k) - 1)) == 0;
        }
    }
    printf("seed %llu, %d damaged frames; agreeing in the lowest k bits, measured and 2^-k of them:",
           (unsigned long long)SEED, DAMAGED);
    for (int k = 1; k <= LOW_BITS; k++) {
        const double expected = ldexp((double)DAMAGED, -k);
        printf(" %d: %zu, %.0f;", k, agree[k], expected);
        TEST_ASSERT_TRUE_MESSAGE(fabs((double)agree[k] - expected) < 5.0 * sqrt(expected),
                                 "more or fewer than by chance");
    }
    printf(" in all 32: %zu\n", unseen);
    TEST_ASSERT_EQUAL(0, unseen);
}

/* ---- The readers themselves ---- */

enum { ROWS = 24, LINE_OCTETS = 2048 };

static uint8_t line[LINE_OCTETS];
static size_t line_length;

static void make_line(void)
{
    static int32_t source[LINE_CHANNELS];
    static int32_t memory[4 * ROWS];
    const iqfoc_recorder_config_t config = line_config(source);
    iqfoc_recorder_t recorder;
    TEST_ASSERT_EQUAL(IQFOC_OK, iqfoc_recorder_init(&recorder, &config, memory, 4 * ROWS));
    iqfoc_recorder_arm(&recorder);
    for (uint32_t cycle = 0; cycle < ROWS; cycle++) {
        line_record(&recorder, source, cycle, 0);
    }
    iqfoc_recorder_stop(&recorder);
    int32_t octet;
    for (line_length = 0; (octet = iqfoc_recorder_octet(&recorder)) >= 0; line_length++) {
        line[line_length] = (uint8_t)octet;
    }
}

/* What came of the line as it is now: nothing that was not sent, and a count of what is missing. */
static void read_line(void)
{
    static wire_reader reader;
    static line_rows rows;
    memset(&reader, 0, sizeof reader);
    memset(&rows, 0, sizeof rows);
    TEST_ASSERT_TRUE(wire_read(&reader, line, line_length, line_take, &rows));
    wire_close(&reader);
    TEST_ASSERT_EQUAL(0, rows.false_values);
    TEST_ASSERT_TRUE(rows.count < ROWS || reader.ended || reader.counts.damaged > 0);
    if (reader.ended) {
        TEST_ASSERT_EQUAL(ROWS, rows.count + reader.counts.missing_rows);
    }
}

/* Marks, escapes and all: each bit of the line, and each two that stand within an octet of each other. */
static void test_no_wrong_bit_of_the_recorders_line_is_taken(void)
{
    make_line();
    read_line();
    for (size_t k = 0; k < 8 * line_length; k++) {
        line[k / 8] ^= (uint8_t)(1U << k % 8);
        read_line();
        for (size_t other = k + 1; other < k + 9 && other < 8 * line_length; other++) {
            line[other / 8] ^= (uint8_t)(1U << other % 8);
            read_line();
            line[other / 8] ^= (uint8_t)(1U << other % 8);
        }
        line[k / 8] ^= (uint8_t)(1U << k % 8);
    }
}

static void expect_no_frame(const uint8_t *bytes, uint32_t count)
{
    pil_decoder_t decoder = {.count = 0};
    pil_frame_t frame;
    for (uint32_t k = 0; k < count; k++) {
        TEST_ASSERT_NOT_EQUAL(PIL_WHOLE, pil_decode(&decoder, bytes[k], &frame));
    }
}

/* The board's answer: any two bits of it, sync and type included. */
static void test_no_two_wrong_bits_of_the_boards_line_are_taken(void)
{
    const pil_result_t result = {{{{IQ24(0.4), IQ24(0.5), IQ24(0.6)}, IQ24_ONE}, true}, 5};
    const pil_frame_t frame = pil_command_frame(&result);
    uint8_t bytes[PIL_FRAME_MAX];
    const uint32_t count = pil_encode(&frame, bytes);
    for (uint32_t a = 0; a < 8 * count; a++) {
        bytes[a / 8] ^= (uint8_t)(1U << a % 8);
        expect_no_frame(bytes, count);
        for (uint32_t b = a + 1; b < 8 * count; b++) {
            bytes[b / 8] ^= (uint8_t)(1U << b % 8);
            expect_no_frame(bytes, count);
            bytes[b / 8] ^= (uint8_t)(1U << b % 8);
        }
        bytes[a / 8] ^= (uint8_t)(1U << a % 8);
    }
}

int main(void)
{
    make_syndromes();
    UNITY_BEGIN();
    RUN_TEST(test_a_wrong_bit_shows_as_computed);
    RUN_TEST(test_the_recorder_sees_any_three_bits);
    RUN_TEST(test_the_board_sees_any_four_bits);
    RUN_TEST(test_other_damage_falls_evenly);
    RUN_TEST(test_no_wrong_bit_of_the_recorders_line_is_taken);
    RUN_TEST(test_no_two_wrong_bits_of_the_boards_line_are_taken);
    return UNITY_END();
}
