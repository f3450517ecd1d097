/* Checks of a drive's methods: which can be combined, and that a set without their data is refused. */
#include "iqfoc/cycle_steps.h"

#include "cycle_fixture.h"

#include <stddef.h>
#include <string.h>

static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V);
static const iqfoc_salient_machine_t machine =
    IQFOC_SALIENT_MACHINE(R_OHM, L_H, 1.3 * L_H, PSI_WB, T_S, I_B_A, U_DC_V);
static const iqfoc_extension_t extension = {
    .i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE}, .k_u = IQ24_ONE, .knee_inverse = IQ24(127.0)};
static const iqfoc_flux_predictor_t flux = {.l_d = IQ24(0.5),
                                            .l_q = IQ24(0.5),
                                            .k_d = IQ24(2.0),
                                            .k_q = IQ24(2.0),
                                            .r = IQ24(0.015),
                                            .psi = IQ24(0.9)};
static const iqfoc_flux_map_t flux_map = {.l_d = IQ24(0.5),
                                          .l_q = IQ24(0.3),
                                          .r = IQ24(0.015),
                                          .psi = IQ24(0.9),
                                          .part = {{IQ24(0.2), IQ24_ONE, IQ24_ONE, 0}}};
static iqfoc_exact_law_t law;
static iqfoc_salient_t salient;
static iqfoc_salient_t salient_mean;

/* The fixture's set with all that any method needs. */
static iqfoc_cycle_config_t whole_set(void)
{
    iqfoc_cycle_config_t set = base_config;
    law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    iqfoc_salient_at_speed(&machine, IQ24(0.05), IQ24_ONE, &salient, &salient_mean);
    set.data.exact = &law;
    set.data.exact_mean = &law;
    set.data.salient = &salient;
    set.data.salient_mean = &salient_mean;
    set.data.flux = &flux;
    set.data.flux_map = &flux_map;
    set.data.acting = &extension;
    set.data.extension = &extension;
    set.data.k_u_inverse = iqfoc_deadbeat_inverse(law.k_u_q26);
    set.data.k_psi = set.predictor.k_psi;
    set.data.learning = IQ24(0.1);
    return set;
}

/*
 * Written out by hand from methods.h: by PI, without saliency 4 feedbacks and the exact model's own mean, salient 3,
 * by flux and by flux map 2; deadbeat and deadbeat with disturbance observer only without saliency.
 */
static void test_which_go_together(void)
{
    static const int wanted[6] = {4, 5, 3, 2, 4, 2};
    const iqfoc_cycle_config_t set = whole_set();
    for (int model = 0; model < 7; model++) {
        int of_control[4] = {0};
        for (int choice = 0; choice < 6 * 4 * 4; choice++) {
            const iqfoc_methods_t m = {(iqfoc_model_t)model, (iqfoc_feedback_t)(choice % 6),
                                       (iqfoc_control_t)(choice / 6 % 4),
                                       (iqfoc_modulation_t)(choice / 24 % 4), false};
            const iqfoc_error_t said = iqfoc_cycle_check(m, &set);
            TEST_ASSERT_TRUE(said == IQFOC_OK || said == IQFOC_ERROR_METHODS);
            TEST_ASSERT_TRUE(said != IQFOC_OK || m.modulation <= IQFOC_MODULATION_OVER);
            of_control[choice / 6 % 4] += said == IQFOC_OK ? 1 : 0;
        }
        const int modulations = 3;
        const bool plain = model == 0 || model == 1 || model == 4;
        TEST_ASSERT_EQUAL_INT(model < 6 ? modulations * wanted[model] : 0, of_control[IQFOC_CONTROL_PI]);
        TEST_ASSERT_EQUAL_INT(plain ? modulations * wanted[model] : 0, of_control[IQFOC_CONTROL_DEADBEAT]);
        TEST_ASSERT_EQUAL_INT(plain ? modulations * wanted[model] : 0,
                              of_control[IQFOC_CONTROL_DEADBEAT_LEARNING]);
        TEST_ASSERT_EQUAL_INT(0, of_control[3]);
    }
}

static const iqfoc_methods_t plain_pi = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                                         IQFOC_CONTROL_PI, IQFOC_MODULATION_PWM, false};
static const iqfoc_methods_t exact_mean = {IQFOC_MODEL_EXACT, IQFOC_FEEDBACK_EXACT_MEAN, IQFOC_CONTROL_PI,
                                           IQFOC_MODULATION_PWM, false};
static const iqfoc_methods_t exact_sample = {IQFOC_MODEL_EXACT, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_PI,
                                             IQFOC_MODULATION_PWM, false};
static const iqfoc_methods_t of_salient = {IQFOC_MODEL_SALIENT, IQFOC_FEEDBACK_EXACT_MEAN, IQFOC_CONTROL_PI,
                                           IQFOC_MODULATION_PWM, false};
static const iqfoc_methods_t by_flux = {IQFOC_MODEL_FLUX, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_PI,
                                        IQFOC_MODULATION_OVER, false};
static const iqfoc_methods_t by_flux_map = {IQFOC_MODEL_FLUX_MAP, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_PI,
                                            IQFOC_MODULATION_PWM, false};
static const iqfoc_methods_t diagnosed = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_MIDPOINT,
                                          IQFOC_CONTROL_PI, IQFOC_MODULATION_PWM, true};
static const iqfoc_methods_t deadbeat = {IQFOC_MODEL_EULER, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_DEADBEAT,
                                         IQFOC_MODULATION_PWM, false};
static const iqfoc_methods_t learning = {IQFOC_MODEL_EULER, IQFOC_FEEDBACK_MIDPOINT,
                                         IQFOC_CONTROL_DEADBEAT_LEARNING, IQFOC_MODULATION_PWM, false};

/* The whole set but for one field: refused both at the start, with the object untouched, and when offered. */
#define LACKS(want, methods, field, value)                                                                   \
    do {                                                                                                     \
        iqfoc_cycle_config_t bad = whole_set();                                                              \
        iqfoc_cycle_t object;                                                                                \
        iqfoc_cycle_t before;                                                                                \
        bad.data.field = value;                                                                              \
        memset(&object, 0x5A, sizeof object);                                                                \
        before = object;                                                                                     \
        TEST_ASSERT_EQUAL_INT(want, iqfoc_cycle_init_by(methods, &object, &bad));                            \
        TEST_ASSERT_EQUAL_MEMORY(&before, &object, sizeof object);                                           \
        TEST_ASSERT_EQUAL_INT(want, iqfoc_cycle_offer_by(methods, &object, &bad));                           \
        TEST_ASSERT_EQUAL_MEMORY(&before, &object, sizeof object);                                           \
    } while (0)

static void test_what_is_missing(void)
{
    iqfoc_extension_t unfit = extension;
    iqfoc_flux_predictor_t unfit_flux = flux;
    unfit.k_u = 0;
    unfit_flux.r = -1;
    iqfoc_flux_map_t unfit_map = flux_map;
    unfit_map.part[1].e = -1;
    LACKS(IQFOC_ERROR_NULL, exact_mean, exact, NULL);
    LACKS(IQFOC_ERROR_NULL, exact_mean, exact_mean, NULL);
    LACKS(IQFOC_ERROR_NULL, of_salient, salient, NULL);
    LACKS(IQFOC_ERROR_NULL, of_salient, salient_mean, NULL);
    LACKS(IQFOC_ERROR_NULL, by_flux, flux, NULL);
    LACKS(IQFOC_ERROR_NULL, by_flux, acting, NULL);
    LACKS(IQFOC_ERROR_RESISTANCE, by_flux, flux, &unfit_flux);
    LACKS(IQFOC_ERROR_NULL, by_flux_map, flux_map, NULL);
    LACKS(IQFOC_ERROR_NULL, by_flux_map, acting, NULL);
    LACKS(IQFOC_ERROR_FLUX_PART, by_flux_map, flux_map, &unfit_map);
    LACKS(IQFOC_ERROR_NULL, diagnosed, extension, NULL);
    LACKS(IQFOC_ERROR_VOLTAGE, diagnosed, extension, &unfit);
    LACKS(IQFOC_ERROR_METHODS, deadbeat, k_u_inverse, IQ24(0.0625) - 1);
    LACKS(IQFOC_ERROR_METHODS, deadbeat, k_u_inverse, IQ24(64.0) + 1);
    LACKS(IQFOC_ERROR_METHODS, deadbeat, k_psi, -1);
    LACKS(IQFOC_ERROR_METHODS, deadbeat, k_psi, IQ24(8.0) + 1);
    LACKS(IQFOC_ERROR_METHODS, learning, learning, -1);
    LACKS(IQFOC_ERROR_METHODS, learning, learning, IQ24_ONE + 1);
}

/* A method is not asked for what it does not need. */
static void test_what_is_not_needed(void)
{
    iqfoc_cycle_config_t set = base_config;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init_by(plain_pi, &cycle, &set));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_offer_by(plain_pi, &cycle, &set));
    law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    set.data.exact = &law;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init_by(exact_sample, &cycle, &set));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_init_by(plain_pi, &cycle, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_offer_by(plain_pi, &cycle, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_init_by(plain_pi, NULL, &set));
    set.span_max = 0; /* what every drive needs is seen to as well */
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SPAN, iqfoc_cycle_init_by(exact_sample, &cycle, &set));
}

/* One way to say a method: the configuration's own fields are 0 or agree. */
static void test_methods_are_named_once(void)
{
    static const iqfoc_methods_t up_to_six_step = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_MODULATED_MEAN,
                                                   IQFOC_CONTROL_PI, IQFOC_MODULATION_OVER, false};
    for (int feedback = IQFOC_FEEDBACK_MIDPOINT; feedback <= IQFOC_FEEDBACK_MODULATED_MEAN; feedback++) {
        for (int modulation = IQFOC_MODULATION_PWM; modulation <= IQFOC_MODULATION_OVER; modulation++) {
            iqfoc_cycle_config_t set = base_config;
            set.feedback = (iqfoc_feedback_t)feedback;
            set.modulation = (iqfoc_modulation_t)modulation;
            const bool agree =
                (feedback == IQFOC_FEEDBACK_MIDPOINT || feedback == IQFOC_FEEDBACK_MODULATED_MEAN) &&
                (modulation == IQFOC_MODULATION_PWM || modulation == IQFOC_MODULATION_OVER);
            const iqfoc_error_t want = agree ? IQFOC_OK : IQFOC_ERROR_CHOICE;
            TEST_ASSERT_EQUAL_INT(want, iqfoc_cycle_init_by(up_to_six_step, &cycle, &set));
            TEST_ASSERT_EQUAL_INT(want, iqfoc_cycle_offer_by(up_to_six_step, &cycle, &set));
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_which_go_together);
    RUN_TEST(test_what_is_missing);
    RUN_TEST(test_what_is_not_needed);
    RUN_TEST(test_methods_are_named_once);
    return UNITY_END();
}
