/*
 * The tuned controller (include/iqfoc/tuned_control.h): its coefficients at a speed, its step against the same
 * equations in double, and the closed loop with an exact machine.
 */
#include "iqfoc/tuned_control.h"
#include "model/exact_map.h"
#include "reference_vectors.h"

void setUp(void)
{
}

void tearDown(void)
{
}

enum { TRIES = 100000 / IQFOC_TEST_STRIDE };

static iqfoc_salient_machine_t random_machine(uint64_t *seed)
{
    const double k_d = exp(uniform(seed, log(1.0 / 16.0), log(8.0)));
    const double saliency = uniform(seed, 0.5, 2.0);
    const double rho = uniform(seed, 0.0, 0.4);
    const double k_psi = uniform(seed, 0.0, 4.0);
    const iqfoc_salient_machine_t m = {.rho_d_q30 = to_fixed(rho, 30),
                                       .rho_q_q30 = to_fixed(rho / saliency, 30),
                                       .k_d_q26 = to_fixed(fmax(k_d, 1.0 / 16.0), 26),
                                       .k_q_q26 = to_fixed(fmax(k_d / saliency, 1.0 / 16.0), 26),
                                       .k_psi_d_q27 = to_fixed(k_psi, 27),
                                       .k_psi_q_q27 = to_fixed(k_psi / saliency, 27),
                                       .q_to_d_q27 = to_fixed(saliency, 27),
                                       .d_to_q_q27 = to_fixed(1.0 / saliency, 27)};
    return m;
}

static iqfoc_tuned_law_t random_law(uint64_t *seed)
{
    const iqfoc_tuned_law_t law = {.machine = random_machine(seed),
                                   .keep = random_iq24(seed, 0.0, 1.0),
                                   .follow = random_iq24(seed, 0.0, 1.0),
                                   .learn = random_iq24(seed, 0.0, 1.0),
                                   .learn_offset = random_iq24(seed, 0.0, 1.0)};
    return law;
}

/* ---- The law at a speed ---- */

static void the_voltage_s_matrix_is_inverted(void)
{
    uint64_t seed = 1;
    double most = 0.0;
    for (int n = 0; n < TRIES; n++) {
        const iqfoc_tuned_law_t law = random_law(&seed);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0));
        const double a = ldexp(t.end.d.u_d_q26, -26);
        const double b = ldexp(t.end.d.u_q_q26, -26);
        const double c = ldexp(t.end.q.u_d_q26, -26);
        const double d = ldexp(t.end.q.u_q_q26, -26);
        const double det = a * d - b * c;
        const double want[4] = {d / det, -b / det, -c / det, a / det};
        const iq24_t got[4] = {t.voltage_dd, t.voltage_dq, t.voltage_qd, t.voltage_qq};
        const double largest = fmax(fmax(fabs(want[0]), fabs(want[1])), fmax(fabs(want[2]), fabs(want[3])));
        TEST_ASSERT_TRUE(largest < 32.0);
        for (int k = 0; k < 4; k++) {
            const double beyond = fabs(to_double(got[k]) - want[k]) - 1.0 / 16777216.0;
            most = fmax(most, beyond / largest);
        }
    }
    printf("  G^-1: off by 1 LSB and %.2e of its largest entry\n", most);
    TEST_ASSERT_TRUE(most <= 1e-7);
    TEST_ASSERT_TRUE(most >= 1e-8);
}

static void the_pole_and_the_bow_are_as_stated(void)
{
    uint64_t seed = 2;
    worst keep = {"keep e^(-j phi)", 0.0};
    worst bow = {"bow", 0.0};
    for (int n = 0; n < TRIES; n++) {
        const iqfoc_tuned_law_t law = random_law(&seed);
        const iq24_t speed = random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, speed);
        const double phi = TWO_PI * to_double(speed);
        const double s1 = fabs(phi) > 1e-9 ? sin(0.5 * phi) / (0.5 * phi) : 1.0;
        worst_add(&keep, t.keep_cos, to_double(law.keep) * cos(phi));
        worst_add(&keep, t.keep_sin, to_double(law.keep) * sin(phi));
        if (fabs(phi) > 0.01) {
            worst_add(&bow, t.bow, (1.0 - s1 * s1) / (1.0 - cos(0.5 * phi)));
        }
    }
    worst_check(&keep, 1.1);
    worst_check(&bow, 20.0);
}

static void speeds_beyond_the_limit_are_held(void)
{
    uint64_t seed = 3;
    const iqfoc_tuned_law_t law = random_law(&seed);
    TEST_ASSERT_EQUAL_INT32(IQFOC_ROTOR_SPEED_MAX, iqfoc_tuned_at_speed(&law, IQ24(0.5)).speed);
    TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_SPEED_MAX, iqfoc_tuned_at_speed(&law, IQ24(-0.5)).speed);
}

/* ---- The step ---- */

static double complex end_of(const iqfoc_salient_t *s, double complex i, double complex u)
{
    const iqfoc_salient_row_t *row[2] = {&s->d, &s->q};
    double out[2];
    for (int k = 0; k < 2; k++) {
        out[k] = ldexp(row[k]->constant_q26, -26) + ldexp(row[k]->i_d_q26, -26) * creal(i) +
                 ldexp(row[k]->i_q_q26, -26) * cimag(i) + ldexp(row[k]->u_d_q26, -26) * creal(u) +
                 ldexp(row[k]->u_q_q26, -26) * cimag(u);
    }
    return out[0] + I * out[1];
}

static double complex valley_in_double(const iqfoc_tuned_t *t, double complex mean, double complex offset)
{
    return to_double(t->reference.gain) * mean + to_double(t->reference.magnet_pu) + offset;
}

/* The header's five lines, in double, with the coefficients as they are. */
static double complex step_in_double(const iqfoc_tuned_state_t *state, const iqfoc_tuned_t *t,
                                     iqfoc_ab_t i_ab, iqfoc_ab_t u_now, iqfoc_dq_t i_ref, iq24_t theta)
{
    const double complex frame = cexp(-I * TWO_PI * to_double(theta));
    const double complex i = complex_of_ab(i_ab) * frame;
    const double complex error = i - complex_of_dq(state->i_next);
    const double complex drift = complex_of_dq(state->drift) + to_double(t->learn) * error;
    const double complex ends = 0.5 * (i + complex_of_dq(state->i));
    const double complex mean = ends + to_double(t->bow) * (complex_of_dq(state->i_mid) - ends);
    const double complex seen = ends - valley_in_double(t, mean, 0.0);
    const double complex was = complex_of_dq(state->offset);
    const double complex offset = was + to_double(t->learn_offset) * (seen - was);
    const double complex next = end_of(&t->end, i, complex_of_ab(u_now) * frame) + drift;
    const double complex ref = complex_of_dq(i_ref);
    const double complex aim = complex_of_dq(state->aim);
    const double complex new_aim = to_double(t->follow) * aim + (1.0 - to_double(t->follow)) * ref;
    const double complex keep = to_double(t->keep_cos) - I * to_double(t->keep_sin);
    const double complex want =
        valley_in_double(t, new_aim, offset) + keep * (next - valley_in_double(t, aim, offset));
    const double complex need = want - end_of(&t->end, next, 0.0) - drift;
    const double u_d = to_double(t->voltage_dd) * creal(need) + to_double(t->voltage_dq) * cimag(need);
    const double u_q = to_double(t->voltage_qd) * creal(need) + to_double(t->voltage_qq) * cimag(need);
    return (u_d + I * u_q) / frame * cexp(I * TWO_PI * to_double(t->speed));
}

/* Motors of the kind in data/motors/: k 0.5 to 3, currents about the rated one. */
static void a_step_is_the_law(void)
{
    uint64_t seed = 4;
    worst off = {"step", 0.0};
    for (int n = 0; n < TRIES; n++) {
        iqfoc_tuned_law_t law = random_law(&seed);
        /* So that neither the offset nor a predicted current is held. */
        law.learn_offset = random_iq24(&seed, 0.0, 0.1);
        law.machine.k_psi_d_q27 /= 2;
        law.machine.k_psi_q_q27 /= 2;
        law.machine.k_d_q26 = to_fixed(uniform(&seed, 1.0, 3.0), 26);
        law.machine.k_q_q26 =
            to_fixed(ldexp(law.machine.k_d_q26, -26) * ldexp(law.machine.d_to_q_q27, -27), 26);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, random_iq24(&seed, -0.25, 0.25));
        iqfoc_tuned_state_t state = {.drift = random_dq_in_disc(&seed, 0.2),
                                     .offset = random_dq_in_disc(&seed, 0.1),
                                     .aim = random_dq_in_disc(&seed, 1.0),
                                     .i = random_dq_in_disc(&seed, 1.0),
                                     .i_mid = random_dq_in_disc(&seed, 1.0),
                                     .i_next = random_dq_in_disc(&seed, 1.0),
                                     .predicted = true,
                                     .has_mid = true};
        const iqfoc_ab_t i = random_ab_in_disc(&seed, 1.0);
        const iqfoc_ab_t u_now = random_ab_in_disc(&seed, 0.6);
        const iqfoc_dq_t i_ref = random_dq_in_disc(&seed, 1.0);
        const iq24_t theta = random_iq24(&seed, -0.5, 0.5);
        const double complex want = step_in_double(&state, &t, i, u_now, i_ref, theta);
        const iqfoc_ab_t u = iqfoc_tuned_step(&state, &t, i, u_now, i_ref, theta);
        if (cabs(want) < 12.0) {
            worst_add(&off, u.alpha, creal(want));
            worst_add(&off, u.beta, cimag(want));
        }
    }
    worst_check(&off, 8.0);
}

/* Whatever comes: states and voltage stay within what the header says, and nothing overflows on the way. */
static void extremes_are_held(void)
{
    uint64_t seed = 5;
    for (int n = 0; n < TRIES; n++) {
        const iqfoc_tuned_law_t law = random_law(&seed);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0));
        iqfoc_tuned_state_t state = {.predicted = false};
        for (int k = 0; k < 4; k++) {
            const iq24_t theta = random_iq24(&seed, -0.5, 0.5);
            const iqfoc_dq_t i_ref = {random_iq24(&seed, -8.0, 8.0), random_iq24(&seed, -8.0, 8.0)};
            const iqfoc_ab_t u = iqfoc_tuned_step(&state, &t, random_ab_in_square(&seed, 21.0),
                                                  random_ab_in_square(&seed, 1.0), i_ref, theta);
            iqfoc_tuned_peak(&state, random_ab_in_square(&seed, 64.0), theta);
            TEST_ASSERT_TRUE(cabs(complex_of_ab(u)) <= 16.0 * sqrt(2.0) + 1e-5);
            TEST_ASSERT_TRUE(iq24_within(state.drift.d, IQ24(-4.0), IQ24(4.0)));
            TEST_ASSERT_TRUE(iq24_within(state.drift.q, IQ24(-4.0), IQ24(4.0)));
            TEST_ASSERT_TRUE(iq24_within(state.offset.d, IQ24(-1.0), IQ24(1.0)));
            TEST_ASSERT_TRUE(iq24_within(state.offset.q, IQ24(-1.0), IQ24(1.0)));
            TEST_ASSERT_TRUE(iq24_within(state.i_next.d, IQ24(-8.0), IQ24(8.0)));
            TEST_ASSERT_TRUE(iq24_within(state.i_next.q, IQ24(-8.0), IQ24(8.0)));
        }
    }
}

/* ---- In a loop with an exact machine ---- */

/* The compressor of data/motors/ at six cycles a turn. */
#define R_OHM 0.9
#define L_D_H 0.008
#define L_Q_H 0.011
#define PSI   0.2
#define T_S   (1.0 / 1800.0)
#define I_B   (6.0 * 1.4142135623730951)
#define U_B   565.0
#define TURNS (1.0 / 6.0)

static const iqfoc_salient_machine_t compressor =
    IQFOC_SALIENT_MACHINE(R_OHM, L_D_H, L_Q_H, PSI, T_S, I_B, U_B);

/* The flux at the end of a span, or its mean, per unit of the current's base times L. */
static double complex mapped(const exact_map *m, double complex i, double complex u, double omega)
{
    const double x[2] = {L_D_H * creal(i) * I_B, L_Q_H * cimag(i) * I_B};
    const double v[2] = {creal(u) * U_B, cimag(u) * U_B};
    double out[2];
    for (int k = 0; k < 2; k++) {
        out[k] = m->decay[k][0] * x[0] + m->decay[k][1] * x[1] + m->drive[k][0] * v[0] +
                 m->drive[k][1] * v[1] - m->push[k][1] * omega * PSI;
    }
    return out[0] / (L_D_H * I_B) + I * out[1] / (L_Q_H * I_B);
}

/* Cycles of the firmware and the machine; the means of the last one, and the largest prediction error of the
 * second half. */
static double complex run(const iqfoc_tuned_law_t *law, int cycles, iqfoc_dq_t i_ref, bool peaks,
                          double *error)
{
    const iqfoc_tuned_t t = iqfoc_tuned_at_speed(law, IQ24(TURNS));
    const double phi = TWO_PI * to_double(t.speed);
    const double omega = phi / T_S;
    exact_map end;
    exact_map mean;
    exact_map half;
    iqfoc_tuned_state_t state = {.predicted = false};
    iqfoc_ab_t u_now = {0, 0};
    double complex i = 0.0;
    double complex last = 0.0;
    iq24_t theta = IQ24(0.1);
    exact_maps(R_OHM, L_D_H, L_Q_H, T_S, omega, &end, &mean);
    exact_maps(R_OHM, L_D_H, L_Q_H, 0.5 * T_S, omega, &half, NULL);
    *error = 0.0;
    for (int n = 0; n < cycles; n++) {
        const double complex frame = cexp(I * TWO_PI * to_double(theta));
        const double complex i_ab = i * frame;
        const iqfoc_ab_t sample = {to_iq24(creal(i_ab)), to_iq24(cimag(i_ab))};
        const iqfoc_ab_t next = iqfoc_tuned_step(&state, &t, sample, u_now, i_ref, theta);
        const double complex u = complex_of_ab(u_now) / frame;
        const double complex mid = mapped(&half, i, u, omega) * frame * cexp(0.5 * I * phi);
        if (n > cycles / 2) {
            *error = fmax(*error, cabs(complex_of_dq(state.error)));
        }
        if (peaks) {
            const iqfoc_ab_t peak = {to_iq24(creal(mid)), to_iq24(cimag(mid))};
            iqfoc_tuned_peak(&state, peak, iq24_add_wrap(theta, iq24_asr32(t.speed, 1)));
        }
        last = mapped(&mean, i, u, omega);
        i = mapped(&end, i, u, omega);
        u_now = next;
        theta = iq24_add_wrap(theta, t.speed) & (IQ24_ONE - 1);
    }
    return last;
}

/*
 * With an exact model the disturbance estimate stays at 0, and the mean is there after the delay's two cycles, but
 * for the resistance that the valley's reference leaves out.
 */
static void with_the_truth_it_is_deadbeat(void)
{
    const iqfoc_tuned_law_t law = {.machine = compressor, .keep = 0, .follow = 0, .learn = IQ24(0.1)};
    const iqfoc_dq_t i_ref = {IQ24(-0.3), IQ24(0.6)};
    double error = 0.0;
    const double complex mean = run(&law, 4, i_ref, false, &error);
    TEST_ASSERT_TRUE(cabs(mean - complex_of_dq(i_ref)) < 0.02);
    (void)run(&law, 60, i_ref, false, &error);
    TEST_ASSERT_TRUE(error < 1e-5);
}

/* Inductances believed a third too large: with the peaks' samples the mean is met nevertheless. */
static void the_mean_is_met_whatever_is_believed(void)
{
    static const iqfoc_salient_machine_t wrong =
        IQFOC_SALIENT_MACHINE(1.3 * R_OHM, 1.3 * L_D_H, 1.3 * L_Q_H, 0.95 * PSI, T_S, I_B, U_B);
    iqfoc_tuned_law_t law = {.machine = wrong,
                             .keep = IQ24(0.5),
                             .follow = IQ24(0.5),
                             .learn = IQ24(0.25),
                             .learn_offset = IQ24(0.05)};
    const iqfoc_dq_t i_ref = {IQ24(-0.3), IQ24(0.6)};
    double error = 0.0;
    const double with_peaks = cabs(run(&law, 600, i_ref, true, &error) - complex_of_dq(i_ref));
    const double without = cabs(run(&law, 600, i_ref, false, &error) - complex_of_dq(i_ref));
    printf("  mean off by %.2e with the peaks' samples, by %.2e without\n", with_peaks, without);
    TEST_ASSERT_TRUE(with_peaks < 0.005);
    TEST_ASSERT_TRUE(without > 0.02);
}

/* T U_b/(L I_b) is 1/16 at least (iqfoc tune refuses less). */
static void the_least_machine_is_a_sixteenth(void)
{
    TEST_ASSERT_EQUAL_INT32(67108864 / 16, IQFOC_TUNED_K_LEAST_Q26);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_voltage_s_matrix_is_inverted);
    RUN_TEST(the_pole_and_the_bow_are_as_stated);
    RUN_TEST(the_least_machine_is_a_sixteenth);
    RUN_TEST(speeds_beyond_the_limit_are_held);
    RUN_TEST(a_step_is_the_law);
    RUN_TEST(extremes_are_held);
    RUN_TEST(with_the_truth_it_is_deadbeat);
    RUN_TEST(the_mean_is_met_whatever_is_believed);
    return UNITY_END();
}
