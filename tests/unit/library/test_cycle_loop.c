/*
 * The cycle in closed loop on a small machine that this test integrates: stationary frame, fourth order, mean
 * voltages. test_host_drive.c has the switching-level drive.
 */
#include "cycle_fixture.h"
#include "iqfoc/transform.h"

#include <complex.h>
#include <stdbool.h>

typedef struct machine {
    double complex i;       /* A */
    double theta, omega_T;  /* rad, rad per cycle */
    double complex mean_dq; /* true means since they were last zeroed, A */
    double complex mean_ab;
} machine;

static void machine_advance(machine *m, double complex u_V, double part)
{
    enum { STEPS = 20 };
    const double h = part * T_S / STEPS;
    const double omega = m->omega_T / T_S;
    double complex sum = 0.0;
    for (int n = 0; n < STEPS; n++) {
        const double complex e0 = I * omega * PSI_WB * cexp(I * m->theta);
        const double complex e1 = I * omega * PSI_WB * cexp(I * (m->theta + 0.5 * omega * h));
        const double complex e2 = I * omega * PSI_WB * cexp(I * (m->theta + omega * h));
        const double complex k1 = (u_V - R_OHM * m->i - e0) / L_H;
        const double complex k2 = (u_V - R_OHM * (m->i + 0.5 * h * k1) - e1) / L_H;
        const double complex k3 = (u_V - R_OHM * (m->i + 0.5 * h * k2) - e1) / L_H;
        const double complex k4 = (u_V - R_OHM * (m->i + h * k3) - e2) / L_H;
        const double complex begin = m->i * cexp(-I * m->theta);
        const double complex i_mid =
            m->i + 0.25 * h * (k1 + k2); /* third order: enough for the means' fourth */
        const double complex middle = i_mid * cexp(-I * (m->theta + 0.5 * omega * h));
        m->mean_ab +=
            (m->i + 4.0 * i_mid + m->i + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)) / 6.0 / STEPS * part;
        m->i += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        m->theta += omega * h;
        sum += (begin + 4.0 * middle + m->i * cexp(-I * m->theta)) / 6.0 / STEPS;
    }
    m->mean_dq += sum * part;
}

static iqfoc_abc_t phases_of(double complex i_A)
{
    const double complex i = i_A / I_B_A;
    const iqfoc_abc_t abc = {to_iq24(creal(i)), to_iq24(creal(i * cexp(-I * TWO_PI / 3.0))),
                             to_iq24(creal(i * cexp(I * TWO_PI / 3.0)))};
    return abc;
}

static iqfoc_sample_t measured(const machine *m, iq24_t at)
{
    iqfoc_sample_t s = sample_at(at);
    s.i = phases_of(m->i);
    s.i_mean = phases_of(m->mean_ab);
    s.theta = to_iq24(remainder(m->theta / TWO_PI, 1.0));
    s.speed = to_iq24(m->omega_T / TWO_PI);
    return s;
}

/* Runs to the steady state; gives the true mean dq current of the last cycle, in per unit. */
static double complex settled_mean(iqfoc_feedback_t feedback, bool averaging, double speed,
                                   double complex ref)
{
    config.feedback = feedback;
    config.tolerance_ticks = PERIOD;
    cycle.enabled = false;
    iqfoc_cycle_clear(&cycle);
    cycle.enabled = true;
    cycle.i_ref.d = to_iq24(creal(ref));
    cycle.i_ref.q = to_iq24(cimag(ref));
    machine m = {0.0, 0.3, TWO_PI * speed, 0.0, 0.0};
    iqfoc_duties_t duties = {{IQ24(0.5), IQ24(0.5), IQ24(0.5)}, IQ24_ONE};
    for (int32_t n = 0; n < 1500; n++) {
        const iqfoc_ab_t legs = iqfoc_clarke3(duties.high);
        const double complex u = U_DC_V * (to_double(legs.alpha) + I * to_double(legs.beta));
        iqfoc_sample_t at_valley = measured(&m, 0);
        at_valley.has_mean = averaging;
        m.mean_ab = 0.0;
        m.mean_dq = 0.0;
        iqfoc_cycle_valley(&cycle, &at_valley, ticks + 5);
        machine_advance(&m, u, 0.5);
        ticks += PERIOD / 2;
        const iqfoc_sample_t at_peak = measured(&m, IQ24(0.5));
        duties = iqfoc_cycle_peak(&cycle, &at_peak, IQ24(1.5), ticks + 5).duties;
        machine_advance(&m, u, 0.5);
        ticks += PERIOD / 2;
    }
    return m.mean_dq / I_B_A;
}

static void test_feedback_decides_what_is_regulated(void)
{
    /* A twelfth of a turn per cycle: SFFR 12. The mean dq current misses its reference by what the feedback
     * leaves out. */
    const double complex ref = 0.0 + 0.5 * I;
    const double midpoint = cabs(settled_mean(IQFOC_FEEDBACK_MIDPOINT, false, 1.0 / 12.0, ref) - ref) / 0.5;
    const uint32_t midpoint_status = cycle.status;
    const double corrected =
        cabs(settled_mean(IQFOC_FEEDBACK_CORRECTED_MEAN, false, 1.0 / 12.0, ref) - ref) / 0.5;
    const uint32_t corrected_status = cycle.status;
    const double quasi =
        cabs(settled_mean(IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN, false, 1.0 / 12.0, ref) - ref) / 0.5;
    /* The same correction, fed by a port that averages the phase currents over the cycle. */
    const double averaged =
        cabs(settled_mean(IQFOC_FEEDBACK_CORRECTED_MEAN, true, 1.0 / 12.0, ref) - ref) / 0.5;
    printf("  mean dq current off its reference at SFFR 12: mid-point %.4f %%, corrected %.4f %%, corrected "
           "with an "
           "averaging port %.4f %%, quasi-discrete %.4f %%\n",
           100.0 * midpoint, 100.0 * corrected, 100.0 * averaged, 100.0 * quasi);
    TEST_ASSERT_EQUAL_UINT32(0, midpoint_status);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_NO_INTERVAL, corrected_status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    TEST_ASSERT_TRUE(midpoint > 0.03 && midpoint < 0.05);
    TEST_ASSERT_TRUE(corrected < midpoint);
    TEST_ASSERT_TRUE(averaged < 0.1 * midpoint);
    TEST_ASSERT_TRUE(quasi < 0.1 * midpoint);
}

static void test_prediction_error_is_what_the_model_leaves(void)
{
    /* Only R i is frozen: of the order rho/2 of the current's change over a cycle, 2019 Table 1. */
    (void)settled_mean(IQFOC_FEEDBACK_MIDPOINT, false, 1.0 / 12.5, 1.0 * I);
    const double error = hypot(to_double(cycle.error.alpha), to_double(cycle.error.beta));
    printf("  prediction error at SFFR 12.5: %.3f %% of the current\n", 100.0 * error);
    TEST_ASSERT_TRUE(error > 0.006 && error < 0.0095);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_feedback_decides_what_is_regulated);
    RUN_TEST(test_prediction_error_is_what_the_model_leaves);
    return UNITY_END();
}
