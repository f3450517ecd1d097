/*
 * Edges on the STM32G474 (hal_stm32g4_edges.h): the functions of hal.h, in place of hal_stm32g4.c.
 */
#include "hal_stm32g4_edges.h"

#include "hal_stm32g4_inline.h"

#include <stddef.h>

#define NEVER UINT32_C(0xFFFF) /* no counter reaches it */

#define TOGGLE_1 (TIM_CCMR_TOGGLE_LOW | TIM_CCMR_PRELOAD_LOW | TIM_CCMR_TOGGLE_HIGH | TIM_CCMR_PRELOAD_HIGH)
#define TOGGLE_2 (TIM_CCMR_TOGGLE_LOW | TIM_CCMR_PRELOAD_LOW | TIM_CCMR_PWM_2_HIGH | TIM_CCMR_PRELOAD_HIGH)
#define LOW_1    (TIM_CCMR_INACTIVE_LOW | TIM_CCMR_PRELOAD_LOW | TIM_CCMR_INACTIVE_HIGH | TIM_CCMR_PRELOAD_HIGH)
#define LOW_2    (TIM_CCMR_INACTIVE_LOW | TIM_CCMR_PRELOAD_LOW | TIM_CCMR_PWM_2_HIGH | TIM_CCMR_PRELOAD_HIGH)

/* ---- A cycle in the DMA's memory ---- */

/* Lengths of the spans; the converters are triggered a tick before the middle and the end. */
static void set_lengths(hal_stm32g4_edges_t *e, uint32_t which, uint32_t period_ticks)
{
    hal_stm32g4_span_t *span = &e->span[which * e->spans];
    hal_stm32g4_played_t *cycle = &e->cycle[which];
    const uint32_t of_side = e->spans / 2;
    cycle->period_ticks = period_ticks;
    for (uint32_t s = 0; s < 2; s++) {
        const uint32_t ticks = s == 0 ? period_ticks / 2 : period_ticks - period_ticks / 2;
        const hal_stm32g4_side_t side = {s * (period_ticks / 2), ticks / of_side, ticks % of_side};
        cycle->side[s] = side;
        for (uint32_t k = 0; k < of_side; k++) {
            hal_stm32g4_span_t *at = &span[s * of_side + k];
            const uint32_t last = side.ticks + (k < side.longer ? 1 : 0) - 1;
            at->reload = (uint16_t)last;
            at->repetition = 0;
            at->compare[3] = (uint16_t)(k + 1 == of_side ? last : NEVER);
        }
    }
}

/* A leg's edges, one after the other. */
typedef struct edge_writer {
    hal_stm32g4_span_t *span; /* of the cycle */
    const hal_stm32g4_played_t *cycle;
    uint32_t spans;
    uint32_t leg;
    uint32_t next; /* the first span without an edge */
    int32_t level;
} edge_writer_t;

static void write_edge(edge_writer_t *w, uint32_t tick)
{
    const uint32_t s = tick >= w->cycle->side[1].first ? 1 : 0;
    const hal_stm32g4_side_t *side = &w->cycle->side[s];
    const uint32_t after = tick - side->first;
    const uint32_t of_longer = side->longer * (side->ticks + 1);
    uint32_t span = s * (w->spans / 2);
    uint32_t compare;
    if (after < of_longer) {
        span += after / (side->ticks + 1);
        compare = after % (side->ticks + 1);
    } else {
        span += side->longer + (after - of_longer) / side->ticks;
        compare = (after - of_longer) % side->ticks;
    }
    if (span < w->next) {
        span = w->next;
        compare = 0;
    }
    if (span < w->spans) {
        w->span[span].compare[w->leg] = (uint16_t)(compare == 0 ? 1 : compare);
        w->next = span + 1;
        w->level = -w->level;
    }
}

/* An edge on tick 0 is a level at the valley. */
static void fill_leg(edge_writer_t *w, const iqfoc_leg_edges_t *leg)
{
    const int32_t first = leg->edges > 0 && leg->instant[0] == 0 ? 1 : 0;
    const int32_t level = first == 0 ? leg->level : -leg->level;
    if (level != w->level) {
        write_edge(w, 0);
    }
    for (int32_t k = first; k < leg->edges; k++) {
        write_edge(w, leg->instant[k]);
    }
}

static void fill(hal_stm32g4_edges_t *e, uint32_t which, const iqfoc_edges_t *edges)
{
    hal_stm32g4_span_t *span = &e->span[which * e->spans];
    if (edges->period_ticks != e->cycle[which].period_ticks) {
        set_lengths(e, which, edges->period_ticks);
    }
    for (uint32_t k = 0; k < e->spans; k++) {
        span[k].compare[0] = (uint16_t)NEVER;
        span[k].compare[1] = (uint16_t)NEVER;
        span[k].compare[2] = (uint16_t)NEVER;
    }
    for (uint32_t x = 0; x < 3; x++) {
        edge_writer_t w = {span, &e->cycle[which], e->spans, x, 0, e->cycle[1 - which].level[x]};
        fill_leg(&w, &edges->leg[x]);
        e->cycle[which].level[x] = w.level;
    }
}

/* What a cycle gets if nothing else is written; as long as the one before it. */
static void fill_repeating(hal_stm32g4_edges_t *e, uint32_t which)
{
    const hal_stm32g4_played_t *before = &e->cycle[1 - which];
    iqfoc_edges_t edges = {.period_ticks = before->period_ticks};
    if (e->repeats == HAL_EDGES_DUTIES) {
        iqfoc_edges_of_duties(e->high, before->period_ticks, &edges);
    } else {
        for (uint32_t x = 0; x < 3; x++) {
            edges.leg[x].level = e->repeats == HAL_EDGES_LOW ? -1 : before->level[x];
        }
    }
    fill(e, which, &edges);
}

/* ---- The DMA's place ---- */

/* Spans that it has fetched, 0 ... 2 spans - 1. */
static uint32_t fetched(const iqfoc_hal_t *hal)
{
    const uint32_t all = 2 * hal->edges->spans;
    const uint32_t left = stm32g4_read(&hal->chip->dma1->CNDTR1) & 0xFFFF;
    return (all - (left + HAL_SPAN_VALUES - 1) / HAL_SPAN_VALUES) % all;
}

/* While a span plays, the DMA has fetched the one after it: two at the first one of a cycle. */
bool hal_stm32g4_edges_at_valley(const iqfoc_hal_t *hal)
{
    const uint32_t spans = hal->edges->spans;
    return (fetched(hal) + spans - 1) % spans < spans / 2;
}

static void gates_off(const iqfoc_hal_t *hal)
{
    stm32g4_tim_t *tim = hal->chip->tim1;
    stm32g4_write(&tim->BDTR, stm32g4_read(&tim->BDTR) & ~TIM_BDTR_MOE);
}

/* Forced inactive (29.6.8): no match changes the outputs until they toggle again. */
static void outputs_low(const stm32g4_chip_t *chip, hal_stm32g4_edges_t *e)
{
    stm32g4_write(&chip->tim1->CCMR1, LOW_1);
    stm32g4_write(&chip->tim1->CCMR2, LOW_2);
    for (uint32_t x = 0; x < 3; x++) {
        e->cycle[0].level[x] = -1;
        e->cycle[1].level[x] = -1;
    }
    e->repeats = HAL_EDGES_LOW;
}

static void lose(iqfoc_hal_t *hal)
{
    gates_off(hal);
    outputs_low(hal->chip, hal->edges);
    hal->edges->lost = true;
    hal->edges->since_lost = 0;
}

/*
 * Between two changes of the DMA's cycle there is one period. If it seems to be the same cycle for longer, or another one after two periods,
 * changes were not seen, or the DMA has stopped.
 */
void hal_stm32g4_edges_follow(iqfoc_hal_t *hal)
{
    hal_stm32g4_edges_t *e = hal->edges;
    const uint32_t fetching = fetched(hal) / e->spans;
    const uint32_t now = hal_stm32g4_now(hal);
    const uint32_t other = fetching == e->fetching ? 0 : e->cycle[1 - fetching].period_ticks;
    if (!e->follows) {
        e->follows = true;
        e->changed = now;
    } else if (now - e->changed >= e->cycle[fetching].period_ticks + other) {
        lose(hal);
        e->changed = now;
    }
    if (fetching != e->fetching) {
        e->fetching = fetching;
        e->changed = now;
        fill_repeating(e, 1 - fetching);
        e->since_lost++;
    }
}

/* The cycle that the DMA does not read, if it will not be read soon. */
static void fill_next(iqfoc_hal_t *hal, const iqfoc_edges_t *edges)
{
    hal_stm32g4_edges_t *e = hal->edges;
    if (e->lost || fetched(hal) % e->spans + 2 > e->spans) {
        return;
    }
    if (edges == NULL) {
        fill_repeating(e, 1 - e->fetching);
    } else {
        fill(e, 1 - e->fetching, edges);
    }
    if (fetched(hal) / e->spans != e->fetching) {
        lose(hal);
    }
}

/* ---- The HAL's functions ---- */

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    return hal_stm32g4_now(hal);
}

/* TIM2 captures itself at the converters' trigger, a tick before valley and peak. */
static void read_sample(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    const uint32_t instant = stm32g4_read(&hal->chip->tim2->CCR[0]) + 1;
    const uint32_t now = hal_stm32g4_now(hal);
    const uint32_t encoder = stm32g4_read(&hal->chip->tim4->CNT) & 0xFFFF;
    if (sample->instant == 0) {
        hal_stm32g4_speed_follow(hal, encoder);
    }
    hal_stm32g4_sample_fill(hal, sample, now, now - instant, encoder);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    hal_stm32g4_edges_follow(hal);
    sample->instant = 0;
    read_sample(hal, sample);
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    hal_stm32g4_edges_follow(hal);
    sample->instant = IQ24_ONE / 2;
    read_sample(hal, sample);
}

static void gates_on(const iqfoc_hal_t *hal)
{
    stm32g4_tim_t *tim = hal->chip->tim1;
    if (!hal->edges->lost && (stm32g4_read(&tim->SR) & TIM_SR_BIF) == 0) {
        stm32g4_write(&tim->BDTR, stm32g4_read(&tim->BDTR) | TIM_BDTR_MOE);
    }
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    if (!command->gates) {
        gates_off(hal);
    }
    hal_stm32g4_edges_follow(hal);
    hal->edges->repeats = command->gates ? HAL_EDGES_DUTIES : HAL_EDGES_LOW;
    hal->edges->high = command->duties.high;
    fill_next(hal, NULL);
    if (command->gates) {
        gates_on(hal);
    }
}

static bool spans_fit(uint32_t period_ticks, uint32_t spans)
{
    return period_ticks / spans >= HAL_SPAN_TICKS && (period_ticks + spans - 1) / spans <= 65535;
}

void iqfoc_hal_write_edges(iqfoc_hal_t *hal, const iqfoc_edges_t *edges)
{
    if (!spans_fit(edges->period_ticks, hal->edges->spans)) {
        const iqfoc_command_t off = {{{0, 0, 0}, IQ24_ONE}, false};
        iqfoc_hal_write(hal, &off);
        return;
    }
    hal_stm32g4_edges_follow(hal);
    hal->edges->repeats = HAL_EDGES_HELD;
    fill_next(hal, edges);
    gates_on(hal);
}

bool hal_stm32g4_broken(const iqfoc_hal_t *hal)
{
    return (stm32g4_read(&hal->chip->tim1->SR) & TIM_SR_BIF) != 0 || hal->edges->lost;
}

/* After three cycles without an edge none is left in memory or timer. */
void hal_stm32g4_clear_break(iqfoc_hal_t *hal)
{
    hal_stm32g4_edges_t *e = hal->edges;
    stm32g4_write(&hal->chip->tim1->SR, ~TIM_SR_BIF);
    if (e->lost && e->since_lost >= 3) {
        stm32g4_write(&hal->chip->tim1->CCMR1, TOGGLE_1);
        stm32g4_write(&hal->chip->tim1->CCMR2, TOGGLE_2);
        e->lost = false;
    }
}

/* ---- Set-up ---- */

/* A burst for each update event of TIM1, round and round through both cycles. */
static void dma_start(const stm32g4_chip_t *chip, const hal_stm32g4_edges_t *e)
{
    stm32g4_write(&chip->rcc->AHB1ENR,
                  stm32g4_read(&chip->rcc->AHB1ENR) | RCC_AHB1ENR_DMA1EN | RCC_AHB1ENR_DMAMUX1EN);
    (void)stm32g4_read(&chip->rcc->AHB1ENR);
    stm32g4_write(&chip->dmamux->C0CR, DMAMUX_TIM1_UP);
    stm32g4_write(&chip->dma1->CPAR1, (uint32_t)(uintptr_t)&chip->tim1->DMAR);
    stm32g4_write(&chip->dma1->CMAR1, (uint32_t)(uintptr_t)e->span);
    stm32g4_write(&chip->dma1->CNDTR1, 2 * e->spans * HAL_SPAN_VALUES);
    stm32g4_write(&chip->dma1->CCR1, DMA_CCR_EN | DMA_CCR_TO_PERIPHERAL | DMA_CCR_CIRC | DMA_CCR_MINC |
                                         DMA_CCR_PSIZE_32 | DMA_CCR_MSIZE_16 | DMA_CCR_PL_VERY_HIGH);
}

/* Two spans without an edge come first: those in the timer's registers. */
static void timer_start(const stm32g4_chip_t *chip, uint32_t span_ticks, uint32_t dead_time)
{
    stm32g4_tim_t *tim = chip->tim1;
    stm32g4_write(&chip->rcc->APB2ENR, stm32g4_read(&chip->rcc->APB2ENR) | RCC_APB2ENR_TIM1EN);
    (void)stm32g4_read(&chip->rcc->APB2ENR);
    stm32g4_write(&tim->CR1, TIM_CR1_ARPE | TIM_CR1_URS);
    stm32g4_write(&tim->CR2, TIM_CR2_MMS_OC4 | TIM_CR2_MMS2_OC4);
    stm32g4_write(&tim->PSC, 0);
    stm32g4_write(&tim->ARR, span_ticks - 1);
    stm32g4_write(&tim->RCR, 0);
    stm32g4_write(&tim->CCMR1, LOW_1);
    stm32g4_write(&tim->CCMR2, LOW_2);
    for (uint32_t channel = 0; channel < 4; channel++) {
        stm32g4_write(&tim->CCR[channel], NEVER);
    }
    stm32g4_write(&tim->CCER, TIM_CCER_LEGS);
    stm32g4_write(&tim->BDTR, dead_time | TIM_BDTR_LOCK_1 | TIM_BDTR_OSSI | TIM_BDTR_OSSR | TIM_BDTR_BKE);
    stm32g4_write(&tim->DCR, TIM_DCR_BURST(TIM_ARR_NUMBER, HAL_SPAN_VALUES));
    stm32g4_write(&tim->EGR, TIM_EGR_UG); /* loads all shadow registers; with URS it asks for no burst */
    stm32g4_write(&tim->SR, 0);
    stm32g4_write(&tim->CCMR1, TOGGLE_1);
    stm32g4_write(&tim->CCMR2, TOGGLE_2);
    stm32g4_write(&tim->DIER, TIM_DIER_UDE);
    /* TIM2 captures its count at TRGO, its internal trigger 0. */
    stm32g4_write(&chip->tim2->SMCR, 0);
    stm32g4_write(&chip->tim2->CCMR1, TIM_CCMR1_CAPTURE_TRC);
    stm32g4_write(&chip->tim2->CCER, TIM_CCER_CC1E);
}

stm32g4_error_t hal_stm32g4_edges_start(iqfoc_hal_t *hal, const stm32g4_chip_t *chip,
                                        const hal_stm32g4_board_t *board, hal_stm32g4_edges_t *edges,
                                        uint32_t spans, uint32_t dead_time_ns)
{
    const uint32_t period_ticks = 2 * board->half_ticks;
    const int32_t dead_time = stm32g4_dead_time_code(dead_time_ns);
    const hal_stm32g4_edges_t fresh = {.spans = spans};
    if (spans < 8 || spans > HAL_SPANS_MAX || spans % 2 != 0 || !spans_fit(period_ticks, spans)) {
        return STM32G4_ERROR_EDGES;
    }
    if (dead_time < 0) {
        return STM32G4_ERROR_DEAD_TIME;
    }
    hal_stm32g4_fresh(hal, chip, board);
    hal->edges = edges;
    *edges = fresh;
    edges->cycle[0].period_ticks = period_ticks;
    edges->cycle[1].period_ticks = period_ticks;
    timer_start(chip, period_ticks / spans, (uint32_t)dead_time);
    for (uint32_t which = 0; which < 2; which++) {
        for (uint32_t x = 0; x < 3; x++) {
            edges->cycle[which].level[x] = -1;
        }
        set_lengths(edges, which, period_ticks);
    }
    fill_repeating(edges, 0);
    fill_repeating(edges, 1);
    dma_start(chip, edges);
    return STM32G4_OK;
}
