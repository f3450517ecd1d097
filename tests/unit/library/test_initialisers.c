/*
 * The initialiser macros give their values in the order of the struct's members, without naming them, so that C++17
 * takes them too. Each value here differs from all others of its struct: two members exchanged would fail. And the
 * version: header, CMake and package say the same.
 */
#include "iqfoc/iqfoc.h"

#include "unity.h"

#include <stdio.h>

#define R     0.9
#define L_D   8e-3
#define L_Q   11e-3
#define PSI   0.2
#define T     2.5e-4
#define I     IQFOC_I_BASE(6.0)
#define U     565.0
#define W     900.0
#define R_R   0.5
#define L_SIG 9e-3
#define L_M   0.12

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_predictor(void)
{
    static const iqfoc_predictor_t positional = IQFOC_PREDICTOR(R, L_D, PSI, T, I, U);
    static const iqfoc_predictor_t named = {
        .k_u = IQFOC_K_U(L_D, T, I, U), .k_r = IQFOC_K_R(R, L_D, T), .k_psi = IQFOC_K_PSI(PSI, L_D, I)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_gains(void)
{
    static const iqfoc_current_control_gains_t positional = IQFOC_GAINS(W, R, L_D, L_Q, PSI, T, I, U);
    static const iqfoc_current_control_gains_t named = {.kp_d = IQFOC_KP(W, L_D, I, U),
                                                        .kp_q = IQFOC_KP(W, L_Q, I, U),
                                                        .ki_d = IQFOC_KI(W, R, T, I, U),
                                                        .ki_q = IQFOC_KI(W, R, T, I, U),
                                                        .anti_windup = IQFOC_ANTI_WINDUP(W, T),
                                                        .x_d = IQFOC_X(L_D, T, I, U),
                                                        .x_q = IQFOC_X(L_Q, T, I, U),
                                                        .emf = IQFOC_EMF(PSI, T, U)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_flux_predictor(void)
{
    static const iqfoc_flux_predictor_t positional = IQFOC_FLUX_PREDICTOR(R, L_D, L_Q, PSI, T, I, U);
    static const iqfoc_flux_predictor_t named = {.l_d = IQFOC_FLUX_L(L_D, T, I, U),
                                                 .l_q = IQFOC_FLUX_L(L_Q, T, I, U),
                                                 .k_d = IQFOC_FLUX_K(L_D, T, I, U),
                                                 .k_q = IQFOC_FLUX_K(L_Q, T, I, U),
                                                 .r = IQFOC_FLUX_R(R, I, U),
                                                 .psi = IQFOC_FLUX_PSI(PSI, T, U),
                                                 .skew = IQFOC_FLUX_SKEW(L_D, L_Q)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_flux_map(void)
{
    static const iqfoc_flux_map_t positional =
        IQFOC_FLUX_MAP(R, L_D, L_Q, PSI, IQFOC_FLUX_MAP_PART(0.5, 20.0, 12.0, -5.0, T, I, U),
                       IQFOC_FLUX_MAP_NO_PART, T, I, U);
    static const iqfoc_flux_map_t named = {.l_d = IQFOC_MAP_L(L_D, T, I, U),
                                           .l_q = IQFOC_MAP_L(L_Q, T, I, U),
                                           .r = IQFOC_FLUX_R(R, I, U),
                                           .psi = IQFOC_MAP_PSI(PSI, T, U),
                                           .part = {{.e = IQFOC_MAP_E(0.5, T, I, U),
                                                     .k_d = IQFOC_MAP_K(20.0, I),
                                                     .k_q = IQFOC_MAP_K(12.0, I),
                                                     .x_0 = IQFOC_MAP_X(-5.0, 20.0)}}};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_extension(void)
{
    static const iqfoc_extension_t positional = IQFOC_EXTENSION_NONE;
    static const iqfoc_extension_t named = {
        .i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE}, .k_u = IQ24_ONE, .knee_inverse = IQ24(127.0)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

#define Q(x, bits) IQFOC_EXACT_Q(x, bits)

static void test_exact(void)
{
    static const iqfoc_exact_winding_t positional = IQFOC_EXACT_WINDING(R, L_D, PSI, T, I, U);
    static const iqfoc_exact_winding_t named = {.rho_q30 = Q(IQFOC_RAW_K_R(R, L_D, T), 30),
                                                .k_u_q26 = Q(IQFOC_RAW_K_U(L_D, T, I, U), 26),
                                                .k_psi_q27 = Q(IQFOC_RAW_K_PSI(PSI, L_D, I), 27)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_salient(void)
{
    static const iqfoc_salient_machine_t positional = IQFOC_SALIENT_MACHINE(R, L_D, L_Q, PSI, T, I, U);
    static const iqfoc_salient_machine_t named = {.rho_d_q30 = Q(IQFOC_RAW_K_R(R, L_D, T), 30),
                                                  .rho_q_q30 = Q(IQFOC_RAW_K_R(R, L_Q, T), 30),
                                                  .k_d_q26 = Q(IQFOC_RAW_K_U(L_D, T, I, U), 26),
                                                  .k_q_q26 = Q(IQFOC_RAW_K_U(L_Q, T, I, U), 26),
                                                  .k_psi_d_q27 = Q(IQFOC_RAW_K_PSI(PSI, L_D, I), 27),
                                                  .k_psi_q_q27 = Q(IQFOC_RAW_K_PSI(PSI, L_Q, I), 27),
                                                  .q_to_d_q27 = Q(L_Q / L_D, 27),
                                                  .d_to_q_q27 = Q(L_D / L_Q, 27)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_induction(void)
{
    static const iqfoc_induction_machine_t positional = IQFOC_INDUCTION_MACHINE(R, R_R, L_SIG, L_M, T, I, U);
    static const iqfoc_induction_machine_t named = {.rho_s_q30 = Q(IQFOC_RAW_K_R(R, L_SIG, T), 30),
                                                    .rho_r_q30 = Q(IQFOC_RAW_K_R(R_R, L_SIG, T), 30),
                                                    .a_q30 = Q(IQFOC_RAW_K_R(R_R, L_M, T), 30),
                                                    .k_u_q26 = Q(IQFOC_RAW_K_U(L_SIG, T, I, U), 26)};
    TEST_ASSERT_EQUAL_MEMORY(&named, &positional, sizeof named);
}

static void test_recorder_channel(void)
{
    static const iq24_t variable = 0;
    const iqfoc_recorder_channel_t c = IQFOC_RECORDER_IQ24(&variable, IQFOC_RECORDER_U_DC, 565.0, 21);
    TEST_ASSERT_EQUAL_PTR(&variable, c.source);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_RECORDER_U_DC, c.column);
    TEST_ASSERT_EQUAL_INT32(565 * 2097152, c.mantissa);
    TEST_ASSERT_EQUAL_UINT32(45, c.shift);
}

static void test_version(void)
{
    char text[40];
    snprintf(text, sizeof text, "%d.%d.%d", IQFOC_VERSION_MAJOR, IQFOC_VERSION_MINOR, IQFOC_VERSION_PATCH);
    TEST_ASSERT_EQUAL_STRING(text, IQFOC_VERSION_STRING);
    TEST_ASSERT_EQUAL_STRING(IQFOC_PROJECT_VERSION, IQFOC_VERSION_STRING);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_predictor);
    RUN_TEST(test_gains);
    RUN_TEST(test_flux_predictor);
    RUN_TEST(test_flux_map);
    RUN_TEST(test_extension);
    RUN_TEST(test_exact);
    RUN_TEST(test_salient);
    RUN_TEST(test_induction);
    RUN_TEST(test_recorder_channel);
    RUN_TEST(test_version);
    return UNITY_END();
}
