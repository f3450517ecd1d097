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
        bits_add(digest, edges[k].instant, (size_t)edges[k].edges * sizeof edges[k].instant[0]);
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
        const iq24_t speed = random_iq24(&seed, -0.15, 0.15);
        const iq24_t u = random_iq24(&seed, 0.0, 1.0);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_step(&m, angle, speed, iqfoc_pattern_index(u, random_iq24(&seed, 0.7, 2.0)), edges);
        add_edges(&digest, edges);
        bits_add(&digest, m.leg, sizeof m.leg);
    }
    bits_golden(UINT64_C(0xfe738ac9a4dbbd44), digest);
}

/* Where rows are not joined the next one is taken from 3/4 of the way on, and the last one back from 1/4 on. */
static void change_of_the_row(void)
{
    static const iqfoc_pattern_row_t two[2] = {{1, 0, {IQ24(0.1)}}, {-1, 0, {IQ24(0.2)}}};
    const iqfoc_pattern_t unjoined = {two, 2, 1, 0, IQ24_ONE};
    iqfoc_pattern_modulator_t m;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &unjoined, 0));
    static const struct {
        iq24_t index;
        int32_t row;
    } steps[] = {{IQ24(0.75) - 1, 0}, {IQ24(0.75), 1}, {IQ24(0.25), 1}, {IQ24(0.25) - 1, 0},
                 {IQ24(0.5), 0},      {IQ24_ONE, 1},   {IQ24(0.5), 1}};
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        const iqfoc_pattern_shape_t shape = iqfoc_pattern_shape_at(&m, steps[k].index);
        TEST_ASSERT_EQUAL_INT32(steps[k].row, m.row);
        TEST_ASSERT_EQUAL_INT32(two[m.row].start, shape.start);
        TEST_ASSERT_EQUAL_INT32(two[m.row].angle[0], shape.angle[0]);
    }
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
    digest_add(digest, c->trajectory.u_place);
    bits_add(digest, &c->trajectory.steady_q28, sizeof c->trajectory.steady_q28);
    bits_add(digest, &c->trajectory.drift_q26, sizeof c->trajectory.drift_q26);
    bits_add(digest, c->leg, sizeof c->leg);
    bits_add(digest, &c->i_next, sizeof c->i_next);
    bits_add(digest, &c->carried, sizeof c->carried);
    bits_add(digest, &c->v, sizeof c->v);
    bits_add(digest, &c->error, sizeof c->error);
    digest_add(digest, c->u_slope);
    digest_add(digest, c->u_mean);
    digest_add(digest, c->u_dc_inverse);
}

static void the_control(void)
{
    uint64_t seed = 4;
    uint64_t digest = DIGEST_START;
    iqfoc_pattern_control_t c;
    iq24_t theta = 0;
    iq24_t speed = 0;
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
            speed = random_iq24(&seed, -0.13, 0.13);
            i_ref.d = random_iq24(&seed, -1.5, 1.5);
            i_ref.q = random_iq24(&seed, -1.5, 1.5);
            far = n % 3 == 0 ? 0.01 : 1.0;
        }
        iqfoc_ab_t i = c.i_next;
        i.alpha = iq24_clamp(i.alpha + random_iq24(&seed, -far, far), IQ24(-8.0), IQ24(8.0));
        i.beta = iq24_clamp(i.beta + random_iq24(&seed, -far, far), IQ24(-8.0), IQ24(8.0));
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        iqfoc_pattern_control_step(&c, i, theta, random_iq24(&seed, 0.5, 1.5), edges);
        theta = iq24_add_wrap(theta, speed);
        add_edges(&digest, edges);
        add_control(&digest, &c);
    }
    bits_golden(UINT64_C(0x056bbaf227c2ec60), digest);
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
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.01)};
    iq24_t theta = 0;
    iq24_t speed = 0;
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
            speed = random_iq24(&seed, -0.13, 0.13) / (n % 80 == 0 ? 1 : 4);
        }
        const iqfoc_dq_t i_ref = {IQ24(-0.3), random_iq24(&seed, 0.7, 0.8)};
        const bool waits = c.wanted != NULL;
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        iqfoc_pattern_control_step(&c, c.i_next, theta, IQ24_ONE, edges);
        theta = iq24_add_wrap(theta, speed);
        taken += waits && c.wanted == NULL ? 1 : 0;
        add_edges(&digest, edges);
        add_control(&digest, &c);
        digest_add(&digest, c.wanted == NULL ? 0 : 1);
        digest_add(&digest, c.waited);
        bits_add64(&digest, c.nearest_q48);
    }
    TEST_ASSERT_TRUE(taken > CYCLES / 40 / 2);
    bits_golden(UINT64_C(0x90781871ddadf3ef), digest);
}

/* All angles within 1/64 of a turn of its quarter, so that one cycle has the most edges. */
static void crowd_table(void)
{
    for (int n = 0; n < ROWS; n++) {
        for (int k = 0; k < table.angles; k++) {
            rows[n].angle[k] = IQ24(0.25) - (IQ24(0.25) - rows[n].angle[k]) / 16;
        }
    }
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
            if (n % 20 == 0) {
                crowd_table();
            }
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
        const iq24_t speed = random_iq24(&seed, -0.3, 0.3) / bits_random(&seed, 1, 100);
        const double far = n % 3 == 0 ? 8.0 : 1.0;
        iqfoc_dq_t i_ref;
        i_ref.d = random_iq24(&seed, -far, far);
        i_ref.q = random_iq24(&seed, -far, far);
        iqfoc_ab_t i;
        i.alpha = random_iq24(&seed, -8.0, 8.0);
        i.beta = random_iq24(&seed, -8.0, 8.0);
        const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        iqfoc_pattern_control_step(&c, i, theta, random_iq24(&seed, 0.5, 1.5), edges);
        add_edges(&digest, edges);
        add_control(&digest, &c);
        digest_add(&digest, c.trajectory.speed);
        digest_add(&digest, c.trajectory.cycles_q22);
        digest_add(&digest, c.trajectory.l_q28);
    }
    bits_golden(UINT64_C(0x606271a11fe10a48), digest);
}

/* All rows alike, with angles of whole 64ths of a turn: at angles of such the edges are where a cycle begins or ends. */
static void grid_table(uint64_t *seed)
{
    const iq24_t unit = IQ24_ONE / 64;
    drawn_table(seed);
    for (int k = 0; k < table.angles; k++) {
        rows[0].angle[k] -= rows[0].angle[k] % unit;
    }
    for (int n = 0; n < ROWS; n++) {
        rows[n] = rows[0];
        rows[n].joined = n + 1 < ROWS;
    }
}

static void edges_at_the_ends_of_cycles(void)
{
    uint64_t seed = 9;
    uint64_t digest = DIGEST_START;
    const iq24_t unit = IQ24_ONE / 64;
    iqfoc_pattern_modulator_t m;
    iqfoc_pattern_control_t c;
    for (int n = 0; n < CYCLES / 4; n++) {
        if (n % 50 == 0) {
            grid_table(&seed);
            const iqfoc_pattern_control_config_t config = any_machine(&seed);
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &table, 0));
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, 0));
        }
        const iq24_t speed = unit * (n % 2 == 0 ? bits_random(&seed, 1, 8) : -bits_random(&seed, 1, 8));
        const iq24_t angle = unit * bits_random(&seed, -64, 64) + (n % 3 == 0 ? IQ24(1.0 / 3.0) : 0);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_step(&m, angle, speed, IQ24(0.9), edges);
        add_edges(&digest, edges);
        bits_add(&digest, m.leg, sizeof m.leg);
        const iqfoc_dq_t i_ref = {0, IQ24(0.5)};
        iqfoc_pattern_control_aim(&c, i_ref, speed);
        const iq24_t u_angle = c.trajectory.sense * (c.trajectory.u_place - IQ24(0.25));
        iqfoc_pattern_control_step(&c, c.i_next, angle - speed - u_angle, IQ24_ONE, edges);
        add_edges(&digest, edges);
        add_control(&digest, &c);
    }
    bits_golden(UINT64_C(0x2d6b2559dc14a471), digest);
}

/* Rows at any distance of the index, so that the place between them is rounded. */
static void rows_at_any_distance(void)
{
    uint64_t seed = 10;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < CYCLES; n++) {
        if (n % 100 == 0) {
            drawn_table(&seed);
        }
        iqfoc_pattern_t other = table;
        other.index_low = random_iq24(&seed, 0.0, 1.0);
        other.rows_per_index = random_iq24(&seed, 1.0, 100.0);
        iqfoc_pattern_modulator_t m;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &other, 0));
        m.row = bits_random(&seed, 0, ROWS - 1);
        const iqfoc_pattern_shape_t shape = iqfoc_pattern_shape_at(&m, random_iq24(&seed, 0.0, 1.1));
        digest_add(&digest, shape.start);
        bits_add(&digest, shape.angle, sizeof shape.angle);
        digest_add(&digest, m.row);
    }
    bits_golden(UINT64_C(0xbe7a05ae42e7b31d), digest);
}

/* Nothing beyond the three legs is written. */
static void three_legs(void)
{
    uint64_t seed = 7;
    grid_table(&seed); /* without a jump, which would be a change */
    const iqfoc_pattern_control_config_t config = any_machine(&seed);
    iqfoc_pattern_control_t c;
    iqfoc_pattern_edges_t edges[4];
    iqfoc_pattern_edges_t fourth;
    memset(&fourth, 0x5A, sizeof fourth);
    memset(edges, 0x5A, sizeof edges);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, 0));
    iqfoc_pattern_control_t after = c;
    for (int n = 0; n < 100; n++) {
        const iqfoc_ab_t i = {random_iq24(&seed, -1.0, 1.0), 0};
        const iqfoc_dq_t i_ref = {0, IQ24_ONE};
        iqfoc_pattern_step(&c.modulator, n * IQ24(0.1), IQ24(0.1), IQ24(0.9), edges);
        iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.1));
        iqfoc_pattern_control_step(&c, i, n * IQ24(0.1), IQ24_ONE, edges);
        TEST_ASSERT_EQUAL_MEMORY(&fourth, &edges[3], sizeof fourth);
        TEST_ASSERT_TRUE(c.wanted == after.wanted && c.waited == after.waited &&
                         c.nearest_q48 == after.nearest_q48);
    }
}

/* A table whose flux is the same is taken just beyond a sixth of a turn; one whose flux is never near, when the limit has risen. */
static void times_of_a_change(void)
{
    uint64_t seed = 8;
    static iqfoc_pattern_row_t other_rows[ROWS];
    drawn_table(&seed);
    memcpy(other_rows, rows, sizeof rows);
    iqfoc_pattern_t same = table;
    same.row = other_rows;
    const iqfoc_pattern_control_config_t config = any_machine(&seed);
    const iqfoc_dq_t i_ref = {0, IQ24(0.5)};
    iqfoc_pattern_control_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, 0));
    iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.1));
    iqfoc_pattern_control_change(&c, &same);
    iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.1));
    iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.1666667) - IQ24(0.1));
    TEST_ASSERT_EQUAL_INT32(IQ24(0.1666667), c.waited);
    TEST_ASSERT_EQUAL_PTR(&same, c.wanted);
    iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.1));
    TEST_ASSERT_NULL(c.wanted);
    TEST_ASSERT_EQUAL_PTR(&same, c.modulator.table);

    drawn_table(&seed);
    iqfoc_pattern_control_change(&c, &table);
    c.nearest_q48 = 0;
    int cycles = 0;
    while (c.wanted != NULL && cycles < 600) {
        iqfoc_pattern_control_aim(&c, i_ref, IQ24(0.125));
        cycles++;
    }
    TEST_ASSERT_TRUE(cycles > 16);
    TEST_ASSERT_NULL(c.wanted);
    TEST_ASSERT_EQUAL_PTR(&table, c.modulator.table);
}

/* A jump between rows whose flux is the same is made at once. */
static void jump_at_once(void)
{
    uint64_t seed = 11;
    grid_table(&seed);
    rows[ROWS - 2].joined = 0;
    const iqfoc_pattern_control_config_t config = {
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.01)};
    const iqfoc_dq_t none = {0, 0};
    const iqfoc_dq_t most = {0, IQ24(8.0)};
    iqfoc_pattern_control_t c;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&c, &config, &table, 0));
    iqfoc_pattern_control_aim(&c, none, IQFOC_PATTERN_CONTROL_SPEED_MIN);
    TEST_ASSERT_TRUE(c.modulator.row < ROWS - 1);
    iqfoc_pattern_control_aim(&c, most, IQ24(0.1));
    TEST_ASSERT_EQUAL_INT32(ROWS - 1, c.modulator.row);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, c.waited);
    TEST_ASSERT_NULL(c.wanted);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_modulator);
    RUN_TEST(change_of_the_row);
    RUN_TEST(the_control);
    RUN_TEST(change_of_the_table);
    RUN_TEST(the_controls_ends);
    RUN_TEST(edges_at_the_ends_of_cycles);
    RUN_TEST(rows_at_any_distance);
    RUN_TEST(three_legs);
    RUN_TEST(times_of_a_change);
    RUN_TEST(jump_at_once);
    return UNITY_END();
}
