/*
 * The modulator by pulse pattern and its control to the last bit: hashes over edges, states and trajectories of drawn tables, forward and
 * backward, with jumps of every input. test_pattern.c and test_pattern_control.c have the references in double.
 */
#include "bits.h"
#include "hash.h"
#include "pattern_reference.h"

#include "iqfoc/pattern_control.h"

#define CYCLES 20000

void setUp(void)
{
}

void tearDown(void)
{
}

static void add_edges(uint64_t *digest, const iqfoc_pattern_edges_t edges[3])
{
    for (int k = 0; k < 3; k++) {
        digest_add(digest, edges[k].level);
        digest_add(digest, edges[k].edges);
        digest_add(digest, edges[k].high);
        bits_add(digest, edges[k].at, (size_t)edges[k].edges * sizeof edges[k].at[0]);
    }
}

static void the_modulator(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    iqfoc_pattern_modulator_t m;
    for (int n = 0; n < CYCLES; n++) {
        if (n % 100 == 0) {
            drawn_table(&seed);
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &table, random_iq24(&seed, 0.0, 0.2)));
        }
        const iq24_t angle = bits_random(&seed, INT32_MIN, INT32_MAX);
        const iq24_t turns = random_iq24(&seed, -0.15, 0.15);
        const iq24_t u = random_iq24(&seed, 0.0, 1.0);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_step(&m, angle, turns, iqfoc_pattern_index(u, random_iq24(&seed, 0.7, 2.0)), edges);
        add_edges(&digest, edges);
        bits_add(&digest, m.leg, sizeof m.leg);
    }
    bits_golden(UINT64_C(0xfe738ac9a4dbbd44), digest);
}

static iqfoc_pattern_control_config_t any_machine(uint64_t *seed)
{
    iqfoc_pattern_control_config_t config;
    config.winding.rho_q30 = bits_random(seed, 0, 1 << 27);
    config.winding.k_u_q26 = bits_random(seed, 1 << 25, 1 << 28);
    config.winding.k_psi_q27 = bits_random(seed, 0, 1 << 28);
    config.correction = random_iq24(seed, 0.0, 1.0);
    config.disturbance = random_iq24(seed, 0.0, 0.25);
    return config;
}

static void add_control(uint64_t *digest, const iqfoc_pattern_control_t *c)
{
    digest_add(digest, c->trajectory.u_angle);
    bits_add(digest, &c->trajectory.steady, sizeof c->trajectory.steady);
    bits_add(digest, &c->trajectory.drift, sizeof c->trajectory.drift);
    bits_add(digest, c->leg, sizeof c->leg);
    bits_add(digest, &c->i_next, sizeof c->i_next);
    bits_add(digest, &c->v, sizeof c->v);
    bits_add(digest, &c->error, sizeof c->error);
    digest_add(digest, c->u_mean);
    digest_add(digest, c->u_dc_inverse);
}

static void the_control(void)
{
    uint64_t seed = 4;
    uint64_t digest = DIGEST_START;
    iqfoc_pattern_control_t c;
    iq24_t theta = 0;
    iq24_t turns = 0;
    iqfoc_dq_t i_ref = {0, 0};
    double far = 0.0;
    for (int n = 0; n < CYCLES; n++) {
        if (n % 200 == 0) {
            drawn_table(&seed);
            const iqfoc_pattern_control_config_t config = any_machine(&seed);
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, IQ24(0.02)));
            digest_add(&digest, c.l);
            digest_add(&digest, c.r);
            digest_add(&digest, c.psi);
            digest_add(&digest, c.disturbance_l);
        }
        if (n % 20 == 0) {
            turns = random_iq24(&seed, -0.13, 0.13);
            i_ref.d = random_iq24(&seed, -1.5, 1.5);
            i_ref.q = random_iq24(&seed, -1.5, 1.5);
            far = n % 3 == 0 ? 0.01 : 1.0;
        }
        iqfoc_ab_t i = c.i_next;
        i.alpha = iq24_clamp(i.alpha + random_iq24(&seed, -far, far), IQ24(-8.0), IQ24(8.0));
        i.beta = iq24_clamp(i.beta + random_iq24(&seed, -far, far), IQ24(-8.0), IQ24(8.0));
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_aim(&c, i_ref, turns);
        iqfoc_pattern_control_step(&c, i, theta, random_iq24(&seed, 0.5, 1.5), edges);
        theta = iq24_add_wrap(theta, turns);
        add_edges(&digest, edges);
        add_control(&digest, &c);
    }
    bits_golden(UINT64_C(0x7b9987d23cb4a51c), digest);
}

/* Another table is asked for every 40 cycles, where the last one was taken or not. */
static void change_of_the_table(void)
{
    uint64_t seed = 5;
    uint64_t digest = DIGEST_START;
    static iqfoc_pattern_row_t other_rows[ROWS];
    iqfoc_pattern_t other;
    iqfoc_pattern_control_t c;
    const iqfoc_pattern_control_config_t config = {
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.005)};
    iq24_t theta = 0;
    iq24_t turns = 0;
    int taken = 0;
    for (int n = 0; n < CYCLES; n++) {
        if (n % 400 == 0) {
            drawn_table(&seed);
            memcpy(other_rows, rows, sizeof rows);
            other = table;
            other.row = other_rows;
            drawn_table(&seed);
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, IQ24(0.02)));
            TEST_ASSERT_TRUE(c.wanted == NULL && c.waited == 0 && c.nearest_q48 == 0);
        }
        if (n % 40 == 0) {
            iqfoc_pattern_control_change(&c, c.modulator.table == &table ? &other : &table);
            turns = random_iq24(&seed, -0.13, 0.13) / (n % 80 == 0 ? 1 : 4);
        }
        const iqfoc_dq_t i_ref = {IQ24(-0.3), random_iq24(&seed, 0.7, 0.8)};
        const bool waits = c.wanted != NULL;
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_aim(&c, i_ref, turns);
        iqfoc_pattern_control_step(&c, c.i_next, theta, IQ24_ONE, edges);
        theta = iq24_add_wrap(theta, turns);
        taken += waits && c.wanted == NULL ? 1 : 0;
        add_edges(&digest, edges);
        add_control(&digest, &c);
        digest_add(&digest, c.wanted == NULL ? 0 : 1);
        digest_add(&digest, c.waited);
        bits_add64(&digest, c.nearest_q48);
    }
    TEST_ASSERT_TRUE(taken > CYCLES / 40 / 2);
    bits_golden(UINT64_C(0x2f8fbb7458f980c2), digest);
}

/* Whatever is held is held at: any machine that is allowed, currents to 8, speeds and references beyond their ends. */
static void the_controls_ends(void)
{
    uint64_t seed = 6;
    uint64_t digest = DIGEST_START;
    iqfoc_pattern_control_t c;
    for (int n = 0; n < CYCLES; n++) {
        if (n % 10 == 0) {
            drawn_table(&seed);
            iqfoc_pattern_control_config_t config;
            config.winding.k_u_q26 = bits_random(&seed, 1 << 23, 1 << bits_random(&seed, 24, 30));
            config.winding.rho_q30 = bits_random(&seed, 0, 1 << bits_random(&seed, 24, 30));
            config.winding.k_psi_q27 =
                (int32_t)bits_held(bits_random(&seed, 0, 1 << 30), 0, 31 * (int64_t)config.winding.k_u_q26);
            config.correction = random_iq24(&seed, 0.0, 1.0);
            config.disturbance = random_iq24(&seed, 0.0, 0.25);
            TEST_ASSERT_EQUAL_INT(
                IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, random_iq24(&seed, 0.0, 0.1)));
        }
        const iq24_t turns = random_iq24(&seed, -0.3, 0.3) / bits_random(&seed, 1, 100);
        const double far = n % 3 == 0 ? 8.0 : 1.0;
        iqfoc_dq_t i_ref;
        i_ref.d = random_iq24(&seed, -far, far);
        i_ref.q = random_iq24(&seed, -far, far);
        iqfoc_ab_t i;
        i.alpha = random_iq24(&seed, -8.0, 8.0);
        i.beta = random_iq24(&seed, -8.0, 8.0);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_aim(&c, i_ref, turns);
        iqfoc_pattern_control_step(&c, i, bits_random(&seed, INT32_MIN, INT32_MAX),
                                   random_iq24(&seed, 0.5, 1.5), edges);
        add_edges(&digest, edges);
        add_control(&digest, &c);
        digest_add(&digest, c.trajectory.turns);
        digest_add(&digest, c.trajectory.cycles_q22);
        digest_add(&digest, c.trajectory.l);
    }
    bits_golden(UINT64_C(0x205a727dbef04c4f), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_modulator);
    RUN_TEST(the_control);
    RUN_TEST(change_of_the_table);
    RUN_TEST(the_controls_ends);
    return UNITY_END();
}
