/*
 * The emulated board's line, and the drive behind it: a refused configuration never runs, and whatever the samples, the duties are
 * duties. Every frame's CRC is made right here; a first byte that is odd feeds bytes as they come.
 */
#include "fuzz.h"
#include "iqfoc/hal.h"
#include "iqfoc/params.h"
#include "pil_wire.h"

/* The 2019 paper's drive. */
#define R_OHM  0.75
#define L_H    5.2e-3
#define PSI_WB 0.134
#define T_S    2e-4
#define U_DC_V 750.0
#define I_A    IQFOC_I_BASE(10.5)
#define PERIOD 34000U

struct iqfoc_hal {
    iqfoc_sample_t sample;
    iqfoc_command_t command;
};

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

uint32_t iqfoc_hal_now(iqfoc_hal_t *h)
{
    return h->sample.time;
}

typedef struct board {
    iqfoc_cycle_config_t config;
    iqfoc_cycle_t cycle;
    iqfoc_hal_t hal;
    bool runs;
} board;

static void expect_duty(iq24_t duty)
{
    fuzz_expect(duty >= 0 && duty <= IQ24_ONE, "a duty lies within 0 and 1");
}

static void run_cycle(board *b, const pil_frame_t *frame)
{
    iqfoc_sample_t valley;
    iqfoc_sample_t peak;
    iqfoc_dq_t i_ref;
    pil_cycle_read(frame, &i_ref, &valley, &peak);
    /* A reference is the caller's word, and bounded by contract. */
    b->cycle.i_ref.d = i_ref.d % IQ24(32);
    b->cycle.i_ref.q = i_ref.q % IQ24(32);
    b->hal.sample = valley;
    iqfoc_isr_valley(&b->cycle, &b->hal);
    b->hal.sample = peak;
    iqfoc_isr_peak(&b->cycle, &b->hal);
    expect_duty(b->hal.command.duties.high.a);
    expect_duty(b->hal.command.duties.high.b);
    expect_duty(b->hal.command.duties.high.c);
}

static void obey(board *b, const pil_frame_t *frame)
{
    if (frame->type == PIL_START) {
        iqfoc_cycle_config_t config;
        pil_start_read(frame, &config);
        iqfoc_cycle_t cycle;
        if (iqfoc_cycle_init(&cycle, &config) == IQFOC_OK) {
            b->config = config;
            b->runs = iqfoc_cycle_init(&b->cycle, &b->config) == IQFOC_OK;
            b->cycle.enabled = true;
        }
    } else if (frame->type == PIL_CYCLE && b->runs) {
        run_cycle(b, frame);
    }
}

static void feed(board *b, pil_decoder_t *decoder, const uint8_t *bytes, size_t count)
{
    pil_frame_t frame;
    for (size_t k = 0; k < count; k++) {
        if (pil_decode(decoder, bytes[k], &frame) == PIL_WHOLE) {
            obey(b, &frame);
        }
    }
}

/* A drive that runs, and a sample of it, to be changed: chance alone would hardly make a configuration that is accepted. */
static pil_frame_t usual_frame(uint32_t type, uint32_t cycle)
{
    static const iqfoc_cycle_config_t usual = {
        .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_A, U_DC_V),
        .gains = IQFOC_GAINS(1200.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_A, U_DC_V),
        .span_max = IQ24(1.0),
        .current_limit = IQ24(2.0),
        .period_ticks = PERIOD,
        .tolerance_ticks = PERIOD / 100,
        .stale_ticks = PERIOD / 4,
        .deadline_ticks = PERIOD / 3,
    };
    if (type == PIL_START) {
        return pil_start_frame(&usual);
    }
    const iqfoc_dq_t reference = {0, IQ24(0.5)};
    const iqfoc_sample_t valley = {
        .theta = (iq24_t)(cycle * 500000U % IQ24_ONE), .u_dc = IQ24_ONE, .time = PERIOD * (cycle % 4000U)};
    iqfoc_sample_t peak = valley;
    peak.time += PERIOD / 2;
    return pil_cycle_frame(reference, &valley, &peak);
}

int LLVMFuzzerInitialize(int *argc, char ***argv);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    static board b;
    const pil_frame_t frame = usual_frame(PIL_START, 0);
    obey(&b, &frame);
    fuzz_expect(b.runs, "the fuzzer itself: a drive that runs to begin with");
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static board b;
    pil_decoder_t decoder = {.count = 0};
    fuzz_bytes input = {data, size};
    b.runs = false;
    if (fuzz_take(&input, 1) % 2 == 1) {
        feed(&b, &decoder, input.data, input.left);
        return 0;
    }
    uint32_t type = PIL_START;
    for (uint32_t cycle = 0; input.left > 0; cycle++) {
        uint8_t bytes[PIL_FRAME_MAX];
        const uint32_t choice = fuzz_take(&input, 1);
        pil_frame_t frame = usual_frame(type, cycle);
        for (uint32_t changes = choice % 4; changes > 0; changes--) {
            const uint32_t word = fuzz_take(&input, 1) % frame.words;
            frame.data[word] = (int32_t)fuzz_take(&input, 4);
        }
        feed(&b, &decoder, bytes, pil_encode(&frame, bytes));
        type = choice >> 4 == 15 ? PIL_START : PIL_CYCLE;
    }
    return 0;
}
