#include "diagnose_bench.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const double TWO_PI = 6.28318530717958647693;
enum { STEPS = 40 };

motor bench_motor(void)
{
    motor m = motor_blank();
    strcpy(m.name, "bench");
    m.pole_pairs = 3;
    m.R_ohm = 0.9;
    m.L_d_H = 0.008;
    m.L_q_H = 0.011;
    m.psi_f_Wb = 0.2;
    m.I_rated_A_rms = 6.0;
    m.n_max_rpm = 6000.0;
    m.f_pwm_Hz = 4000.0;
    m.u_dc_V = 565.0;
    return m;
}

/* splitmix64, and the normal by twelve uniforms: enough for noise. */
static double uniform(uint64_t *state)
{
    *state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

double bench_normal(uint64_t *state)
{
    double sum = -6.0;
    for (int k = 0; k < 12; k++) {
        sum += uniform(state);
    }
    return sum;
}

/* Of phases A, B, C at theta less 0, a third and two thirds of a turn, as a vector. */
static void magnet_flux(const motor *m, double theta, double flux[2])
{
    const bool harmonics = m->ext.has[CAUSE_EMF_HARMONICS];
    flux[0] = flux[1] = 0.0;
    for (int x = 0; x < 3; x++) {
        double from = theta - TWO_PI * x / 3.0;
        double own = m->psi_f_Wb * cos(from);
        if (harmonics) {
            own += m->ext.psi_5_Wb * cos(5.0 * from) + m->ext.psi_7_Wb * cos(7.0 * from) +
                   m->ext.psi_11_Wb * cos(11.0 * from) + m->ext.psi_13_Wb * cos(13.0 * from);
        }
        flux[0] += 2.0 / 3.0 * own * cos(TWO_PI * x / 3.0);
        flux[1] += 2.0 / 3.0 * own * sin(TWO_PI * x / 3.0);
    }
}

/*
 * Iron by its flux, x = flux less the magnet's: the gradient of an energy of x_d, x_q, and no polynomial of the current.
 * A bend is the share of the rated current that its term takes where that of the inductances alone is rated.
 */
static void current_of_iron(const bench *b, const double flux[2], double theta, double i[2])
{
    const motor *m = &b->m;
    const double c = cos(theta);
    const double s = sin(theta);
    const double d = (c * flux[0] + s * flux[1] - m->psi_f_Wb) / (m->L_d_H * motor_rated_peak_A(m));
    const double q = (c * flux[1] - s * flux[0]) / (m->L_q_H * motor_rated_peak_A(m));
    /* H = L_d d^2/2 (1 + bend_d d^2/2) + L_q q^2/2 (1 + bend_q q^4/3) + L_d bend_cross d^2 q^2/2; i_d = dH/dd / L_d */
    const double i_d = motor_rated_peak_A(m) * d * (1.0 + b->bend_d * d * d + b->bend_cross * q * q);
    const double i_q = motor_rated_peak_A(m) * q *
                       (1.0 + b->bend_q * q * q * q * q + b->bend_cross * d * d * m->L_d_H / m->L_q_H);
    i[0] = c * i_d - s * i_q;
    i[1] = s * i_d + c * i_q;
}

/*
 * d(total flux)/dt = u - R i, all stationary. The winding's current solves flux - magnet = (L(theta) + M) i, with M
 * the phases' own additions: of a phase x on the axis at angle a_x, 2/3 dL_x cos a_x cos a_x and so on.
 */
static void current_of(const motor *m, const double flux[2], double theta, double i[2])
{
    double c = cos(theta);
    double s = sin(theta);
    double aa = m->L_d_H * c * c + m->L_q_H * s * s;
    double ab = (m->L_d_H - m->L_q_H) * c * s;
    double bb = m->L_d_H * s * s + m->L_q_H * c * c;
    for (int x = 0; x < 3 && m->ext.has[CAUSE_PHASE_INDUCTANCE]; x++) {
        double along = cos(TWO_PI * x / 3.0);
        double across = sin(TWO_PI * x / 3.0);
        aa += 2.0 / 3.0 * m->ext.dL_H[x] * along * along;
        ab += 2.0 / 3.0 * m->ext.dL_H[x] * along * across;
        bb += 2.0 / 3.0 * m->ext.dL_H[x] * across * across;
    }
    double magnet[2];
    magnet_flux(m, theta, magnet);
    double alpha = flux[0] - magnet[0];
    double beta = flux[1] - magnet[1];
    double det = aa * bb - ab * ab;
    i[0] = (bb * alpha - ab * beta) / det;
    i[1] = (aa * beta - ab * alpha) / det;
}

static void bench_current(const bench *b, const double flux[2], double theta, double i[2])
{
    if (b->bend_d != 0.0 || b->bend_q != 0.0 || b->bend_cross != 0.0) {
        current_of_iron(b, flux, theta, i);
    } else {
        current_of(&b->m, flux, theta, i);
    }
}

/* State: total flux (alpha, beta), the current in the iron, which is measured with the winding's, and what the sensors'
 * filter has let through. */
enum { STATES = 6 };

static void to_phases(const double ab[2], double x[3])
{
    x[0] = ab[0];
    x[1] = -0.5 * ab[0] + 0.86602540378443865 * ab[1];
    x[2] = -0.5 * ab[0] - 0.86602540378443865 * ab[1];
}

/* What dead time takes of each leg's voltage, or a compensation adds, and what a phase's own resistance does, as a vector. */
static void lost_by_legs(const motor *m, const double i_ab[2], double lost[2])
{
    double i[3];
    to_phases(i_ab, i);
    lost[0] = lost[1] = 0.0;
    for (int p = 0; p < 3; p++) {
        double V = 0.0;
        if (m->ext.has[CAUSE_DEAD_TIME]) {
            V += m->ext.v_dead_V * fmin(fmax(i[p] / m->ext.i_knee_A, -1.0), 1.0);
        }
        if (m->ext.has[CAUSE_PHASE_ASYMMETRY]) {
            V += m->ext.dR_ohm[p] * i[p];
        }
        lost[0] += 2.0 / 3.0 * V * cos(TWO_PI * p / 3.0);
        lost[1] += 2.0 / 3.0 * V * sin(TWO_PI * p / 3.0);
    }
}

static void slope(const bench *b, const double state[STATES], double theta, const double u[2],
                  double out[STATES])
{
    double i[2];
    double lost[2];
    bench_current(b, state, theta, i);
    lost_by_legs(&b->m, i, lost);
    const double c = cos(theta);
    const double s = sin(theta);
    const double along_d = b->product_V_A2 * (c * i[0] + s * i[1]) * (c * i[1] - s * i[0]);
    const double along_q = b->cogging_V * cos(9.0 * theta);
    lost[0] -= c * along_d - s * along_q;
    lost[1] -= s * along_d + c * along_q;
    for (int x = 0; x < 2; x++) {
        double iron = state[2 + x];
        out[x] = u[x] - lost[x] - b->m.R_ohm * (i[x] + iron);
        out[2 + x] = b->R_iron_ohm > 0.0 ? (out[x] / b->R_iron_ohm - iron) / b->tau_iron_s : 0.0;
        out[4 + x] = b->filter_s > 0.0 ? (i[x] + iron - state[4 + x]) / b->filter_s : 0.0;
    }
}

/* One cycle under `u`; its first `steps_late` steps are still under `late`. */
/*
 * The mean of a leg-switched voltage from `from` to `to` of the cycle: each leg is high around its middle. What is sampled
 * at the cycle's ends then is the mean current, but an iron that follows within a cycle sees no pulse there.
 */
static void switched(const bench *b, const double u[2], double from, double to, double out[2])
{
    double phase[3];
    double least = INFINITY;
    double most = -INFINITY;
    out[0] = out[1] = 0.0;
    for (int x = 0; x < 3; x++) {
        phase[x] = u[0] * cos(TWO_PI * x / 3.0) + u[1] * sin(TWO_PI * x / 3.0);
        least = fmin(least, phase[x]);
        most = fmax(most, phase[x]);
    }
    for (int x = 0; x < 3; x++) {
        const double duty = 0.5 + (phase[x] - 0.5 * (least + most)) / b->m.u_dc_V;
        const double on = fmin(to, 0.5 + 0.5 * duty) - fmax(from, 0.5 - 0.5 * duty);
        const double leg = b->m.u_dc_V * fmax(on, 0.0) / (to - from);
        out[0] += 2.0 / 3.0 * leg * cos(TWO_PI * x / 3.0);
        out[1] += 2.0 / 3.0 * leg * sin(TWO_PI * x / 3.0);
    }
}

static void cycle(const bench *b, double state[STATES], double *theta, double omega, double T,
                  const double late[2], long steps_late, const double now[2])
{
    double h = T / STEPS;
    for (int k = 0; k < STEPS; k++) {
        const double *mean = k < steps_late ? late : now;
        double u[2] = {mean[0], mean[1]};
        if (b->R_iron_ohm > 0.0 || b->filter_s > 0.0) {
            switched(b, mean, (double)k / STEPS, (double)(k + 1) / STEPS, u);
        }
        double k1[STATES], k2[STATES], k3[STATES], k4[STATES], at[STATES];
        slope(b, state, *theta, u, k1);
        for (int x = 0; x < STATES; x++) {
            at[x] = state[x] + 0.5 * h * k1[x];
        }
        slope(b, at, *theta + 0.5 * omega * h, u, k2);
        for (int x = 0; x < STATES; x++) {
            at[x] = state[x] + 0.5 * h * k2[x];
        }
        slope(b, at, *theta + 0.5 * omega * h, u, k3);
        for (int x = 0; x < STATES; x++) {
            at[x] = state[x] + h * k3[x];
        }
        slope(b, at, *theta + omega * h, u, k4);
        for (int x = 0; x < STATES; x++) {
            state[x] += h / 6.0 * (k1[x] + 2.0 * k2[x] + 2.0 * k3[x] + k4[x]);
        }
        *theta += omega * h;
    }
}

static double *column(size_t rows)
{
    double *x = calloc(rows, sizeof *x);
    if (!x) {
        abort();
    }
    return x;
}

static void allocate(recording *r, const bench *b)
{
    const size_t rows = (size_t)BENCH_RUNS * BENCH_ROWS;
    *r = (recording){.rows = rows, .T_s = 1.0 / b->m.f_pwm_Hz, .i_c_measured = !b->two_sensors};
    r->t_s = column(rows);
    r->theta_e_rad = column(rows);
    r->omega_e_rad_s = column(rows);
    r->temp_C = b->swing_K != 0.0 ? column(rows) : NULL;
    for (int x = 0; x < 3; x++) {
        r->i_A[x] = column(rows);
        r->u_V[x] = column(rows);
    }
    r->run = calloc(rows, sizeof *r->run);
    r->line = calloc(rows, sizeof *r->line);
    r->stretch = calloc(BENCH_RUNS, sizeof *r->stretch);
    r->stretches = BENCH_RUNS;
    if (!r->run || !r->line || !r->stretch) {
        abort();
    }
}

/* From the middle of the recording, where the value of a drift is defined. */
static double middle_s(double T_s)
{
    double sum = 0.0;
    for (size_t run = 0; run < BENCH_RUNS; run++) {
        sum += 2.0 * (double)run + 0.5 * (double)(BENCH_ROWS - 1) * T_s;
    }
    return sum / BENCH_RUNS;
}

/* What the sensors make of the true current and angle. */
static void sense(const bench *b, recording *r, size_t k, const double i_ab[2], double theta, double omega,
                  uint64_t *random)
{
    const motor_extension *x = &b->m.ext;
    double i[3];
    to_phases(i_ab, i);
    for (int p = 0; p < 3; p++) {
        double from = r->t_s[k] - middle_s(r->T_s);
        double g = x->has[CAUSE_CURRENT_GAIN] ? x->g[p] + x->g_rate_s[p] * from : 1.0;
        double o = x->has[CAUSE_CURRENT_OFFSET] ? x->o_A[p] + x->o_rate_A_s[p] * from : 0.0;
        r->i_A[p][k] = g * i[p] + o + b->noise_A * bench_normal(random);
    }
    if (b->fault_share > 0.0 && uniform(random) < b->fault_share) {
        r->i_A[b->fault_phase][k] += b->fault_A;
    }
    if (b->two_sensors) {
        r->i_A[2][k] = -r->i_A[0][k] - r->i_A[1][k];
    }
    double shown = theta + (x->has[CAUSE_ANGLE_OFFSET] ? x->theta_0_rad : 0.0) +
                   (x->has[CAUSE_ANGLE_DELAY] ? x->t_delay_s * omega : 0.0);
    if (x->has[CAUSE_ANGLE_HARMONIC]) {
        shown += x->harmonic_amplitude_rad *
                 cos(x->harmonic_order * theta / b->m.pole_pairs + x->harmonic_phase_rad);
    }
    if (x->has[CAUSE_ANGLE_HARMONIC_2]) {
        shown += x->harmonic_2_amplitude_rad *
                 cos(x->harmonic_2_order * theta / b->m.pole_pairs + x->harmonic_2_phase_rad);
    }
    r->theta_e_rad[k] = shown - TWO_PI * floor(shown / TWO_PI);
    r->omega_e_rad_s[k] = omega;
}

static double speed_at(const bench *b, double speed, double t_s)
{
    return speed * (1.0 + b->swing * sin(TWO_PI * b->swing_Hz * t_s));
}

/* Warm, then cooled, then warm again, so that no drift in time is like it. */
static double bench_temperature_C(const bench *b, double from)
{
    return b->mean_C + b->swing_K * sin(0.9 * from);
}

/* The bench as it is so long after the recording's middle; a magnet that weakens takes its flux with it. */
static bench drifted(const bench *b, double from)
{
    bench now = *b;
    now.m.R_ohm += b->m.ext.has[CAUSE_RESISTANCE] ? b->m.ext.R_rate_ohm_s * from : 0.0;
    now.m.psi_f_Wb += b->m.ext.has[CAUSE_FLUX_LINKAGE] ? b->m.ext.psi_rate_Wb_s * from : 0.0;
    if (b->m.ext.has[CAUSE_TEMPERATURE]) {
        now.m.R_ohm *= 1.0 + b->m.ext.alpha_R * (bench_temperature_C(b, from) - b->mean_C);
        now.m.psi_f_Wb *= 1.0 + b->m.ext.alpha_psi * (bench_temperature_C(b, from) - b->mean_C);
    }
    return now;
}

recording bench_record(const bench *b)
{
    static const double speed[BENCH_RUNS] = {60.0, 300.0, -500.0, 900.0, 1300.0, -150.0};
    static const double i_d[BENCH_RUNS] = {0.0, -2.0, -1.0, -2.0, -4.0, 1.0};
    static const double i_q[BENCH_RUNS] = {4.0, -3.0, 5.0, 3.0, 2.0, 6.0};
    uint64_t random = b->seed;
    recording r;
    allocate(&r, b);
    for (size_t run = 0; run < BENCH_RUNS; run++) {
        double omega = speed_at(b, speed[run], 2.0 * (double)run);
        double seen = omega; /* what has come through the speed's filter */
        double theta = 0.4 + (double)run;
        bench now = drifted(b, 2.0 * (double)run - middle_s(r.T_s));
        const motor *m = &now.m;
        double state[STATES] = {0.0};
        magnet_flux(m, theta, state);
        double step[2] = {0.0, 0.0};
        double before[3][2] = {{0.0, 0.0}}; /* commands of this cycle and of the two before */
        double held[2] = {0.0, 0.0};        /* what acts */
        r.stretch[run] = (stretch){run * BENCH_ROWS, BENCH_ROWS, (long)run + 1};
        for (size_t j = 0; j < BENCH_ROWS; j++) {
            size_t k = run * BENCH_ROWS + j;
            double i_ab[2];
            r.t_s[k] = 2.0 * (double)run + (double)j * r.T_s;
            omega = speed_at(b, speed[run], r.t_s[k]);
            now = drifted(b, r.t_s[k] - middle_s(r.T_s));
            if (r.temp_C) {
                r.temp_C[k] = bench_temperature_C(b, r.t_s[k] - middle_s(r.T_s));
            }
            bench_current(&now, state, theta, i_ab);
            i_ab[0] += state[2];
            i_ab[1] += state[3];
            if (j == 0) {
                state[4] = i_ab[0];
                state[5] = i_ab[1];
            }
            sense(b, &r, k, b->filter_s > 0.0 ? state + 4 : i_ab, theta, omega, &random);
            /* A cycle turns by the speed of its middle, which its filter sees throughout. */
            omega = speed_at(b, speed[run], r.t_s[k] + 0.5 * r.T_s);
            if (b->speed_filter_s > 0.0) {
                r.omega_e_rad_s[k] = seen;
                seen += (omega - seen) * -expm1(-r.T_s / b->speed_filter_s);
            }
            r.run[k] = (long)run + 1;
            r.line[k] = (long)k + 2;
            /* The steady voltage, a proportional pull towards the operating point, and a step every thirty
             * cycles. */
            double late = m->ext.has[CAUSE_VOLTAGE_DELAY] ? m->ext.voltage_delay_cycles : 0.0;
            double ahead = (0.5 + late) * omega * r.T_s; /* to where the voltage acts */
            double c = cos(theta + ahead);
            double s = sin(theta + ahead);
            double d = i_ab[0] * cos(theta) + i_ab[1] * sin(theta);
            double q = i_ab[1] * cos(theta) - i_ab[0] * sin(theta);
            if (j % 30 == 0) {
                step[0] = 6.0 * bench_normal(&random);
                step[1] = 6.0 * bench_normal(&random);
            }
            double u_d = m->R_ohm * i_d[run] - omega * m->L_q_H * q + 5.0 * (i_d[run] - d) + step[0];
            double u_q =
                m->R_ohm * i_q[run] + omega * (m->L_d_H * d + m->psi_f_Wb) + 5.0 * (i_q[run] - q) + step[1];
            double u_ab[2] = {u_d * c - u_q * s, u_d * s + u_q * c};
            double applied[2][2]; /* this cycle's, and what still acts at its start */
            double k_u = m->ext.has[CAUSE_VOLTAGE_GAIN] ? m->ext.k_u : 1.0;
            double ripple = 1.0 + b->unlogged_ripple * sin(TWO_PI * 300.0 * r.t_s[k]);
            /* A cycle whose update was missed: the last one's command acts on. */
            const bool misses = j > 0 && b->missed_share > 0.0 && uniform(&random) < b->missed_share;
            size_t whole = late < 2.0 ? (size_t)late : 1;
            double phase[3];
            to_phases(u_ab, phase);
            for (int p = 0; p < 3; p++) {
                r.u_V[p][k] = phase[p];
            }
            for (int x = 0; x < 2; x++) {
                before[2][x] = before[1][x];
                before[1][x] = before[0][x];
                before[0][x] = u_ab[x];
                applied[1][x] = k_u * ripple * held[x];
                held[x] = misses ? held[x] : before[whole][x];
                applied[0][x] = k_u * ripple * held[x];
            }
            cycle(&now, state, &theta, omega, r.T_s, applied[1], lround(STEPS * (late - (double)whole)),
                  applied[0]);
        }
    }
    return r;
}
