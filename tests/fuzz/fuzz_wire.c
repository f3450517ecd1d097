/*
 * The recorder's line: no stream does harm or gives a row that is in no whole frame.
 *
 * A first byte that is odd: octets as they come. Even: a list of frames with correct CRC and escapes, since random
 * bytes hardly pass a CRC of 32 bits.
 */
#include "fuzz.h"
#include "record/wire_reader.h"

#include <math.h>
#include <zlib.h>

typedef struct rows_seen {
    unsigned long rows;
} rows_seen;

static bool take_row(void *context, const wire_header *header, const wire_row *row)
{
    rows_seen *seen = context;
    fuzz_expect(header->channels >= 1 && header->channels <= IQFOC_RECORDER_CHANNELS_MAX &&
                    header->decimation > 0,
                "a row has a header that can be");
    for (size_t k = 0; k < header->channels; k++) {
        fuzz_expect(isfinite(header->channel[k].scale * (double)row->value[k]),
                    "every value on the wire is finite");
    }
    seen->rows++;
    return true;
}

static void put_escaped(wire_reader *r, rows_seen *seen, const uint8_t *octets, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const uint8_t end[2] = {0xDB, 0xDC};
        const uint8_t escape[2] = {0xDB, 0xDD};
        if (octets[k] == 0xC0) {
            wire_read(r, end, 2, take_row, seen);
        } else if (octets[k] == 0xDB) {
            wire_read(r, escape, 2, take_row, seen);
        } else {
            wire_read(r, &octets[k], 1, take_row, seen);
        }
    }
}

static void put_word(uint8_t *octets, uint32_t word)
{
    for (size_t k = 0; k < 4; k++) {
        octets[k] = (uint8_t)(word >> (8 * k) & 0xFF);
    }
}

/* A frame of so many words of the input and their CRC. */
static void put_frame(wire_reader *r, rows_seen *seen, fuzz_bytes *b)
{
    static const uint8_t mark = 0xC0;
    uint8_t frame[4 * (WIRE_WORDS_MAX + 8)];
    const size_t words = fuzz_take(b, 1) % (WIRE_WORDS_MAX + 7);
    for (size_t k = 0; k < words; k++) {
        put_word(&frame[4 * k], fuzz_take(b, 4));
    }
    put_word(&frame[4 * words], (uint32_t)crc32(0, frame, (uInt)(4 * words)));
    put_escaped(r, seen, frame, 4 * (words + 1));
    wire_read(r, &mark, 1, take_row, seen);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    wire_reader reader = {0};
    rows_seen seen = {0};
    fuzz_bytes b = {data, size};
    if (fuzz_take(&b, 1) % 2 == 1) {
        wire_read(&reader, b.data, b.left, take_row, &seen);
    } else {
        while (b.left > 0) {
            put_frame(&reader, &seen, &b);
        }
    }
    wire_close(&reader);
    fuzz_expect(seen.rows <= 8 * reader.counts.frames, "every row is in a whole frame");
    return 0;
}
