/*
 * Recording in the loop (pil_recorder.h).
 */
#include "pil_recorder.h"

#include "console.h"

#include "iqfoc/recorder.h"

/* Of a second at 8 kHz: nine channels, and each row's number. */
#define MEMORY_WORDS (8000 * 10)

/* 2 pi, a turn in radians. */
#define TURN_MANTISSA 1686629713
#define TURN_SHIFT    28

static iqfoc_recorder_t recorder;
static iqfoc_recorder_config_t config;
static int32_t memory[MEMORY_WORDS];
static bool running;

/* A per-unit variable: 2^-24 of the base per step. */
static void channel_add(const int32_t *source, iqfoc_recorder_column_t column, int32_t mantissa,
                        int32_t shift)
{
    const iqfoc_recorder_channel_t channel = {source, (uint32_t)column, mantissa, (uint32_t)shift + 24};
    config.channels[config.channel_count++] = channel;
}

/* A variable whose 1.0 is a duty of 1. */
static void channel_add_share(const int32_t *source, iqfoc_recorder_column_t column)
{
    channel_add(source, column, 1, 0);
}

static pil_bases_t begin(const pil_frame_t *frame)
{
    pil_bases_t b;
    pil_record_read(frame, &b);
    config.channel_count = 0;
    config.decimation = 1;
    config.trigger = IQFOC_RECORDER_NOW;
    config.period_mantissa = (uint32_t)b.T_mantissa;
    config.period_shift = (uint32_t)b.T_shift;
    return b;
}

static int32_t end(void)
{
    const iqfoc_error_t refused = iqfoc_recorder_init(&recorder, &config, memory, MEMORY_WORDS);
    running = refused == IQFOC_OK;
    return (int32_t)refused;
}

int32_t pil_recorder_start(const pil_frame_t *frame, const iqfoc_cycle_t *cycle)
{
    const pil_bases_t b = begin(frame);
    channel_add(&cycle->i_valley.alpha, IQFOC_RECORDER_I_ALPHA, b.I_mantissa, b.I_shift);
    channel_add(&cycle->i_valley.beta, IQFOC_RECORDER_I_BETA, b.I_mantissa, b.I_shift);
    channel_add(&cycle->theta_valley, IQFOC_RECORDER_THETA_E, TURN_MANTISSA, TURN_SHIFT);
    channel_add(&cycle->rotor.speed, IQFOC_RECORDER_OMEGA_E, b.omega_mantissa, b.omega_shift);
    channel_add(&cycle->u_now.alpha, IQFOC_RECORDER_U_ALPHA, b.U_mantissa, b.U_shift);
    channel_add(&cycle->u_now.beta, IQFOC_RECORDER_U_BETA, b.U_mantissa, b.U_shift);
    const iqfoc_recorder_channel_t status = IQFOC_RECORDER_STATUS_CHANNEL(recorder);
    config.channels[config.channel_count++] = status;
    return end();
}

int32_t pil_recorder_at_alarm(const pil_frame_t *frame, const tuned_firmware_t *t)
{
    const pil_bases_t b = begin(frame);
    config.trigger = IQFOC_RECORDER_STATUS;
    config.status_bits = TUNED_FIRMWARE_ALARM;
    channel_add(&t->sample.i.a, IQFOC_RECORDER_I_A, b.I_mantissa, b.I_shift);
    channel_add(&t->sample.i.b, IQFOC_RECORDER_I_B, b.I_mantissa, b.I_shift);
    channel_add(&t->sample.i.c, IQFOC_RECORDER_I_C, b.I_mantissa, b.I_shift);
    channel_add(&t->sample.theta, IQFOC_RECORDER_THETA_E, TURN_MANTISSA, TURN_SHIFT);
    channel_add(&t->sample.speed, IQFOC_RECORDER_OMEGA_E, b.omega_mantissa, b.omega_shift);
    channel_add_share(&t->high_now.a, IQFOC_RECORDER_D_A);
    channel_add_share(&t->high_now.b, IQFOC_RECORDER_D_B);
    channel_add_share(&t->high_now.c, IQFOC_RECORDER_D_C);
    channel_add(&t->sample.u_dc, IQFOC_RECORDER_U_DC, b.U_mantissa, b.U_shift);
    return end();
}

void pil_recorder_arm(void)
{
    if (running) {
        iqfoc_recorder_arm(&recorder);
    }
}

void pil_recorder_take(uint32_t status)
{
    if (running) {
        iqfoc_recorder_take(&recorder, status);
    }
}

void pil_recorder_drain(void)
{
    int32_t octet;
    while (running && (octet = console_receive()) >= 0) {
        iqfoc_recorder_receive(&recorder, (uint32_t)octet);
    }
    if (running && iqfoc_recorder_requested(&recorder)) {
        (void)iqfoc_recorder_obey(&recorder);
    }
    while (running && (octet = iqfoc_recorder_octet(&recorder)) >= 0) {
        console_send(octet);
    }
}

void pil_recorder_finish(void)
{
    if (running) {
        iqfoc_recorder_stop(&recorder);
        pil_recorder_drain();
    }
}
