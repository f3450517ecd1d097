/* A controller of the library, step by step or for many cycles with the plant. */
#include "handles.h"

#include <math.h>

static const char *const run_columns[] = {
    "t_s", "i_a_A", "i_b_A",     "i_c_A",     "theta_e_rad", "omega_e_rad_s", "u_dc_V",     "d_a",
    "d_b", "d_c",   "i_a_mid_A", "i_b_mid_A", "i_c_mid_A",   "i_d_mean_A",    "i_q_mean_A", "torque_Nm"};
enum { RUN_COLUMNS = sizeof run_columns / sizeof run_columns[0] };

void py_firmware_begin(py_firmware *f, drive_firmware calls)
{
    const iqfoc_abc_t half = {IQ24_ONE / 2, IQ24_ONE / 2, IQ24_ONE / 2};
    *f = (py_firmware){.calls = calls,
                       .answer = {.command = {{half, IQ24_ONE}, true}},
                       .output_mid = IQ24_ONE + IQ24_ONE / 2};
}

void py_firmware_reference(py_firmware *f, int32_t d, int32_t q)
{
    f->i_ref = (iqfoc_dq_t){d, q};
}

static iqfoc_sample_t sample_of(const py_sample *s)
{
    const iqfoc_sample_t sample = {.i = {s->i[0], s->i[1], s->i[2]},
                                   .theta = s->theta,
                                   .turns = s->turns,
                                   .u_dc = s->u_dc,
                                   .at = s->at,
                                   .time = s->time,
                                   .clipped = s->clipped};
    return sample;
}

/* The calls of these controllers do not fail. */
void py_firmware_valley(py_firmware *f, const py_sample *sample)
{
    const iqfoc_sample_t s = sample_of(sample);
    (void)f->calls.valley(f->calls.context, f->i_ref, &s, NULL);
}

void py_firmware_peak(py_firmware *f, const py_sample *sample, int32_t output_mid, py_command *command)
{
    const iqfoc_sample_t s = sample_of(sample);
    f->output_mid = output_mid;
    (void)f->calls.peak(f->calls.context, f->i_ref, &s, &f->answer, NULL);
    f->output_mid = IQ24_ONE + IQ24_ONE / 2;
    const iqfoc_abc_t high = f->answer.command.duties.high;
    *command =
        (py_command){{high.a, high.b, high.c}, f->answer.command.duties.scale, f->answer.command.gates};
}

const char *py_run_column_name(size_t column)
{
    return column < RUN_COLUMNS ? run_columns[column] : NULL;
}

static void put_row(const drive_row *r, double torque_Nm, double *const *column, size_t k)
{
    const plant_samples *v = &r->valley;
    const double value[RUN_COLUMNS] = {v->t_s,         v->i_A[0],         v->i_A[1],         v->i_A[2],
                                       v->theta_e_rad, v->omega_e_rad_s,  v->u_dc_V,         r->duty[0],
                                       r->duty[1],     r->duty[2],        r->peak.i_A[0],    r->peak.i_A[1],
                                       r->peak.i_A[2], r->truth.i_dq_A.d, r->truth.i_dq_A.q, torque_Nm};
    for (size_t n = 0; n < RUN_COLUMNS; n++) {
        column[n][k] = value[n];
    }
}

bool py_run(py_firmware *f, py_plant *p, size_t cycles, double *const *column, error *e)
{
    drive_loop *const l = &p->loop;
    l->firmware = &f->calls;
    drive_loop_put(l, &f->answer);
    for (size_t k = 0; k < cycles; k++) {
        drive_row row = {.run = 1};
        if (!f->answer.command.gates) {
            char text[160];
            return error_failure(e, 0, "the firmware stopped the drive at %.6f s: %s", l->drive.t_begin_s,
                                 f->answer.status == 0
                                     ? "it is not enabled"
                                     : drive_status_text(f->answer.status, text, sizeof text));
        }
        if (!drive_loop_span(l, f->i_ref, &row, e)) {
            return false;
        }
        f->answer = row.answer;
        put_row(&row, plant_now(&l->drive).torque_Nm, column, k);
    }
    return true;
}
