/* Three Hall sensors (include/iqfoc/halls.h). */
#include "iqfoc/halls.h"

#include <stddef.h>

#define CYCLE_Q8 UINT32_C(256)

iqfoc_error_t iqfoc_halls_init(iqfoc_halls_t *halls, const iqfoc_halls_config_t *config)
{
    if (halls == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    bool good = config->stall_cycles >= 1 && config->stall_cycles <= UINT32_C(1) << 20;
    for (int32_t k = 0; k < IQFOC_HALLS_SECTORS; k++) {
        const iq24_t place = (2 * k - 1) * (IQ24_ONE / 12);
        good = good && iq24_within(config->border[k], place - IQ24_ONE / 24, place + IQ24_ONE / 24);
    }
    if (!good) {
        return IQFOC_ERROR_HALLS;
    }
    const iqfoc_halls_t fresh = {config, 0, 0, 0, -1, 0, 0, 0, 0, {0, 0, 0, 0, 0, 0}, 0};
    *halls = fresh;
    return IQFOC_OK;
}

static int32_t sector_of(uint32_t bits)
{
    static const int32_t sectors[8] = {-1, 0, 2, 1, 4, 5, 3, -1};
    return sectors[bits & 7];
}

/* k modulo six, -6 <= k < 12. */
static int32_t around(int32_t k)
{
    return k < 0 ? k + IQFOC_HALLS_SECTORS : k >= IQFOC_HALLS_SECTORS ? k - IQFOC_HALLS_SECTORS : k;
}

/* Angle from border `from` on to border `to`, forwards: above 0, a whole turn if they are the same. */
static iq24_t between(const iqfoc_halls_config_t *config, int32_t from, int32_t to)
{
    const uint32_t way = (uint32_t)(config->border[to] - config->border[from]);
    const iq24_t on = (iq24_t)(way & UINT32_C(0x00FFFFFF)); /* modulo a turn, negative ones too */
    return on == 0 ? IQ24_ONE : on;
}

/* The border at which the shaft entered its sector, and the width of that sector. */
static int32_t entry(const iqfoc_halls_t *halls)
{
    return halls->way < 0 ? around(halls->sector + 1) : halls->sector;
}

static iq24_t width(const iqfoc_halls_t *halls)
{
    return between(halls->config, halls->sector, around(halls->sector + 1));
}

/*
 * The speed over the last `count` spans, with the direction of their passage.
 *
 * Range: each span is at most 2^28 (stall) and the sum of six below 2^31. angle <= 2^24, times 2^8 is 2^32 in
 * 64 bits. The sum is not below 1 - a span of 0 counts as 1 -, and the quotient is held to 1/3 turn.
 */
static iq24_t speed_of(const iqfoc_halls_t *halls, uint32_t count)
{
    const int32_t last = entry(halls);
    uint32_t sum = 0;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t back = halls->next + IQFOC_HALLS_SECTORS - 1 - k;
        sum += halls->span[back >= IQFOC_HALLS_SECTORS ? back - IQFOC_HALLS_SECTORS : back];
    }
    const int32_t first = around(last - halls->way * (int32_t)count);
    const iq24_t angle =
        halls->way < 0 ? between(halls->config, last, first) : between(halls->config, first, last);
    const uint64_t speed = ((uint64_t)(uint32_t)angle * CYCLE_Q8 + sum / 2) / sum;
    const iq24_t held = speed > (uint64_t)IQFOC_ROTOR_SPEED_MAX ? IQFOC_ROTOR_SPEED_MAX : (iq24_t)speed;
    return halls->way < 0 ? -held : held;
}

/* The middle of the sector, without a speed: all that is known. */
static void forget(iqfoc_halls_t *halls)
{
    halls->count = 0;
    halls->next = 0;
    halls->speed_seen = 0;
}

static void pass_border(iqfoc_halls_t *halls, int32_t sector, uint32_t since)
{
    const int32_t steps = around(sector - halls->sector);
    const int32_t way = steps == 1 ? 1 : steps == IQFOC_HALLS_SECTORS - 1 ? -1 : 0;
    const uint32_t span = halls->since > since ? halls->since - since : 1;
    halls->sector = sector;
    halls->since = since;
    if (way == 0) {
        halls->faults |= IQFOC_HALLS_SKIPPED;
    }
    if (way == 0 || way != halls->way) {
        halls->way = way;
        forget(halls);
        return;
    }
    halls->span[halls->next] = span;
    halls->next = halls->next + 1 < IQFOC_HALLS_SECTORS ? halls->next + 1 : 0;
    halls->count += halls->count < IQFOC_HALLS_SECTORS ? 1 : 0;
    halls->speed_seen = speed_of(halls, halls->count);
    /* A last span that is far from the mean of all: the shaft speeds up or brakes, the older ones are stale. */
    const iq24_t latest = speed_of(halls, 1);
    if (iq24_abs_sat(latest - halls->speed_seen) > iq24_abs_sat(halls->speed_seen) / 2) {
        halls->speed_seen = latest;
        halls->count = 1;
    }
}

/*
 * Angle and speed since the last border. The angle follows the speed but stays within the sector. At the sector's end
 * the speed is limited to the value at which the shaft would reach the border now.
 *
 * Range: |speed| < 2^22.5 and since <= 2^28 + 256: the product is below 2^51. width <= 2^24: its 2^8 fit 32 bits
 * unsigned. since >= 1 where it divides, because moved > width > 0.
 */
static void go_on(iqfoc_halls_t *halls)
{
    const iq24_t wide = width(halls);
    if (halls->count == 0) {
        halls->speed = 0;
        halls->theta = halls->config->border[halls->sector] + wide / 2;
        return;
    }
    /*@ assert either: halls->since == 0 || halls->since >= 1; */
    const int32_t since = (int32_t)halls->since;
    int64_t moved = iq24_asr64(IQ24_MUL64(halls->speed_seen, since), 8);
    halls->speed = halls->speed_seen;
    if (moved > wide || moved < -wide) {
        const iq24_t most = (iq24_t)((uint32_t)wide * CYCLE_Q8 / halls->since);
        moved = moved < 0 ? -wide : wide;
        halls->speed = halls->speed_seen < 0 ? -most : most;
    }
    halls->theta = halls->config->border[entry(halls)] + (iq24_t)moved;
}

void iqfoc_halls_step(iqfoc_halls_t *halls, uint32_t bits, uint32_t since_q8)
{
    const int32_t sector = sector_of(bits);
    const uint32_t stall = halls->config->stall_cycles * CYCLE_Q8;
    halls->since += halls->since < stall ? CYCLE_Q8 : 0;
    if (halls->since >= stall) {
        halls->way = 0; /* the span that ends with the next border does not show the speed */
        forget(halls);
    }
    if (sector < 0) {
        halls->faults |= IQFOC_HALLS_INVALID;
    } else if (halls->sector < 0) {
        halls->sector = sector;
    } else if (sector != halls->sector) {
        pass_border(halls, sector, since_q8 < CYCLE_Q8 ? since_q8 : CYCLE_Q8);
    }
    if (halls->sector >= 0) {
        go_on(halls);
    }
}
