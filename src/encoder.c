/* Incremental encoder with index (include/iqfoc/encoder.h). */
#include "iqfoc/encoder.h"

#include <stddef.h>

iqfoc_error_t iqfoc_encoder_init(iqfoc_encoder_t *encoder, const iqfoc_encoder_config_t *config)
{
    if (encoder == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const uint32_t counts = config->counts_per_turn;
    if (counts < 4 || counts > 65536 || config->pole_pairs < 1 || config->pole_pairs > 64 ||
        config->slip_max > counts / 4) {
        return IQFOC_ERROR_ENCODER;
    }
    const uint64_t turns_per_count = ((uint64_t)config->pole_pairs << 48) / counts;
    const iqfoc_encoder_t fresh = {config, turns_per_count, 0, 0, false, false, 0, 0, 0};
    *encoder = fresh;
    return IQFOC_OK;
}

/* Forward distance from one count to another: 0 ... counts_per_turn - 1. */
static uint32_t forwards(const iqfoc_encoder_t *encoder, uint32_t from, uint32_t to)
{
    const uint32_t on = to >= from ? to - from : encoder->config->counts_per_turn - (from - to);
    /*@ assert encoder: on < encoder->config->counts_per_turn; */
    return on;
}

/*
 * Range: counts < 2^16 and turns_per_count <= 64 2^48/counts_per_turn: the product is below 2^54, and with half an
 * LSB (2^23) too. Shifted by 24 it is below 2^30, 64 turns. turns_per_count is short by less than 2^-48, the angle by
 * less than 2^-32 of a turn: 0.004 LSB in addition to the rounding's 0.5.
 */
iq24_t iqfoc_encoder_theta(const iqfoc_encoder_t *encoder, uint32_t count)
{
    const uint64_t moved = forwards(encoder, encoder->count_known, count) * encoder->turns_per_count_q48;
    return iq24_add_wrap(encoder->theta_known, iq24_shift_wrap((int64_t)moved + IQ24_ACC_HALF, 24));
}

void iqfoc_encoder_align(iqfoc_encoder_t *encoder, uint32_t count, iq24_t theta)
{
    encoder->count_known = count;
    encoder->theta_known = theta;
    encoder->referenced = true;
}

bool iqfoc_encoder_index(iqfoc_encoder_t *encoder, uint32_t count)
{
    const iqfoc_encoder_config_t *config = encoder->config;
    const int32_t counts = (int32_t)config->counts_per_turn;
    if (!encoder->indexed) {
        encoder->indexed = true;
        encoder->index_count = count;
        if (config->index_known) {
            iqfoc_encoder_align(encoder, count, config->index_theta);
        }
        return true;
    }
    /* The shorter way round: |slip| <= counts/2. */
    const int32_t on = (int32_t)forwards(encoder, encoder->index_count, count);
    encoder->slip = on > counts / 2 ? on - counts : on;
    if (iq24_within(encoder->slip, -(int32_t)config->slip_max, (int32_t)config->slip_max)) {
        return true;
    }
    const uint32_t known = encoder->count_known + (uint32_t)on; /* below 2 counts */
    encoder->count_known = known >= config->counts_per_turn ? known - config->counts_per_turn : known;
    encoder->index_count = count;
    encoder->slips += encoder->slips < UINT32_MAX ? 1 : 0;
    return false;
}

iq24_t iqfoc_encoder_index_theta(const iqfoc_encoder_t *encoder)
{
    return encoder->indexed && encoder->referenced ? iqfoc_encoder_theta(encoder, encoder->index_count) : 0;
}
