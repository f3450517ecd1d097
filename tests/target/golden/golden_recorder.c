/*
 * Digest of the recorder (golden_recorder.h): the octets that go out while cycles are recorded. A new configuration
 * every thousand cycles; the line is now faster than the recording, now slower, so that rows are lost.
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
    for (uint32_t k = 0; k < octets; k++) {
        digest_add(digest, iqfoc_recorder_octet(&recorder));
    }
    digest_add(digest, iqfoc_recorder_finished(&recorder) ? 1 : 0);
}
