/*
 * Effects that no cause of a diagnosis stands for: a short circuit between turns against the phases' equations, a weak pole
 * against its flux, and what the current channels make of hum, edges, crosstalk and a core's play.
 */
#include "plant/plant.h"
#include "plant/plant_effect.h"
#include "plant/plant_machine.h"

#include <math.h>
#include <string.h>
#include <unity.h>

static const double R = 0.8, L = 5e-3, PSI = 0.12, T_S = 2e-4, U_DC = 560.0;

void setUp(void)
{
}

void tearDown(void)
{
}

static plant_config drive(double psi_f_Wb, double omega_rad_s)
{
    plant_config c;
    memset(&c, 0, sizeof c);
    c.machine.pole_pairs = 2;
    c.machine.R_ohm = R;
    c.machine.L_d_H = c.machine.L_q_H = L;
    c.machine.psi_f_Wb = psi_f_Wb;
    c.inverter.u_dc_V = U_DC;
    c.inverter.k_u = 1.0;
    c.shaft.omega_e_start_rad_s = omega_rad_s;
    c.sensors.loose_samples = 1.0;
    for (int n = 0; n < PLANT_HARMONICS; n++) {
        c.sensors.harmonic[n].order = 1.0;
    }
    for (int x = 0; x < 3; x++) {
        c.sensors.current_gain[x] = 1.0;
    }
    c.T_s = T_S;
    c.I_scale_A = 15.0;
    return c;
}

static plant_config with(plant_config c, const char *effect)
{
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(plant_effect_apply(&c, effect, &e), e.text);
    return c;
}

static vec_ab current_after(plant_config c, const double duty[3], int cycles)
{
    plant p;
    plant_init(&p, &c);
    for (int k = 0; k < cycles; k++) {
        plant_cycle(&p, duty, NULL, NULL, NULL);
    }
    return (vec_ab){p.state.y[STATE_I_ALPHA], p.state.y[STATE_I_BETA]};
}

/* The phases' equations: d/dt of (i_a, i_b, i_c, i_f) with s of phase a's turns around the fault. */
typedef struct coils {
    double s, around_ohm, tau_s, omega, u_V[3];
} coils;

static void coil_rates(const coils *k, double t_s, const double i[4], double rate[4])
{
    /* What drives each phase's flux: its voltage against the star point less its resistance's. */
    const double i_m[3] = {i[0] - k->s * i[3], i[1], i[2]};
    double e[3];
    double star = 0.0;
    for (int x = 0; x < 3; x++) {
        e[x] = k->u_V[x] - R * i_m[x];
        star += e[x] / 3.0;
    }
    double d_flux[3];
    for (int x = 0; x < 3; x++) {
        d_flux[x] = e[x] - star;
        /* The magnetising currents without their mean make the flux: L times that, and the magnet's. */
        const double emf_V = -k->omega * PSI * sin(k->omega * t_s - 2.0 * VEC_PI / 3.0 * x);
        rate[x] = (d_flux[x] - emf_V) / L;
    }
    rate[3] = (k->s * (R * i[0] + d_flux[0]) / k->around_ohm - i[3]) / k->tau_s;
    /* The terminals' currents are the magnetising ones and the fault's share, without a mean. */
    const double share[3] = {2.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0};
    for (int x = 0; x < 3; x++) {
        rate[x] += share[x] * k->s * rate[3];
    }
}

static void coil_step(const coils *k, double t_s, double h_s, double i[4])
{
    double k1[4], k2[4], k3[4], k4[4], at[4];
    coil_rates(k, t_s, i, k1);
    for (int n = 0; n < 4; n++) {
        at[n] = i[n] + 0.5 * h_s * k1[n];
    }
    coil_rates(k, t_s + 0.5 * h_s, at, k2);
    for (int n = 0; n < 4; n++) {
        at[n] = i[n] + 0.5 * h_s * k2[n];
    }
    coil_rates(k, t_s + 0.5 * h_s, at, k3);
    for (int n = 0; n < 4; n++) {
        at[n] = i[n] + h_s * k3[n];
    }
    coil_rates(k, t_s + h_s, at, k4);
    for (int n = 0; n < 4; n++) {
        i[n] += h_s / 6.0 * (k1[n] + 2.0 * (k2[n] + k3[n]) + k4[n]);
    }
}

/* One cycle from edge to edge. */
static void coil_cycle(coils *k, double t_s, const double duty[3], double i[4])
{
    double at[8] = {0.0, T_S};
    for (int x = 0; x < 3; x++) {
        at[2 + 2 * x] = 0.5 * T_S * (1.0 - duty[x]);
        at[3 + 2 * x] = 0.5 * T_S * (1.0 + duty[x]);
    }
    for (int n = 1; n < 8; n++) {
        for (int m = n; m > 0 && at[m] < at[m - 1]; m--) {
            const double other = at[m];
            at[m] = at[m - 1];
            at[m - 1] = other;
        }
    }
    for (int n = 0; n < 7; n++) {
        const double middle = 0.5 * (at[n] + at[n + 1]);
        for (int x = 0; x < 3; x++) {
            k->u_V[x] = fabs(middle - 0.5 * T_S) < 0.5 * T_S * duty[x] ? U_DC : 0.0;
        }
        for (int j = 0; j < 40; j++) {
            const double h_s = (at[n + 1] - at[n]) / 40.0;
            coil_step(k, t_s + at[n] + h_s * j, h_s, i);
        }
    }
}

static void a_short_agrees_with_the_phases_equations(void)
{
    const double omega = 900.0;
    const double duty[3] = {0.53, 0.5, 0.44};
    const int cycles = 60;
    plant_config c = with(drive(PSI, omega), "turn_short:turns=0.1,R=0.5,tau=6e-5,phase=1");
    plant p;
    plant_init(&p, &c);
    coils k = {.s = 0.1, .around_ohm = 0.5 + 0.1 * R, .tau_s = 6e-5, .omega = omega};
    double i[4] = {0.0, 0.0, 0.0, 0.0};
    double most = 0.0;
    double worst = 0.0;
    double fault = 0.0;
    for (int n = 0; n < cycles; n++) {
        plant_cycle(&p, duty, NULL, NULL, NULL);
        coil_cycle(&k, T_S * n, duty, i);
        const vec_ab expected = {i[0], (i[1] - i[2]) / sqrt(3.0)};
        worst = fmax(
            worst, hypot(p.state.y[STATE_I_ALPHA] - expected.alpha, p.state.y[STATE_I_BETA] - expected.beta));
        most = fmax(most, fabs(i[0]));
        fault = fmax(fault, fabs(i[3]));
    }
    TEST_ASSERT_TRUE(most > 10.0 && fault > 1.0);
    TEST_ASSERT_TRUE(worst < 1e-6 * most);
    const vec_ab sound = current_after(drive(PSI, omega), duty, cycles);
    TEST_ASSERT_TRUE(hypot(sound.alpha - i[0], sound.beta - (i[1] - i[2]) / sqrt(3.0)) > 1e-3 * most);
}

/* Of a direct current the shorted turns lie in parallel with the fault: a smaller resistance of that phase. */
static void a_short_is_a_resistance_at_standstill(void)
{
    const double duty[3] = {0.52, 0.49, 0.49};
    plant_config c[2] = {with(drive(0.0, 0.0), "turn_short:turns=0.2,R=1,tau=1e-4,phase=2"), drive(0.0, 0.0)};
    c[1].machine.dR_ohm[1] = -R * R * 0.2 * 0.2 / (1.0 + 0.2 * R);
    plant_means mean[2];
    for (int n = 0; n < 2; n++) {
        plant p;
        plant_init(&p, &c[n]);
        for (int k = 0; k < 400; k++) {
            plant_cycle(&p, duty, NULL, NULL, &mean[n]);
        }
    }
    TEST_ASSERT_TRUE(fabs(mean[1].i_ab_A.beta) > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, mean[1].i_ab_A.alpha, mean[0].i_ab_A.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, mean[1].i_ab_A.beta, mean[0].i_ab_A.beta);
}

/* Without current the legs see omega dpsi/dtheta of a flux that dips by a cosine over one of the pole pairs, or varies
 * with the shaft. */
static double flux_over(double theta, int axis, bool eccentric)
{
    double around = fmod(theta + 4.0 * VEC_PI, 4.0 * VEC_PI);
    around = around > 2.0 * VEC_PI ? around - 4.0 * VEC_PI : around;
    const double lost = fabs(around) < VEC_PI ? 0.3 * 0.5 * (1.0 + cos(around)) : 0.0;
    const double share = eccentric ? 1.0 + 0.1 * cos(0.5 * theta) : 1.0 - lost;
    return PSI * share * (axis == 0 ? cos(theta) : sin(theta));
}

static void flux_of_the_shaft(const char *effect, bool eccentric, double least)
{
    const double omega = 500.0;
    const plant_config c = with(drive(PSI, omega), effect);
    double weakest = 1.0;
    for (double theta = 0.05; theta < 4.0 * VEC_PI; theta += 0.1) {
        plant_state s = {.y = {[STATE_THETA_E] = theta, [STATE_OMEGA_E] = omega}};
        machine_terms t;
        machine_linearise(&c, &s, &t);
        for (int axis = 0; axis < 2; axis++) {
            const double slope =
                (flux_over(theta + 1e-5, axis, eccentric) - flux_over(theta - 1e-5, axis, eccentric)) / 2e-5;
            const double emf_V = -L * (axis == 0 ? t.drift_A_s.alpha : t.drift_A_s.beta);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * omega * PSI, omega * slope, emf_V);
        }
        weakest = fmin(weakest, hypot(flux_over(theta, 0, eccentric), flux_over(theta, 1, eccentric)) / PSI);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, least, weakest);
}

static void a_weak_pole_induces_its_flux(void)
{
    flux_of_the_shaft("weak_pole:share=0.3", false, 0.7);
    flux_of_the_shaft("eccentricity:share=0.1", true, 0.9);
}

/* What the three channels show of given currents. */
static void read_channels(const char *effect, const sensor_truth *truth, sensor_memory *m, double shown[3])
{
    const plant_config c = with(drive(PSI, 0.0), effect);
    plant_samples s;
    sensor_read(&c, m, truth, &s);
    memcpy(shown, s.i_A, sizeof s.i_A);
}

static sensor_truth truth_of(double a, double b, double c)
{
    return (sensor_truth){.i_A = {a, b, c}, .edge_age_s = {INFINITY, INFINITY, INFINITY}};
}

static void crosstalk_goes_on_to_the_next_channel(void)
{
    sensor_memory m;
    double shown[3];
    const sensor_truth truth = truth_of(3.0, -1.0, -2.0);
    sensor_init(&m, 1);
    read_channels("crosstalk:share=0.1", &truth, &m, shown);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, shown[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.7, shown[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -2.1, shown[2]);
}

static void hum_is_in_one_channel_or_in_all(void)
{
    sensor_memory m;
    double shown[3];
    sensor_truth truth = truth_of(3.0, -1.0, -2.0);
    truth.t_s = 0.005; /* a quarter of 50 Hz */
    sensor_init(&m, 1);
    read_channels("hum:amplitude=0.5,frequency=50,channel=2", &truth, &m, shown);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, shown[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.5, shown[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -2.0, shown[2]);
    read_channels("hum:amplitude=0.5,frequency=50", &truth, &m, shown);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.5, shown[0] + shown[1] + shown[2]);
}

static void a_core_plays(void)
{
    sensor_memory m;
    double shown[3];
    const double course[] = {0.0, 1.0, 2.0, 1.9, 1.7, 1.0, 1.15, 1.5};
    const double expected[] = {0.0, 0.8, 1.8, 1.8, 1.8, 1.2, 1.2, 1.3};
    sensor_init(&m, 1);
    for (int k = 0; k < 8; k++) {
        const sensor_truth truth = truth_of(course[k], 0.0, 0.0);
        read_channels("sensor_hysteresis:width=0.2", &truth, &m, shown);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[k], shown[0]);
    }
}

/* The mean over many edges: 1 A after a rise, -1 A after a fall, less by e for each time constant, a tenth in the others. */
static void edges_die_away(void)
{
    sensor_memory m;
    double sum[3] = {0.0, 0.0, 0.0};
    const int n = 20000;
    sensor_init(&m, 1);
    for (int k = 0; k < n; k++) {
        sensor_truth truth = truth_of(0.0, 0.0, 0.0);
        double shown[3];
        truth.edge_age_s[0] = 0.0;
        truth.edge_sign[0] = 1.0;
        truth.edge_age_s[1] = 1e-5;
        truth.edge_sign[1] = -1.0;
        read_channels("switching_noise:amplitude=1,tau=1e-5,coupling=0.1", &truth, &m, shown);
        for (int x = 0; x < 3; x++) {
            sum[x] += shown[x] / n;
        }
    }
    const double later = exp(-1.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0 - 0.1 * later, sum[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1 - later, sum[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1 - 0.1 * later, sum[2]);
}

/* The plant tells its sensors when each leg's last edge was, and which way. */
static void the_plant_knows_its_edges(void)
{
    const double duty[3] = {0.5, 0.2, 1.0};
    const plant_config c = with(drive(PSI, 0.0), "switching_noise:amplitude=1,tau=1e9,coupling=0");
    double first[3] = {0.0, 0.0, 0.0};
    plant p;
    plant_init(&p, &c);
    for (int k = 0; k < 200; k++) {
        plant_samples valley, peak;
        const vec_ab before = {p.state.y[STATE_I_ALPHA], p.state.y[STATE_I_BETA]};
        plant_cycle(&p, duty, &valley, &peak, NULL);
        for (int x = 0; x < 3 && k > 0; x++) {
            first[x] += (valley.i_A[x] - vec_phase(before, x)) / 199.0;
        }
    }
    /* Two legs fell before the valley, the third went up once for good. */
    TEST_ASSERT_DOUBLE_WITHIN(0.1, -1.0, first[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, -1.0, first[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0, first[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_short_agrees_with_the_phases_equations);
    RUN_TEST(a_short_is_a_resistance_at_standstill);
    RUN_TEST(a_weak_pole_induces_its_flux);
    RUN_TEST(crosstalk_goes_on_to_the_next_channel);
    RUN_TEST(hum_is_in_one_channel_or_in_all);
    RUN_TEST(a_core_plays);
    RUN_TEST(edges_die_away);
    RUN_TEST(the_plant_knows_its_edges);
    return UNITY_END();
}
