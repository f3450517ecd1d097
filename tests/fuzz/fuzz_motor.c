/* Motor files: an accepted file is finite and the same after writing and reading. */
#include "data/motor.h"
#include "fuzz.h"

#include <math.h>
#include <unistd.h>

static void expect_round_trip(const motor *read)
{
    error e = {0};
    motor again;
    const char *path = fuzz_output();
    fuzz_expect(motor_write(path, read, NULL, &e), "what was read can be written");
    fuzz_expect(motor_read(path, &again, &e), "what was written can be read");
    unlink(path);
    fuzz_expect(again.pole_pairs == read->pole_pairs && again.R_ohm == read->R_ohm &&
                    again.L_d_H == read->L_d_H && again.L_q_H == read->L_q_H &&
                    again.psi_f_Wb == read->psi_f_Wb && again.f_pwm_Hz == read->f_pwm_Hz,
                "a motor that was written reads as it was");
    for (size_t k = 0; k < motor_values_length; k++) {
        const motor_value *v = &motor_values[k];
        if (!v->of_machine && read->ext.has[v->cause]) {
            const double value = motor_value_of(read, v);
            fuzz_expect(isfinite(value) || isnan(v->absent), "every value of an extension is finite");
            fuzz_expect(!isfinite(value) || value == motor_value_of(&again, v),
                        "an extension that was written reads as it was");
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    error e = {0};
    motor m;
    if (motor_read(fuzz_file(data, size), &m, &e)) {
        expect_round_trip(&m);
    } else {
        fuzz_expect_refusal(&e);
    }
    return 0;
}
