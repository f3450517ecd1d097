/*
 * When a flux map of terms becomes the whole map, and when parts that saturate take the place of what bends otherwise
 * (sim_host/diagnose/weigh/map_choice.h). The program is linked so
 * that the fit of a trial is what a test says it is.
 */
#include "choose_fixture.h"
#include "diagnose/identify/fit.h"
#include "diagnose/weigh/map_choice.h"
#include "diagnose/weigh/tolerance.h"
#include "model/flux_map.h"

#include <string.h>

#define RATED_A 10.0
#define L_D_H   2e-3
#define L_Q_H   3e-3
#define MAPS    (BIT(H_MAP_TERMS) | BIT(H_MAP))

static coordinate_frame frame;
static fit_data data;
static size_t fits;
enum { MOST_FITS = 8 };

static fit_state tried[MOST_FITS];
/* By the first part alone or a whole map, by a second part, and by the first alone again, of the objective at which each begins. */
static double gained[3];
static double gained_with;    /* by the first part with the other members */
static double gained_close;   /* by two parts that begin at the state's flux */
static double energy;         /* of the first part, as fitted */
static double fall, given_up; /* of a whole map */
static size_t memory_for;

bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone);
bool __wrap_tolerance_of_state(fit_data *d, const fit_state *s, double *worth);

/* A second part that is not in its usual place next to a first one. */
static bool begins_close(const fit_state *s)
{
    return hypothesis_in(s->set, H_IRON_2) && (s->z[P_IRON_2_D] != 0.0 || s->z[P_IRON_2_Q] != 0.0);
}

bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone)
{
    TEST_ASSERT_TRUE(d == &data && fits < MOST_FITS);
    const bool whole = hypothesis_in(s->set, H_MAP);
    if (whole) {
        TEST_ASSERT_EQUAL_INT(5, iterations);
        SAME(1000.0, aim->most);
    } else {
        TEST_ASSERT_TRUE(iterations > 10 && aim->most == INFINITY);
    }
    const bool second = hypothesis_in(s->set, H_IRON_2);
    const bool close = begins_close(s);
    const bool again = !whole && !second && fits > 0 && hypothesis_in(tried[fits - 1].set, H_IRON_2);
    const bool with = !whole && !second && !again && s->set != BIT(H_IRON_1);
    tried[fits] = *s;
    s->objective -= close ? gained_close : (with ? gained_with : gained[again ? 2 : (second ? 1 : 0)]);
    s->z[whole ? P_SATURATION : P_IRON_1] = whole ? fall : energy;
    *alone = s->objective + (whole ? given_up : 0.0);
    return fits++ < memory_for;
}

bool __wrap_tolerance_of_state(fit_data *d, const fit_state *s, double *worth)
{
    (void)d;
    (void)s;
    *worth = 0.0;
    return true;
}

/* A fitted state with a fall by a third at the rated current, next to a resistance. */
static void prepare(hypothesis_set set)
{
    frame = (coordinate_frame){.i_rated_peak_A = RATED_A, .of_least = 1.0};
    const iron_part none = {0.0, RATED_A, RATED_A, 0.0};
    frame.nominal = (averaged_drive){.R_ohm = 1.0,
                                     .L_d_H = 2e-3,
                                     .L_q_H = 3e-3,
                                     .psi_f_Wb = 0.1,
                                     .iron = {none, none},
                                     .i_knee_A = 0.1,
                                     .k_u = 1.0};
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        frame.scale[k] = 1.0;
    }
    for (int n = 0; n < COORDINATE_DIRECTIONS; n++) {
        const double turn = VEC_TWO_PI * n / COORDINATE_DIRECTIONS;
        frame.reach_A[n] = (vec_dq){RATED_A * cos(turn), RATED_A * sin(turn)};
    }
    frame.scale[SCALE_PER_SQUARE] = 1.0 / (RATED_A * RATED_A);
    frame.scale[SCALE_MAP_ENERGY] = 2.5e-3 * RATED_A * RATED_A;
    frame.scale[SCALE_CURRENT] = RATED_A;
    data = (fit_data){.rows = &rows, .frame = &frame};
    state = fit_nominal();
    state.set = set;
    state.objective = 1000.0;
    state.z[P_R] = 0.2;
    state.z[P_L_D] = state.z[P_L_Q] = 0.1;
    state.z[P_SATURATION] = hypothesis_in(set, H_SATURATION) ? 0.5 : 0.0;
    state.z[P_IRON_1] = hypothesis_in(set, H_IRON_1) ? 0.6 : 0.0;
    fits = 0;
    gained[0] = gained[1] = 500.0;
    gained[2] = gained_with = gained_close = -500.0;
    energy = 0.4;
    memory_for = MOST_FITS;
}

static hypothesis_set chosen(hypothesis_set allowed)
{
    TEST_ASSERT_TRUE(map_choose(&data, &state, allowed, 5));
    return state.set;
}

/* A fitted state that holds a map of terms. */
static void prepare_terms(hypothesis_set set)
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
    state = fit_nominal();
    state.set = set;
    state.objective = 1000.0;
    state.z[P_L_D] = 0.1;
    state.z[P_L_Q] = -0.1;
    state.z[P_W_DQQ] = 0.05;
    state.z[P_W_QQQQ] = -0.1;
    fits = 0;
    gained[0] = 60.1;
    fall = 0.4;
    given_up = 0.0;
    memory_for = MOST_FITS;
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
        const vec_dq is = flux_of(&tried[0], i);
        most = fmax(most, fmax(fabs(is.d - was.d), fabs(is.q - was.q)));
    }
    return most;
}

/* The fall that begins takes a third at the rated current; to the third order of the current the flux stays what it is. */
static void a_fall_begins_where_the_terms_leave_off(void)
{
    prepare_terms(BIT(H_MAP_Q) | BIT(H_RESISTANCE));
    const fit_state before = state;
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    TEST_ASSERT_EQUAL_size_t(1, fits);
    TEST_ASSERT_TRUE(tried[0].set == (BIT(H_MAP) | BIT(H_RESISTANCE)));
    SAME(0.5, tried[0].z[P_SATURATION]);
    const double small = more_at(&before, 0.1);
    const double large = more_at(&before, 1.0);
    TEST_ASSERT_TRUE(large > 1e-8);
    TEST_ASSERT_DOUBLE_WITHIN(0.1e-5 * large, 1e-5 * large, small); /* by the fifth power */
    SAME(before.z[P_W_DQQ], tried[0].z[P_W_DQQ]);
}

static void it_is_worth_its_parameters_and_physical(void)
{
    prepare_terms(BIT(H_MAP_TERMS));
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    SAME(1000.0 - 60.1, state.objective);
    prepare_terms(BIT(H_MAP_TERMS));
    gained[0] = gained[1] = 59.9;
    const fit_state before = state;
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof before);
    gained[0] = gained[1] = 60.0;
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    gained[0] = gained[1] = 200.0;
    given_up = 201.0; /* its own coordinates were still behind the state */
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    given_up = 0.0;
    fall = -0.1; /* iron does not rise */
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    memory_for = 0;
    TEST_ASSERT_FALSE(map_choose(&data, &state, BIT(H_MAP), 5));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof before);
}

/* Each of the maps of terms, and only where the whole one may be; from within what is physical. */
static void it_is_tried_from_terms_alone(void)
{
    const hypothesis_id terms[] = {H_MAP_TERMS, H_MAP_EVEN, H_MAP_Q};
    for (size_t k = 0; k < sizeof terms / sizeof *terms; k++) {
        prepare_terms(BIT(terms[k]));
        TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP_TERMS) | BIT(H_RESISTANCE)));
        TEST_ASSERT_EQUAL_size_t(0, fits);
        TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
        TEST_ASSERT_TRUE(state.set == BIT(H_MAP));
    }
    prepare_terms(BIT(H_RESISTANCE));
    TEST_ASSERT_FALSE(becomes_whole(BIT(H_MAP)));
    prepare_terms(BIT(H_MAP));
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    TEST_ASSERT_EQUAL_size_t(0, fits);
    prepare_terms(BIT(H_MAP_EVEN));
    state.z[P_L_D] = 9.0;
    TEST_ASSERT_TRUE(becomes_whole(BIT(H_MAP)));
    SAME(coordinate_table[P_L_D].high, tried[0].z[P_L_D]);
}

static void one_part_and_then_a_second(void)
{
    prepare(BIT(H_SATURATION) | BIT(H_RESISTANCE));
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_2));
    TEST_ASSERT_EQUAL_size_t(5, fits);
    TEST_ASSERT_TRUE(tried[0].set == BIT(H_IRON_1));
    /* Nothing is left of what was found next to the wrong model, and the part is there. */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, tried[0].z[P_R]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, tried[0].z[P_SATURATION]);
    TEST_ASSERT_TRUE(tried[0].z[P_IRON_1] > 0.0 && tried[0].z[P_IRON_2] == 0.0);
    /* With all of it that is no shape of the flux as well. */
    TEST_ASSERT_TRUE(tried[1].set == (BIT(H_IRON_1) | BIT(H_RESISTANCE)));
    TEST_ASSERT_EQUAL_DOUBLE(0.2, tried[1].z[P_R]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, tried[1].z[P_SATURATION]);
    TEST_ASSERT_EQUAL_DOUBLE(tried[0].z[P_IRON_1], tried[1].z[P_IRON_1]);
    /* The second begins where the better one's fit ended, at another place in the map. */
    TEST_ASSERT_EQUAL_DOUBLE(energy, tried[2].z[P_IRON_1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, tried[2].z[P_R]);
    TEST_ASSERT_TRUE(tried[2].z[P_IRON_2] > 0.0 && tried[2].z[P_IRON_2_C] != tried[2].z[P_IRON_1_C]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.objective);
}

/* Two parts that begin as close to the state's flux as they come: here a fall by a third, and terms. */
static void two_begin_at_the_flux_of_the_state(void)
{
    for (int terms = 0; terms < 2; terms++) {
        prepare((terms ? BIT(H_MAP) : BIT(H_SATURATION)) | BIT(H_RESISTANCE));
        state.z[P_SATURATION] = 0.5;
        frame.scale[SCALE_MAP_THIRD] = 2.5e-3 / (3.0 * RATED_A);
        state.z[P_W_DQQ] = terms ? -0.1 : 0.0;
        const fit_state before = state;
        gained[0] = gained[1] = -500.0;
        gained_close = 500.0;
        TEST_ASSERT_TRUE(chosen(MAPS) == (BIT(H_IRON_2) | BIT(H_RESISTANCE)));
        const fit_state *close = &tried[3];
        TEST_ASSERT_TRUE(begins_close(close) && close->set == (BIT(H_IRON_2) | BIT(H_RESISTANCE)));
        TEST_ASSERT_EQUAL_DOUBLE(before.z[P_R], close->z[P_R]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, close->z[P_SATURATION]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, close->z[P_W_DQQ]);
        for (int n = 0; n < COORDINATE_DIRECTIONS; n++) {
            const vec_dq wanted = flux_of(&before, frame.reach_A[n]);
            const vec_dq two = flux_of(close, frame.reach_A[n]);
            TEST_ASSERT_TRUE(hypot(two.d - wanted.d, two.q - wanted.q) < 0.03 * hypot(wanted.d, wanted.q));
        }
        /* What is better than the state decides whose members they keep. */
        state = before;
        fits = 0;
        gained[0] = 500.0;
        TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_1));
        TEST_ASSERT_TRUE(tried[3].set == BIT(H_IRON_2));
    }
}

static void other_members_stay_if_they_pay(void)
{
    prepare(BIT(H_SATURATION) | BIT(H_RESISTANCE));
    gained_with = 800.0;
    TEST_ASSERT_TRUE(chosen(MAPS) == (BIT(H_IRON_2) | BIT(H_RESISTANCE)));
    TEST_ASSERT_TRUE(tried[2].set == (BIT(H_IRON_2) | BIT(H_RESISTANCE)));
    TEST_ASSERT_EQUAL_DOUBLE(0.2, state.z[P_R]);
    prepare(BIT(H_SATURATION) | BIT(H_RESISTANCE));
    gained_with = 505.0; /* less than a resistance pays */
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_2));
}

/* A second part may only have led the first one on, which then does as well alone. */
static void the_first_part_alone_again(void)
{
    prepare(BIT(H_SATURATION) | BIT(H_RESISTANCE));
    gained[2] = -40.0; /* four numbers at 12 each */
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_1));
    TEST_ASSERT_EQUAL_size_t(5, fits);
    TEST_ASSERT_TRUE(tried[4].set == BIT(H_IRON_1));
    TEST_ASSERT_EQUAL_DOUBLE(energy, tried[4].z[P_IRON_1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, tried[4].z[P_IRON_2]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, tried[4].z[P_IRON_2_C]);
    prepare(BIT(H_SATURATION) | BIT(H_RESISTANCE));
    gained[2] = -60.0;
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_2));
}

static void each_pays_for_its_numbers(void)
{
    /* Four numbers at 12 each. */
    prepare(BIT(H_SATURATION));
    gained[1] = 40.0;
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_1));
    prepare(BIT(H_SATURATION));
    gained[1] = 60.0;
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_2));
    /* Neither is better than what is there; then it stays to the last bit. */
    prepare(BIT(H_SATURATION));
    gained[0] = 20.0;
    gained[1] = 0.0;
    const fit_state before = state;
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_SATURATION));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof before);
    /* A second part may bring what the first alone does not. */
    prepare(BIT(H_SATURATION));
    gained[0] = 20.0;
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_IRON_2));
    /* No part of no energy. */
    prepare(BIT(H_SATURATION));
    gained[1] = 0.0;
    energy = 0.0;
    TEST_ASSERT_TRUE(chosen(MAPS) == BIT(H_SATURATION) || state.z[P_IRON_2] > 0.0);
    TEST_ASSERT_FALSE(hypothesis_in(state.set, H_IRON_1));
}

static void a_second_part_leaves_the_others(void)
{
    prepare(BIT(H_IRON_1) | BIT(H_RESISTANCE));
    TEST_ASSERT_TRUE(chosen(MAPS) == (BIT(H_IRON_2) | BIT(H_RESISTANCE)));
    TEST_ASSERT_EQUAL_size_t(2, fits);
    TEST_ASSERT_EQUAL_DOUBLE(0.2, tried[0].z[P_R]);
    TEST_ASSERT_EQUAL_DOUBLE(0.6, tried[0].z[P_IRON_1]);
}

static void they_are_tried_where_much_bends(void)
{
    prepare(BIT(H_SATURATION));
    /* i^2 by the energy is 1.2 times the current's in q: a fall by 14 and by 16 %. */
    state.z[P_SATURATION] = 0.163 / 1.2;
    chosen(MAPS);
    TEST_ASSERT_EQUAL_size_t(0, fits);
    state.z[P_SATURATION] = 0.19 / 1.2;
    chosen(MAPS);
    TEST_ASSERT_EQUAL_size_t(4, fits);
    const hypothesis_set never[] = {BIT(H_RESISTANCE), BIT(H_IRON_2), BIT(H_INDUCTANCE)};
    for (size_t k = 0; k < sizeof never / sizeof *never; k++) {
        prepare(never[k]);
        TEST_ASSERT_TRUE(chosen(MAPS) == never[k]);
        TEST_ASSERT_EQUAL_size_t(0, fits);
    }
    prepare(BIT(H_SATURATION));
    chosen(BIT(H_MAP)); /* the cause was dropped */
    TEST_ASSERT_EQUAL_size_t(0, fits);
    data.effort = 1e9; /* so much was tried */
    chosen(MAPS);
    TEST_ASSERT_EQUAL_size_t(1, fits);
    TEST_ASSERT_TRUE(begins_close(&tried[0]));
}

static void without_memory_the_state_stays(void)
{
    for (memory_for = 0; memory_for < 2; memory_for++) {
        const size_t until = memory_for;
        prepare(BIT(H_SATURATION));
        memory_for = until;
        gained[0] = 0.0;
        const fit_state before = state;
        TEST_ASSERT_FALSE(map_choose(&data, &state, MAPS, 5));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof before);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_fall_begins_where_the_terms_leave_off);
    RUN_TEST(it_is_worth_its_parameters_and_physical);
    RUN_TEST(it_is_tried_from_terms_alone);
    RUN_TEST(one_part_and_then_a_second);
    RUN_TEST(two_begin_at_the_flux_of_the_state);
    RUN_TEST(other_members_stay_if_they_pay);
    RUN_TEST(the_first_part_alone_again);
    RUN_TEST(each_pays_for_its_numbers);
    RUN_TEST(a_second_part_leaves_the_others);
    RUN_TEST(they_are_tried_where_much_bends);
    RUN_TEST(without_memory_the_state_stays);
    return UNITY_END();
}
