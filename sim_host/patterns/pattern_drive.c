/* The control of a pulse pattern as a scenario's firmware (pattern_drive.h). */
#include "pattern_drive.h"

#include "base/vector.h"
#include "params_host.h"

#include <math.h>
#include <string.h>

static bool start(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    pattern_drive *d = context;
    (void)config;
    d->run++;
    d->cycle = 0;
    memset(d->edges, 0, sizeof d->edges);
    const iq24_t least = iq24_from_double(PATTERN_DRIVE_LEAST_S * d->m->f_pwm_Hz);
    const iqfoc_error_t refused = iqfoc_pattern_control_init(&d->control, &d->config, &d->table, least);
    return refused == IQFOC_OK ||
           error_failure(e, 0, "the library refused its pattern: iqfoc_error_t %d", (int)refused);
}

static double rpm_of(const motor *m, double per_cycle)
{
    return per_cycle * m->f_pwm_Hz * 60.0 / m->pole_pairs;
}

/* Whether speed, reference and link are within the pattern's range. */
static bool within_range(const pattern_drive *d, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    const scenario_run *run = &d->s->run[d->run - 1];
    const double speed = iq24_to_double(sample->speed);
    const double u_dc = iq24_to_double(sample->u_dc);
    const double least = iq24_to_double(IQFOC_PATTERN_CONTROL_SPEED_MIN);
    const double most = iq24_to_double(IQFOC_PATTERN_SPEED_MAX);
    const double low = patterns_index(0);
    const double high = patterns_index(d->table.rows - 1);
    motor now = *d->m;
    now.u_dc_V *= u_dc;
    const double index = patterns_index_of(&now, speed * d->m->f_pwm_Hz * VEC_TWO_PI, iq24_to_double(i_ref.d),
                                           iq24_to_double(i_ref.q));
    if (fabs(speed) >= least && fabs(speed) <= most && index >= low && index <= high && u_dc >= 0.5 &&
        u_dc <= 1.5) {
        return true;
    }
    const double t_s = (double)(d->cycle - run->settle_cycles) / d->m->f_pwm_Hz;
    return error_input(
        e, d->path, run->line, run->column,
        "run %zu at %.4f s: %.0f rpm, modulation index %.2f, link %.0f V; a pattern of %d pulses needs %.0f "
        "to %.0f rpm, an index of %.2f to %.2f and a link of %.0f to %.0f V",
        d->run, t_s, rpm_of(d->m, speed), index, now.u_dc_V, d->s->pwm.pulses, rpm_of(d->m, least),
        rpm_of(d->m, most), low, high, 0.5 * d->m->u_dc_V, 1.5 * d->m->u_dc_V);
}

static bool valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    pattern_drive *d = context;
    if (!within_range(d, i_ref, sample, e)) {
        return false;
    }
    if (d->cycle++ == 0) { /* no peak was before */
        iqfoc_pattern_control_aim(&d->control, i_ref, sample->speed);
    }
    d->speed = sample->speed;
    iqfoc_pattern_control_step(&d->control, iqfoc_clarke3(sample->i), sample->theta, sample->u_dc, d->edges);
    return true;
}

static bool peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                 error *e)
{
    pattern_drive *d = context;
    (void)sample;
    (void)e;
    iqfoc_pattern_control_aim(&d->control, i_ref, d->speed);
    answer->command.duties.high = d->control.high;
    answer->command.gates = true;
    answer->edges = d->edges;
    return true;
}

bool pattern_drive_begin(pattern_drive *d, const motor *m, const scenario *s, const char *path,
                         drive_firmware *firmware, error *e)
{
    double L_d_H;
    double L_q_H;
    *d = (pattern_drive){.m = m, .s = s, .path = path};
    d->config.correction = IQ24(0.1);
    d->config.disturbance = IQ24(0.01);
    *firmware = (drive_firmware){d, start, valley, peak};
    motor_inductances(m, &L_d_H, &L_q_H);
    if (L_d_H != L_q_H) {
        return motor_refuse(
            m->path, "L_q_H", e,
            "L_d_H = %g and L_q_H = %g; modulation = \"pattern\" needs a machine without saliency", L_d_H,
            L_q_H);
    }
    return winding_from_motor(m, &d->config.winding, e) &&
           patterns_table_find(s->pwm.pulses, d->row, &d->table, e);
}
