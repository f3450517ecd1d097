/*
 * TIM1, DMA and TIM2's capture tick by tick (rig_stm32g4_edges.h), as RM0440 describes them; only what the port has set up works.
 */
#include "rig_stm32g4_edges.h"

#include "fake_stm32g4_bank.h"
#include "rig_stm32g4_sensors.h"

#define ALL (2 * RIG_EDGES_SPANS * HAL_SPAN_VALUES)

uint32_t rig_edges_latency;
bool rig_edges_followed;
iqfoc_hal_t rig_edges_hal;
hal_stm32g4_edges_t rig_edges;

static uint32_t count;
static uint32_t reload;     /* behind the preload registers */
static uint32_t compare[4]; /* of channels 1 to 4 */
static bool reference[4];   /* OCxREF */
static int32_t span;        /* since the first cycle's start */
static uint32_t tick;       /* of the cycle */
static uint32_t now;
static bool burst_waits;

static uint32_t mode(int channel)
{
    const uint32_t two = channel < 2 ? fake_bank.tim1.CCMR1 : fake_bank.tim1.CCMR2;
    return two >> (channel % 2 == 0 ? 0 : 8) & 0xF8;
}

/* 29.3.28: DMAR goes to DBL + 1 registers from DBA on. 12.4: circular, 16 bits of memory to 32 of the peripheral. */
static void burst(void)
{
    stm32g4_reg_t *registers = &fake_bank.tim1.CR1;
    const uint32_t wanted = DMA_CCR_EN | DMA_CCR_TO_PERIPHERAL | DMA_CCR_CIRC | DMA_CCR_MINC |
                            DMA_CCR_PSIZE_32 | DMA_CCR_MSIZE_16;
    const volatile uint16_t *memory = &rig_edges.span[0].reload;
    const uint32_t first = fake_bank.tim1.DCR & 31;
    const uint32_t length = (fake_bank.tim1.DCR >> 8 & 31) + 1;
    burst_waits = false;
    if ((fake_bank.dma1.CCR1 & 0x4FFF) != wanted || fake_bank.dmamux.C0CR != 46 ||
        fake_bank.dma1.CMAR1 != (uint32_t)(uintptr_t)rig_edges.span ||
        fake_bank.dma1.CPAR1 != (uint32_t)(uintptr_t)&fake_bank.tim1.DMAR) {
        return;
    }
    for (uint32_t k = 0; k < length; k++) {
        registers[first + k] = memory[ALL - fake_bank.dma1.CNDTR1];
        fake_bank.dma1.CNDTR1 = fake_bank.dma1.CNDTR1 == 1 ? ALL : fake_bank.dma1.CNDTR1 - 1;
    }
}

/* 29.3.4 and 29.6.8: the update event loads reload and, with OCxPE, compare values; with UDE it asks for the DMA. */
static void update(void)
{
    count = 0;
    span++;
    if (span >= 0 && (uint32_t)span % RIG_EDGES_SPANS == 0) {
        tick = 0;
    }
    reload = fake_bank.tim1.ARR;
    for (int x = 0; x < 4; x++) {
        compare[x] = fake_bank.tim1.CCR[x];
    }
    burst_waits = (fake_bank.tim1.DIER & TIM_DIER_UDE) != 0;
}

static void step(void)
{
    count++;
    now++;
    tick++;
    fake_bank.tim2.CNT = now;
    if (count > reload) {
        update();
    }
    if (burst_waits && count >= rig_edges_latency) {
        burst();
    }
    for (int x = 0; x < 3; x++) {
        const uint32_t m = mode(x);
        reference[x] = m == 0x48 ? false : m == 0x38 && count == compare[x] ? !reference[x] : reference[x];
    }
    const bool triggers = mode(3) == 0x78 && count >= compare[3];
    if (triggers && !reference[3]) {
        rig_sensors_sample(TIM_CR2_MMS2_OC4);
        if ((fake_bank.tim1.CR2 & 0x70) == TIM_CR2_MMS_OC4 && fake_bank.tim2.CCMR1 == 3 &&
            fake_bank.tim2.CCER == 1 && fake_bank.tim2.SMCR == 0) {
            fake_bank.tim2.CCR[0] = now;
        }
    }
    reference[3] = triggers;
}

/* Of the cycle that plays: the reloads in the memory. */
static uint32_t length(void)
{
    const uint32_t which = (uint32_t)span / RIG_EDGES_SPANS % 2;
    uint32_t ticks = 0;
    for (uint32_t k = 0; k < RIG_EDGES_SPANS; k++) {
        ticks += rig_edges.span[which * RIG_EDGES_SPANS + k].reload + 1u;
    }
    return ticks;
}

static double phase;

static void go_to(double to)
{
    if (to < phase) {
        const int32_t cycle = span / (int32_t)RIG_EDGES_SPANS;
        while (span / (int32_t)RIG_EDGES_SPANS == cycle) {
            step();
        }
        if (rig_edges_followed) {
            hal_stm32g4_edges_follow(&rig_edges_hal);
        }
    }
    phase = to;
    const uint32_t target = (uint32_t)(to * length());
    const int32_t present = span / (int32_t)RIG_EDGES_SPANS;
    while (tick < target && span / (int32_t)RIG_EDGES_SPANS == present) {
        step();
    }
}

static bool leg_high(int leg)
{
    return reference[leg];
}

static uint32_t period_ticks(void)
{
    return 2 * RIG_EDGES_HALF;
}

const port_rig *rig_stm32g4_edges_start(void)
{
    static port_rig rig;
    const hal_stm32g4_board_t *board = rig_sensors_start(RIG_EDGES_HALF);
    fake_reset();
    now = UINT32_MAX - 100000;
    (void)stm32g4_encoder_start(&fake_chip, board->counts_per_turn);
    (void)stm32g4_converters_start(&fake_chip);
    (void)hal_stm32g4_edges_start(&rig_edges_hal, &fake_chip, board, &rig_edges, RIG_EDGES_SPANS, 1000);
    stm32g4_run(&fake_chip);
    /* UG has loaded the registers; two spans come before the first cycle. */
    span = -3;
    update();
    burst_waits = false;
    for (int x = 0; x < 4; x++) {
        reference[x] = false;
    }
    rig_edges_followed = true;
    while (span < 0) {
        step();
    }
    phase = 0.0;
    rig = rig_sensors;
    rig.hal = &rig_edges_hal;
    rig.go_to = go_to;
    rig.leg_high = leg_high;
    rig.period_ticks = period_ticks;
    rig.edges_least = 2 * RIG_EDGES_HALF / RIG_EDGES_SPANS;
    return &rig;
}
