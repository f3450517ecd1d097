/*
 * Hall sensors to the last bit: the library against halls.h's rules with the spans in a list, for any borders, any
 * movement and any age of the last change.
 */
#include "bits.h"

#include "iqfoc/halls.h"

#include <stdbool.h>
#include <string.h>

#define RUNS (1500 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

static const uint32_t bits_of_sector[6] = {1, 3, 2, 6, 4, 5};

typedef struct model {
    const iqfoc_halls_config_t *config;
    int64_t theta, turns, since, turns_seen;
    uint32_t faults;
    int sector, way, count;
    int64_t span[6]; /* the last one first */
} model;

static int around(int k)
{
    return (k + 12) % 6;
}

/* From one border on to another, forwards; a whole turn to itself. */
static int64_t between(const model *m, int from, int to)
{
    const int64_t way = (int64_t)m->config->border[around(to)] - m->config->border[around(from)];
    const int64_t on = way - bits_floor(way, IQ24_ONE) * IQ24_ONE;
    return on == 0 ? IQ24_ONE : on;
}

static int entry(const model *m)
{
    return m->way < 0 ? around(m->sector + 1) : m->sector;
}

/* The angle of the last spans over their time, to nearest, at most 1/3 turn a cycle. */
static int64_t speed(const model *m, int count)
{
    int64_t sum = 0;
    for (int k = 0; k < count; k++) {
        sum += m->span[k];
    }
    const int64_t angle =
        m->way < 0 ? between(m, entry(m), entry(m) + count) : between(m, entry(m) - count, entry(m));
    const int64_t turns = bits_held((256 * angle + sum / 2) / (sum > 1 ? sum : 1), 0, IQFOC_ROTOR_TURNS_MAX);
    return m->way < 0 ? -turns : turns;
}

static int64_t size(int64_t x)
{
    return x < 0 ? -x : x;
}

static void pass_border(model *m, int sector, int64_t age)
{
    const int steps = around(sector - m->sector);
    const int way = steps == 1 ? 1 : steps == 5 ? -1 : 0;
    const int64_t span = m->since > age ? m->since - age : 1;
    m->sector = sector;
    m->since = age;
    m->faults |= way == 0 ? IQFOC_HALLS_SKIPPED : 0;
    if (way == 0 || way != m->way) {
        m->way = way;
        m->count = 0;
        m->turns_seen = 0;
        return;
    }
    memmove(m->span + 1, m->span, 5 * sizeof *m->span);
    m->span[0] = span;
    m->count += m->count < 6 ? 1 : 0;
    m->turns_seen = speed(m, m->count);
    const int64_t latest = speed(m, 1);
    if (size(latest - m->turns_seen) > size(m->turns_seen) / 2) {
        m->turns_seen = latest;
        m->count = 1;
    }
}

static void go_on(model *m)
{
    const int64_t wide = between(m, m->sector, m->sector + 1);
    if (m->count == 0) {
        m->turns = 0;
        m->theta = m->config->border[m->sector] + wide / 2;
        return;
    }
    int64_t moved = bits_floor(m->turns_seen * m->since, 256);
    m->turns = m->turns_seen;
    if (size(moved) > wide) {
        const int64_t most = wide * 256 / m->since;
        moved = moved < 0 ? -wide : wide;
        m->turns = m->turns_seen < 0 ? -most : most;
    }
    m->theta = m->config->border[entry(m)] + moved;
}

static void step(model *m, uint32_t bits, uint32_t age)
{
    const int64_t stall = 256 * (int64_t)m->config->stall_cycles;
    int sector = -1;
    for (int k = 0; k < 6; k++) {
        sector = (bits & 7) == bits_of_sector[k] ? k : sector;
    }
    m->since += m->since < stall ? 256 : 0;
    if (m->since >= stall) {
        m->way = 0;
        m->count = 0;
        m->turns_seen = 0;
    }
    m->faults |= sector < 0 ? IQFOC_HALLS_INVALID : 0;
    if (sector >= 0 && m->sector < 0) {
        m->sector = sector;
    } else if (sector >= 0 && sector != m->sector) {
        pass_border(m, sector, age < 256 ? age : 256);
    }
    if (m->sector >= 0) {
        go_on(m);
    }
}

static void any_borders(uint64_t *seed, iqfoc_halls_config_t *c, int run)
{
    for (int k = 0; k < 6; k++) {
        const int32_t place = (2 * k - 1) * (IQ24_ONE / 12);
        c->border[k] = place + (run % 3 == 0 ? 0 : bits_random(seed, -IQ24_ONE / 24, IQ24_ONE / 24));
    }
    c->stall_cycles = (uint32_t)bits_random(seed, 1, run % 4 == 0 ? 12 : 400);
}

/* Where the shaft goes next: on in its way mostly, back, any bits, or stays for long. */
static int next_sector(uint64_t *seed, int sector, int *way)
{
    const int draw = bits_random(seed, 0, 59);
    if (draw == 0) {
        *way = -*way;
    }
    return draw == 1 ? bits_random(seed, 0, 5) : around(sector + *way);
}

static void test_any_movement(void)
{
    uint64_t seed = 1;
    for (int run = 0; run < RUNS; run++) {
        iqfoc_halls_config_t c;
        iqfoc_halls_t got;
        any_borders(&seed, &c, run);
        model want = {.config = &c, .sector = -1};
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_halls_init(&got, &c));
        int sector = bits_random(&seed, 0, 5);
        int way = run % 2 == 0 ? 1 : -1;
        int dwell = bits_random(&seed, 1, 20);
        int left = dwell;
        for (int n = 0; n < 400; n++) {
            uint32_t bits = bits_of_sector[sector];
            bits = bits_random(&seed, 0, 99) == 0 ? (uint32_t)bits_random(&seed, 0, 1) * 7 : bits;
            const uint32_t age = bits_random(&seed, 0, 9) == 0 ? (uint32_t)bits_random(&seed, 250, 300)
                                                               : (uint32_t)bits_random(&seed, 0, 255);
            iqfoc_halls_step(&got, bits | (uint32_t)bits_random(&seed, 0, 1) << 3, age);
            step(&want, bits, age);
            TEST_ASSERT_EQUAL_INT64(want.theta, got.theta);
            TEST_ASSERT_EQUAL_INT64(want.turns, got.turns);
            TEST_ASSERT_EQUAL_UINT32(want.faults, got.faults);
            TEST_ASSERT_EQUAL_INT32(want.sector, got.sector);
            if (--left == 0) {
                sector = next_sector(&seed, sector, &way);
                dwell = bits_random(&seed, 0, 30) == 0 ? bits_random(&seed, 1, 500)
                                                       : dwell + bits_random(&seed, -1, 1);
                dwell = dwell < 1 ? 1 : dwell;
                left = dwell;
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_any_movement);
    return UNITY_END();
}
