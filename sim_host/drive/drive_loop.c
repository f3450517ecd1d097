/* The one loop of firmware and drive (drive_loop.h). */
#include "drive_loop.h"

#include <string.h>

void drive_loop_begin(drive_loop *l, const motor *m, const plant_config *c, const drive_firmware *firmware)
{
    *l = (drive_loop){.firmware = firmware, .base = per_unit_of(m), .duty = {0.5, 0.5, 0.5}};
    plant_init(&l->drive, c);
}

void drive_loop_put(drive_loop *l, const drive_answer *answer)
{
    const iqfoc_abc_t high = answer->command.duties.high;
    l->duty[0] = iq24_to_double(high.a);
    l->duty[1] = iq24_to_double(high.b);
    l->duty[2] = iq24_to_double(high.c);
    l->interval_s = answer->interval_s;
}

/* Over the parts first ... last of `parts` that the span is cut into. */
static void advance(drive_loop *l, int first, int last, int parts)
{
    for (int n = first; n <= last; n++) {
        plant_advance_to(&l->drive, l->drive.duration_s * n / parts);
        if (l->watch.points > 0) {
            l->watch.point(l->watch.context, &l->drive);
        }
    }
}

static bool begin_cycle(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    if (l->halves) {
        plant_begin_half(&l->drive, l->duty, !l->falling);
        l->falling = !l->falling;
    } else {
        plant_begin_cycle(&l->drive, l->duty);
    }
    plant_sample(&l->drive, &row->valley);
    const iqfoc_sample_t sample = hal_host_sample(&row->valley, &l->drive.config.sensors, &l->base, 0);
    return l->firmware->valley(l->firmware->context, i_ref, &sample, e);
}

static void begin_interval(drive_loop *l)
{
    const bool high[3] = {l->duty[0] > 0.5, l->duty[1] > 0.5, l->duty[2] > 0.5};
    plant_begin_interval(&l->drive, high, l->interval_s);
}

/* A converter that averages: what six-step control is fed with. */
static void add_means(const drive_loop *l, iqfoc_sample_t *sample)
{
    const plant_means means = plant_mean(&l->drive);
    sample->i_mean.a = iq24_from_double(means.i_A[0] / l->base.I_A);
    sample->i_mean.b = iq24_from_double(means.i_A[1] / l->base.I_A);
    sample->i_mean.c = iq24_from_double(means.i_A[2] / l->base.I_A);
    sample->has_mean = true;
}

bool drive_loop_open(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    memcpy(row->duty, l->duty, sizeof row->duty);
    row->answer = (drive_answer){.status = 0};
    if (l->interval_s > 0.0) {
        begin_interval(l);
        return true;
    }
    return begin_cycle(l, i_ref, row, e);
}

bool drive_loop_sample(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    const drive_firmware *f = l->firmware;
    const bool interval = l->interval_s > 0.0;
    if (l->halves && !interval) {
        row->peak = row->valley;
    } else {
        plant_sample(&l->drive, &row->peak);
    }
    const iq24_t at = interval || l->halves ? 0 : IQ24(0.5);
    iqfoc_sample_t sample = hal_host_sample(&row->peak, &l->drive.config.sensors, &l->base, at);
    if (interval) {
        add_means(l, &sample);
    }
    return f->peak(f->context, i_ref, &sample, &row->answer, e);
}

void drive_loop_close(drive_loop *l, drive_row *row)
{
    row->truth = plant_mean(&l->drive);
    drive_loop_put(l, &row->answer);
}

bool drive_loop_span(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    const bool interval = l->interval_s > 0.0;
    const int least = interval ? 1 : 2;
    const int parts = l->watch.points > least ? l->watch.points : least;
    const int sampled = interval ? parts : parts / 2;
    if (!drive_loop_open(l, i_ref, row, e)) {
        return false;
    }
    advance(l, 1, sampled, parts);
    if (!drive_loop_sample(l, i_ref, row, e)) {
        return false;
    }
    advance(l, sampled + 1, parts, parts);
    drive_loop_close(l, row);
    return true;
}
