/*
 * Self-commissioning: whole runs on switching drives drawn at random (commission_drive.h), each result against the truth and its interval;
 * the limits in every cycle; every way to end; the estimators against long double.
 */
#include "commission_drive.h"

#include "../../../src/commission_fit.h"
#include "reference_vectors.h"

#include <string.h>

#define SEED   UINT64_C(20261125)
#define DRIVES 4

static drawn_drive d;

void setUp(void)
{
}

void tearDown(void)
{
}

static void run_to(iqfoc_commission_phase_t phase)
{
    while (d.commission.end == IQFOC_COMMISSION_RUNNING && d.commission.phase != phase) {
        drawn_cycle(&d);
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_RUNNING, d.commission.end);
}

/* The gates are off, and the end does not change, whatever the samples are. */
static void stays(iqfoc_commission_end_t end)
{
    for (int k = 0; k < 3; k++) {
        drawn_cycle(&d);
        TEST_ASSERT_FALSE(d.command.gates);
        TEST_ASSERT_EQUAL_INT(end, d.commission.end);
    }
}

/* Every interval holds the truth or misses it by less than its own width: 4 standard deviations. None is wider than 4 (offsets: of the rated
 * current) or 2 per cent. No phase current exceeds 5/4 of the alignment's by more than noise and ripple. */
static void test_drives(void)
{
    double squares = 0.0;
    int inside = 0;
    for (uint64_t n = 0; n < DRIVES; n++) {
        drawn_begin(&d, SEED, n);
        while (d.commission.end == IQFOC_COMMISSION_RUNNING) {
            drawn_cycle(&d);
        }
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_DONE, d.commission.end);
        TEST_ASSERT_TRUE(d.highest_A < 1.3 * 0.5 * d.base.I_A);
        TEST_ASSERT_TRUE(d.highest_rad_s < 1.2 * 0.01 * VEC_TWO_PI / d.base.T_s);
        for (int k = 0; k < DRAWN_VALUES; k++) {
            double value = 0.0;
            double half = 0.0;
            drawn_result(&d, k, &value, &half);
            const double miss = (value - d.truth[k]) / half;
            printf("  drive %d %-6s %9.6f found %9.6f +- %.6f, %5.2f half widths off\n", (int)n,
                   drawn_names[k], d.truth[k], value, half, miss);
            TEST_ASSERT_TRUE(fabs(miss) < 2.0);
            TEST_ASSERT_TRUE(half < (k >= DRAWN_O_A ? 0.001 : 0.02 * d.truth[k]));
            inside += fabs(miss) <= 1.0 ? 1 : 0;
            squares += miss * miss;
        }
        stays(IQFOC_COMMISSION_DONE);
    }
    const double rms = sqrt(squares / (DRIVES * DRAWN_VALUES));
    printf("  %d of %d intervals hold the truth; rms %.2f half widths\n", inside, DRIVES * DRAWN_VALUES, rms);
    TEST_ASSERT_TRUE(inside >= DRIVES * DRAWN_VALUES - 4);
    TEST_ASSERT_TRUE(rms > 0.2);
}

/* The course of the current between the samples, without noise: what the estimator of L leaves out. Small time constants, all dead times. */
static void test_course(void)
{
    double worst_l[2] = {0.0, 0.0};
    for (uint64_t n = 0; n < 4; n++) {
        drawn_begin(&d, SEED, n);
        plant_config c = d.plant.config;
        c.sensors.current_noise_A = 0.0;
        c.sensors.current_bits = 0;
        c.machine.R_ohm = (n < 2 ? 0.1 : 0.05) * c.machine.L_d_H / d.base.T_s;
        c.inverter.t_dead_s = (n % 2 == 0 ? 0.002 : 0.016) * d.base.T_s;
        plant_init(&d.plant, &c);
        run_to(IQFOC_COMMISSION_RUN_UP);
        for (int k = 0; k < 2; k++) {
            double value = 0.0;
            double half = 0.0;
            drawn_result(&d, DRAWN_L_D + k, &value, &half);
            worst_l[k] = fmax(worst_l[k], fabs(value / d.truth[DRAWN_L_D + k] - 1.0));
        }
    }
    printf("  L_d %.1e, L_q %.1e off\n", worst_l[0], worst_l[1]);
    TEST_ASSERT_TRUE(worst_l[0] < 5e-5);
    TEST_ASSERT_TRUE(worst_l[1] < 5e-5);
}

/* The parameter set passes the checks of those who take it. */
static void test_parameters(void)
{
    iqfoc_flux_predictor_t predictor;
    iqfoc_extension_t extension;
    iqfoc_commission_parameters(&d.commission.result, &predictor, &extension);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&predictor));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_extension_check(&extension));
    TEST_ASSERT_EQUAL_INT32(d.commission.result.l_d.value, predictor.l_d);
    TEST_ASSERT_EQUAL_INT32(d.commission.result.l_q.value, predictor.l_q);
    TEST_ASSERT_EQUAL_INT32(d.commission.result.r.value, predictor.r);
    TEST_ASSERT_EQUAL_INT32(d.commission.result.psi.value, predictor.psi);
    TEST_ASSERT_EQUAL_INT32(d.commission.result.v_dead.value, extension.v_dead);
    TEST_ASSERT_EQUAL_INT32(d.commission.result.i_offset.b, extension.i_offset.b);
}

/* Aborted in each phase; what earlier phases found stays. */
static void test_abort(void)
{
    for (int phase = 0; phase <= (int)IQFOC_COMMISSION_SPIN; phase++) {
        drawn_begin(&d, SEED, 0);
        run_to((iqfoc_commission_phase_t)phase);
        drawn_cycle(&d);
        iqfoc_commission_abort(&d.commission);
        stays(IQFOC_COMMISSION_ABORTED);
        TEST_ASSERT_EQUAL_INT(phase, (int)d.commission.phase);
        TEST_ASSERT_TRUE((d.commission.result.r.value != 0) == (phase > (int)IQFOC_COMMISSION_STAIRCASE));
        TEST_ASSERT_TRUE((d.commission.result.l_d.value != 0) ==
                         (phase > (int)IQFOC_COMMISSION_INDUCTANCE_D));
        TEST_ASSERT_EQUAL_INT32(0, d.commission.result.psi.value);
    }
}

/* One step with a sample that is not allowed, in the middle of the alignment. */
static void end_by(iqfoc_sample_t sample, iqfoc_commission_end_t end)
{
    drawn_begin(&d, SEED, 0);
    run_to(IQFOC_COMMISSION_ALIGN);
    const iqfoc_command_t command = iqfoc_commission_step(&d.commission, &sample);
    TEST_ASSERT_EQUAL_INT(end == IQFOC_COMMISSION_RUNNING, command.gates);
    TEST_ASSERT_EQUAL_INT(end, d.commission.end);
    if (end != IQFOC_COMMISSION_RUNNING) {
        stays(end);
    }
}

static void test_limits(void)
{
    drawn_begin(&d, SEED, 0);
    run_to(IQFOC_COMMISSION_ALIGN);
    iqfoc_sample_t good = d.sample;
    good.i = d.commission.result.i_offset;
    end_by(good, IQFOC_COMMISSION_RUNNING);
    iq24_t *const phases[3] = {&good.i.a, &good.i.b, &good.i.c};
    for (int x = 0; x < 3; x++) {
        const iq24_t offset = *phases[x];
        *phases[x] = offset + d.config.i_max;
        end_by(good, IQFOC_COMMISSION_RUNNING);
        *phases[x] = offset + d.config.i_max + 1;
        end_by(good, IQFOC_COMMISSION_OVER_CURRENT);
        *phases[x] = offset - d.config.i_max - 1;
        end_by(good, IQFOC_COMMISSION_OVER_CURRENT);
        *phases[x] = offset;
    }
    iqfoc_sample_t sample = good;
    sample.clipped = true;
    end_by(sample, IQFOC_COMMISSION_OVER_CURRENT);
    sample = good;
    sample.speed = d.config.speed_max + 1;
    end_by(sample, IQFOC_COMMISSION_OVER_SPEED);
    sample.speed = IQ24_MIN;
    end_by(sample, IQFOC_COMMISSION_OVER_SPEED);
    sample = good;
    sample.u_dc = IQ24(0.5) - 1;
    end_by(sample, IQFOC_COMMISSION_DC_LINK);
    sample.u_dc = IQ24(1.5) + 1;
    end_by(sample, IQFOC_COMMISSION_DC_LINK);
}

static void test_too_slow(void)
{
    drawn_begin(&d, SEED, 0);
    d.config.cycles_max = 5000;
    for (int k = 0; k < 5000; k++) {
        drawn_cycle(&d);
        TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_RUNNING, d.commission.end);
    }
    stays(IQFOC_COMMISSION_TOO_SLOW);
}

static void test_noisy_sensor(void)
{
    drawn_begin(&d, SEED, 0);
    d.plant.config.sensors.current_noise_A = 0.1 * d.base.I_A;
    while (d.commission.end == IQFOC_COMMISSION_RUNNING) {
        drawn_cycle(&d);
        TEST_ASSERT_FALSE(d.command.gates);
    }
    stays(IQFOC_COMMISSION_SENSORS);
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_NOISY, d.commission.offset.verdict);
}

/* No motor: the square wave ends at u_max and never exceeds it. */
static void test_no_motor(void)
{
    iqfoc_sample_t sample = {.u_dc = IQ24_ONE};
    drawn_begin(&d, SEED, 0);
    double highest = 0.0;
    while (d.commission.end == IQFOC_COMMISSION_RUNNING) {
        const iqfoc_command_t command = iqfoc_commission_step(&d.commission, &sample);
        highest = fmax(highest, fabs(iq24_to_double(command.duties.high.a - command.duties.high.b)));
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_NO_CURRENT, d.commission.end);
    TEST_ASSERT_EQUAL_INT(IQFOC_COMMISSION_SEEK_ALPHA, d.commission.phase);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5 * iq24_to_double(d.config.u_max), highest);
}

/* A shaft that is blocked at the angle of the alignment. */
static void test_blocked(void)
{
    drawn_begin(&d, SEED, 0);
    plant_config c = d.plant.config;
    c.shaft.mode = PLANT_SHAFT_GIVEN;
    c.shaft.theta_mech_start_rad = 0.0;
    plant_init(&d.plant, &c);
    while (d.commission.end == IQFOC_COMMISSION_RUNNING) {
        drawn_cycle(&d);
    }
    stays(IQFOC_COMMISSION_NOT_TURNING);
    TEST_ASSERT_TRUE(d.highest_A < 2.0 * 0.5 * d.base.I_A);
}

/* psi_f = share (L_q - L_d) i_align, on a shaft as stiff as the drawn one. The header's formula gives L_q - L_d wherever the rotor rests. */
static void end_with_share(double share, double salient, iqfoc_commission_end_t end)
{
    drawn_begin(&d, SEED, 1);
    plant_config c = d.plant.config;
    c.machine.L_q_H = salient * c.machine.L_d_H;
    c.machine.psi_f_Wb = share * (c.machine.L_q_H - c.machine.L_d_H) * 0.5 * d.base.I_A;
    c.shaft.J_kgm2 *= c.machine.psi_f_Wb / d.motor.psi_f_Wb;
    c.shaft.friction_Nms *= c.machine.psi_f_Wb / d.motor.psi_f_Wb;
    plant_init(&d.plant, &c);
    while (d.commission.end == IQFOC_COMMISSION_RUNNING) {
        drawn_cycle(&d);
    }
    stays(end);
    const double l_d = iq24_to_double(d.commission.result.l_d.value);
    const double l_q = iq24_to_double(d.commission.result.l_q.value);
    const double k = iq24_to_double(d.commission.across);
    const double found = hypot(l_q - l_d, 2.0 * k * l_q) / (1.0 - k * k * l_q / l_d);
    const double truth = (salient - 1.0) * c.machine.L_d_H * d.base.I_A / (d.base.U_V * d.base.T_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * truth, truth, found);
}

static void test_alignment(void)
{
    end_with_share(0.4, 3.0, IQFOC_COMMISSION_NOT_ALIGNED);
    end_with_share(0.7, 1.5, IQFOC_COMMISSION_NOT_ALIGNED);
    end_with_share(1.2, 1.5, IQFOC_COMMISSION_NOT_ALIGNED);
    end_with_share(1.8, 3.0, IQFOC_COMMISSION_DONE);
}

static void refused(const iqfoc_commission_config_t *good, size_t at, int32_t value)
{
    iqfoc_commission_config_t config = *good;
    iqfoc_commission_t before = d.commission;
    memcpy((char *)&config + at, &value, sizeof value);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_COMMISSION, iqfoc_commission_init(&d.commission, &config));
    TEST_ASSERT_EQUAL_MEMORY(&before, &d.commission, sizeof before);
}

static void taken(const iqfoc_commission_config_t *good, size_t at, int32_t value)
{
    iqfoc_commission_config_t config = *good;
    memcpy((char *)&config + at, &value, sizeof value);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_commission_init(&d.commission, &config));
}

#define AT(field) offsetof(iqfoc_commission_config_t, field)

static void test_configuration(void)
{
    drawn_begin(&d, SEED, 0);
    const iqfoc_commission_config_t good = d.config;
    const iq24_t share = IQ24(0.25);
    const struct {
        size_t at;
        int32_t low, high;
    } fields[] = {
        {AT(start.i_align), 1, IQ24(2.0 / 3.0)},
        {AT(i_max), IQ24(0.75), IQ24(4.0)},
        {AT(speed_max), good.start.speed_end, IQFOC_ROTOR_SPEED_MAX},
        {AT(u_max), 1, IQ24(0.5)},
        {AT(settle_cycles), 1, INT32_C(1) << 24},
        {AT(block_log2), 6, 12},
        {AT(half_log2), 1, 2},
        {AT(share_r), 0, share},
        {AT(share_l), 0, share},
        {AT(share_psi), 0, share},
        {AT(offset.count_log2), 2, 16},
        {AT(start.hold_cycles), 1, INT32_C(1) << 24},
    };
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++) {
        refused(&good, fields[k].at, fields[k].low - 1);
        refused(&good, fields[k].at, fields[k].high + 1);
        taken(&good, fields[k].at, fields[k].low);
        taken(&good, fields[k].at, fields[k].high);
    }
    refused(&good, AT(start.speed_end), 0);
    refused(&good, AT(cycles_max), 0);
    taken(&good, AT(cycles_max), 1);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_commission_init(NULL, &good));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_commission_init(&d.commission, NULL));
}

/* ---- The estimators against long double ---- */

#define N IQFOC_COMMISSION_BLOCKS

typedef struct line {
    long double a, b, half_a, half_b;
} line;

static line line_reference(const iq24_t x[N], const iq24_t y[N])
{
    long double mx = 0.0L;
    long double my = 0.0L;
    long double xx = 0.0L;
    long double xy = 0.0L;
    long double squares = 0.0L;
    for (int k = 0; k < N; k++) {
        mx += x[k] / 16777216.0L / N;
        my += y[k] / 16777216.0L / N;
    }
    for (int k = 0; k < N; k++) {
        xx += (x[k] / 16777216.0L - mx) * (x[k] / 16777216.0L - mx);
        xy += (x[k] / 16777216.0L - mx) * (y[k] / 16777216.0L - my);
    }
    line l = {0.0L, xy / xx, 0.0L, 0.0L};
    l.a = my - l.b * mx;
    for (int k = 0; k < N; k++) {
        const long double e = y[k] / 16777216.0L - l.a - l.b * (x[k] / 16777216.0L);
        squares += e * e;
    }
    const long double s = sqrtl(squares / (N - 2));
    l.half_b = 2.042L * s / sqrtl(xx);
    l.half_a = 2.042L * s * sqrtl(1.0L / N + mx * mx / xx);
    return l;
}

/* An error in units of scale. */
static void add_scaled(worst *w, iq24_t got, double want, double scale)
{
    w->lsb = fmax(w->lsb, fabs(got - 16777216.0 * want) / scale);
}

static void test_estimators(void)
{
    uint64_t seed = SEED;
    worst a = {"a", 0.0};
    worst b = {"slope", 0.0};
    worst l = {"inductance", 0.0};
    double low = 1e9;
    double high = -1e9;
    for (int n = 0; n < 3000; n++) {
        iq24_t x[N];
        iq24_t y[N];
        const double r = pow(10.0, uniform(&seed, -2.5, -0.05));
        const double noise = pow(10.0, uniform(&seed, -6.0, -3.0));
        const double i = uniform(&seed, 0.2, 2.0);
        for (int k = 0; k < N; k++) {
            const double level = i * (2 + k / 8) / 5.0;
            x[k] = to_iq24(level + 0.01 * uniform(&seed, -1.0, 1.0));
            y[k] = to_iq24(0.02 + r * level + noise * uniform(&seed, -1.0, 1.0));
        }
        const line expected = line_reference(x, y);
        const commission_line_t found = commission_line(x, y);
        worst_add(&a, found.at_zero.value, (double)expected.a);
        worst_add(&b, found.slope.value, (double)expected.b);
        const double over_a = found.at_zero.half - (double)expected.half_a * 16777216.0;
        const double over_b = found.slope.half - (double)expected.half_b * 16777216.0;
        low = fmin(low, fmin(over_a, over_b));
        high = fmax(high, fmax(over_a / (1.0 + i), over_b * i));
        /* D and S of an inductance. */
        const double u = uniform(&seed, 0.05, 0.5);
        long double d_mean = 0.0L;
        long double s_mean = 0.0L;
        for (int k = 0; k < N; k++) {
            x[k] = to_iq24(u * i * (1.0 + noise * uniform(&seed, -1.0, 1.0)));
            y[k] = to_iq24(0.1 * i * uniform(&seed, -1.0, 1.0));
            d_mean += x[k] / 16777216.0L / N;
            s_mean += y[k] / 16777216.0L / N;
        }
        iqfoc_commission_result_t known;
        memset(&known, 0, sizeof known);
        known.r.value = to_iq24(r);
        known.v_dead.value = to_iq24(uniform(&seed, -0.02, 0.02));
        const iq24_t h_u = to_iq24(2.0 * u);
        const long double r_held = known.r.value / 16777216.0L;
        const long double rough = (h_u / 16777216.0L - r_held * s_mean) / d_mean;
        const long double exact =
            rough + r_held * (known.v_dead.value / 33554432.0L - 0.09375L * r_held / rough);
        const double scale = fmax(1.0, (double)((1.0L + exact) / d_mean));
        add_scaled(&l, commission_inductance(&known, x, y, h_u).value, (double)exact, scale);
    }
    worst_check(&a, 1.6);
    worst_check(&b, 0.51);
    worst_check(&l, 0.75);
    printf("  half widths %.2f ... %.2f LSB off\n", low, high);
    TEST_ASSERT_TRUE(low > -1.6);
    TEST_ASSERT_TRUE(high < 6.0);
}

/* psi_f of a machine in any steady state. */
static void test_flux(void)
{
    uint64_t seed = SEED;
    worst flux = {"psi_f", 0.0};
    for (int n = 0; n < 3000; n++) {
        const double speed = uniform(&seed, 0.005, 0.05) * (n % 2 == 0 ? 1.0 : -1.0);
        const double delta = uniform(&seed, -1.0, 1.0);
        const double psi = uniform(&seed, 0.5, 4.0);
        const double size = uniform(&seed, 0.1, 1.0);
        iqfoc_commission_result_t known;
        memset(&known, 0, sizeof known);
        known.r.value = to_iq24(uniform(&seed, 0.0, 0.1));
        known.v_dead.value = to_iq24(uniform(&seed, 0.0, 0.02));
        known.l_d.value = to_iq24(uniform(&seed, 0.1, 2.0));
        known.l_q.value = to_iq24(uniform(&seed, 0.1, 2.0));
        const double phi_s1 = 2.0 * sin(0.5 * TWO_PI * speed);
        const double complex turn = cexp(I * delta); /* rotor - frame */
        const double complex i = size;
        const double complex i_r = i / turn;
        const double l_d = known.l_d.value / 16777216.0;
        const double l_q = known.l_q.value / 16777216.0;
        const double complex linkage = (psi + l_d * creal(i_r) + I * l_q * cimag(i_r)) * turn;
        const double complex u = I * phi_s1 * linkage + known.r.value / 16777216.0 * i +
                                 4.0 / (0.5 * TWO_PI) * known.v_dead.value / 16777216.0;
        if (psi + (l_d - l_q) * creal(i_r) < 0.2) {
            continue; /* the active flux must not vanish */
        }
        const commission_means_t means = {{to_iq24(creal(i)), to_iq24(cimag(i))},
                                          {to_iq24(creal(u)), to_iq24(cimag(u))}};
        const iq24_t found = commission_flux(&known, &means, to_iq24(phi_s1));
        /* A voltage of 1 LSB is 1/phi of flux, and phi's own rounding psi/phi. */
        const double scale = (2.0 + fabs(psi) + size * (l_d + l_q)) / fabs(phi_s1);
        add_scaled(&flux, found, psi, scale);
    }
    worst_check(&flux, 0.55);
}

/* An aligned machine at either side of psi_f = 3/2 |L_q - L_d| i_align. */
static void test_aligns(void)
{
    iqfoc_commission_result_t known;
    memset(&known, 0, sizeof known);
    known.l_d.value = IQ24(1.0);
    for (int n = 0; n < 2; n++) {
        known.l_q.value = n == 0 ? IQ24(3.0) : IQ24(0.5);
        const double least = 1.5 * fabs(iq24_to_double(known.l_q.value) - 1.0) * 0.5;
        known.psi.value = to_iq24(least * 1.000001);
        TEST_ASSERT_TRUE(commission_aligns(&known, 0, IQ24(0.5)));
        known.psi.value = to_iq24(least * 0.999999);
        TEST_ASSERT_FALSE(commission_aligns(&known, 0, IQ24(0.5)));
    }
    known.psi.value = IQ24(16.0);
    TEST_ASSERT_FALSE(commission_aligns(&known, IQ24(-128.0), IQ24(0.5)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_drives);
    RUN_TEST(test_parameters);
    RUN_TEST(test_course);
    RUN_TEST(test_abort);
    RUN_TEST(test_limits);
    RUN_TEST(test_alignment);
    RUN_TEST(test_too_slow);
    RUN_TEST(test_noisy_sensor);
    RUN_TEST(test_no_motor);
    RUN_TEST(test_blocked);
    RUN_TEST(test_configuration);
    RUN_TEST(test_estimators);
    RUN_TEST(test_aligns);
    RUN_TEST(test_flux);
    return UNITY_END();
}
