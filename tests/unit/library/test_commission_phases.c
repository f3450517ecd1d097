/*
 * Self-commissioning phase by phase: currents that the test makes, so that each command, each block's mean and each result has an exact value.
 * The references are the formulas of commission.h in double on the same samples; test_commission.c runs whole drives.
 */
#include "../../../src/commission_fit.h"
#include "../../../src/commission_phases.h"
#include "reference_vectors.h"

#include <stdbool.h>
#include <string.h>

#define N     IQFOC_COMMISSION_BLOCKS
#define LSB   (1.0 / 16777216.0)
#define DRAWS 40

#define near(tolerance, want, got) TEST_ASSERT_DOUBLE_WITHIN(tolerance, want, to_double(got))

static iqfoc_commission_config_t config;
static iqfoc_commission_t c;
static iqfoc_command_t command;
static double complex i_now; /* of the last step, as its sample had it */
static double u_dc;
static uint64_t seed;

void setUp(void)
{
    seed = UINT64_C(20261126);
}

void tearDown(void)
{
}

static double log_uniform(double low, double high)
{
    return low * pow(high / low, uniform(&seed, 0.0, 1.0));
}

static uint32_t whole(uint32_t low, uint32_t high)
{
    return low + (uint32_t)(random_bits(&seed) % (high - low + 1));
}

static double held(double x, double low, double high)
{
    return fmax(low, fmin(x, high));
}

/* A configuration within its ranges, and a run that has just begun. */
static void draw_run(void)
{
    memset(&config, 0, sizeof config);
    config.offset.settle = whole(0, 5);
    config.offset.count_log2 = whole(2, 7);
    config.offset.offset_max = IQ24(0.25);
    config.offset.noise_max = IQ24(0.125);
    config.start.i_align = random_iq24(&seed, 0.1, 2.0);
    config.start.ramp_cycles = whole(5, 20);
    config.start.hold_cycles = whole(5, 20);
    config.start.run_up_cycles = whole(5, 20);
    config.start.speed_end = to_iq24(uniform(&seed, 0.01, 0.05) * (whole(0, 1) == 0 ? 1.0 : -1.0));
    config.i_max = IQ24(4.0);
    config.speed_max = IQFOC_ROTOR_SPEED_MAX;
    config.u_max = random_iq24(&seed, 0.05, 0.3);
    config.cycles_max = UINT32_MAX;
    config.settle_cycles = whole(1, 40);
    config.block_log2 = whole(6, 7);
    config.half_log2 = whole(1, 2);
    config.share_r = random_iq24(&seed, 0.0, 0.25);
    config.share_l = random_iq24(&seed, 0.0, 0.25);
    config.share_psi = random_iq24(&seed, 0.0, 0.25);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_commission_init(&c, &config));
}

static void draw_gains(void)
{
    c.gains.kp_d = random_iq24(&seed, 0.02, 0.5);
    c.gains.kp_q = random_iq24(&seed, 0.02, 0.5);
    c.gains.ki_d = random_iq24(&seed, 0.002, 0.05);
    c.gains.ki_q = random_iq24(&seed, 0.002, 0.05);
    c.gains.anti_windup = random_iq24(&seed, 0.1, 0.5);
}

/* A run in the middle: its offsets are known, a phase has been entered. */
static void draw_phase(iqfoc_commission_phase_t phase)
{
    draw_run();
    c.offset.verdict = IQFOC_OFFSET_GOOD;
    c.offset.offset.a = random_iq24(&seed, -0.1, 0.1);
    c.offset.offset.b = random_iq24(&seed, -0.1, 0.1);
    c.offset.offset.c = random_iq24(&seed, -0.1, 0.1);
    draw_gains();
    commission_enter(&c, phase, config.settle_cycles);
}

/* ---- What a cycle commands ---- */

static double complex voltage_of(iqfoc_abc_t duty)
{
    const double a = to_double(duty.a);
    const double b = to_double(duty.b);
    const double d = to_double(duty.c);
    return u_dc * ((2.0 * a - b - d) / 3.0 + I * (b - d) / sqrt(3.0));
}

static double hold_8(double x)
{
    return held(x, -8.0, 8.0);
}

/* PI control in the frame of the commanded angle; the voltage acts a cycle and a half after the sample. */
static void check_controlled(const iqfoc_commission_t *before)
{
    const double complex i = i_now * cexp(-I * TWO_PI * to_double(c.start.theta));
    const double level = (2.0 + c.blocks / 8) / 5.0;
    const double d = c.phase == IQFOC_COMMISSION_STAIRCASE ? level * to_double(config.start.i_align)
                                                           : to_double(c.start.i_ref.d);
    const double complex e = d + I * to_double(c.start.i_ref.q) - i;
    const double integral_d = ldexp((double)before->control.integral_d, -48);
    const double integral_q = ldexp((double)before->control.integral_q, -48);
    const double complex u = hold_8(to_double(c.gains.kp_d) * creal(e) + integral_d) +
                             I * hold_8(to_double(c.gains.kp_q) * cimag(e) + integral_q);
    const double ahead = to_double(c.start.theta) + 1.5 * to_double(c.start.speed);
    const double complex v = u * cexp(I * TWO_PI * ahead) / u_dc;
    const double x[3] = {creal(v), creal(v * cexp(-I * TWO_PI / 3.0)), creal(v * cexp(I * TWO_PI / 3.0))};
    const double high = fmax(x[0], fmax(x[1], x[2]));
    const double low = fmin(x[0], fmin(x[1], x[2]));
    const double scale = fmin(1.0, 1.0 / (high - low));
    const iqfoc_abc_t duty = command.duties.high;
    const iq24_t duties[3] = {duty.a, duty.b, duty.c};
    for (int k = 0; k < 3; k++) {
        near(40 * LSB, 0.5 + scale * (x[k] - 0.5 * (high + low)), duties[k]);
    }
    const double back = to_double(c.gains.anti_windup) * (scale - 1.0);
    near(100 * LSB, scale * creal(u), c.u_dq.d);
    near(100 * LSB, scale * cimag(u), c.u_dq.q);
    const double next_d = hold_8(integral_d + to_double(c.gains.ki_d) * creal(e)) + back * creal(u);
    const double next_q = hold_8(integral_q + to_double(c.gains.ki_q) * cimag(e)) + back * cimag(u);
    TEST_ASSERT_DOUBLE_WITHIN(100 * LSB, next_d, ldexp((double)c.control.integral_d, -48));
    TEST_ASSERT_DOUBLE_WITHIN(100 * LSB, next_q, ldexp((double)c.control.integral_q, -48));
}

/* The sign of the square wave, which is on the phase's axis; on the other axis and with it only the bias. */
static int sign_of_wave(void)
{
    const bool on_beta = c.phase == IQFOC_COMMISSION_SEEK_BETA || c.phase == IQFOC_COMMISSION_INDUCTANCE_Q ||
                         c.phase == IQFOC_COMMISSION_SHAFT;
    const bool seeks = c.phase == IQFOC_COMMISSION_SEEK_ALPHA || c.phase == IQFOC_COMMISSION_SEEK_BETA;
    const double complex wave = voltage_of(command.duties.high) - (seeks ? 0.0 : to_double(c.bias));
    const double along = on_beta ? cimag(wave) : creal(wave);
    TEST_ASSERT_DOUBLE_WITHIN(16 * LSB, 0.0, on_beta ? creal(wave) : cimag(wave));
    near(16 * LSB, fabs(along), c.amplitude);
    return along > 0.0 ? 1 : -1;
}

/* One cycle at a current. The three sensors have their offsets and a common error, which no result shows. */
static void step(double complex i)
{
    const double zero = uniform(&seed, -0.01, 0.01);
    iqfoc_sample_t sample = {.theta = random_iq24(&seed, -1.0, 1.0), .u_dc = random_iq24(&seed, 0.8, 1.2)};
    const iqfoc_abc_t abc = {to_iq24(creal(i) + zero), to_iq24(creal(i * cexp(-I * TWO_PI / 3.0)) + zero),
                             to_iq24(creal(i * cexp(I * TWO_PI / 3.0)) + zero)};
    const double a = to_double(abc.a);
    const double b = to_double(abc.b);
    const double d = to_double(abc.c);
    sample.i.a = abc.a + c.offset.offset.a;
    sample.i.b = abc.b + c.offset.offset.b;
    sample.i.c = abc.c + c.offset.offset.c;
    u_dc = to_double(sample.u_dc);
    i_now = (2.0 * a - b - d) / 3.0 + I * (b - d) / sqrt(3.0);
    const uint32_t cycles = c.cycles;
    command = iqfoc_commission_step(&c, &sample);
    TEST_ASSERT_EQUAL_UINT32(cycles + 1, c.cycles);
    TEST_ASSERT_EQUAL(c.end == IQFOC_COMMISSION_RUNNING && c.phase != IQFOC_COMMISSION_OFFSET, command.gates);
    if (!command.gates) {
        TEST_ASSERT_TRUE(cabs(voltage_of(command.duties.high)) == 0.0);
    }
}

/* ---- OFFSET, SEEK ---- */

static void check_offset(void)
{
    const double offset[3] = {uniform(&seed, -0.2, 0.2), uniform(&seed, -0.2, 0.2),
                              uniform(&seed, -0.2, 0.2)};
    const double noise = log_uniform(1e-6, 0.05);
    const uint32_t n = UINT32_C(1) << config.offset.count_log2;
    double sum[3] = {0.0, 0.0, 0.0};
    double squares[3] = {0.0, 0.0, 0.0};
    for (uint32_t k = 0; k < config.offset.settle + n; k++) {
        iqfoc_sample_t sample = {.u_dc = IQ24_ONE};
        iq24_t *const i[3] = {&sample.i.a, &sample.i.b, &sample.i.c};
        for (int x = 0; x < 3; x++) {
            *i[x] = to_iq24(offset[x] + (x + 1) * 0.3 * noise * uniform(&seed, -1.0, 1.0));
            sum[x] += k >= config.offset.settle ? *i[x] : 0.0;
            squares[x] += k >= config.offset.settle ? (double)*i[x] * *i[x] : 0.0;
        }
        TEST_ASSERT_FALSE(command.gates);
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_OFFSET, c.phase);
        command = iqfoc_commission_step(&c, &sample);
        u_dc = 1.0;
    }
    const iqfoc_abc_t value = c.result.i_offset;
    const iqfoc_abc_t width = c.result.i_offset_half;
    const iq24_t values[3] = {value.a, value.b, value.c};
    const iq24_t widths[3] = {width.a, width.b, width.c};
    for (int x = 0; x < 3; x++) {
        const double mean = sum[x] / n;
        const double half = 2.0 * sqrt(fmax(squares[x] / n - mean * mean, 0.0) / n);
        TEST_ASSERT_DOUBLE_WITHIN(0.6, mean, values[x]);
        /* Rounded up: never more than 1 LSB too small. */
        TEST_ASSERT_TRUE(widths[x] > half - 1.1 && widths[x] < half + 2.5);
    }
}

/* The square wave grows on an inductor with a loss v_loss of voltage until D is the target; L = h dU/dD is free of that loss. */
static double check_seek(double l, iqfoc_commission_end_t *end)
{
    const iqfoc_commission_phase_t phase = c.phase;
    const double complex axis = phase == IQFOC_COMMISSION_SEEK_ALPHA ? 1.0 : I;
    const double complex rest = i_now - axis * creal(i_now / axis);
    const int h = 1 << config.half_log2;
    const double loss = uniform(&seed, 0.0, 0.001);
    const double target = 0.5 * to_double(config.start.i_align);
    const iq24_t least = IQ24_ONE / 512;
    double half_u = 0.0;
    double half_d = 0.0;
    iq24_t amplitude = least;
    double i = creal(i_now / axis);
    int sign = sign_of_wave();
    TEST_ASSERT_EQUAL_INT(1, sign);
    for (int cycle = h / 2;; amplitude += amplitude / 16 > least ? amplitude / 16 : least) {
        amplitude = amplitude < config.u_max ? amplitude : config.u_max;
        TEST_ASSERT_EQUAL_INT32(amplitude, c.amplitude);
        for (int k = 0; k < 2 * h; k++) {
            TEST_ASSERT_EQUAL_INT(phase, c.phase);
            const double u_now = to_double(c.amplitude); /* of the command that acts from now on */
            step(rest + axis * i);
            i += sign * (u_now - loss) / l;
            cycle++;
            if (c.phase == phase && c.end == IQFOC_COMMISSION_RUNNING) {
                sign = sign_of_wave();
                TEST_ASSERT_EQUAL_INT(cycle % (2 * h) < h ? 1 : -1, sign);
            }
        }
        const double u = to_double(amplitude);
        const double d = (u - loss) * h / l;
        if (d >= target || (amplitude == config.u_max && d >= 0.25 * target)) {
            *end = IQFOC_COMMISSION_RUNNING;
            return held(h * (u - half_u) / (d - half_d), 0.0625, 8.0);
        }
        if (amplitude == config.u_max) {
            *end = IQFOC_COMMISSION_NO_CURRENT;
            return 0.0;
        }
        if (half_u == 0.0 && d >= 0.5 * target) {
            half_u = u;
            half_d = d;
        }
    }
}

static void test_seek(void)
{
    int ends[2] = {0, 0};
    for (int n = 0; n < 5 * DRAWS; n++) {
        iqfoc_commission_end_t end = IQFOC_COMMISSION_RUNNING;
        draw_run();
        command.gates = false;
        check_offset();
        i_now = 0.0;
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_SEEK_ALPHA, c.phase);
        const double l_a = check_seek(log_uniform(0.04, 8.0), &end);
        ends[0] += end != IQFOC_COMMISSION_RUNNING;
        TEST_ASSERT_EQUAL_INT(end, c.end);
        if (end != IQFOC_COMMISSION_RUNNING) {
            continue;
        }
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_SEEK_BETA, c.phase);
        near(1e-3 * l_a, l_a, c.l_rough);
        const double l_b = check_seek(log_uniform(0.04, 8.0), &end);
        ends[1] += end != IQFOC_COMMISSION_RUNNING;
        TEST_ASSERT_EQUAL_INT(end, c.end);
        if (end != IQFOC_COMMISSION_RUNNING) {
            continue;
        }
        const double l = fmin(l_a, l_b);
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_ALIGN, c.phase);
        near(1e-3 * l, l, c.l_rough);
        near(5.0 * LSB, 0.1 * to_double(c.l_rough), c.gains.kp_d);
        near(5.0 * LSB, 0.1 * to_double(c.l_rough), c.gains.kp_q);
        near(LSB, 0.1 * 0.2 / 7.0 * to_double(c.l_rough), c.gains.ki_d);
        near(LSB, 0.1 * 0.2 / 7.0 * to_double(c.l_rough), c.gains.ki_q);
        near(LSB, 0.1, c.gains.anti_windup);
    }
    printf("  no current: %d on alpha, %d on beta, of %d\n", ends[0], ends[1], 5 * DRAWS);
    TEST_ASSERT_TRUE(ends[0] > 10 && ends[1] > 10);
}

/* ---- ALIGN, RUN_UP ---- */

/* Currents of up to 2 per unit, which the voltage's limit is too small for: the controller's integrators do not wind up. */
static void test_start(void)
{
    int limited = 0;
    for (int n = 0; n < DRAWS; n++) {
        const bool runs_up = n % 2 == 1;
        draw_phase(runs_up ? IQFOC_COMMISSION_RUN_UP : IQFOC_COMMISSION_ALIGN);
        const iqfoc_start_stage_t last = runs_up ? IQFOC_START_OPEN_LOOP : IQFOC_START_RUN_UP;
        c.start.stage = runs_up ? IQFOC_START_RUN_UP : IQFOC_START_RAISE;
        c.start.i_ref.q = random_iq24(&seed, -0.5, 0.5);
        const iqfoc_commission_phase_t phase = c.phase;
        while (c.phase == phase) {
            const iqfoc_commission_t before = c;
            TEST_ASSERT_TRUE(c.start.stage != last);
            step(uniform(&seed, 0.0, 2.0) * cexp(I * uniform(&seed, 0.0, TWO_PI)));
            check_controlled(&before);
            limited += command.duties.scale < IQ24_ONE;
        }
        TEST_ASSERT_EQUAL_INT(last, c.start.stage);
        TEST_ASSERT_EQUAL_INT(runs_up ? IQFOC_COMMISSION_SPIN : IQFOC_COMMISSION_STAIRCASE, c.phase);
        TEST_ASSERT_EQUAL_UINT32(runs_up ? config.start.hold_cycles : config.settle_cycles, c.wait);
        TEST_ASSERT_EQUAL_UINT32(0, c.blocks);
    }
    TEST_ASSERT_TRUE(limited > 100);
}

/* ---- STAIRCASE ---- */

typedef struct found {
    double value, half;
} found;

static double mean_of(const double x[N])
{
    double sum = 0.0;
    for (int k = 0; k < N; k++) {
        sum += x[k] / N;
    }
    return sum;
}

/* sum (x - mean x)(y - mean y) */
static double products(const double x[N], const double y[N])
{
    double sum = 0.0;
    for (int k = 0; k < N; k++) {
        sum += (x[k] - mean_of(x)) * (y[k] - mean_of(y));
    }
    return sum;
}

static found mean_with_half(const double x[N])
{
    const found f = {mean_of(x), 2.042 * sqrt(products(x, x) / (N - 2) / N)};
    return f;
}

static void check_found(found want, double share, double tolerance, iqfoc_commission_value_t got)
{
    near(tolerance, want.value, got.value);
    near(tolerance, want.half + share * fabs(want.value), got.half);
}

/* Steps through a phase of blocks; x and y: means of the currents and of the voltages that act in its settled cycles. */
static void measure_blocks(const double complex i[N], const double complex u[N], double ripple,
                           uint32_t waits_every, double complex x[N], double complex y[N])
{
    const uint32_t cycles = UINT32_C(1) << config.block_log2;
    const iqfoc_commission_phase_t phase = c.phase;
    uint32_t wait = c.wait;
    for (uint32_t b = 0; b < N; b++) {
        x[b] = 0.0;
        y[b] = 0.0;
        for (uint32_t k = 0; k < wait + cycles; k++) {
            TEST_ASSERT_EQUAL_UINT32(b, c.blocks);
            TEST_ASSERT_EQUAL_INT(phase, c.phase);
            const double turn = to_double(c.start.theta) + to_double(c.start.speed);
            c.u_dq.d = to_iq24(creal(u[b]) + ripple * uniform(&seed, -1.0, 1.0));
            c.u_dq.q = to_iq24(cimag(u[b]) + ripple * uniform(&seed, -1.0, 1.0));
            const double complex u_now = complex_of_dq(c.u_dq);
            const iqfoc_commission_t before = c;
            step((i[b] + ripple * (uniform(&seed, -1.0, 1.0) + I * uniform(&seed, -1.0, 1.0))) *
                 cexp(I * TWO_PI * turn));
            if (c.end == IQFOC_COMMISSION_RUNNING && c.phase == phase) {
                check_controlled(&before);
            }
            if (k >= wait) {
                x[b] += i_now * cexp(-I * TWO_PI * turn) / cycles;
                y[b] += u_now / cycles;
            }
        }
        wait = waits_every != 0 && (b + 1) % waits_every == 0 ? config.settle_cycles : 0;
    }
}

static void test_staircase(void)
{
    int out = 0;
    for (int n = 0; n < DRAWS; n++) {
        double complex i[N];
        double complex u[N];
        double complex x[N];
        double complex y[N];
        double i_d[N];
        double u_d[N];
        const double r = log_uniform(0.003, n % 4 == 0 ? 2.0 : 0.5) * (n % 8 == 1 ? -1.0 : 1.0);
        const double v_dead = n % 4 == 2 ? uniform(&seed, -0.3, 0.3) : uniform(&seed, -0.02, 0.02);
        draw_phase(IQFOC_COMMISSION_STAIRCASE);
        c.start.stage = IQFOC_START_RUN_UP;
        c.start.theta = 0;
        c.l_rough = random_iq24(&seed, 0.0625, 8.0);
        c.result.i_offset_half.a = random_iq24(&seed, 0.0, 0.01);
        c.result.i_offset_half.b = random_iq24(&seed, 0.0, 0.01);
        c.result.i_offset_half.c = random_iq24(&seed, 0.0, 0.01);
        for (int b = 0; b < N; b++) {
            i[b] = to_double(config.start.i_align) * (2 + b / 8) / 5.0;
            u[b] = r * i[b] + 4.0 / 3.0 * v_dead + I * 0.1;
        }
        measure_blocks(i, u, log_uniform(1e-4, 1e-2), 8, x, y);
        double last = 0.0;
        for (int b = 0; b < N; b++) {
            i_d[b] = creal(x[b]);
            u_d[b] = creal(y[b]);
            last += b >= 24 ? u_d[b] / 8.0 : 0.0;
            near(1.6 * LSB, i_d[b], c.x[b]);
            near(0.6 * LSB, u_d[b], c.y[b]);
        }
        const double xx = products(i_d, i_d);
        const double slope = products(i_d, u_d) / xx;
        double rest[N];
        for (int b = 0; b < N; b++) {
            rest[b] = u_d[b] - slope * i_d[b];
        }
        const double s = sqrt(products(rest, rest) / (N - 2));
        const found line = {slope, 2.042 * s / sqrt(xx)};
        const iqfoc_abc_t o = c.result.i_offset_half;
        const double offset = hypot(2.0 * to_double(o.a), hypot(to_double(o.b), to_double(o.c))) / 3.0;
        const double half = hypot(hypot(2.042 * s / sqrt(N), line.half * mean_of(i_d)), slope * offset);
        const found dead = {0.75 * mean_of(rest), 0.75 * half};
        const double tolerance = 12.0 * LSB * fmax(1.0, 1.0 / to_double(config.start.i_align));
        check_found(line, to_double(config.share_r), tolerance, c.result.r);
        check_found(dead, 0.0, tolerance, c.result.v_dead);
        near(1.6 * LSB, last, c.bias);
        const double target = to_double(c.l_rough) * to_double(config.start.i_align);
        near(2.0 * LSB, held(target / (4 << config.half_log2), LSB, to_double(config.u_max)), c.amplitude);
        const bool good = slope > 0.0 && slope <= 1.0 && fabs(dead.value) <= 0.25;
        TEST_ASSERT_EQUAL_INT(good ? IQFOC_COMMISSION_RUNNING : IQFOC_COMMISSION_OUT_OF_RANGE, c.end);
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_INDUCTANCE_D, c.phase);
        TEST_ASSERT_EQUAL_UINT32(config.settle_cycles, c.wait);
        out += good ? 0 : 1;
    }
    TEST_ASSERT_TRUE(out > 5 && out < DRAWS - 10);
}

/* The wave has a voltage however small the alignment's current is. */
static void test_least_amplitude(void)
{
    draw_phase(IQFOC_COMMISSION_STAIRCASE);
    config.start.i_align = 1;
    c.start.theta = 0;
    c.l_rough = IQ24(0.0625);
    while (c.phase == IQFOC_COMMISSION_STAIRCASE) {
        step(0.0);
    }
    TEST_ASSERT_EQUAL_INT32(1, c.amplitude);
}

/* ---- INDUCTANCE_D, INDUCTANCE_Q, SHAFT ---- */

/* The means of D, S and k D over the phase's blocks, from the samples and the voltage that acts at each: half periods as it shows them. */
typedef struct wave {
    double d[N], s[N], across[N];
} wave;

static void measure_wave(double l, double across, wave *w)
{
    const iqfoc_commission_phase_t phase = c.phase;
    const double complex axis = phase == IQFOC_COMMISSION_INDUCTANCE_D ? 1.0 : I;
    const int h = (1 << config.half_log2) * (phase == IQFOC_COMMISSION_SHAFT ? 4 : 1);
    const double noise = 0.003 * to_double(config.start.i_align);
    const double r = to_double(c.result.r.value);
    const double target = 0.5 * to_double(config.start.i_align);
    const double mean = uniform(&seed, 0.2, 0.5);
    const double beside = uniform(&seed, -0.2, 0.2);
    const int periods = (1 << config.block_log2) / (2 * h);
    int wait = ((int)config.settle_cycles + 2 * h - 1) / (2 * h);
    int cycle = h / 2;
    int acting = sign_of_wave();
    int before = acting;
    double i = 0.0;
    TEST_ASSERT_EQUAL_INT(1, acting);
    for (int b = 0; b <= N; b++) {
        double d = 0.0;
        double s = 0.0;
        double k_d = 0.0;
        const double u = to_double(c.amplitude);
        for (int k = 0; k < 2 * h * (wait + periods); k++) {
            TEST_ASSERT_EQUAL_INT(phase, c.phase);
            const double u_now = to_double(c.amplitude);
            const double off = across * i + beside + noise * uniform(&seed, -1.0, 1.0);
            step(axis * (mean + i + noise * uniform(&seed, -1.0, 1.0)) + (axis == 1.0 ? I : 1.0) * off);
            const double i_along = axis == 1.0 ? creal(i_now) : cimag(i_now);
            const double i_across = axis == 1.0 ? cimag(i_now) : creal(i_now);
            if (k >= 2 * h * wait) {
                const double ends =
                    acting != before ? 2.0 * before : 0.0; /* the last half period's end, this one's begin */
                d += ends * i_along / (2.0 * periods);
                k_d += ends * i_across / (2.0 * periods);
                s += (acting == before ? acting : 0.0) * i_along / (2.0 * periods);
            }
            i += (acting * u_now - r * i) / l;
            before = acting;
            cycle++;
            if (c.phase == phase && c.end == IQFOC_COMMISSION_RUNNING) {
                acting = sign_of_wave();
                TEST_ASSERT_EQUAL_INT(cycle % (2 * h) < h ? 1 : -1, acting);
            }
        }
        wait = 0;
        if (b == 0) {
            const double scaled = u * held(target / fmax(d, LSB), 0.125, 8.0);
            near(200 * LSB, held(scaled, LSB, to_double(config.u_max)), c.amplitude);
            wait = ((int)config.settle_cycles + 2 * h - 1) / (2 * h);
        } else {
            w->d[b - 1] = d;
            w->s[b - 1] = s;
            w->across[b - 1] = k_d;
            near(2.6 * LSB, d, c.x[b - 1]);
            near(1.6 * h * LSB, s, c.y[b - 1]);
        }
    }
}

static found inductance_of(const wave *w, const iqfoc_commission_result_t *known, double h_u)
{
    const double r = to_double(known->r.value);
    const double d = mean_of(w->d);
    const double s = mean_of(w->s);
    const double l = (h_u - r * s) / d;
    double rest[N];
    for (int b = 0; b < N; b++) {
        rest[b] = l * w->d[b] + r * w->s[b];
    }
    const double noise = 2.042 * sqrt(products(rest, rest) / (N - 2) / N);
    const found f = {l + r * to_double(known->v_dead.value) / 2.0 - 3.0 / 32.0 * r * r / l,
                     (noise + to_double(known->r.half) * fabs(s)) / fabs(d)};
    return f;
}

static void test_inductances(void)
{
    int out = 0;
    for (int n = 0; n < 2 * DRAWS; n++) {
        wave w;
        const double share = n % 2 == 0 ? 0.0 : 0.2;
        const double l_d = log_uniform(n % 4 == 0 ? 0.02 : 0.1, n % 4 == 1 ? 16.0 : 4.0);
        const double l_q = log_uniform(0.1, 4.0);
        const double across = uniform(&seed, -0.4, 0.4);
        draw_phase(IQFOC_COMMISSION_STAIRCASE);
        config.share_l = to_iq24(share);
        c.result.r.value = random_iq24(&seed, 0.001, 0.02);
        c.result.r.half = random_iq24(&seed, 0.0, 0.001);
        c.result.v_dead.value = random_iq24(&seed, -0.02, 0.02);
        c.bias = random_iq24(&seed, 0.0, 0.1);
        const double first = l_d * to_double(config.start.i_align) / (4 << config.half_log2);
        c.amplitude = to_iq24(held(first * log_uniform(0.1, 10.0), 0.001, to_double(config.u_max)));
        commission_enter(&c, IQFOC_COMMISSION_INDUCTANCE_D, config.settle_cycles);
        step(0.0); /* commands the first cycle */
        double u = 0.0;
        measure_wave(l_d, across, &w);
        u = 2.0 * (to_double(c.amplitude) - LSB); /* the next phase begins with half of it, and an LSB */
        const double scale = 6.0 * LSB / mean_of(w.d);
        const int h = 1 << config.half_log2;
        found want = inductance_of(&w, &c.result, h * u);
        check_found(want, share, scale * (1.0 + fabs(want.value)) * h, c.result.l_d);
        near(40.0 * LSB / mean_of(w.d), mean_of(w.across) / mean_of(w.d), c.across);
        const bool good = want.value >= 0.0625 && want.value <= 8.0;
        TEST_ASSERT_EQUAL_INT(good ? IQFOC_COMMISSION_RUNNING : IQFOC_COMMISSION_OUT_OF_RANGE, c.end);
        if (!good) {
            out++;
            continue;
        }
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_INDUCTANCE_Q, c.phase);
        TEST_ASSERT_EQUAL_UINT32(config.settle_cycles, c.wait);
        measure_wave(l_q, -across, &w);
        u = 8.0 * (to_double(c.amplitude) - LSB);
        const found fast = inductance_of(&w, &c.result, h * u);
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_SHAFT, c.phase);
        TEST_ASSERT_EQUAL_UINT32(config.settle_cycles, c.wait);
        const double slack = 12.0 * LSB / mean_of(w.d) * (1.0 + fabs(fast.value)) * h;
        check_found(fast, 0.0, slack, c.result.l_q);
        const iq24_t k = c.across;
        const double slower = uniform(&seed, 0.7, 1.0);
        measure_wave(l_q * slower, across, &w);
        TEST_ASSERT_EQUAL_INT32(k, c.across);
        const found slow = inductance_of(&w, &c.result, 4.0 * h * to_double(c.amplitude));
        const double r = (4.0 / 15.0) * LSB / mean_of(w.d) * (1.0 + fabs(slow.value)) * h;
        want.value = fast.value + (fast.value - slow.value) / 15.0;
        want.half = (16.0 * fast.half + slow.half) / 15.0;
        check_found(want, share, slack + 6.0 * r, c.result.l_q);
        const bool taken = want.value >= 0.0625 && want.value <= 8.0;
        TEST_ASSERT_EQUAL_INT(taken ? IQFOC_COMMISSION_RUNNING : IQFOC_COMMISSION_OUT_OF_RANGE, c.end);
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_RUN_UP, c.phase);
        near(5.0 * LSB, 0.35 * to_double(c.result.l_d.value), c.gains.kp_d);
        near(5.0 * LSB, 0.35 * to_double(c.result.l_q.value), c.gains.kp_q);
        near(4.0 * LSB, 0.035 * to_double(c.result.l_d.value), c.gains.ki_d);
        near(4.0 * LSB, 0.035 * to_double(c.result.l_q.value), c.gains.ki_q);
        near(LSB, 0.35, c.gains.anti_windup);
    }
    printf("  L_d out of range: %d of %d\n", out, 2 * DRAWS);
    TEST_ASSERT_TRUE(out > 5 && out < DRAWS);
}

/* ---- SPIN ---- */

static double complex active_flux(const iqfoc_commission_result_t *known, double complex i, double complex u,
                                  double speed)
{
    const double lost = 8.0 / TWO_PI * to_double(known->v_dead.value);
    const double complex e = u - to_double(known->r.value) * i - lost * i / cabs(i);
    return -I * e / (2.0 * sin(0.5 * TWO_PI * speed)) - to_double(known->l_q.value) * i;
}

/* psi_f and the half width that the parameters add, by the header's formulas. */
static found flux_of(const iqfoc_commission_result_t *known, double complex i, double complex u, double speed)
{
    const double four_over_pi = 8.0 / TWO_PI;
    const double l_d = to_double(known->l_d.value);
    const double l_q = to_double(known->l_q.value);
    const double v_dead = to_double(known->v_dead.value);
    const double chord = 2.0 * sin(0.5 * TWO_PI * speed);
    const double complex active = active_flux(known, i, u, speed);
    const double complex i_r = i * cabs(active) / active; /* in the frame of the active flux */
    const double drop = to_double(known->r.half) * cabs(i) + four_over_pi * to_double(known->v_dead.half);
    const double sides = drop * fabs(cimag(i_r)) / cabs(i) + four_over_pi * fabs(v_dead) / 32.0;
    const found f = {cabs(active) - (l_d - l_q) * creal(i_r),
                     to_double(known->l_d.half) * fabs(creal(i_r)) + sides / fabs(chord)};
    return f;
}

/* Means of current and voltage in the frame of the commanded angle, of a machine whose d axis is delta ahead of it. */
static void draw_machine(const iqfoc_commission_result_t *known, double psi, double speed, double complex *i,
                         double complex *u)
{
    const double complex turn = cexp(I * uniform(&seed, -1.0, 1.0));
    *i = to_double(config.start.i_align) * cexp(I * uniform(&seed, -0.3, 0.3));
    const double complex i_r = *i / turn;
    const double complex linkage =
        (psi + to_double(known->l_d.value) * creal(i_r) + I * to_double(known->l_q.value) * cimag(i_r)) *
        turn;
    *u = I * 2.0 * sin(0.5 * TWO_PI * speed) * linkage + to_double(known->r.value) * *i +
         8.0 / TWO_PI * to_double(known->v_dead.value) * *i / cabs(*i);
}

static void draw_known(iqfoc_commission_result_t *known)
{
    memset(known, 0, sizeof *known);
    known->r.value = random_iq24(&seed, 0.001, 0.1);
    known->r.half = random_iq24(&seed, 0.0, 0.01);
    known->v_dead.value = random_iq24(&seed, -0.02, 0.02);
    known->v_dead.half = random_iq24(&seed, 0.0, 0.002);
    known->l_d.value = random_iq24(&seed, 0.1, 2.0);
    known->l_d.half = random_iq24(&seed, 0.0, 0.05);
    known->l_q.value = random_iq24(&seed, 0.1, 2.0);
}

/* psi (1 - k^2 l_q/l_d) against 3/2 i sqrt((l_q - l_d)^2 + (2 k l_q)^2): the difference of the two sides. */
static double aligned_by(const iqfoc_commission_result_t *known, double k, double i)
{
    const double l_d = to_double(known->l_d.value);
    const double l_q = to_double(known->l_q.value);
    const double kept = fmax(1.0 - k * k * l_q / l_d, 0.0);
    return to_double(known->psi.value) * kept - 1.5 * i * hypot(l_q - l_d, 2.0 * k * l_q);
}

static void test_spin(void)
{
    int ends[16] = {0};
    for (int n = 0; n < 4 * DRAWS; n++) {
        double complex i[N];
        double complex u[N];
        double complex x[N];
        double complex y[N];
        double psi[N];
        draw_phase(IQFOC_COMMISSION_SPIN);
        c.wait = config.start.hold_cycles;
        c.start.stage = IQFOC_START_OPEN_LOOP;
        c.start.speed = config.start.speed_end;
        c.start.theta = random_iq24(&seed, -0.5, 0.5);
        const double speed = to_double(config.start.speed_end);
        draw_known(&c.result);
        const double salient = fabs(to_double(c.result.l_d.value - c.result.l_q.value));
        const double truth = n % 8 == 7
                                 ? uniform(&seed, 15.0, 17.0)
                                 : 0.4 + uniform(&seed, 1.0, 3.0) * salient * to_double(config.start.i_align);
        c.result.r.half *= n % 4 == 0 ? 20 : 1;
        draw_machine(&c.result, truth, speed, i, u);
        c.across = random_iq24(&seed, -0.2, 0.2);
        const double swing = log_uniform(1e-4, 0.02);
        for (int b = N - 1; b >= 0; b--) {
            i[b] = i[0];
            u[b] = u[0] + swing * speed * uniform(&seed, -1.0, 1.0);
        }
        measure_blocks(i, u, 0.001, 0, x, y);
        const double unit =
            4.0 * LSB / fabs(TWO_PI * speed) * (2.0 + truth + 4.0 * to_double(config.start.i_align));
        for (int b = 0; b < N; b++) {
            psi[b] = flux_of(&c.result, x[b], y[b], speed).value;
            near(unit, psi[b], c.x[b]);
        }
        found want = mean_with_half(psi);
        want.half += flux_of(&c.result, x[N - 1], y[N - 1], speed).half;
        check_found(want, to_double(config.share_psi), 2.0 * unit, c.result.psi);
        const double turning = want.value / 4.0 - want.half;
        const double aligned = aligned_by(&c.result, to_double(c.across), to_double(config.start.i_align));
        if (fabs(want.value) > 2.0 * unit && fabs(want.value - 16.0) > unit && fabs(turning) > 2.0 * unit &&
            fabs(aligned) > 1e-5) {
            const iqfoc_commission_end_t end = want.value < 0.0 || want.value > 16.0
                                                   ? IQFOC_COMMISSION_OUT_OF_RANGE
                                               : turning < 0.0 ? IQFOC_COMMISSION_NOT_TURNING
                                               : aligned < 0.0 ? IQFOC_COMMISSION_NOT_ALIGNED
                                                               : IQFOC_COMMISSION_DONE;
            TEST_ASSERT_EQUAL_INT(end, c.end);
        }
        ends[c.end]++;
    }
    printf("  %d done, %d out of range, %d not turning, %d not aligned\n", ends[IQFOC_COMMISSION_DONE],
           ends[IQFOC_COMMISSION_OUT_OF_RANGE], ends[IQFOC_COMMISSION_NOT_TURNING],
           ends[IQFOC_COMMISSION_NOT_ALIGNED]);
    TEST_ASSERT_TRUE(ends[IQFOC_COMMISSION_DONE] > 10 && ends[IQFOC_COMMISSION_OUT_OF_RANGE] > 5);
    TEST_ASSERT_TRUE(ends[IQFOC_COMMISSION_NOT_TURNING] > 5 && ends[IQFOC_COMMISSION_NOT_ALIGNED] > 5);
}

/* ---- The estimators alone ---- */

static void test_estimators(void)
{
    worst both = {"both", 0.0};
    double least = 9.0;
    double narrow = 9.0;
    double wide = -9.0;
    for (int n = 0; n < 4000; n++) {
        iq24_t x[N];
        double as_double[N];
        const double size = log_uniform(1e-6, 0.5);
        const double place = uniform(&seed, -60.0, 60.0);
        for (int k = 0; k < N; k++) {
            x[k] = to_iq24(place + size * uniform(&seed, -1.0, 1.0));
            as_double[k] = to_double(x[k]);
        }
        const found want = mean_with_half(as_double);
        const iqfoc_commission_value_t got = commission_spread(x);
        near(0.5001 * LSB, want.value, got.value);
        TEST_ASSERT_EQUAL_INT32(got.value, commission_mean(x));
        const double wider = got.half - want.half / LSB;
        narrow = fmin(narrow, wider);
        wide = fmax(wide, wider);
        const uint32_t bits = whole(1, 12);
        const int64_t sum = random_iq24(&seed, -8.0, 8.0) * (INT64_C(1) << bits) + whole(0, 4095);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, ldexp((double)sum, -(int)bits), commission_block_mean(sum, bits));
        const iq24_t a = random_iq24(&seed, -8.0, 8.0);
        const iq24_t b = n % 4 == 0 ? 0 : to_iq24(log_uniform(1e-7, 80.0));
        const double over = commission_both(a, b) - hypot(a, b);
        both.lsb = fmax(both.lsb, over);
        least = fmin(least, over);
    }
    printf("  half width of a mean %.3f ... %.3f LSB over, both %.3f ...\n", narrow, wide, least);
    TEST_ASSERT_TRUE(narrow > -0.1 && wide < 1.5);
    TEST_ASSERT_TRUE(least > -0.5);
    worst_check(&both, 2.1);
}

/* The half width that the parameters add to psi_f; whether the rotor is aligned, both sides of the limit. */
static void test_flux_half_and_alignment(void)
{
    config.start.i_align = IQ24(0.7);
    for (int n = 0; n < 4000; n++) {
        double complex i = 0.0;
        double complex u = 0.0;
        iqfoc_commission_result_t known;
        draw_known(&known);
        const double speed = uniform(&seed, 0.005, 0.05) * (n % 2 == 0 ? 1.0 : -1.0);
        const double psi = uniform(&seed, 1.5, 8.0);
        draw_machine(&known, psi, speed, &i, &u);
        const commission_means_t means = {{to_iq24(creal(i)), to_iq24(cimag(i))},
                                          {to_iq24(creal(u)), to_iq24(cimag(u))}};
        const double unit = 4.0 * LSB / fabs(TWO_PI * speed);
        const iq24_t got = commission_flux_half(&known, &means, to_iq24(2.0 * sin(0.5 * TWO_PI * speed)));
        near(unit, flux_of(&known, i, u, speed).half, got);
        const double k = uniform(&seed, -1.2, 1.2);
        known.psi.value = to_iq24(psi);
        const double by = aligned_by(&known, to_double(to_iq24(k)), 0.7);
        known.psi.value = to_iq24(held(psi - by + uniform(&seed, -1e-4, 1e-4), 0.0, 16.0));
        const double now = aligned_by(&known, to_double(to_iq24(k)), 0.7);
        if (fabs(now) > 40.0 * LSB) {
            TEST_ASSERT_EQUAL(now > 0.0, commission_aligns(&known, to_iq24(k), to_iq24(0.7)));
        }
    }
}

/* ---- The guard, the parameter set ---- */

/* Every limit of the header, itself allowed and an LSB beyond it not; the first of those that are exceeded ends the run. */
static void test_guard(void)
{
    const iqfoc_commission_end_t order[] = {IQFOC_COMMISSION_ABORTED, IQFOC_COMMISSION_OVER_CURRENT,
                                            IQFOC_COMMISSION_OVER_SPEED, IQFOC_COMMISSION_DC_LINK,
                                            IQFOC_COMMISSION_TOO_SLOW};
    for (int n = 0; n < 4000; n++) {
        draw_phase(IQFOC_COMMISSION_ALIGN);
        config.speed_max = random_iq24(&seed, 0.05, 0.3);
        config.i_max = random_iq24(&seed, 3.0, 4.0);
        config.cycles_max = 5000;
        const uint32_t wrong = n % 2 == 0 ? 0 : whole(0, 31);
        const int sign = n % 4 < 2 ? 1 : -1;
        const iq24_t current = sign * (config.i_max + ((wrong & 2) != 0 && n % 8 != 3 ? 1 : 0));
        const iq24_t speed = sign * (config.speed_max + ((wrong & 4) != 0 ? 1 : 0));
        const iq24_t beyond = (wrong & 8) != 0 ? 1 : 0;
        const uint32_t phase = whole(0, 2);
        iqfoc_sample_t sample = {.i = c.offset.offset, .speed = speed};
        sample.u_dc = sign > 0 ? IQ24(1.5) + beyond : IQ24(0.5) - beyond;
        sample.clipped = (wrong & 2) != 0 && n % 8 == 3;
        *(phase == 0 ? &sample.i.a : phase == 1 ? &sample.i.b : &sample.i.c) += current;
        c.cycles = 4999 + ((wrong & 16) != 0 ? 1 : 0);
        if ((wrong & 1) != 0) {
            iqfoc_commission_abort(&c);
        }
        iqfoc_commission_end_t want = IQFOC_COMMISSION_RUNNING;
        for (int k = 4; k >= 0; k--) {
            want = (wrong >> k & 1) != 0 ? order[k] : want;
        }
        command = iqfoc_commission_step(&c, &sample);
        TEST_ASSERT_EQUAL_INT(want, c.end);
        TEST_ASSERT_EQUAL(want == IQFOC_COMMISSION_RUNNING, command.gates);
        /* Ended: the command is the safe one and the state stays. */
        if (want != IQFOC_COMMISSION_RUNNING) {
            const iqfoc_commission_t ended = c;
            const iqfoc_sample_t good = {.u_dc = IQ24_ONE};
            TEST_ASSERT_FALSE(iqfoc_commission_step(&c, &good).gates);
            TEST_ASSERT_EQUAL_MEMORY(&ended, &c, sizeof c);
        }
    }
}

static void test_parameters(void)
{
    iqfoc_commission_result_t result;
    iqfoc_flux_predictor_t p;
    iqfoc_extension_t e;
    draw_known(&result);
    result.psi.value = IQ24(3.0);
    result.i_offset.a = 1;
    result.i_offset.b = 2;
    result.i_offset.c = 3;
    iqfoc_commission_parameters(&result, &p, &e);
    TEST_ASSERT_EQUAL_INT32(result.l_d.value, p.l_d);
    TEST_ASSERT_EQUAL_INT32(result.l_q.value, p.l_q);
    near(LSB, 1.0 / to_double(p.l_d), p.k_d);
    near(LSB, 1.0 / to_double(p.l_q), p.k_q);
    TEST_ASSERT_EQUAL_INT32(result.r.value, p.r);
    TEST_ASSERT_EQUAL_INT32(IQ24(3.0), p.psi);
    TEST_ASSERT_EQUAL_INT32(0, p.skew);
    const iqfoc_extension_t want = {
        {1, 2, 3}, {IQ24_ONE, IQ24_ONE, IQ24_ONE}, 0, 0, IQ24_ONE, result.v_dead.value, IQ24(127.0), 0};
    TEST_ASSERT_EQUAL_MEMORY(&want, &e, sizeof want);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_seek);
    RUN_TEST(test_start);
    RUN_TEST(test_staircase);
    RUN_TEST(test_least_amplitude);
    RUN_TEST(test_inductances);
    RUN_TEST(test_spin);
    RUN_TEST(test_estimators);
    RUN_TEST(test_flux_half_and_alignment);
    RUN_TEST(test_guard);
    RUN_TEST(test_parameters);
    return UNITY_END();
}
