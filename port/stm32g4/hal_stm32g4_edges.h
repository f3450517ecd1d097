/*
 * Edges on the STM32G474: the HAL with its optional fifth function, for pulse patterns and for carriers whose length changes. It takes the
 * place of hal_stm32g4.c and stm32g4_carrier_start. It uses TIM1, DMA1 channel 1 and a capture of TIM2; pins and converters are the same.
 *
 * TIM1 counts upwards. A cycle is 8 to 32 of its periods, here called spans. In each span a leg has one edge at most, where the counter
 * matches its compare value (output mode "toggle"). Reload and compare values have preload registers, which act at the start of the next
 * span. At each start the timer asks for a DMA burst, which writes the values of the span after it. So:
 *
 * - An edge comes at a match, exact to a tick of the clock. The DMA has a whole span for its six values; its latency is of no matter.
 * - Least distance of two edges of a leg: a span, period_ticks/spans rounded up, at least HAL_SPAN_TICKS. An edge that is nearer to the
 *   last one moves to the next span. Edges of different legs may have any distance.
 * - An edge on the first tick of a span comes one tick later. A compare value of 0 is not used, because the manual does not say whether it
 *   matches when it loads.
 * - Edges must be written four spans ahead of their valley. Later ones are dropped, and the legs keep their levels.
 * - A toggle does not know the level. The HAL counts the edges and knows the level at the end of each cycle. If a cycle is to begin with
 *   the other level, it adds an edge at the valley. The level is lost if the HAL was not called for a cycle, or if the DMA stopped or overtook
 *   a write: gates off, outputs low, until hal_stm32g4_clear_break.
 *
 * Safe output and break line clear MOE as on the plain carrier. The edges then go on inside the timer, so the levels stay known.
 *
 * Speed and angle assume cycles of 2 half_ticks, as in hal_stm32g4.h.
 *
 * This has not run on silicon. tests/target/test_port_stm32g4_edges.c checks it with memory in place of the registers, and timer and DMA as
 * RM0440 describes them.
 */
#ifndef PORT_STM32G4_HAL_STM32G4_EDGES_H
#define PORT_STM32G4_HAL_STM32G4_EDGES_H

#include "board.h"
#include "hal_stm32g4.h"

#define HAL_SPANS_MAX   32
#define HAL_SPAN_TICKS  340 /* shortest span */
#define HAL_SPAN_VALUES 6   /* of a burst */

/* What a burst writes, in the order of the registers. */
typedef struct hal_stm32g4_span {
    volatile uint16_t reload;
    volatile uint16_t repetition;
    volatile uint16_t compare[4]; /* legs a, b, c, and the converters' trigger */
} hal_stm32g4_span_t;

/* Half a cycle in spans: the first `longer` ones have a tick more than the others. */
typedef struct hal_stm32g4_side {
    uint32_t first; /* tick */
    uint32_t ticks; /* of a span */
    uint32_t longer;
} hal_stm32g4_side_t;

/* A cycle as it is in the DMA's memory. */
typedef struct hal_stm32g4_played {
    uint32_t period_ticks;
    hal_stm32g4_side_t side[2];
    int32_t level[3]; /* at its end */
} hal_stm32g4_played_t;

/* What a cycle gets if nothing is written. */
typedef enum hal_stm32g4_repeats {
    HAL_EDGES_LOW,    /* all legs low */
    HAL_EDGES_DUTIES, /* the last duties */
    HAL_EDGES_HELD    /* no edge */
} hal_stm32g4_repeats_t;

/* Memory and state. The DMA goes round through `span`, which has two cycles. */
typedef struct hal_stm32g4_edges {
    hal_stm32g4_span_t span[2 * HAL_SPANS_MAX];
    uint32_t spans; /* of a cycle */
    hal_stm32g4_played_t cycle[2];
    uint32_t fetching; /* which of the two the DMA reads */
    uint32_t changed;  /* TIM2 when that was first seen */
    bool follows;      /* hal_stm32g4_edges_follow was called */
    hal_stm32g4_repeats_t repeats;
    iqfoc_abc_t high;    /* the last duties */
    bool lost;           /* the levels are not known */
    uint32_t since_lost; /* cycles filled */
} hal_stm32g4_edges_t;

/*
 * In place of stm32g4_carrier_start and hal_stm32g4_start: TIM1, stopped, outputs off and low; DMA; TIM2's capture. board->half_ticks: half
 * the length of the first cycles. spans: even, 8 ... HAL_SPANS_MAX, each HAL_SPAN_TICKS ... 65535 ticks long. `edges` is in RAM, not in CCM
 * SRAM.
 */
stm32g4_error_t hal_stm32g4_edges_start(iqfoc_hal_t *hal, const stm32g4_chip_t *chip,
                                        const hal_stm32g4_board_t *board, hal_stm32g4_edges_t *edges,
                                        uint32_t spans, uint32_t dead_time_ns);

/* As hal_stm32g4_at_valley, by the DMA's place. The handler must begin a span ahead of the next trigger. */
bool hal_stm32g4_edges_at_valley(const iqfoc_hal_t *hal);

/* Fills the cycle that the DMA has left with what repeats. All functions of hal.h but iqfoc_hal_now call it. */
void hal_stm32g4_edges_follow(iqfoc_hal_t *hal);

#endif
