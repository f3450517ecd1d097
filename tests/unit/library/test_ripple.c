/*
 * The ripple's coefficients and its part over half a period, to the bit that ripple.h states; mean_modulated.h's
 * coefficients likewise. That the formulas themselves are right: test_mean_modulated.c, test_half_period.c.
 */
#include "bits.h"

#include "iqfoc/mean_modulated.h"
#include "iqfoc/ripple.h"

#define DRAWS (200000 / IQFOC_TEST_STRIDE)
#define SEED  UINT64_C(20260901)

void setUp(void)
{
}

void tearDown(void)
{
}

/* Any within the ranges, every other one of a size that a motor has. */
static iqfoc_salient_machine_t any_machine(uint64_t *seed, int n)
{
    const int64_t k = n % 2 == 0 ? INT64_C(1) << 30 : INT64_C(1) << 27;
    const int64_t rho = n % 2 == 0 ? INT64_C(1) << 30 : INT64_C(1) << 25;
    const iqfoc_salient_machine_t machine = {.rho_d_q30 = bits_random(seed, 0, rho),
                                             .rho_q_q30 = bits_random(seed, 0, rho),
                                             .k_d_q26 = bits_random(seed, 1, k),
                                             .k_q_q26 = bits_random(seed, 1, k)};
    return machine;
}

static iqfoc_rotor_t any_rotor(uint64_t *seed)
{
    return iqfoc_rotor_from_speed(bits_random(seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
}

/* k x/by: the product to nearest, the quotient towards 0. */
static int64_t part(int32_t k_q26, int64_t x, int by)
{
    return bits_product_of(k_q26, x, 26) / by;
}

static void test_coefficients(void)
{
    uint64_t seed = SEED;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_salient_machine_t m = any_machine(&seed, n);
        const iqfoc_rotor_t rotor = any_rotor(&seed);
        const iqfoc_ripple_t got = iqfoc_ripple_at_speed(&m, &rotor);
        TEST_ASSERT_EQUAL_INT64(bits_product(rotor.phi, rotor.phi) / 80, got.square);
        TEST_ASSERT_EQUAL_INT64(part(m.k_d_q26, bits_nearest(m.rho_d_q30, 6), 24), got.along_d);
        TEST_ASSERT_EQUAL_INT64(part(m.k_d_q26, rotor.phi, 24), got.across_d);
        TEST_ASSERT_EQUAL_INT64(part(m.k_q_q26, bits_nearest(m.rho_q_q30, 6), 24), got.along_q);
        TEST_ASSERT_EQUAL_INT64(part(m.k_q_q26, rotor.phi, 24), got.across_q);
    }
}

/* k (1 - rho/2)/2: rho/2 to nearest, the product to nearest, its half down. */
static int64_t even_part(int32_t k_q26, int32_t rho_q30)
{
    return bits_floor(bits_product_of(k_q26, IQ24_ONE - bits_nearest(rho_q30, 7), 26), 2);
}

static void test_coefficients_of_a_half(void)
{
    uint64_t seed = SEED + 1;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_salient_machine_t m = any_machine(&seed, n);
        const iqfoc_rotor_t rotor = any_rotor(&seed);
        const iqfoc_ripple_half_t got = iqfoc_ripple_half_at_speed(&m, &rotor);
        TEST_ASSERT_EQUAL_INT64(bits_product(rotor.phi, rotor.phi) / 24, got.square);
        TEST_ASSERT_EQUAL_INT64(even_part(m.k_d_q26, m.rho_d_q30), got.even_d);
        TEST_ASSERT_EQUAL_INT64(-part(m.k_d_q26, bits_nearest(m.rho_d_q30, 6), 12), got.along_d);
        TEST_ASSERT_EQUAL_INT64(part(m.k_d_q26, rotor.phi, 12), got.across_d);
        TEST_ASSERT_EQUAL_INT64(even_part(m.k_q_q26, m.rho_q_q30), got.even_q);
        TEST_ASSERT_EQUAL_INT64(-part(m.k_q_q26, bits_nearest(m.rho_q_q30, 6), 12), got.along_q);
        TEST_ASSERT_EQUAL_INT64(part(m.k_q_q26, rotor.phi, 12), got.across_q);
    }
}

/* One leg's b (1 - square (1 - 2 b)) and b (1 - 2 d), b = d (1 - d). */
static void leg(iq24_t d, iq24_t square, iq24_t *even, iq24_t *odd)
{
    const int64_t b = bits_product(d, IQ24_ONE - d);
    *odd = (iq24_t)bits_product(b, IQ24_ONE - 2 * (int64_t)d);
    *even = (iq24_t)(b - bits_product(b, bits_product(square, IQ24_ONE - 2 * b)));
}

static void test_part_over_a_half(void)
{
    uint64_t seed = SEED + 2;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_salient_machine_t m = any_machine(&seed, n);
        const iqfoc_rotor_t rotor = any_rotor(&seed);
        const iqfoc_ripple_half_t c = iqfoc_ripple_half_at_speed(&m, &rotor);
        const iqfoc_abc_t high = {bits_random(&seed, 0, IQ24_ONE), bits_random(&seed, 0, IQ24_ONE),
                                  bits_random(&seed, 0, IQ24_ONE)};
        const iq24_t u_dc = bits_random(&seed, 0, 2 * IQ24_ONE);
        const iq24_sincos_t sc = iq24_sincos(bits_random(&seed, 0, IQ24_ONE));
        const bool to_peak = n % 2 == 1;
        iqfoc_abc_t even;
        iqfoc_abc_t odd;
        leg(high.a, c.square, &even.a, &odd.a);
        leg(high.b, c.square, &even.b, &odd.b);
        leg(high.c, c.square, &even.c, &odd.c);
        const iqfoc_dq_t v = iqfoc_park(iqfoc_clarke3(even), sc);
        const iqfoc_dq_t w = iqfoc_park(iqfoc_clarke3(odd), sc);
        const int64_t u = to_peak ? -(int64_t)u_dc : u_dc;
        const int64_t d = c.even_d * bits_product(v.d, u) + c.along_d * bits_product(w.d, u_dc) -
                          c.across_d * bits_product(w.q, u_dc);
        const int64_t q = c.even_q * bits_product(v.q, u) + c.along_q * bits_product(w.q, u_dc) +
                          c.across_q * bits_product(w.d, u_dc);
        const iqfoc_dq_t got = iqfoc_ripple_half_seen(&c, high, u_dc, to_peak, sc);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(d, 24), got.d);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(q, 24), got.q);
    }
}

/* s2/phi by its series in h2 = (phi/2)^2, each product to nearest. */
static int64_t bow_of(int64_t h2)
{
    const int64_t last = to_iq24(1.0 / 3360.0) - bits_product(to_iq24(1.0 / 181440.0), h2);
    return to_iq24(1.0 / 12.0) - bits_product(to_iq24(1.0 / 120.0) - bits_product(last, h2), h2);
}

static void test_coefficients_of_the_modulated_mean(void)
{
    uint64_t seed = SEED + 3;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_predictor_t p = {bits_random(&seed, 1, IQ24(16.0)), bits_random(&seed, 0, IQ24_ONE),
                                     bits_random(&seed, 0, IQ24(8.0))};
        const iqfoc_rotor_t rotor = any_rotor(&seed);
        const iqfoc_mean_modulated_t got = iqfoc_mean_modulated_at_speed(&p, &rotor);
        const int64_t phi2 = bits_product(rotor.phi, rotor.phi);
        const int64_t lost = bits_product(IQ24_ONE - rotor.s1, IQ24_ONE + rotor.s1);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(rotor.s1, 1), got.half_s1);
        TEST_ASSERT_EQUAL_INT32(rotor.s2, got.s2);
        TEST_ASSERT_EQUAL_INT64(bits_product(p.k_r, bow_of(bits_floor(phi2, 4))), got.bow);
        TEST_ASSERT_EQUAL_INT64(bits_product(p.k_psi, lost), got.emf);
        TEST_ASSERT_EQUAL_INT64(phi2 / 80, got.square);
        TEST_ASSERT_EQUAL_INT64(bits_product(p.k_u, p.k_r) / 24, got.along);
        TEST_ASSERT_EQUAL_INT64(bits_product(p.k_u, rotor.phi) / 24, got.across);
        /* The series is s2/phi. */
        const double h = to_double(rotor.phi) / 2.0;
        const double want = h == 0.0 ? 1.0 / 12.0 : (sin(h) - h * cos(h)) / (4.0 * h * h * h);
        TEST_ASSERT_DOUBLE_WITHIN(fabs(h) > 0.02 ? 3e-7 : 1e-5, want, to_double((iq24_t)bow_of(phi2 / 4)));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_coefficients);
    RUN_TEST(test_coefficients_of_a_half);
    RUN_TEST(test_part_over_a_half);
    RUN_TEST(test_coefficients_of_the_modulated_mean);
    return UNITY_END();
}
