/* The tuned firmware on the angle of the observer (sensorless_drive.h). */
#include "sensorless_drive.h"

#include "params_host.h"

#include "iqfoc/transform.h"

#include <math.h>

bool sensorless_drive_init(sensorless_drive *d, const motor *m, const tune_design *design,
                           const iqfoc_observer_config_t *config, long from, error *e)
{
    *d = (sensorless_drive){.config = *config, .voltage_gain = 1.0, .from = from};
    return tuned_drive_init(&d->tuned, m, design, e);
}

static void note(sensorless_drive *d, const iqfoc_sample_t *sample)
{
    const double off =
        remainder(iq24_to_double(iqfoc_observer_theta(&d->observer, 0)) - iq24_to_double(sample->theta), 1.0);
    const double faster = iq24_to_double(iqfoc_observer_speed(&d->observer)) - iq24_to_double(sample->speed);
    d->largest = fmax(d->largest, fabs(off));
    d->lost = d->lost || !d->observer.locked;
    if (d->cycle >= d->from) {
        spread_add(&d->off, off);
        spread_add(&d->faster, faster);
    }
    d->cycle++;
}

static iqfoc_ab_t mean_of(iqfoc_ab_t x, iqfoc_ab_t y)
{
    const iqfoc_ab_t mean = {iq24_asr32(x.alpha + y.alpha, 1), iq24_asr32(x.beta + y.beta, 1)};
    return mean;
}

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    sensorless_drive *d = context;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    iqfoc_sample_t seen = *sample;
    (void)e;
    if (d->cycle == 0) {
        (void)iqfoc_observer_init(&d->observer, &d->config); /* checked by the design */
        iqfoc_observer_start(&d->observer, i, sample->theta, sample->speed, true);
    } else {
        const iqfoc_ab_t mean =
            d->halves ? mean_of(d->i_start, i) : iqfoc_observer_mean(d->i_start, d->i_middle, i);
        iqfoc_observer_step(&d->observer, d->tuned.u_now, mean, i);
    }
    note(d, sample);
    d->i_start = i;
    seen.theta = iqfoc_observer_theta(&d->observer, 0);
    seen.speed = iqfoc_observer_speed(&d->observer);
    seen.u_dc = iq24_from_double(iq24_to_double(sample->u_dc) / d->voltage_gain);
    tuned_firmware_valley(&d->tuned, i_ref, &seen);
    return true;
}

static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    sensorless_drive *d = context;
    (void)i_ref;
    (void)e;
    if (!d->halves) {
        iqfoc_sample_t seen = *sample;
        d->i_middle = iqfoc_clarke3(sample->i);
        seen.theta = iqfoc_observer_theta(&d->observer, IQ24(0.5));
        tuned_firmware_peak(&d->tuned, &seen);
    }
    answer->command = d->tuned.command;
    answer->status = d->tuned.status;
    return true;
}

drive_firmware sensorless_drive_firmware(sensorless_drive *d)
{
    const drive_firmware firmware = {d, NULL, take_valley, give_peak};
    return firmware;
}
