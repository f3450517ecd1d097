/*
 * The firmware's image for processor in the loop: the HAL here is the simulator at the other end of the line.
 *
 * Samples come in a frame, the two handlers run as they would on an interrupt, the command goes out. Anything
 * that is no frame ends the image: nothing is guessed.
 */
#include "console.h"
#include "pil_wire.h"
#include "semihost.h"

#include "pil_recorder.h"
#include "pil_reference.h"

#include "iqfoc/hal.h"

/* Exit status after a damaged frame. */
#define STATUS_GARBLED 3

struct iqfoc_hal {
    iqfoc_sample_t sample;   /* of the handler that runs */
    iqfoc_command_t command; /* written by the peak's */
};

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;
static tuned_firmware_t tuned;
/* What a configuration that was not refused has started. */
static enum { NOTHING, CYCLE, TUNED } started;

void iqfoc_hal_read_valley(iqfoc_hal_t *h, iqfoc_sample_t *sample)
{
    *sample = h->sample;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *h, iqfoc_sample_t *sample)
{
    *sample = h->sample;
}

void iqfoc_hal_write(iqfoc_hal_t *h, const iqfoc_command_t *command)
{
    h->command = *command;
}

/* Time is the simulator's: no time passes while it waits. */
uint32_t iqfoc_hal_now(iqfoc_hal_t *h)
{
    return h->sample.time;
}

static void send(const pil_frame_t *frame)
{
    uint8_t bytes[PIL_FRAME_MAX];
    semihost_send(bytes, pil_encode(frame, bytes));
}

/* The next frame. More than one is never on its way: the simulator waits for each answer. */
static void receive(pil_frame_t *frame)
{
    static pil_decoder_t decoder;
    for (;;) {
        uint8_t bytes[PIL_FRAME_MAX];
        const uint32_t count = semihost_receive(bytes, sizeof bytes);
        if (count == 0) { /* the simulator has hung up */
            pil_recorder_finish();
            console_exit(0);
        }
        for (uint32_t k = 0; k < count; k++) {
            const pil_decoded_t decoded = pil_decode(&decoder, bytes[k], frame);
            if (decoded == PIL_WHOLE && k + 1 == count) {
                return;
            }
            if (decoded != PIL_MORE) {
                const pil_frame_t garbled = {PIL_GARBLED, 0, {0}};
                send(&garbled);
                console_exit(STATUS_GARBLED);
            }
        }
    }
}

static void answer_started(int32_t refused)
{
    const pil_frame_t answer = {PIL_STARTED, 1, {refused}};
    send(&answer);
}

/* A refused configuration drives nothing, and ends what an earlier one drove. */
static void start(const pil_frame_t *frame)
{
    pil_recorder_finish();
    pil_start_read(frame, &config);
    const iqfoc_error_t refused = iqfoc_cycle_init(&cycle, &config);
    started = refused == IQFOC_OK ? CYCLE : NOTHING;
    if (started == CYCLE) {
        cycle.enabled = true;
        pil_recorder_arm();
    }
    answer_started((int32_t)refused);
}

/* The values are the simulator's, which holds them to the library's ranges. */
static void start_tuned(const pil_frame_t *frame)
{
    tuned_firmware_config_t read;
    pil_recorder_finish();
    pil_tune_read(frame, &read);
    const iqfoc_error_t refused = read.extended != 0 ? iqfoc_extension_check(&read.extension) : IQFOC_OK;
    started = refused == IQFOC_OK ? TUNED : NOTHING;
    if (started == TUNED) {
        tuned_firmware_start(&tuned, &read);
        pil_recorder_arm();
    }
    answer_started((int32_t)refused);
}

static void answer_command(const iqfoc_command_t *command, uint32_t status)
{
    const pil_result_t result = {*command, status};
    const pil_frame_t answer = pil_command_frame(&result);
    send(&answer);
    pil_recorder_drain();
}

static void run_tuned(const pil_frame_t *frame)
{
    iqfoc_dq_t i_ref;
    iqfoc_sample_t valley;
    iqfoc_sample_t peak;
    pil_cycle_read(frame, &i_ref, &valley, &peak);
    tuned_firmware_valley(&tuned, i_ref, &valley);
    pil_recorder_take(tuned.status);
    tuned_firmware_peak(&tuned, &peak);
    answer_command(&tuned.command, tuned.status);
}

static void answer_watched(void)
{
    const iqfoc_watch_t *watch = &tuned.watch;
    const pil_watched_t watched = {(int32_t)watch->group, watch->since, watch->amount_q16};
    const pil_frame_t answer = pil_watched_frame(&watched);
    send(&answer);
}

static void run_cycle(const pil_frame_t *frame)
{
    iqfoc_sample_t valley;
    iqfoc_sample_t peak;
    pil_cycle_read(frame, &cycle.i_ref, &valley, &peak);
    cycle.i_ref = pil_reference(cycle.i_ref);
    hal.sample = valley;
    iqfoc_isr_valley(&cycle, &hal);
    pil_recorder_take(cycle.status);
    hal.sample = peak;
    iqfoc_isr_peak(&cycle, &hal);
    answer_command(&hal.command, cycle.status);
}

/* False: no image is asked this, not even by mistake. */
static bool obey(const pil_frame_t *frame)
{
    if (frame->type == PIL_START) {
        start(frame);
    } else if (frame->type == PIL_TUNE) {
        start_tuned(frame);
    } else if (frame->type == PIL_RECORD) {
        answer_started(pil_recorder_start(frame, &cycle));
    } else if (frame->type == PIL_RECORD_ALARM) {
        answer_started(pil_recorder_at_alarm(frame, &tuned));
    } else if (frame->type == PIL_CYCLE && started == CYCLE) {
        run_cycle(frame);
    } else if (frame->type == PIL_CYCLE && started == TUNED) {
        run_tuned(frame);
    } else if (frame->type == PIL_ASK && started == TUNED) {
        answer_watched();
    } else {
        return false;
    }
    return true;
}

int main(void)
{
    pil_frame_t frame;
    do {
        receive(&frame);
    } while (obey(&frame));
    return STATUS_GARBLED;
}
