/*
 * Digest of the recorder (golden_recorder.h): the octets that go out while cycles are recorded. A new configuration
 * every thousand cycles; the line is now faster than the recording, now slower, so that rows are lost. Octets come in, too: noise, and
 * requests.
 */
#include "golden_recorder.h"

#include "golden_types.h"

#include "iqfoc/recorder.h"

#define AGAIN 1000
#define WORDS 60

static int32_t variables[3];
static int32_t memory[WORDS];
static iqfoc_recorder_config_t config;
static iqfoc_recorder_t recorder;

static uint32_t below(golden_inputs_t *inputs, uint32_t limit)
{
    return (uint32_t)golden_positive(inputs, (iq24_t)limit - 1);
}

static void begin(golden_inputs_t *inputs, uint64_t *digest)
{
    for (uint32_t k = 0; k < 3; k++) {
        const iqfoc_recorder_channel_t channel = {&variables[k], k, 1 + golden_positive(inputs, IQ24_ONE),
                                                  24 + below(inputs, 8)};
        config.channels[k] = channel;
    }
    config.channel_count = 1 + below(inputs, 3);
    config.decimation = 1 + below(inputs, 4);
    config.period_mantissa = 1 + below(inputs, 1U << 30);
    config.period_shift = below(inputs, 63);
    config.trigger = (iqfoc_recorder_trigger_t)below(inputs, 4);
    config.status_bits = 1;
    config.channel = 0;
    config.level = golden_within(inputs, IQ24(0.5));
    config.pre_share = golden_positive(inputs, IQ24_ONE - 1);
    digest_add(digest, (int32_t)iqfoc_recorder_init(&recorder, &config, memory, WORDS));
    iqfoc_recorder_arm(&recorder);
}

static void receive(uint32_t octet)
{
    if (octet == 0xC0 || octet == 0xDB) {
        iqfoc_recorder_receive(&recorder, 0xDB);
        iqfoc_recorder_receive(&recorder, octet == 0xC0 ? 0xDC : 0xDD);
    } else {
        iqfoc_recorder_receive(&recorder, octet);
    }
}

/* A request with its CRC; one in four is one that the recorder refuses. */
static void ask(golden_inputs_t *inputs)
{
    const uint32_t words[7] = {0x0401 | below(inputs, 1U << 16) << 16,
                               below(inputs, 6),
                               below(inputs, 4),
                               below(inputs, 4),
                               (uint32_t)golden_within(inputs, IQ24_ONE),
                               below(inputs, IQ24_ONE + (1U << 20)),
                               below(inputs, 6)};
    uint32_t crc = UINT32_MAX;
    iqfoc_recorder_receive(&recorder, 0xC0);
    for (uint32_t k = 0; k < 28; k++) {
        const uint32_t octet = (words[k / 4] >> (8 * (k % 4))) & 0xFF;
        crc ^= octet;
        for (uint32_t bit = 0; bit < 8; bit++) {
            crc = (crc & 1) != 0 ? crc >> 1 ^ 0xEDB88320 : crc >> 1;
        }
        receive(octet);
    }
    for (uint32_t k = 0; k < 4; k++) {
        receive((~crc >> (8 * k)) & 0xFF);
    }
    iqfoc_recorder_receive(&recorder, 0xC0);
}

void golden_recorder(golden_inputs_t *inputs, uint64_t *digest)
{
    if (inputs->number % AGAIN == 0) {
        begin(inputs, digest);
    }
    const uint32_t octets = inputs->number++ / 100 % 2 == 0 ? 40 : 6;
    for (uint32_t k = 0; k < 3; k++) {
        variables[k] = golden_within(inputs, IQ24_ONE);
    }
    iqfoc_recorder_take(&recorder, below(inputs, 100) == 7 ? 1 : 0);
    if (inputs->number % AGAIN == AGAIN - 100) {
        iqfoc_recorder_stop(&recorder);
    }
    if (inputs->number % 130 == 0) {
        ask(inputs);
    } else if (inputs->number % 13 == 0) {
        iqfoc_recorder_receive(&recorder, below(inputs, 256));
    }
    if (iqfoc_recorder_requested(&recorder)) {
        digest_add(digest, (int32_t)iqfoc_recorder_obey(&recorder));
    }
    for (uint32_t k = 0; k < octets; k++) {
        digest_add(digest, iqfoc_recorder_octet(&recorder));
    }
    digest_add(digest, iqfoc_recorder_finished(&recorder) ? 1 : 0);
}
