/*
 * Whole diagnoses: a recording of a real run with values of it changed, and a motor file with values of it changed,
 * both within what their readers accept. The diagnosis ends, and reports neither nan nor inf.
 */
#include "data/motor.h"
#include "data/recording.h"
#include "diagnose/diagnose.h"
#include "diagnose/tell/text.h"
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROWS 400

static recording whole;
static motor nominal;

int LLVMFuzzerInitialize(int *argc, char ***argv);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    error e = {0};
    setenv("IQFOC_JOBS", "1", 1); /* the same threads every time */
    fuzz_expect(recording_read(FUZZ_ROOT "/data/recordings/dead_time.csv.gz", &whole, &e) &&
                    motor_read(FUZZ_ROOT "/data/recordings/dead_time.toml", &nominal, &e),
                "the fuzzer itself: the recording to begin with");
    return 0;
}

/* A part of the recording as a CSV file, with `edits` of its values replaced. */
static size_t write_rows(char *text, size_t size, fuzz_bytes *b)
{
    FILE *out = fmemopen(text, size, "w");
    const size_t first = fuzz_take(b, 2) % (whole.rows - ROWS);
    const size_t edits = fuzz_take(b, 1) % 16;
    double rows[ROWS][8];
    for (size_t k = 0; k < ROWS; k++) {
        const size_t n = first + k;
        double u[3];
        recording_voltage(&whole, n, u);
        const double row[8] = {whole.t_s[n],
                               whole.i_A[0][n],
                               whole.i_A[1][n],
                               whole.theta_e_rad[n],
                               whole.omega_e_rad_s[n],
                               u[0],
                               u[1],
                               u[2]};
        memcpy(rows[k], row, sizeof row);
    }
    for (size_t k = 0; k < edits; k++) {
        const size_t column = 1 + fuzz_take(b, 1) % 7;
        const size_t from = fuzz_take(b, 2) % ROWS;
        const size_t count = 1 + fuzz_take(b, 2) % ROWS;
        const double factor = ldexp((double)(int8_t)fuzz_take(b, 1), (int)(fuzz_take(b, 1) % 64) - 32);
        const double added = ldexp((double)(int8_t)fuzz_take(b, 1), (int)(fuzz_take(b, 1) % 64) - 32);
        for (size_t row = from; row < from + count && row < ROWS; row++) {
            rows[row][column] = rows[row][column] * factor + added;
        }
    }
    fprintf(out, "t_s,i_a_A,i_b_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V\n");
    for (size_t k = 0; k < ROWS; k++) {
        for (size_t column = 0; column < 8; column++) {
            fprintf(out, "%.10g%c", rows[k][column], column == 7 ? '\n' : ',');
        }
    }
    const long length = ftell(out);
    fclose(out);
    return (size_t)length;
}

/* Values of the motor file scaled, within what its reader accepts: it is written and read. */
static bool scaled_motor(motor *m, fuzz_bytes *b)
{
    error e = {0};
    motor scaled = nominal;
    double *const values[] = {&scaled.R_ohm, &scaled.L_d_H, &scaled.L_q_H, &scaled.psi_f_Wb,
                              &scaled.I_rated_A_rms};
    const uint32_t which = fuzz_take(b, 1);
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
        if ((which >> k & 1) != 0) {
            *values[k] *= ldexp(1.0 + (double)fuzz_take(b, 1) / 256.0, (int)(fuzz_take(b, 1) % 24) - 12);
        }
    }
    const char *path = fuzz_output();
    const bool read = motor_write(path, &scaled, NULL, &e) && motor_read(path, m, &e);
    if (!read) {
        fuzz_expect_refusal(&e);
    }
    remove(path);
    return read;
}

static void expect_told(const diagnosis *d)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    text_print(out, d);
    fclose(out);
    fuzz_expect(length > 0, "a diagnosis says something");
    fuzz_expect_numbers(text);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char text[ROWS * 8 * 24];
    error e = {0};
    fuzz_bytes b = {data, size};
    motor m;
    recording r;
    if (!scaled_motor(&m, &b)) {
        return 0;
    }
    const size_t length = write_rows(text, sizeof text, &b);
    if (!recording_read(fuzz_file((const uint8_t *)text, length), &r, &e)) {
        fuzz_expect_refusal(&e);
        return 0;
    }
    const diagnose_options options = {0};
    diagnosis d;
    if (diagnose(&d, &r, &m, &options, &e)) {
        expect_told(&d);
        diagnosis_free(&d);
    } else {
        fuzz_expect_refusal(&e);
    }
    recording_free(&r);
    return 0;
}
