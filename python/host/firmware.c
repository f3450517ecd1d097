/* A controller of the library, step by step or for many cycles with the plant. */
#include "handles.h"

#include <math.h>

static const char *const run_columns[] = {
    "t_s",       "i_a_A",      "i_b_A",      "i_c_A",     "theta_e_rad", "omega_e_rad_s",
    "u_dc_V",    "d_a",        "d_b",        "d_c",       "i_a_mid_A",   "i_b_mid_A",
    "i_c_mid_A", "i_d_mean_A", "i_q_mean_A", "torque_Nm", "duration_s"};
enum { RUN_COLUMNS = sizeof run_columns / sizeof run_columns[0], RUN_PEAK = 10 /* the first of three */ };

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

iqfoc_sample_t py_sample_of(const py_sample *s)
{
    const iqfoc_sample_t sample = {.i = {s->i[0], s->i[1], s->i[2]},
                                   .theta = s->theta,
                                   .speed = s->speed,
                                   .u_dc = s->u_dc,
                                   .instant = s->instant,
                                   .time = s->time,
                                   .clipped = s->clipped,
                                   .has_mean = s->has_mean,
                                   .i_mean = {s->i_mean[0], s->i_mean[1], s->i_mean[2]}};
    return sample;
}

py_command py_command_of(const drive_answer *answer)
{
    const iqfoc_abc_t high = answer->command.duties.high;
    return (py_command){.duty = {high.a, high.b, high.c},
                        .scale = answer->command.duties.scale,
                        .gates = answer->command.gates,
                        .interval_s = answer->interval_s};
}

/* The calls of these controllers do not fail. */
void py_firmware_valley(py_firmware *f, const py_sample *sample)
{
    const iqfoc_sample_t s = py_sample_of(sample);
    (void)f->calls.valley(f->calls.context, f->i_ref, &s, NULL);
}

void py_firmware_peak(py_firmware *f, const py_sample *sample, int32_t output_mid, py_command *command)
{
    const iqfoc_sample_t s = py_sample_of(sample);
    f->output_mid = output_mid;
    (void)f->calls.peak(f->calls.context, f->i_ref, &s, &f->answer, NULL);
    f->output_mid = IQ24_ONE + IQ24_ONE / 2;
    *command = py_command_of(&f->answer);
}

const char *py_run_column_name(size_t column)
{
    return column < RUN_COLUMNS ? run_columns[column] : NULL;
}

void py_run_put(const drive_row *r, double torque_Nm, bool carrier, double *const *column, size_t k)
{
    const plant_samples *v = &r->valley;
    const double value[RUN_COLUMNS] = {
        v->t_s,           v->i_A[0],          v->i_A[1],      v->i_A[2],         v->theta_e_rad,
        v->omega_e_rad_s, v->u_dc_V,          r->duty[0],     r->duty[1],        r->duty[2],
        r->peak.i_A[0],   r->peak.i_A[1],     r->peak.i_A[2], r->truth.i_dq_A.d, r->truth.i_dq_A.q,
        torque_Nm,        r->truth.duration_s};
    for (size_t n = 0; n < RUN_COLUMNS; n++) {
        if (carrier || n < RUN_PEAK || n >= RUN_PEAK + 3) {
            column[n][k] = value[n];
        }
    }
}

/* The sample at the start of an interval is that of the end of the one before. */
static void interval_start(drive_loop *l, size_t k, plant_samples *start)
{
    if (k == 0) {
        plant_sample(&l->drive, start);
    }
}

bool py_run(py_firmware *f, py_plant *p, py_recorder *recorder, size_t cycles, double *const *column,
            error *e)
{
    drive_loop *const l = &p->loop;
    plant_samples last;
    l->firmware = &f->calls;
    drive_loop_put(l, &f->answer);
    for (size_t k = 0; k < cycles; k++) {
        drive_row row = {.run = 1};
        const bool carrier = l->interval_s == 0.0;
        if (!f->answer.command.gates) {
            char text[160];
            return error_failure(e, 0, "the firmware stopped the drive at %.6f s: %s", l->drive.t_begin_s,
                                 f->answer.status == 0
                                     ? "it is not enabled"
                                     : drive_status_text(f->answer.status, text, sizeof text));
        }
        if (!carrier) {
            interval_start(l, k, &last);
            row.valley = last;
        }
        if (!drive_loop_span(l, f->i_ref, &row, e)) {
            return false;
        }
        last = row.peak;
        f->answer = row.answer;
        py_run_put(&row, plant_now(&l->drive).torque_Nm, carrier, column, k);
        if (recorder != NULL) {
            py_recorder_take(recorder, &row, &l->drive.config.sensors);
        }
    }
    return true;
}
