/*
 * The coefficients of the exact predictors, of salient machines and of induction machines, to the last bit: one hash
 * for each over all results. test_predictor_exact.c, test_predictor_salient.c and test_induction.c check in double
 * precision that the coefficients describe the machines.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/induction.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"

#define DRAWS 20000

static const int64_t one_q30 = INT64_C(1) << 30;

void setUp(void)
{
}

void tearDown(void)
{
}

/* A speed within the range, one held to it, a low one. */
static iq24_t any_speed(uint64_t *seed, int n)
{
    const int64_t most = n % 8 == 0 ? IQ24_ONE : n % 3 == 0 ? IQ24_ONE / 100 : IQFOC_ROTOR_SPEED_MAX;
    return bits_random(seed, -most, most);
}

static iq24_t any_span(uint64_t *seed, int n)
{
    return n % 4 == 0 ? IQ24_ONE : bits_random(seed, 1, IQ24_ONE);
}

static void test_laws_of_the_round_machine(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_exact_winding_t w;
        w.rho_q30 = bits_random(&seed, 0, n % 2 == 0 ? one_q30 : one_q30 / 32);
        w.k_u_q26 = bits_random(&seed, 1, one_q30);
        w.k_psi_q27 = bits_random(&seed, 0, one_q30);
        const iq24_t span = any_span(&seed, n);
        const iqfoc_exact_law_t end = iqfoc_exact_prediction(&w, span);
        const iqfoc_exact_law_t mean = iqfoc_exact_mean(&w, span);
        const iqfoc_exact_t at = iqfoc_exact_at_speed(&end, any_speed(&seed, n));
        bits_add(&digest, &end, sizeof end);
        bits_add(&digest, &mean, sizeof mean);
        bits_add(&digest, &at, sizeof at);
    }
    bits_golden(UINT64_C(0x3b433c925a4f143e), digest);
}

static void test_rows_of_the_salient_machine(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const int64_t rho = n % 2 == 0 ? one_q30 : one_q30 / 32;
        const double ratio = exp(uniform(&seed, -2.0, 2.0));
        iqfoc_salient_machine_t m;
        m.rho_d_q30 = bits_random(&seed, 0, rho);
        m.rho_q_q30 = bits_random(&seed, 0, rho);
        m.k_d_q26 = bits_random(&seed, 1, one_q30);
        m.k_q_q26 = bits_random(&seed, 1, one_q30);
        m.k_psi_d_q27 = bits_random(&seed, 0, one_q30);
        m.k_psi_q_q27 = bits_random(&seed, 0, one_q30);
        m.q_to_d_q27 = (int32_t)lround(ldexp(ratio, 27));
        m.d_to_q_q27 = (int32_t)lround(ldexp(1.0 / ratio, 27));
        const iq24_t speed = any_speed(&seed, n);
        const iq24_t span = any_span(&seed, n);
        iqfoc_salient_t end;
        iqfoc_salient_t mean;
        iqfoc_salient_at_speed(&m, speed, span, &end, &mean);
        bits_add(&digest, &end, sizeof end);
        bits_add(&digest, &mean, sizeof mean);
        iqfoc_salient_t alone;
        iqfoc_salient_at_speed(&m, speed, span, &alone, NULL);
        TEST_ASSERT_EQUAL_MEMORY(&end, &alone, sizeof end);
        iqfoc_salient_at_speed(&m, speed, span, NULL, &alone);
        TEST_ASSERT_EQUAL_MEMORY(&mean, &alone, sizeof mean);
    }
    bits_golden(UINT64_C(0x75cc1ce0614b4811), digest);
}

static void test_rows_of_the_induction_machine(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const int64_t part = n % 2 == 0 ? 2 : 40;
        iqfoc_induction_machine_t machine;
        machine.rho_s_q30 = bits_random(&seed, 0, one_q30 / part);
        machine.rho_r_q30 = bits_random(&seed, 0, one_q30 / part);
        machine.a_q30 = bits_random(&seed, 0, one_q30 / 10);
        machine.k_u_q26 = bits_random(&seed, 1, one_q30);
        const iq24_t speed = any_speed(&seed, n);
        const iq24_t span = any_span(&seed, n);
        const iqfoc_induction_t got = iqfoc_induction_at_speed(&machine, speed, span);
        bits_add(&digest, &got, sizeof got);
    }
    bits_golden(UINT64_C(0x08351b68deef38bd), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_laws_of_the_round_machine);
    RUN_TEST(test_rows_of_the_salient_machine);
    RUN_TEST(test_rows_of_the_induction_machine);
    return UNITY_END();
}
