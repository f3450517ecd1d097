/*
 * Hall sensors to the last bit: one hash over the results for any borders, any movement and any age of the last change.
 * test_halls.c checks angle and speed in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/halls.h"

#define RUNS 1500

void setUp(void)
{
}

void tearDown(void)
{
}

static const uint32_t bits_of_sector[6] = {1, 3, 2, 6, 4, 5};

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
    return draw == 1 ? bits_random(seed, 0, 5) : (sector + *way + 6) % 6;
}

static void test_any_movement(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < RUNS; run++) {
        iqfoc_halls_config_t c;
        iqfoc_halls_t h;
        any_borders(&seed, &c, run);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_halls_init(&h, &c));
        int sector = bits_random(&seed, 0, 5);
        int way = run % 2 == 0 ? 1 : -1;
        int dwell = bits_random(&seed, 1, 20);
        int left = dwell;
        for (int n = 0; n < 400; n++) {
            uint32_t bits = bits_of_sector[sector];
            bits = bits_random(&seed, 0, 99) == 0 ? (uint32_t)bits_random(&seed, 0, 1) * 7 : bits;
            const uint32_t age = bits_random(&seed, 0, 9) == 0 ? (uint32_t)bits_random(&seed, 250, 300)
                                                               : (uint32_t)bits_random(&seed, 0, 255);
            iqfoc_halls_step(&h, bits | (uint32_t)bits_random(&seed, 0, 1) << 3, age);
            digest_add(&digest, h.theta);
            digest_add(&digest, h.speed);
            digest_add(&digest, (int32_t)h.faults);
            digest_add(&digest, h.sector);
            if (--left == 0) {
                sector = next_sector(&seed, sector, &way);
                dwell = bits_random(&seed, 0, 30) == 0 ? bits_random(&seed, 1, 500)
                                                       : dwell + bits_random(&seed, -1, 1);
                dwell = dwell < 1 ? 1 : dwell;
                left = dwell;
            }
        }
    }
    bits_golden(UINT64_C(0x6f6ebc5c8409e32c), digest);
}

/* The time since the last change is counted to the stall and no further, from any draw of it. */
static void test_time_ends_at_the_stall(void)
{
    uint64_t seed = 2;
    iqfoc_halls_config_t c;
    iqfoc_halls_t h;
    any_borders(&seed, &c, 0);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_halls_init(&h, &c));
    iqfoc_halls_step(&h, bits_of_sector[0], 128);
    iqfoc_halls_step(&h, bits_of_sector[1], 0);
    for (uint32_t n = 1; n < c.stall_cycles + 4; n++) {
        iqfoc_halls_step(&h, bits_of_sector[1], 0);
        TEST_ASSERT_EQUAL_UINT32(256 * (n < c.stall_cycles ? n : c.stall_cycles), h.since);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_any_movement);
    RUN_TEST(test_time_ends_at_the_stall);
    return UNITY_END();
}
