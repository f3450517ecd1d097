/*
 * One drawn drive's self-commissioning (tests/unit/library/commission_drive.h) with the library's recorder at work: the recorder's bytes, one
 * run for each operating point, a motor file whose values are off by up to 20 %, and one line with the results.
 *
 *     commission_study NUMBER STREAM MOTOR
 *
 * The line: end, cycles, highest phase current in units of i_align, then for each result name, truth, value, half width, in SI units.
 */
#include "commission_drive.h"

#include "iqfoc/recorder.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SEED UINT64_C(20261125)

static drawn_drive d;
static int32_t memory[4096];

void setUp(void)
{
}

void tearDown(void)
{
}

/* The largest shift that leaves the mantissa below 2^31, for a value in units of `unit` with 24 fractional bits. */
static iqfoc_recorder_channel_t channel(const iq24_t *source, uint32_t what, double unit)
{
    int exponent = 0;
    (void)frexp(unit, &exponent);
    const int bits = 30 - exponent;
    const iqfoc_recorder_channel_t c = {source, what, (int32_t)lround(ldexp(unit, bits)),
                                        (uint32_t)(24 + bits)};
    return c;
}

static void send(iqfoc_recorder_t *recorder, FILE *out)
{
    for (int32_t octet = iqfoc_recorder_octet(recorder); octet >= 0; octet = iqfoc_recorder_octet(recorder)) {
        (void)fputc(octet, out);
    }
}

static void write_motor(const char *path, uint64_t n)
{
    plant_random r;
    error e = {0};
    plant_random_seed(&r, SEED + 1, n);
    motor m = d.motor;
    (void)snprintf(m.name, sizeof m.name, "drawn %d", (int)n);
    double *const values[] = {&m.R_ohm, &m.L_d_H, &m.L_q_H, &m.psi_f_Wb};
    for (int k = 0; k < 4; k++) {
        *values[k] *= 0.8 + 0.4 * plant_random_uniform(&r);
    }
    TEST_ASSERT_TRUE_MESSAGE(motor_write(path, &m, "A drawn drive, its values off by up to 20 %.", &e),
                             e.text);
}

/*
 * Whether this cycle is recorded: the blocks of each operating point, and the current's slow quarter turn at standstill. There a phase
 * current passes zero slowly, which shows the dead time's knee: without it R and the dead time are not distinguishable.
 */
static bool is_recorded(void)
{
    switch (d.commission.phase) {
    case IQFOC_COMMISSION_ALIGN:
        return d.commission.start.stage == IQFOC_START_TURN;
    case IQFOC_COMMISSION_STAIRCASE:
    case IQFOC_COMMISSION_INDUCTANCE_D:
    case IQFOC_COMMISSION_INDUCTANCE_Q:
    case IQFOC_COMMISSION_SHAFT:
    case IQFOC_COMMISSION_SPIN:
        return d.commission.wait == 0;
    default:
        return false;
    }
}

static void run(FILE *out)
{
    const iqfoc_recorder_config_t config = {
        .channels = {channel(&d.sample.i.a, IQFOC_RECORDER_I_A, d.base.I_A),
                     channel(&d.sample.i.b, IQFOC_RECORDER_I_B, d.base.I_A),
                     channel(&d.sample.i.c, IQFOC_RECORDER_I_C, d.base.I_A),
                     channel(&d.sample.theta, IQFOC_RECORDER_THETA_E, VEC_TWO_PI),
                     channel(&d.sample.speed, IQFOC_RECORDER_OMEGA_E, VEC_TWO_PI / d.base.T_s),
                     channel(&d.duties.a, IQFOC_RECORDER_D_A, 1.0),
                     channel(&d.duties.b, IQFOC_RECORDER_D_B, 1.0),
                     channel(&d.duties.c, IQFOC_RECORDER_D_C, 1.0),
                     channel(&d.sample.u_dc, IQFOC_RECORDER_U_DC, d.base.U_V)},
        .channel_count = 9,
        .decimation = 1,
        .period_mantissa = (uint32_t)lround(ldexp(d.base.T_s, 40)),
        .period_shift = 40,
        .trigger = IQFOC_RECORDER_NOW};
    iqfoc_recorder_t recorder;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_recorder_init(&recorder, &config, memory, 4096));
    bool recorded = false;
    while (d.commission.end == IQFOC_COMMISSION_RUNNING) {
        drawn_cycle(&d);
        if (recorded && !is_recorded()) {
            iqfoc_recorder_stop(&recorder);
            send(&recorder, out);
        } else if (!recorded && is_recorded()) {
            iqfoc_recorder_arm(&recorder);
        }
        recorded = is_recorded();
        if (recorded) {
            iqfoc_recorder_take(&recorder, 0);
            send(&recorder, out);
        }
    }
    iqfoc_recorder_stop(&recorder);
    send(&recorder, out);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        (void)fputs("usage: commission_study NUMBER STREAM MOTOR\n", stderr);
        return 2;
    }
    const uint64_t n = strtoull(argv[1], NULL, 10);
    FILE *out = fopen(argv[2], "wb");
    if (out == NULL) {
        perror(argv[2]);
        return 2;
    }
    drawn_begin(&d, SEED, n);
    run(out);
    if (fclose(out) != 0) {
        perror(argv[2]);
        return 2;
    }
    write_motor(argv[3], n);
    const double ohm = d.base.U_V / d.base.I_A;
    const double flux = d.base.U_V * d.base.T_s;
    const double units[DRAWN_VALUES] = {ohm,  d.base.U_V, ohm * d.base.T_s, ohm * d.base.T_s,
                                        flux, d.base.I_A, d.base.I_A,       d.base.I_A};
    printf("%d %u %.4f", (int)d.commission.end, (unsigned)d.commission.cycles,
           d.highest_A / d.base.I_A / iq24_to_double(d.config.start.i_align));
    for (int k = 0; k < DRAWN_VALUES; k++) {
        double value = 0.0;
        double half = 0.0;
        drawn_result(&d, k, &value, &half);
        printf(" %s %.9g %.9g %.9g", drawn_names[k], d.truth[k] * units[k], value * units[k],
               half * units[k]);
    }
    printf("\n");
    return 0;
}
