/*
 * What a flux map gains: one-cycle prediction of a machine that loses much inductance, on the plant that switches, by the map,
 * by the flux predictor with the best fall of both axes, and by the same without saturation.
 */
#include "extension_host.h"
#include "plant/plant.h"
#include "unity.h"

#include "iqfoc/iq24_sincos.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { CYCLES = 600 };

void setUp(void)
{
}

void tearDown(void)
{
}

/* A reluctance machine with magnets, invented: at twice the rated current L_q has a third of what it has at none. */
static motor machine(void)
{
    motor m = motor_blank();
    strcpy(m.name, "pmsyrm");
    m.pole_pairs = 2;
    m.R_ohm = 0.7;
    m.L_d_H = 0.018;
    m.L_q_H = 0.035;
    m.psi_f_Wb = 0.3;
    m.I_rated_A_rms = 8.8;
    m.n_max_rpm = 3000.0;
    m.f_pwm_Hz = 8000.0;
    m.u_dc_V = 540.0;
    m.ext.has[CAUSE_SATURATION_DQ] = true;
    m.ext.L_d0_H = m.L_d_H;
    m.ext.L_q0_H = m.L_q_H;
    m.ext.E_1_J = 0.72;
    m.ext.I_d1_A = 14.0;
    m.ext.I_q1_A = 6.0;
    m.ext.I_c1_A = -4.0;
    m.ext.E_2_J = 0.06;
    m.ext.I_d2_A = 8.0;
    m.ext.I_q2_A = 3.0;
    m.ext.I_c2_A = 5.0;
    return m;
}

/* A predictor as a drive has it. */
typedef struct predictor {
    bool mapped;
    iqfoc_flux_map_t map;
    iqfoc_flux_predictor_t flux;
    iqfoc_extension_t extension;
} predictor;

static predictor predictor_of(const motor *m)
{
    predictor p = {.mapped = motor_has_parts_alone(m)};
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(
        extension_from_motor(m, &p.extension, &e) &&
            (p.mapped ? flux_map_from_motor(m, &p.map, &e) : flux_predictor_from_motor(m, &p.flux, &e)),
        e.text);
    return p;
}

/* The same machine by another model: a fall of both axes with I_sat, or none. */
static predictor falling(double L_share, double I_sat_A)
{
    motor m = machine();
    m.ext.has[CAUSE_SATURATION_DQ] = false;
    m.L_d_H *= L_share;
    m.L_q_H *= L_share;
    m.ext.has[CAUSE_SATURATION] = I_sat_A > 0.0;
    m.ext.L_0_H = 0.5 * (m.L_d_H + m.L_q_H);
    m.ext.I_sat_A = I_sat_A;
    return predictor_of(&m);
}

/* A cycle of the plant: current and voltage as the firmware knows them, and the current at its end. */
typedef struct cycle {
    iqfoc_ab_t i, u;
    iq24_sincos_t start, end;
    vec_ab next_A;
} cycle;

static double drawn(uint64_t *state, double low, double high)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(*state >> 11) / 9007199254740992.0;
}

static iqfoc_ab_t per_unit_ab(vec_ab x, double base)
{
    return (iqfoc_ab_t){iq24_from_double(x.alpha / base), iq24_from_double(x.beta / base)};
}

/* One at any angle and speed, with a current up to `most` of the rated peak and a voltage that changes it. */
static cycle cycle_drawn(plant *p, const motor *m, double most, uint64_t *seed)
{
    const per_unit base = per_unit_of(m);
    const double length_A = most * base.I_A * sqrt(drawn(seed, 0.0, 1.0));
    const double angle = drawn(seed, 0.25 * VEC_TWO_PI, 0.75 * VEC_TWO_PI); /* i_d <= 0, as in a drive */
    const double omega = drawn(seed, -250.0, 250.0);
    plant_set_speed(p, omega, 0.0);
    plant_set_current(p, (vec_dq){length_A * cos(angle), length_A * sin(angle)});
    const plant_point from = plant_now(p);
    const vec_ab i = vec_from_phases(from.i_A);
    const double u_V = drawn(seed, 0.0, 0.5) * base.U_V;
    const double u_angle = drawn(seed, 0.0, VEC_TWO_PI);
    const vec_ab u = {u_V * cos(u_angle), u_V * sin(u_angle)};
    double phase[3];
    double duty[3];
    vec_to_phases(u, phase);
    const double middle =
        0.5 * (fmin(phase[0], fmin(phase[1], phase[2])) + fmax(phase[0], fmax(phase[1], phase[2])));
    for (int x = 0; x < 3; x++) {
        duty[x] = 0.5 + (phase[x] - middle) / base.U_V;
    }
    plant_cycle(p, duty, NULL, NULL, NULL);
    const plant_point to = plant_now(p);
    const iq24_t turns = iq24_from_double(remainder(from.theta_e_rad / VEC_TWO_PI, 1.0));
    const iq24_t speed = iq24_from_double(omega * base.T_s / VEC_TWO_PI);
    return (cycle){per_unit_ab(i, base.I_A), per_unit_ab(u, base.U_V), iq24_sincos(turns),
                   iq24_sincos(turns + speed), vec_from_phases(to.i_A)};
}

static double error_percent(const predictor *p, const cycle *c, double I_A)
{
    double wrong = 0.0;
    double all = 0.0;
    for (int n = 0; n < CYCLES; n++) {
        const iqfoc_ab_t next =
            p->mapped
                ? iqfoc_flux_map_step(&p->map, &p->extension, c[n].i, c[n].u, c[n].start, c[n].end)
                : iqfoc_flux_predictor_step(&p->flux, &p->extension, c[n].i, c[n].u, c[n].start, c[n].end);
        const double alpha = iq24_to_double(next.alpha) * I_A - c[n].next_A.alpha;
        const double beta = iq24_to_double(next.beta) * I_A - c[n].next_A.beta;
        wrong += alpha * alpha + beta * beta;
        all += c[n].next_A.alpha * c[n].next_A.alpha + c[n].next_A.beta * c[n].next_A.beta;
    }
    return 100.0 * sqrt(wrong / all);
}

static void test_gain(void)
{
    static const double range[] = {1.0, 2.0};
    static cycle c[CYCLES];
    static plant p;
    const motor m = machine();
    const double I_A = per_unit_of(&m).I_A;
    plant_config config = plant_config_from_motor(&m);
    error e = {0};
    plant_config_extend(&config, &m, CAUSE_SATURATION_DQ);
    TEST_ASSERT_TRUE_MESSAGE(plant_config_check(&config, &e), e.text);
    plant_init(&p, &config);
    const predictor mapped = predictor_of(&m);
    TEST_ASSERT_TRUE(mapped.mapped);
    const predictor plain = falling(1.0, 0.0);
    for (size_t n = 0; n < 2; n++) {
        uint64_t seed = 1;
        for (int k = 0; k < CYCLES; k++) {
            c[k] = cycle_drawn(&p, &m, range[n], &seed);
        }
        double least = INFINITY;
        for (double share = 0.4; share < 1.05; share += 0.1) {
            for (double I_sat_A = 12.0; I_sat_A < 80.0; I_sat_A *= 1.2) {
                const predictor one = falling(share, I_sat_A);
                least = fmin(least, error_percent(&one, c, I_A));
            }
        }
        const double by_map = error_percent(&mapped, c, I_A);
        const double by_none = error_percent(&plain, c, I_A);
        printf("  up to %.0f times the rated current: %.4f %% by the map, %.2f %% by the best I_sat, %.2f %% "
               "unsaturated\n",
               range[n], by_map, least, by_none);
        TEST_ASSERT_TRUE(by_map < 0.005 && least > 2.0 && by_none > 1.2 * least);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_gain);
    return UNITY_END();
}
