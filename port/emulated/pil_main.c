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
static bool started; /* by a configuration that was not refused */

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
    started = refused == IQFOC_OK;
    if (started) {
        cycle.enabled = true;
        pil_recorder_arm();
    }
    answer_started((int32_t)refused);
}

static void run_cycle(const pil_frame_t *frame)
{
    iqfoc_sample_t valley;
    iqfoc_sample_t peak;
    pil_cycle_read(frame, &cycle.i_ref, &valley, &peak);
    hal.sample = valley;
    iqfoc_isr_valley(&cycle, &hal);
    pil_recorder_take(cycle.status);
    hal.sample = peak;
    iqfoc_isr_peak(&cycle, &hal);
    const pil_result_t result = {hal.command, cycle.status};
    const pil_frame_t answer = pil_command_frame(&result);
    send(&answer);
    pil_recorder_drain();
}

int main(void)
{
    pil_frame_t frame;
    for (;;) {
        receive(&frame);
        if (frame.type == PIL_START) {
            start(&frame);
        } else if (frame.type == PIL_RECORD) {
            answer_started(pil_recorder_start(&frame, &cycle));
        } else if (frame.type == PIL_CYCLE && started) {
            run_cycle(&frame);
        } else {
            return STATUS_GARBLED;
        }
    }
}
