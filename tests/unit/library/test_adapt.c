/*
 * Adaptation of resistance and magnet flux (include/iqfoc/adapt.h): each sentence of the header, with computed
 * errors, and a drive in the plant that warms.
 */
#include "tune/adapt_trial.h"

#include "iqfoc/adapt.h"

#include "reference_vectors.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* The compressor of data/motors/ at 8 kHz. */
#define R_OHM 0.9
#define L_D_H 0.008
#define L_Q_H 0.011
#define PSI   0.2
#define T_S   1.25e-4
#define I_B   (6.0 * 1.4142135623730951)
#define U_B   565.0
#define NOISE 0.003

static const iqfoc_watch_config_t watch_config =
    IQFOC_WATCH_CONFIG(R_OHM, L_D_H, L_Q_H, PSI, 3, T_S, I_B, U_B, NOISE);
static const iqfoc_adapt_config_t usual = IQFOC_ADAPT_CONFIG;

/* A drive whose R and psi_f are off by these shares, and a model that has `adapt` of them. */
typedef struct numbers {
    uint64_t seed;
    double r, psi, theta, x;
    iqfoc_watch_t watch;
    iqfoc_adapt_t adapt;
} numbers;

static void begin(numbers *n, uint64_t seed, double r, double psi)
{
    const numbers fresh = {.seed = seed, .r = r, .psi = psi};
    *n = fresh;
    iqfoc_watch_reset(&n->watch);
    n->watch.blocks = 1; /* the first is not learnt from */
}

/* A block at speed x, with noise or without; the watch's own block stands for the reset of its sums. */
static void block(numbers *n, const iqfoc_adapt_config_t *config, double complex i, double x, double noise)
{
    const double L = 0.5 * (L_D_H + L_Q_H);
    const double phi = TWO_PI * x;
    const double r = n->r - ldexp(n->adapt.r, -24);
    const double psi = n->psi - ldexp(n->adapt.psi, -24);
    const double complex in_flux = -r * R_OHM * T_S / L * i - psi * I * phi * PSI / (L * I_B);
    const double complex e_mid = creal(in_flux) * L / L_D_H + I * cimag(in_flux) * L / L_Q_H;
    const uint32_t blocks = n->watch.blocks;
    const iqfoc_dq_t i_dq = {to_iq24(creal(i)), to_iq24(cimag(i))};
    const iqfoc_dq_t no_voltage = {0, 0};
    iqfoc_watch_reset(&n->watch);
    n->watch.blocks = blocks + 1;
    n->watch.speed = to_iq24(x);
    for (int k = 0; k < IQFOC_WATCH_BLOCK_CYCLES; k++) {
        n->theta = fmod(n->theta + phi, TWO_PI);
        const double complex e = e_mid * cexp(I * (n->theta - 0.5 * phi)) +
                                 noise * (uniform(&n->seed, -1.0, 1.0) + I * uniform(&n->seed, -1.0, 1.0));
        const iqfoc_ab_t off = {to_iq24(creal(e)), to_iq24(cimag(e))};
        const iq24_t theta = to_iq24(n->theta / TWO_PI);
        (void)iqfoc_watch_step(&n->watch, off, i_dq, no_voltage, iq24_sincos(theta));
    }
    iqfoc_adapt_block(&n->adapt, config, &n->watch, &watch_config, to_iq24(x));
}

/* To the true values in the header's units. */
static double distance(const numbers *n)
{
    return hypot((n->r - ldexp(n->adapt.r, -24)) / IQFOC_ADAPT_R,
                 (n->psi - ldexp(n->adapt.psi, -24)) / IQFOC_ADAPT_PSI);
}

static double complex some_current(numbers *n)
{
    return uniform(&n->seed, 0.2, 1.0) * cexp(I * uniform(&n->seed, 0.0, TWO_PI));
}

/* Whatever the drive does, and up to the full step: in no block does the distance grow by more than the stated error. */
static void without_a_rest_the_distance_never_grows(void)
{
    static const double gain[] = {1.0 / 64.0, 0.1, 1.0};
    double most_grown = -1.0;
    for (int g = 0; g < 3; g++) {
        iqfoc_adapt_config_t config = usual;
        config.gain = to_iq24(gain[g]);
        numbers n;
        begin(&n, 5, 0.236, -0.05);
        for (int k = 0; k < 20000 / IQFOC_TEST_STRIDE; k++) {
            const double before = distance(&n);
            block(&n, &config, some_current(&n), uniform(&n.seed, -0.1, 0.1), 0.0);
            most_grown = fmax(most_grown, distance(&n) - before);
        }
        printf("  gain %.4f: distance %.5f after all\n", gain[g], distance(&n));
    }
    printf("  grew by %.2g units at most\n", most_grown);
    /* Found: 9.5e-6 at most, by seven seeds and the orders in which two compilers draw. */
    TEST_ASSERT_TRUE(most_grown < 1e-4 && most_grown > 1e-9);
}

/* The step is the header's projection, computed here in doubles from the drive's constants. */
static void each_step_is_the_projection(void)
{
    const double L = 0.5 * (L_D_H + L_Q_H);
    const double per = watch_config.per_noise_q8 / 256.0;
    iqfoc_adapt_config_t config = usual;
    config.gain = IQ24_ONE;
    config.r_low = IQ24(-0.5);
    config.r_high = IQ24_ONE;
    config.psi_low = IQ24(-0.25);
    config.psi_high = IQ24(0.25);
    double most_off = 0.0;
    numbers n;
    begin(&n, 9, 0.0, 0.0);
    for (int k = 0; k < 60000 / IQFOC_TEST_STRIDE; k++) {
        const iqfoc_adapt_t none = {0, 0};
        const double complex i = some_current(&n);
        const double x = uniform(&n.seed, -0.1, 0.1);
        n.adapt = none;
        n.r = uniform(&n.seed, -0.2, 0.5);
        n.psi = uniform(&n.seed, -0.1, 0.1);
        const double complex x_r = -IQFOC_ADAPT_R * R_OHM * T_S / L * per * i;
        const double complex x_psi = -I * IQFOC_ADAPT_PSI * TWO_PI * x * PSI / (L * I_B) * per;
        const double complex all = n.r / IQFOC_ADAPT_R * x_r + n.psi / IQFOC_ADAPT_PSI * x_psi;
        const double complex e =
            fmax(-128.0, fmin(creal(all), 128.0)) + I * fmax(-128.0, fmin(cimag(all), 128.0));
        const double most = creal(x_r * conj(x_r) + x_psi * conj(x_psi)) + 1.0 / 16.0;
        block(&n, &config, i, x, 0.0);
        const double r = fmax(-0.5, fmin(IQFOC_ADAPT_R * creal(conj(x_r) * e) / most, 1.0));
        const double psi = fmax(-0.25, fmin(IQFOC_ADAPT_PSI * creal(conj(x_psi) * e) / most, 0.25));
        const double r_off = (ldexp(n.adapt.r, -24) - r) / IQFOC_ADAPT_R;
        const double psi_off = (ldexp(n.adapt.psi, -24) - psi) / IQFOC_ADAPT_PSI;
        most_off = fmax(most_off, fmax(fabs(r_off), fabs(psi_off)));
    }
    printf("  off by %.2g units at most\n", most_off);
    /* Found: 2.2e-4 of 60,000 drawn by this seed. */
    TEST_ASSERT_TRUE(most_off < 5e-4);
}

/* With noise, and through all speeds, both are found. */
static void both_are_found_in_noise(void)
{
    numbers n;
    begin(&n, 6, 0.236, -0.05);
    for (int k = 0; k < 20000; k++) {
        block(&n, &usual, some_current(&n), uniform(&n.seed, -0.02, 0.02), NOISE);
    }
    printf("  R %+.4f, psi %+.5f\n", ldexp(n.adapt.r, -24), ldexp(n.adapt.psi, -24));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.236, ldexp(n.adapt.r, -24));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -0.05, ldexp(n.adapt.psi, -24));
}

static void it_stays_within_its_bounds(void)
{
    iqfoc_adapt_config_t config = usual;
    config.gain = IQ24_ONE;
    for (int k = 0; k < 4; k++) {
        numbers n;
        const double sign = (k & 1) != 0 ? 1.0 : -1.0;
        begin(&n, 7, (k & 2) != 0 ? sign * 3.0 : 0.0, (k & 2) != 0 ? 0.0 : sign * 0.5);
        for (int j = 0; j < 3000; j++) {
            block(&n, &config, some_current(&n), uniform(&n.seed, -0.05, 0.05), NOISE);
            TEST_ASSERT_TRUE(n.adapt.r >= usual.r_low && n.adapt.r <= usual.r_high);
            TEST_ASSERT_TRUE(n.adapt.psi >= usual.psi_low && n.adapt.psi <= usual.psi_high);
        }
        const iq24_t reached = (k & 2) != 0 ? n.adapt.r : n.adapt.psi;
        const iq24_t low = (k & 2) != 0 ? usual.r_low : usual.psi_low;
        const iq24_t high = (k & 2) != 0 ? usual.r_high : usual.psi_high;
        TEST_ASSERT_EQUAL_INT32(sign > 0.0 ? high : low, reached);
    }
}

/* Not in the first block, not about zero current, not from the alarm on. */
static void nothing_is_learnt_where_it_must_not_be(void)
{
    numbers n;
    begin(&n, 8, 0.236, -0.05);
    block(&n, &usual, 0.14, 0.02, 0.0);
    TEST_ASSERT_EQUAL_INT32(0, n.adapt.r);
    TEST_ASSERT_EQUAL_INT32(0, n.adapt.psi);
    block(&n, &usual, 0.5, 0.02, 0.0);
    TEST_ASSERT_NOT_EQUAL(0, n.adapt.psi);
    const iqfoc_adapt_t before = n.adapt;
    n.watch.naming = 1;
    iqfoc_adapt_block(&n.adapt, &usual, &n.watch, &watch_config, IQ24(0.02));
    n.watch.naming = 0;
    n.watch.group = IQFOC_WATCH_FLUX;
    iqfoc_adapt_block(&n.adapt, &usual, &n.watch, &watch_config, IQ24(0.02));
    n.watch.group = IQFOC_WATCH_NONE;
    n.watch.blocks = 0;
    iqfoc_adapt_block(&n.adapt, &usual, &n.watch, &watch_config, IQ24(0.02));
    TEST_ASSERT_EQUAL_INT32(before.r, n.adapt.r);
    TEST_ASSERT_EQUAL_INT32(before.psi, n.adapt.psi);
    n.watch.blocks = 1; /* the second block, the first that is learnt from */
    iqfoc_adapt_block(&n.adapt, &usual, &n.watch, &watch_config, IQ24(0.02));
    TEST_ASSERT_NOT_EQUAL(before.psi, n.adapt.psi);
}

/* Currents, speeds and errors at their ranges' ends: the arithmetic's own tests are the sanitizers'. */
static void it_bears_the_extremes(void)
{
    iqfoc_adapt_config_t config = usual;
    config.gain = IQ24_ONE;
    iqfoc_watch_config_t extreme = watch_config;
    extreme.per_noise_q8 = 20000 * 256;
    extreme.size_q16[IQFOC_WATCH_RESISTANCE] = extreme.size_q16[IQFOC_WATCH_FLUX] = 2048 * 65536 - 1;
    iqfoc_adapt_t adapt = {0, 0};
    for (int k = 0; k < 16; k++) {
        iqfoc_watch_t watch;
        iqfoc_watch_reset(&watch);
        watch.blocks = 2;
        watch.alpha_cos = watch.beta_sin = (k & 1) != 0 ? INT64_C(1) << 54 : -(INT64_C(1) << 54);
        watch.beta_cos = (k & 2) != 0 ? INT64_C(1) << 54 : -(INT64_C(1) << 54);
        watch.alpha_sin = -watch.beta_cos;
        watch.i[0] = (k & 4) != 0 ? IQ24(8.0) : -IQ24(8.0);
        watch.i[1] = watch.i[0];
        watch.speed = (k & 8) != 0 ? IQFOC_ROTOR_SPEED_MAX : -IQFOC_ROTOR_SPEED_MAX;
        iqfoc_adapt_block(&adapt, &config, &watch, &extreme, (k & 1) != 0 ? INT32_MAX : INT32_MIN);
        TEST_ASSERT_TRUE(adapt.r >= usual.r_low && adapt.r <= usual.r_high);
        TEST_ASSERT_TRUE(adapt.psi >= usual.psi_low && adapt.psi <= usual.psi_high);
    }
}

/* From a current of 0.15 on, the square to the last number; and at the largest block's current, whose square saturates. */
static void the_least_current(void)
{
    iq24_t least = IQ24(0.15) - 100;
    while (iq24_acc_round(iq24_acc_mul(least, least)) < IQ24(0.0225)) {
        least++;
    }
    TEST_ASSERT_EQUAL_INT32(IQ24(0.0225), iq24_acc_round(iq24_acc_mul(least, least)));
    const iq24_t currents[3] = {least - 1, least, IQ24(8.0)};
    for (int k = 0; k < 3; k++) {
        iqfoc_adapt_t adapt = {0, 0};
        iqfoc_watch_t watch;
        iqfoc_watch_reset(&watch);
        watch.blocks = 2;
        watch.i[0] = currents[k];
        watch.i[1] = k == 2 ? IQ24(8.0) : 0;
        watch.alpha_cos = INT64_C(1) << 50;
        iqfoc_adapt_block(&adapt, &usual, &watch, &watch_config, 0);
        TEST_ASSERT_EQUAL(k != 0, adapt.r != 0);
    }
}

static void the_law_has_the_changes(void)
{
    const iqfoc_tuned_law_t law = {
        .machine = IQFOC_SALIENT_MACHINE(R_OHM, L_D_H, L_Q_H, PSI, T_S, IQFOC_I_BASE(6.0), U_B)};
    const iqfoc_adapt_t none = {0, 0};
    const iqfoc_tuned_law_t same = iqfoc_adapt_law(&law, &none);
    TEST_ASSERT_EQUAL_MEMORY(&law, &same, sizeof law);
    const iqfoc_adapt_t warm = {IQ24(0.236), IQ24(-0.05)};
    const iqfoc_tuned_law_t made = iqfoc_adapt_law(&law, &warm);
    const iqfoc_salient_machine_t want =
        IQFOC_SALIENT_MACHINE(1.236 * R_OHM, L_D_H, L_Q_H, 0.95 * PSI, T_S, IQFOC_I_BASE(6.0), U_B);
    TEST_ASSERT_INT_WITHIN(3, want.rho_d_q30, made.machine.rho_d_q30);
    TEST_ASSERT_INT_WITHIN(3, want.rho_q_q30, made.machine.rho_q_q30);
    /* Half an LSB of the change, over psi_f/(L I_b) of 3 in Q27. */
    TEST_ASSERT_INT_WITHIN(24, want.k_psi_d_q27, made.machine.k_psi_d_q27);
    TEST_ASSERT_INT_WITHIN(24, want.k_psi_q_q27, made.machine.k_psi_q_q27);
    iqfoc_tuned_law_t most = law;
    most.machine.rho_d_q30 = most.machine.k_psi_d_q27 = INT32_C(1) << 30;
    const iqfoc_adapt_t up = {IQ24_ONE, IQ24(0.25)};
    TEST_ASSERT_EQUAL_INT32(INT32_C(1) << 30, iqfoc_adapt_law(&most, &up).machine.rho_d_q30);
    TEST_ASSERT_EQUAL_INT32(INT32_C(1) << 30, iqfoc_adapt_law(&most, &up).machine.k_psi_d_q27);
}

/*
 * Without adaptation the drive alarms while it warms; followed it does not, and the model is the drive's. What comes
 * at once is an alarm all the same.
 */
static void a_drive_that_warms_is_followed(void)
{
    static tune_result r = {.method = TUNE_PI, .disk_wanted = 0.5};
    const tune_tolerances t = {0.3, 0.3, 0.05};
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(motor_read("data/motors/compressor_salient.toml", &r.motor, &e), e.text);
    r.motor.f_pwm_Hz = 8000.0;
    tune_region_of_tolerances(&r.motor, &t, &r.region);
    TEST_ASSERT_TRUE_MESSAGE(tune_design_bandwidth(&r, &e), e.text);
    adapt_trial told[2];
    for (int adapted = 0; adapted < 2; adapted++) {
        const double warming_s = adapted == 1 ? 12.0 : 4.0;
        TEST_ASSERT_TRUE_MESSAGE(
            adapt_trial_run(&r, adapted == 1, warming_s, warming_s + 4.0, 3, &told[adapted], &e), e.text);
        printf("  %-9s R %+.2f %%, psi_f %+.3f %% off, at most %.2f %%, %.3f %%; error %.3f %%; alarm: %d\n",
               adapted == 1 ? "followed" : "not", told[adapted].r_percent, told[adapted].psi_percent,
               told[adapted].r_most_percent, told[adapted].psi_most_percent, told[adapted].error_percent,
               told[adapted].alarm);
    }
    adapt_trial sudden;
    TEST_ASSERT_TRUE_MESSAGE(adapt_trial_run(&r, true, 0.0, 2.0, 4, &sudden, &e), e.text);
    TEST_ASSERT_TRUE(sudden.alarm);
    TEST_ASSERT_TRUE(told[0].alarm);
    TEST_ASSERT_FALSE(told[1].alarm);
    TEST_ASSERT_TRUE(told[1].error_percent < 0.6 * told[0].error_percent);
    TEST_ASSERT_TRUE(fabs(told[1].psi_percent) < 0.5);
    TEST_ASSERT_TRUE(fabs(told[1].r_percent) < 8.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_rest_the_distance_never_grows);
    RUN_TEST(each_step_is_the_projection);
    RUN_TEST(both_are_found_in_noise);
    RUN_TEST(it_stays_within_its_bounds);
    RUN_TEST(nothing_is_learnt_where_it_must_not_be);
    RUN_TEST(it_bears_the_extremes);
    RUN_TEST(the_least_current);
    RUN_TEST(the_law_has_the_changes);
    RUN_TEST(a_drive_that_warms_is_followed);
    return UNITY_END();
}
