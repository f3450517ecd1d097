/* Recordings, plain or gzip: an accepted recording is finite and the same after writing and reading. */
#include "data/recording.h"
#include "fuzz.h"

#include <math.h>
#include <unistd.h>

static bool same_column(const double *a, const double *b, size_t rows)
{
    if (a == NULL || b == NULL) {
        return a == b;
    }
    for (size_t k = 0; k < rows; k++) {
        fuzz_expect(isfinite(a[k]), "every value of a recording is finite");
        if (a[k] != b[k]) {
            return false;
        }
    }
    return true;
}

static bool same_triple(double *const a[3], double *const b[3], size_t rows)
{
    return same_column(a[0], b[0], rows) && same_column(a[1], b[1], rows) && same_column(a[2], b[2], rows);
}

static void expect_round_trip(const recording *read)
{
    error e = {0};
    recording again;
    const char *path = fuzz_output();
    fuzz_expect(recording_write(path, read, "as it was read", &e), "what was read can be written");
    fuzz_expect(recording_read(path, &again, &e), "what was written can be read");
    unlink(path);
    fuzz_expect(again.rows == read->rows && again.stretches == read->stretches &&
                    same_column(read->t_s, again.t_s, read->rows) &&
                    same_column(read->theta_e_rad, again.theta_e_rad, read->rows) &&
                    same_triple(read->u_V, again.u_V, read->rows) &&
                    same_triple(read->duty, again.duty, read->rows) &&
                    same_column(read->i_A[0], again.i_A[0], read->rows) &&
                    same_column(read->i_A[1], again.i_A[1], read->rows) &&
                    same_column(read->u_dc_V, again.u_dc_V, read->rows) &&
                    same_column(read->temp_C, again.temp_C, read->rows),
                "what was written reads as it was");
    recording_free(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    error e = {0};
    recording r;
    if (recording_read(fuzz_file(data, size), &r, &e)) {
        fuzz_expect(r.rows > 0 && r.stretches > 0 && isfinite(r.T_s), "a recording has rows and a cycle");
        expect_round_trip(&r);
        recording_free(&r);
    } else {
        fuzz_expect_refusal(&e);
    }
    return 0;
}
