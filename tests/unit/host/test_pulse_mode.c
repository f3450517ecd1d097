/*
 * A drive through all pulse modes and back: carrier, synchronous carrier, patterns of 9, 7 and 5 pulses, six-step. The library's fixed point
 * controls a switching machine, whose current is solved exactly from edge to edge. The drive of the 2019 paper at 565 V, with a fixed
 * carrier of 2.5 kHz and a control cycle of 0.1 ms for the patterns. Currents are shares of the rated one; without saliency i_q is the
 * torque. The speed that selects the mode has noise.
 */
#include "iqfoc/params.h"
#include "iqfoc/pulse_mode.h"
#include "iqfoc/synchronous_carrier.h"
#include "patterns/patterns.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

#define TWO_PI    6.28318530717958647692
#define R_OHM     0.75
#define L_H       5.2e-3
#define PSI_WB    0.134
#define I_BASE_A  14.849
#define U_DC_V    565.0
#define CARRIER_S 4e-4
#define TICKS     40000
#define PATTERN_S 1e-4
#define P_TICKS   10000
#define LEAST     0.05 /* pattern cycles */
#define RIPPLE    0.01
#define RIPPLE_HZ 300.0
#define NOISE_HZ  2.0 /* of the speed that selects the mode */
#define LOW_HZ    100.0
#define HIGH_HZ   450.0
#define RAMP_S    1.0
#define TOP_S     0.2
#define TOTAL_S   (2.0 * RAMP_S + TOP_S)
#define DT_S      1e-5
#define LINEAR    0.98 /* index up to which the patterns are used */

enum { TABLES = 3, SAMPLES = 221000 };

static const int pulses_of[TABLES] = {9, 7, 5};
static iqfoc_pattern_row_t rows[TABLES][PATTERNS_ROWS];
static iqfoc_pattern_t tables[TABLES];

#define HZ(f) IQ24((f)*PATTERN_S)
static const iqfoc_pulse_level_t levels[] = {
    {NULL, 0, 0, 0, 0},
    {&tables[0], HZ(275.0), HZ(265.0), 0, 0},
    {&tables[1], HZ(300.0), HZ(290.0), 0, 0},
    {&tables[2], HZ(330.0), HZ(320.0), 0, 0},
    {&iqfoc_pattern_six_step, HZ(345.0), HZ(335.0), IQ24_ONE, IQ24(LINEAR)}};
static const iqfoc_pulse_config_t config = {levels, 5, P_TICKS};
enum { SIX_STEP = 4 };

static const iqfoc_synchronous_level_t carrier_levels[] = {{0, 0, 0},
                                                           {21, IQ24(1.0 / 21.0), IQ24(0.95 / 21.0)},
                                                           {15, IQ24(1.0 / 15.0), IQ24(0.95 / 15.0)},
                                                           {9, IQ24(0.095), IQ24(0.09)}};
static const iqfoc_synchronous_config_t carrier_config = {
    carrier_levels, 4, TICKS, TICKS / 8, 2 * TICKS, IQ24_ONE, IQ24(0.125), IQ24(1.0 / 6.0)};
static const iqfoc_cycle_config_t base = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, CARRIER_S, I_BASE_A, U_DC_V),
    .gains = IQFOC_GAINS(1000.0, R_OHM, L_H, L_H, PSI_WB, CARRIER_S, I_BASE_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .span_max = IQ24_ONE,
    .current_limit = IQ24(4.0),
    .period_ticks = TICKS,
    .tolerance_ticks = TICKS / 10,
    .stale_ticks = TICKS / 4,
    .deadline_ticks = TICKS / 2};
static const iqfoc_pattern_control_config_t control_config = {
    IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, PATTERN_S, I_BASE_A, U_DC_V), IQ24(0.1), IQ24(0.02)};

void setUp(void)
{
}

void tearDown(void)
{
}

static iq24_t to_iq24(double x)
{
    return (iq24_t)lround(x * 16777216.0);
}

static double to_double(iq24_t x)
{
    return x / 16777216.0;
}

static void find_tables(void)
{
    for (int n = 0; n < TABLES; n++) {
        static patterns_result found;
        const patterns_request asked = {.pulses = pulses_of[n]};
        error e;
        TEST_ASSERT_TRUE(patterns_find(&asked, &found, &e));
        for (int k = 0; k < found.rows; k++) {
            const patterns_row *from = &found.row[k];
            rows[n][k].start = from->shape.start;
            rows[n][k].joined = from->joined ? 1 : 0;
            for (int j = 0; j < from->shape.angles; j++) {
                rows[n][k].angle[j] = to_iq24(from->shape.angle[j] / TWO_PI);
            }
        }
        const iqfoc_pattern_t t = {rows[n], found.rows, (pulses_of[n] - 1) / 2, IQ24(0.3), IQ24(100.0)};
        tables[n] = t;
    }
}

/* ---- The machine ---- */

typedef struct sample_row {
    double i_q, turn_s;
    int mode;  /* 0 ... 3: level of the carrier; 4 and above: patterns */
    int jumps; /* of the angles between two rows, so far */
} sample_row;

typedef struct drive {
    double ripple;    /* of the link, as a share */
    double time_s;    /* of the present valley, and within its cycle */
    double w;         /* electrical speed of the present cycle, rad/s */
    double theta;     /* rad, at time_s */
    double complex i; /* A, stationary frame */
    int level[3];
    double since_s[3]; /* time of the last edge */
    double shortest_s; /* time between two edges of a leg */
    int mode, jumps;
    long samples;
} drive;

static sample_row sampled[SAMPLES];

static double link_V(const drive *d, double time_s)
{
    return U_DC_V * (1.0 + d->ripple * sin(TWO_PI * RIPPLE_HZ * time_s));
}

/* The exact solution under a constant voltage and speed. */
static void flow(drive *d, double to_s)
{
    const double dt = to_s - d->time_s;
    if (dt > 0.0) {
        double complex u = 0.0;
        for (int k = 0; k < 3; k++) {
            u += d->level[k] / 3.0 * cexp(I * TWO_PI / 3.0 * k);
        }
        u *= link_V(d, d->time_s + 0.5 * dt);
        const double complex emf = -I * d->w * PSI_WB / (R_OHM + I * d->w * L_H);
        const double complex before = u / R_OHM + emf * cexp(I * d->theta);
        d->theta += d->w * dt;
        d->i = u / R_OHM + emf * cexp(I * d->theta) + (d->i - before) * exp(-R_OHM * dt / L_H);
        d->time_s = to_s;
    }
}

/* To this time, with a sample each DT_S. */
static void advance(drive *d, double to_s)
{
    while (d->samples < SAMPLES && (double)d->samples * DT_S <= to_s) {
        flow(d, (double)d->samples * DT_S);
        const sample_row row = {cimag(d->i * cexp(-I * d->theta)) / I_BASE_A, TWO_PI / fabs(d->w), d->mode,
                                d->jumps};
        sampled[d->samples++] = row;
    }
    flow(d, to_s);
}

static void switch_leg(drive *d, int k, int level)
{
    if (d->level[k] != level) {
        d->level[k] = level;
        d->shortest_s = fmin(d->shortest_s, d->time_s - d->since_s[k]);
        d->since_s[k] = d->time_s;
    }
}

/* A cycle with these edges. */
static void play(drive *d, const iqfoc_pattern_edges_t edges[3], double length_s)
{
    const double begin_s = d->time_s;
    int next[3] = {0};
    for (int k = 0; k < 3; k++) {
        switch_leg(d, k, edges[k].level);
    }
    while (true) {
        int first = -1;
        double at = 1.0;
        for (int k = 0; k < 3; k++) {
            if (next[k] < edges[k].edges && to_double(edges[k].at[next[k]]) < at) {
                first = k;
                at = to_double(edges[k].at[next[k]]);
            }
        }
        advance(d, begin_s + at * length_s);
        if (first < 0) {
            return;
        }
        switch_leg(d, first, -d->level[first]);
        next[first]++;
    }
}

/* Centred pulses as edges. */
static void centred(iqfoc_abc_t high, iqfoc_pattern_edges_t edges[3])
{
    const iq24_t share[3] = {high.a, high.b, high.c};
    for (int k = 0; k < 3; k++) {
        edges[k].level = share[k] >= IQ24_ONE ? 1 : -1;
        edges[k].high = share[k];
        edges[k].edges = share[k] > 0 && share[k] < IQ24_ONE ? 2 : 0;
        edges[k].at[0] = (IQ24_ONE - share[k]) / 2;
        edges[k].at[1] = IQ24_ONE - edges[k].at[0];
    }
}

/* ---- The reference ---- */

static double index_of(double w, double i_d, double i_q)
{
    const double complex i = (i_d + I * i_q) * I_BASE_A;
    return cabs(R_OHM * i + I * w * (PSI_WB + L_H * i)) / U_DC_V * TWO_PI / 4.0;
}

/* i_d at which the index is this. */
static double weakening(double w, double i_q, double index)
{
    double low = -1.7;
    double high = 0.5;
    for (int n = 0; n < 40; n++) {
        const double middle = 0.5 * (low + high);
        const bool above = index_of(w, middle, i_q) > index;
        high = above ? middle : high;
        low = above ? low : middle;
    }
    return low;
}

/* ---- Run-up ---- */

/* Largest torque errors, percent of the rated torque, within a turn of an event or with none there. */
typedef enum kind {
    CARRIER,
    TO_PATTERN,
    TO_CARRIER,
    PATTERNS,
    TO_SIX_STEP,
    FROM_SIX_STEP,
    JUMP,
    TOP,
    KINDS
} kind;

static const char *const kind_names[KINDS] = {
    [CARRIER] = "carrier, its periods per turn change",
    [TO_PATTERN] = "carrier to 9 pulses",
    [TO_CARRIER] = "9 pulses to carrier",
    [PATTERNS] = "between 9, 7 and 5 pulses",
    [TO_SIX_STEP] = "5 pulses to six-step",
    [FROM_SIX_STEP] = "six-step to 5 pulses",
    [JUMP] = "jump of the angles in a table",
    [TOP] = "six-step at constant speed",
};

static double worst_of[2][KINDS]; /* constant link, ripple */

/* Mean torque with weights 1 + cos over 2/3 of a turn, in which all harmonics of the modes vanish. */
static double mean_torque(long k, long half)
{
    double sum = 0.0;
    double weights = 0.0;
    for (long n = -half; n <= half; n++) {
        const double weight = 1.0 + cos(TWO_PI / 2.0 * (double)n / ((double)half + 0.5));
        sum += weight * sampled[k + n].i_q;
        weights += weight;
    }
    return sum / weights;
}

static kind kind_of(const sample_row *before, const sample_row *after)
{
    enum { LAST_CARRIER = 3, FIRST = 4, LAST = 7 };
    if (before->mode <= LAST_CARRIER) {
        return after->mode <= LAST_CARRIER ? CARRIER : TO_PATTERN;
    }
    if (after->mode <= LAST_CARRIER) {
        return TO_CARRIER;
    }
    if (before->jumps != after->jumps) {
        return JUMP;
    }
    if (before->mode == after->mode) {
        return before->mode == LAST ? TOP : PATTERNS;
    }
    return after->mode == LAST ? TO_SIX_STEP : before->mode == LAST ? FROM_SIX_STEP : PATTERNS;
}

static void measure(const drive *d, double wanted, double worst[KINDS])
{
    for (long k = 4000; k < d->samples - 4000; k += 5) {
        const long turn = lround(sampled[k].turn_s / DT_S);
        const kind what = kind_of(&sampled[k - turn], &sampled[k + turn]);
        worst[what] =
            fmax(worst[what], 100.0 * fabs(mean_torque(k, lround(sampled[k].turn_s / 3.0 / DT_S)) - wanted));
    }
}

typedef struct firmware {
    iqfoc_synchronous_carrier_t carrier;
    iqfoc_cycle_t cycle;
    iqfoc_pattern_control_t control;
    iqfoc_pulse_mode_t mode;
    iqfoc_cycle_config_t set[3];
    iqfoc_pattern_edges_t acting[3], next[3];
    uint32_t time, ticks; /* of the present cycle */
    bool patterns;        /* act in the present cycle */
    bool resumes;
} firmware;

static void start(firmware *f)
{
    const iqfoc_abc_t half = {IQ24(0.5), IQ24(0.5), IQ24(0.5)};
    memset(f, 0, sizeof *f);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_synchronous_carrier_init(&f->carrier, &carrier_config));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&f->cycle, &base));
    TEST_ASSERT_EQUAL_INT(
        IQFOC_OK, iqfoc_pattern_control_init(&f->control, &control_config, &tables[0], to_iq24(LEAST)));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pulse_mode_init(&f->mode, &config));
    f->cycle.enabled = true;
    f->ticks = TICKS;
    centred(half, f->acting);
}

/* The interrupts of a cycle; returns the length of the next one. */
static uint32_t interrupts(firmware *f, const drive *d, uint32_t n)
{
    const double length_s = f->ticks * CARRIER_S / TICKS;
    const double complex i = d->i / I_BASE_A;
    const iqfoc_ab_t ab = {to_iq24(creal(i)), to_iq24(cimag(i))};
    iqfoc_sample_t sample = {.i = iqfoc_clarke_inverse(ab),
                             .theta = to_iq24(d->theta / TWO_PI - floor(d->theta / TWO_PI)),
                             .turns = to_iq24(d->w * length_s / TWO_PI),
                             .u_dc = to_iq24(link_V(d, d->time_s) / U_DC_V),
                             .time = f->time};
    iqfoc_cycle_config_t *set = &f->set[n % 3];
    const uint32_t ticks = iqfoc_synchronous_carrier_step(&f->carrier, sample.theta, sample.turns);
    iqfoc_synchronous_carrier_set(&base, ticks, set);
    if (f->patterns) {
        iqfoc_duties_t duties;
        iqfoc_pattern_control_aim(&f->control, f->cycle.i_ref, sample.turns);
        if (iqfoc_pulse_mode_to_carrier(&f->mode, &f->control, &f->cycle, set, ab, sample.theta, sample.u_dc,
                                        f->next, &duties)) {
            TEST_ASSERT_EQUAL_INT32(IQ24_ONE, duties.scale);
            centred(duties.high, f->next);
            f->patterns = false;
            f->resumes = true;
            return ticks;
        }
    } else {
        const iqfoc_abc_t high = {f->acting[0].high, f->acting[1].high, f->acting[2].high};
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_offer(&f->cycle, set));
        (void)iqfoc_cycle_valley(&f->cycle, &sample, f->time);
        if (f->resumes) {
            iqfoc_pulse_mode_resume(&f->control, &f->cycle);
            f->resumes = false;
        }
        iqfoc_synchronous_carrier_keep_flux(&f->cycle);
        f->patterns =
            iqfoc_pulse_mode_to_pattern(&f->mode, &f->control, &f->cycle, high, sample.u_dc, f->next);
        if (!f->patterns) {
            const double mid = (d->theta + 0.5 * d->w * length_s) / TWO_PI;
            sample.theta = to_iq24(mid - floor(mid));
            sample.u_dc = to_iq24(link_V(d, d->time_s + 0.5 * length_s) / U_DC_V);
            sample.at = IQ24(0.5);
            sample.time = f->time + f->ticks / 2;
            const iqfoc_command_t command = iqfoc_cycle_peak(&f->cycle, &sample, IQ24(1.5), sample.time);
            centred(command.duties.high, f->next);
            return ticks;
        }
    }
    f->carrier.ticks = P_TICKS;
    return P_TICKS;
}

/* Up through all modes and down again. way: of rotation. angle: of the rotor at the start, turns. */
static void run_up(double i_q, bool ripple, double way, double angle)
{
    static firmware f;
    drive d = {.ripple = ripple ? RIPPLE : 0.0,
               .i = I * i_q * I_BASE_A * cexp(I * TWO_PI * angle),
               .theta = TWO_PI * angle,
               .level = {-1, -1, -1},
               .since_s = {-1.0, -1.0, -1.0},
               .shortest_s = 1.0};
    int changes = 0;
    int highest = 0;
    start(&f);
    srand(1);
    for (uint32_t n = 0; d.time_s < TOTAL_S; n++) {
        const double length_s = f.ticks * CARRIER_S / TICKS;
        const double from_top_s = fmax(fabs(d.time_s - 0.5 * TOTAL_S) - 0.5 * TOP_S, 0.0);
        const double hz = HIGH_HZ - (HIGH_HZ - LOW_HZ) / RAMP_S * from_top_s;
        const double noisy_hz = hz + NOISE_HZ * (2.0 * rand() / RAND_MAX - 1.0);
        d.w = way * TWO_PI * hz;
        const double needed = index_of(d.w, 0.0, i_q);
        const int before = f.mode.level;
        const int start_before = f.control.trajectory.start;
        iqfoc_pulse_mode_step(&f.mode, &f.control, to_iq24(way * noisy_hz * PATTERN_S), to_iq24(needed));
        const bool six_step = f.mode.level == SIX_STEP;
        const double i_d = needed > LINEAR || six_step ? weakening(d.w, i_q, six_step ? 1.0 : LINEAR) : 0.0;
        f.cycle.i_ref.d = to_iq24(i_d);
        f.cycle.i_ref.q = to_iq24(i_q);
        const iqfoc_pattern_t *table = f.control.modulator.table;
        const int32_t row = f.control.modulator.row;
        const uint32_t next_ticks = interrupts(&f, &d, n);
        const bool jumped = table == f.control.modulator.table && f.control.modulator.row != row &&
                            f.control.trajectory.start != start_before;
        d.jumps += jumped ? 1 : 0;
        d.mode = f.patterns ? 3 + f.mode.level : f.carrier.level;
        changes += f.mode.level != before ? 1 : 0;
        highest = f.mode.level > highest ? f.mode.level : highest;
        play(&d, f.acting, length_s);
        memcpy(f.acting, f.next, sizeof f.acting);
        f.time += f.ticks;
        f.ticks = next_ticks;
    }
    TEST_ASSERT_EQUAL_INT(SIX_STEP, highest);
    TEST_ASSERT_EQUAL_INT(2 * SIX_STEP, changes);
    TEST_ASSERT_EQUAL_INT32(0, f.mode.level);
    TEST_ASSERT_EQUAL_HEX32(0, f.cycle.status);
    TEST_ASSERT_TRUE(d.shortest_s >= LEAST * PATTERN_S - 1e-9);
    measure(&d, i_q, worst_of[ripple ? 1 : 0]);
}

static void print_table(void)
{
    printf("| torque off by, %% of the rated torque, at most | constant link | link +-1 %% at 300 Hz |\n"
           "| --- | ---: | ---: |\n");
    for (int k = 0; k < KINDS; k++) {
        printf("| %s | %.2f | %.2f |\n", kind_names[k], worst_of[0][k], worst_of[1][k]);
    }
}

/*
 * Each level once up and once down. With a constant link the torque stays within 2 % of the rated one, but for jumps within a table. A
 * ripple of the link is a voltage error r u, which makes a flux r u/omega_r if nothing corrects it: that is added.
 */
static void test_torque_through_all_modes(void)
{
    static const double i_q[] = {1.0, 0.5, -0.6, 1.0};
    static const double index[KINDS] = {
        [CARRIER] = 0.75,    [TO_PATTERN] = 0.75,   [TO_CARRIER] = 0.75, [PATTERNS] = LINEAR,
        [TO_SIX_STEP] = 1.0, [FROM_SIX_STEP] = 1.0, [JUMP] = LINEAR,     [TOP] = 1.0};
    for (int n = 0; n < 24; n++) {
        run_up(i_q[n / 2 % 4], n % 2 != 0, n / 2 % 4 == 3 ? -1.0 : 1.0, (n / 8) / 9.0);
    }
    print_table();
    for (int k = 0; k < KINDS; k++) {
        const double u_V = index[k] * U_DC_V / (TWO_PI / 4.0);
        const double by_ripple = 100.0 * RIPPLE * u_V / (TWO_PI * RIPPLE_HZ) / (L_H * I_BASE_A);
        const double most = k == JUMP ? 3.0 : 2.0;
        TEST_ASSERT_TRUE(worst_of[0][k] <= most);
        TEST_ASSERT_TRUE(worst_of[1][k] <= most + by_ripple);
    }
    TEST_ASSERT_TRUE(worst_of[0][TOP] <= 0.5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(find_tables);
    RUN_TEST(test_torque_through_all_modes);
    return UNITY_END();
}
