/*
 * The board of README.md's firmware example: what goes wrong with time or current must stop the drive.
 * Exit status 0, or the number of the check that failed. tools/check_examples.py links the example to it.
 */
#include "iqfoc/hal.h"

#define PERIOD UINT32_C(16800) /* ticks of a control cycle: 2e-4 s at 84 MHz */

struct iqfoc_hal {
    uint32_t now, sampled, busy;
    iq24_t i_a;
    bool gates;
};

bool drive_init(void);
void drive_set(bool enabled, iq24_t i_q);
void carrier_valley_isr(void);
void carrier_peak_isr(void);

iqfoc_hal_t board;

static void read_sample(const iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const iqfoc_sample_t none = {{0, 0, 0}, {0, 0, 0}, 0, 0, IQ24_ONE, 0, 0, false, false};
    *sample = none;
    sample->i.a = hal->i_a;
    sample->i.b = -hal->i_a / 2;
    sample->i.c = -hal->i_a / 2;
    sample->time = hal->sampled;
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    read_sample(hal, sample);
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    read_sample(hal, sample);
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    hal->gates = command->gates;
}

/* Each look at the timer finds that the code so far took `busy`. */
uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    hal->now += hal->busy;
    return hal->now;
}

static void half(uint32_t at, void (*isr)(void))
{
    board.sampled = at;
    board.now = at;
    isr();
}

/* Cycle k as it should be; how far the clock is then. */
static void good_cycles(uint32_t first, uint32_t count)
{
    for (uint32_t k = first; k < first + count; k++) {
        half(k * PERIOD, carrier_valley_isr);
        half(k * PERIOD + PERIOD / 2, carrier_peak_isr);
    }
}

static void begin(void)
{
    board.busy = PERIOD / 100;
    board.i_a = 0;
    (void)drive_init();
    drive_set(true, IQ24(0.1));
    good_cycles(1, 4);
}

int main(void)
{
    board.busy = PERIOD / 100;
    if (!drive_init()) {
        return 1;
    }
    good_cycles(1, 4);
    if (board.gates) {
        return 2; /* on before anybody asked for it */
    }
    begin();
    if (!board.gates) {
        return 3;
    }
    half(5 * PERIOD, carrier_valley_isr); /* and no peak */
    good_cycles(6, 1);
    if (board.gates) {
        return 4;
    }
    begin();
    good_cycles(6, 1); /* a whole cycle is missing */
    if (board.gates) {
        return 5;
    }
    begin();
    half(5 * PERIOD, carrier_valley_isr);
    board.busy = PERIOD * 45 / 100;
    half(5 * PERIOD + PERIOD / 2, carrier_peak_isr); /* late */
    if (board.gates) {
        return 6;
    }
    begin();
    board.i_a = IQ24(1.6);
    good_cycles(5, 1);
    return board.gates ? 7 : 0;
}
