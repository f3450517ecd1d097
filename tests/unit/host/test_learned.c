/*
 * What is learned of an effect without a name, on the bench of diagnose_bench.h: the terms that are there, with a gain on
 * rows that were not fitted, and nothing where there is nothing to learn.
 */
#include "diagnose/learn/learned.h"
#include "diagnose/learn/terms.h"
#include "diagnose/tell/json.h"
#include "diagnose_look.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static bench good;

void setUp(void)
{
    good = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20260101};
}

void tearDown(void)
{
}

static double value_of(const diagnosis_learned *l, const char *name, const char *unit)
{
    for (size_t k = 0; k < l->terms; k++) {
        if (strcmp(l->term[k].name, name) == 0) {
            TEST_ASSERT_EQUAL_STRING(unit, l->term[k].unit);
            return l->term[k].value;
        }
    }
    TEST_FAIL_MESSAGE(name);
    return 0.0;
}

/* 0.6 % is what the noise of these recordings leaves. */
static void is_learned_and_not_named(const diagnosis *d)
{
    TEST_ASSERT_EQUAL_INT(VERDICT_UNEXPLAINED, d->verdict);
    TEST_ASSERT_EQUAL_size_t(0, d->causes);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * d->extended, d->extended, d->learned.nominal);
    TEST_ASSERT_TRUE(d->learned.extended < 0.65);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, d->learned.nominal / d->learned.extended, d->learned.gain);
    TEST_ASSERT_TRUE(d->learned.points > 20);
}

static void a_ninth_order_is_learned(void)
{
    good.cogging_V = 6.0;
    diagnosis d = look(&good, NULL);
    is_learned_and_not_named(&d);
    TEST_ASSERT_EQUAL_size_t(1, d.learned.terms);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 6.0, value_of(&d.learned, "v_q: cos(9 theta_e)", "V"));
    TEST_ASSERT_EQUAL_STRING("what is left depends on the rotor's electrical angle (order 9)",
                             d.learned.words);
    TEST_ASSERT_TRUE(d.learned.turns);
    /* The picture shows the same: what is left, and what is learned of it, over the angle. */
    for (size_t n = 0; n < d.learned.points; n++) {
        const diagnosis_learned_point *p = &d.learned.point[n];
        TEST_ASSERT_DOUBLE_WITHIN(0.8, p->left, p->learned);
    }
    d.recording_path = d.motor_path = "bench";
    json_t *json = json_of_diagnosis(&d);
    const json_t *learned = json_object_get(json, "learned");
    const json_t *term = json_array_get(json_object_get(learned, "terms"), 0);
    TEST_ASSERT_EQUAL_STRING("v_q: cos(9 theta_e)", json_string_value(json_object_get(term, "name")));
    TEST_ASSERT_EQUAL_STRING("V", json_string_value(json_object_get(term, "unit")));
    TEST_ASSERT_EQUAL_DOUBLE(d.learned.term[0].value, json_number_value(json_object_get(term, "value")));
    TEST_ASSERT_EQUAL_DOUBLE(d.learned.nominal, json_number_value(json_object_get(learned, "nominal")));
    TEST_ASSERT_EQUAL_DOUBLE(d.learned.extended, json_number_value(json_object_get(learned, "extended")));
    TEST_ASSERT_EQUAL_DOUBLE(d.learned.gain, json_number_value(json_object_get(learned, "gain")));
    json_free(json);
    diagnosis_free(&d);
}

static void a_product_of_the_currents_is_learned(void)
{
    good.product_V_A2 = 0.3;
    diagnosis d = look(&good, NULL);
    is_learned_and_not_named(&d);
    TEST_ASSERT_EQUAL_size_t(1, d.learned.terms);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.3, value_of(&d.learned, "v_d: i_d i_q", "V/A^2"));
    TEST_ASSERT_EQUAL_STRING("what is left depends on i_d i_q", d.learned.words);
    TEST_ASSERT_FALSE(d.learned.turns);
    diagnosis_free(&d);
}

/* Of a ripple that keeps its frequency while the speed changes, nothing in the dictionary is true. */
static void a_ripple_is_no_order_of_the_angle(void)
{
    good.unlogged_ripple = 0.05;
    diagnosis d = look(&good, "dc_link_ripple");
    TEST_ASSERT_EQUAL_INT(VERDICT_UNEXPLAINED, d.verdict);
    TEST_ASSERT_EQUAL_size_t(0, d.learned.terms);
    d.recording_path = d.motor_path = "bench";
    json_t *json = json_of_diagnosis(&d);
    TEST_ASSERT_TRUE(json_is_null(json_object_get(json, "learned")));
    json_free(json);
    diagnosis_free(&d);
}

/* What learned_find makes of the file's drive on a recording of the bench. */
static diagnosis *learned_of_file(void)
{
    diagnosis *d = calloc(1, sizeof *d);
    motor file = bench_motor();
    recording rec = bench_record(&good);
    diagnose_rows rows;
    error e = {0};
    TEST_ASSERT_NOT_NULL(d);
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, &rec, &file, &e), e.text);
    d->extended_motor = file;
    d->extended_drive = averaged_drive_of(&file);
    TEST_ASSERT_TRUE(learned_find(&rows, d));
    rows_free(&rows);
    recording_free(&rec);
    return d;
}

/* The samples' own noise is in each error and in each sample: sixfold, it must not be learned as a current. */
static void noise_is_not_learned(void)
{
    for (int times = 1; times <= 6; times += 5) {
        good.noise_A = 0.017 * times;
        diagnosis *d = learned_of_file();
        TEST_ASSERT_EQUAL_size_t(0, d->learned.terms);
        TEST_ASSERT_EQUAL_STRING("", d->learned.words);
        free(d);
    }
}

/* A resistance that the file does not know is a voltage against each axis' own current. */
static void values_have_their_signs_and_units(void)
{
    good.m.R_ohm = 2.1;
    diagnosis *d = learned_of_file();
    TEST_ASSERT_EQUAL_size_t(2, d->learned.terms);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, -1.2, value_of(&d->learned, "v_d: i_d", "V/A"));
    TEST_ASSERT_DOUBLE_WITHIN(0.06, -1.2, value_of(&d->learned, "v_q: i_q", "V/A"));
    TEST_ASSERT_EQUAL_STRING("what is left depends on i_d and i_q", d->learned.words);
    free(d);
    good.m = bench_motor();
    good.m.psi_f_Wb = 0.21;
    d = learned_of_file();
    TEST_ASSERT_EQUAL_size_t(1, d->learned.terms);
    TEST_ASSERT_DOUBLE_WITHIN(0.0003, -0.01, value_of(&d->learned, "v_q: omega", "V s"));
    free(d);
}

/* An order along q, of 1 V at the operating points of `where`, with noise of a few tenths of a volt. */
static terms_chosen order_at(unsigned where)
{
    enum { GROUPS = 3, ROWS = 1000 };
    terms_sums *group = calloc(GROUPS + 1, sizeof *group);
    TEST_ASSERT_NOT_NULL(group);
    unsigned long random = 1;
    for (size_t g = 0; g < GROUPS; g++) {
        for (size_t k = 0; k < ROWS; k++) {
            double entry[ENTRIES];
            double noise[2];
            for (int x = 0; x < 2; x++) {
                random = (random * 1103515245UL + 12345UL) & 0x7fffffffUL;
                noise[x] = (double)random / 0x7fffffffUL - 0.5;
            }
            const double speed = 100.0 + 200.0 * (double)g;
            const learn_cycle c = {.middle = rotor_at(speed * 2.5e-4 * (double)k),
                                   .half_turn_rad = 1.25e-4 * speed,
                                   .omega_rad_s = speed,
                                   .i_A = {0.3 * (double)g, 2.0}};
            dictionary_at(&c, entry);
            const double v = (where >> g & 1U) ? entry[ENTRY_ANGLE + 2 * 4 + 1] : 0.0; /* sin(5 theta_e) */
            terms_add(&group[g], entry, (vec_dq){noise[0], v + noise[1]});
            terms_add(&group[GROUPS], entry, (vec_dq){noise[0], v + noise[1]});
        }
    }
    const terms_chosen t = terms_choose(group, GROUPS, &group[GROUPS]);
    free(group);
    return t;
}

static void what_one_operating_point_shows_is_no_law(void)
{
    terms_chosen t = order_at(7);
    TEST_ASSERT_EQUAL_size_t(0, t.count[0]);
    TEST_ASSERT_EQUAL_size_t(1, t.count[1]);
    TEST_ASSERT_EQUAL_size_t(ENTRY_ANGLE + 9, t.entry[1][0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.0, t.value[1][0]);
    TEST_ASSERT_EQUAL_size_t(1, t.strongest_axis);
    TEST_ASSERT_EQUAL_size_t(ENTRY_ANGLE + 9, t.strongest_entry);
    for (unsigned g = 0; g < 3; g++) {
        t = order_at(1U << g);
        TEST_ASSERT_EQUAL_size_t(0, t.count[0] + t.count[1]);
    }
}

/* Each entry has a name, a unit and an axis of its own, and an order's value is its mean over the cycle. */
static void the_dictionary_says_what_it_computes(void)
{
    const learn_cycle c = {.middle = rotor_at(0.7),
                           .mechanical = rotor_at(0.2),
                           .mech_known = true,
                           .half_turn_rad = 0.15,
                           .omega_rad_s = -3.0,
                           .i_A = {2.0, -5.0},
                           .u_V = {7.0, 11.0},
                           .u_before_V = {13.0, 17.0},
                           .elapsed_s = 19.0,
                           .temperature_K = 23.0};
    double entry[ENTRIES];
    dictionary_at(&c, entry);
    TEST_ASSERT_EQUAL_DOUBLE(-10.0, entry[ENTRY_I_D_I_Q]);
    TEST_ASSERT_EQUAL_DOUBLE(-75.0, entry[ENTRY_OMEGA_I_Q_I_Q]);
    TEST_ASSERT_EQUAL_DOUBLE(-3.0, entry[ENTRY_OMEGA]);
    TEST_ASSERT_EQUAL_DOUBLE(17.0, entry[ENTRY_U_Q_BEFORE]);
    TEST_ASSERT_EQUAL_DOUBLE(19.0, entry[ENTRY_TIME]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sin(0.4), entry[ENTRY_MECHANICAL + 3]);
    for (int n = 1; n <= DICTIONARY_ORDERS; n++) {
        double mean = 0.0;
        for (int k = 0; k < 1000; k++) {
            mean += cos(n * (0.7 + 0.15 * ((2.0 * k + 1.0) / 1000.0 - 1.0))) / 1000.0;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, mean, entry[ENTRY_ANGLE + 2 * (n - 1)]);
        TEST_ASSERT_EQUAL_DOUBLE(-3.0 * entry[ENTRY_ANGLE + 2 * n - 1], entry[ENTRY_SPEED_ANGLE + 2 * n - 1]);
    }
    /* Phases B and C flow out, A in, or the like: the vector of the signs is 4/3 long unless a phase is at zero. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4.0 / 3.0, hypot(entry[ENTRY_SIGN_D], entry[ENTRY_SIGN_Q]));
    TEST_ASSERT_TRUE(entry[ENTRY_SIGN_D] * 2.0 + entry[ENTRY_SIGN_Q] * -5.0 > 0.0);
    char name[ENTRIES][40];
    for (size_t i = 0; i < ENTRIES; i++) {
        dictionary_name(i, name[i], sizeof name[i]);
        TEST_ASSERT_TRUE(dictionary_unit(i)[0] != '\0' && dictionary_axis(i)[0] != '\0');
        for (size_t j = 0; j < i; j++) {
            TEST_ASSERT_TRUE(strcmp(name[i], name[j]) != 0);
        }
    }
    TEST_ASSERT_EQUAL_STRING("sin(2 theta_mech)", name[ENTRY_MECHANICAL + 3]);
    TEST_ASSERT_EQUAL_STRING("cos(12 theta_e)", name[ENTRY_SPEED_ANGLE - 2]);
    TEST_ASSERT_EQUAL_STRING("omega sin(12 theta_e)", name[ENTRIES - 1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_dictionary_says_what_it_computes);
    RUN_TEST(what_one_operating_point_shows_is_no_law);
    RUN_TEST(noise_is_not_learned);
    RUN_TEST(values_have_their_signs_and_units);
    RUN_TEST(a_ninth_order_is_learned);
    RUN_TEST(a_product_of_the_currents_is_learned);
    RUN_TEST(a_ripple_is_no_order_of_the_angle);
    return UNITY_END();
}
