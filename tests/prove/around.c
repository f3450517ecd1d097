/* Drive services and sensors: any inputs, after set-up with any configuration that is not refused. */
#include "any.h"

#include "iqfoc/encoder.h"
#include "iqfoc/offset.h"
#include "iqfoc/resolver.h"
#include "iqfoc/restart.h"
#include "iqfoc/shunts.h"
#include "iqfoc/start.h"

/* Counts in cases by powers of two: what a count is worth falls as their number grows. */
static void encoder_of(uint32_t counts)
{
    const iqfoc_encoder_config_t config = {counts, any_count(1, 64), any_count(0, 16384), any_bool(), any()};
    iqfoc_encoder_t e;
    if (iqfoc_encoder_init(&e, &config) == IQFOC_OK) {
        iqfoc_encoder_align(&e, any_count(0, counts - 1), any());
        e.indexed = any_bool();
        e.index_count = any_count(0, counts - 1);
        e.slips = any_count(0, UINT32_MAX);
        (void)iqfoc_encoder_index(&e, any_count(0, counts - 1));
        e.count_known = any_count(0, counts - 1);
        (void)iqfoc_encoder_theta(&e, any_count(0, counts - 1));
        (void)iqfoc_encoder_index_theta(&e);
    }
}

/* Encoder and index: any configuration that is not refused, any count, from any state. */
void prove_encoder(void)
{
    for (uint32_t least = 4; least <= 65536; least *= 2) {
        encoder_of(any_count(least, least < 65536 ? 2 * least - 1 : least));
    }
}

/* Resolver: any voltages. */
void prove_resolver(void)
{
    iqfoc_resolver_t r;
    r.offset_sin = any();
    r.offset_cos = any();
    r.gain_sin = any();
    r.gain_cos = any();
    r.amplitude_min = any();
    r.amplitude_max = any_within(2, IQ24(2.0));
    r.ratio = any_within(1, 64);
    r.theta_0 = any_within(-IQ24_ONE, IQ24_ONE);
    if (iqfoc_resolver_check(&r) == IQFOC_OK) {
        (void)iqfoc_resolver_read(&r, any(), any());
    }
}

/* Low-side shunts: any samples and duties. */
void prove_shunts(void)
{
    const iqfoc_shunts_t s = {any_within(IQ24(0.25), IQ24_ONE)};
    (void)iqfoc_shunts_check(&s);
    (void)iqfoc_shunts_read(&s, any_abc(IQ24_MIN, IQ24_MAX), any_abc(IQ24_MIN, IQ24_MAX),
                            any_abc(IQ24_MIN, IQ24_MAX));
    (void)iqfoc_shunts_make_room(&s, any_abc(0, IQ24_ONE));
}

/* Restart: any faults for any time. */
void prove_restart(void)
{
    const iqfoc_restart_config_t config = {any_count(0, UINT32_MAX), any_count(0, UINT32_MAX),
                                           any_count(0, UINT32_MAX), any_count(0, UINT32_MAX)};
    iqfoc_restart_t r;
    if (iqfoc_restart_init(&r, &config) == IQFOC_OK) {
        while (any_bool()) {
            (void)iqfoc_restart_step(&r, any_count(0, UINT32_MAX));
            iqfoc_restart_acknowledge(&r);
        }
    }
}

/* Start: any configuration that is not refused, any sensor, from any state: a stage's count is below its 2^24; and the
 * handover. */
void prove_start(void)
{
    const iqfoc_start_config_t config = {any(), any_count(1, 1 << 24), any_count(1, 1 << 24), any(),
                                         any_count(1, 1 << 24)};
    iqfoc_start_t s;
    if (iqfoc_start_init(&s, &config) == IQFOC_OK) {
        s.stage = (iqfoc_start_stage_t)any_within(0, 6);
        s.done = s.stage <= IQFOC_START_RUN_UP ? any_count(0, (1 << 24) - 1) : any_count(0, UINT32_MAX);
        s.theta = any();
        s.speed = any();
        s.i_ref.d = any_within(0, IQ24(16.0));
        s.sensor_before = any();
        s.sensor_zero = any();
        iqfoc_start_step(&s, any());
        (void)iqfoc_start_theta(&s, any_within(-IQ24_ONE, IQ24_ONE));
        (void)iqfoc_start_handover(&s, any());
    }
}
