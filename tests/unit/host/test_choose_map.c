/*
 * When a flux map of terms becomes the whole map (sim_host/diagnose/choose/map_choice.h). The program is linked so that the
 * fit of the trial is what a test says it is.
 */
#include "choose_fixture.h"
#include "diagnose/choose/map_choice.h"
#include "diagnose/identify/fit.h"
#include "model/flux_map.h"

#include <string.h>

#define RATED_A 10.0
#define L_D_H   2e-3
#define L_Q_H   3e-3

static coordinate_frame frame;
static fit_data data;
static size_t fits;
static fit_state tried;
static double gained, fall, given_up;
static bool no_memory;

bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone);

bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone)
{
    TEST_ASSERT_TRUE(d == &data);
    TEST_ASSERT_EQUAL_INT(5, iterations);
    SAME(1000.0, aim->most);
    fits++;
    tried = *s;
    s->objective -= gained;
    *alone = s->objective + given_up;
    s->z[P_SATURATION] = fall;
    return !no_memory;
}

/* A fitted state that holds a map of terms. */
static void prepare(hypothesis_set set)
{
    frame = (coordinate_frame){.i_rated_peak_A = RATED_A, .of_least = 1.0};
    frame.nominal = (averaged_drive){
        .R_ohm = 1.0, .L_d_H = L_D_H, .L_q_H = L_Q_H, .psi_f_Wb = 0.1, .i_knee_A = 0.1, .k_u = 1.0};
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        frame.scale[k] = 1.0;
    }
    frame.scale[SCALE_PER_SQUARE] = 1.0 / (RATED_A * RATED_A);
    frame.scale[SCALE_MAP_THIRD] = 0.5 * (L_D_H + L_Q_H) / (3.0 * RATED_A);
    frame.scale[SCALE_MAP_FOURTH] = 0.5 * (L_D_H + L_Q_H) / (4.0 * RATED_A * RATED_A);
    data = (fit_data){.rows = &rows, .frame = &frame};
    state.set = set;
    state.objective = 1000.0;
    state.z[P_L_D] = 0.1;
    state.z[P_L_Q] = -0.1;
    state.z[P_W_DQQ] = 0.05;
    state.z[P_W_QQQQ] = -0.1;
    fits = 0;
    gained = 60.1;
    fall = 0.4;
    given_up = 0.0;
    no_memory = false;
}

static bool becomes_whole(hypothesis_set allowed)
{
    TEST_ASSERT_TRUE(map_choose(&data, &state, allowed, 5));
    return hypothesis_in(state.set, H_MAP);
}

static vec_dq flux_of(const fit_state *s, vec_dq i)
{
    const averaged_drive drive = coordinates_drive(&frame, s->z, EDGE_CHARGED);
    return flux_map_flux(&drive, i);
}

/* What the trial's flux has more than the state's, in d or q, where the current has that length. */
static double more_at(const fit_state *s, double length_A)
{
    double most = 0.0;
    for (int n = 0; n < 8; n++) {
        const double turn = VEC_TWO_PI * (n + 0.3) / 8.0;
        const vec_dq i = {length_A * cos(turn), length_A * sin(turn)};
        const vec_dq was = flux_of(s, i);
        const vec_dq is = flux_of(&tried, i);
        most = fmax(most, fmax(fabs(is.d - was.d), fabs(is.q - was.q)));
    }
    return most;
}

/* The fall that begins takes a third at the rated current; to the third order of the current the flux stays what it is. */
static void a_fall_begins_where_the_terms_leave_off(void)
{
    prepare(BIT(H_MAP_Q) | BIT(H_RESISTANCE));
    const fit_state before = state;
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    TEST_ASSERT_EQUAL_size_t(1, fits);
    TEST_ASSERT_TRUE(tried.set == (BIT(H_MAP) | BIT(H_RESISTANCE)));
    SAME(0.5, tried.z[P_SATURATION]);
    const double small = more_at(&before, 0.1);
    const double large = more_at(&before, 1.0);
    TEST_ASSERT_TRUE(large > 1e-8);
    TEST_ASSERT_DOUBLE_WITHIN(0.1e-5 * large, 1e-5 * large, small); /* by the fifth power */
    SAME(before.z[P_W_DQQ], tried.z[P_W_DQQ]);
}

static void it_is_worth_its_parameters_and_physical(void)
{
    prepare(BIT(H_MAP_TERMS));
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    SAME(1000.0 - 60.1, state.objective);
    prepare(BIT(H_MAP_TERMS));
    gained = 59.9;
    const fit_state before = state;
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof before);
    gained = 60.0;
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    gained = 200.0;
    given_up = 201.0; /* its own coordinates were still behind the state */
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    given_up = 0.0;
    fall = -0.1; /* iron does not rise */
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    no_memory = true;
    TEST_ASSERT_FALSE(map_choose(&data, &state, BIT(H_MAP), 5));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof before);
}

/* Each of the maps of terms, and only where the whole one may be; from within what is physical. */
static void it_is_tried_from_terms_alone(void)
{
    const hypothesis_id terms[] = {H_MAP_TERMS, H_MAP_EVEN, H_MAP_Q};
    for (size_t k = 0; k < sizeof terms / sizeof *terms; k++) {
        prepare(BIT(terms[k]));
        TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP_TERMS) | BIT(H_RESISTANCE)));
        TEST_ASSERT_EQUAL_size_t(0, fits);
        TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
        TEST_ASSERT_TRUE(state.set == BIT(H_MAP));
    }
    prepare(BIT(H_RESISTANCE));
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    prepare(BIT(H_MAP));
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    TEST_ASSERT_EQUAL_size_t(0, fits);
    prepare(BIT(H_MAP_EVEN));
    state.z[P_L_D] = 9.0;
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    SAME(coordinate_table[P_L_D].high, tried.z[P_L_D]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_fall_begins_where_the_terms_leave_off);
    RUN_TEST(it_is_worth_its_parameters_and_physical);
    RUN_TEST(it_is_tried_from_terms_alone);
    return UNITY_END();
}
