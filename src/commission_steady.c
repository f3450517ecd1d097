/* Phases of self-commissioning without a square wave: OFFSET, STAIRCASE and SPIN, means at constant currents. */
#include "commission_fit.h"
#include "commission_phases.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/rotor.h"
#include "root.h"

#define LEVEL_BLOCKS (IQFOC_COMMISSION_BLOCKS / 4)
#define ROUNDING     4 /* LSB of a voltage's mean, by the modulator */

void commission_offset(iqfoc_commission_t *c, const iqfoc_sample_t *sample)
{
    const iqfoc_offset_verdict_t verdict = iqfoc_offset_step(&c->offset, sample->i);
    if (verdict == IQFOC_OFFSET_BUSY) {
        return;
    }
    if (verdict != IQFOC_OFFSET_GOOD) {
        c->end = IQFOC_COMMISSION_SENSORS;
        return;
    }
    /* 2 sigma/sqrt(n). Range: noise <= 1/8, squares 2^42. */
    const uint32_t n = c->config->offset.count_log2;
    const iqfoc_abc_t noise = c->offset.noise;
    const iqfoc_abc_t half = {2 * root_of(IQ24_MUL64(noise.a, noise.a) >> n) + 2,
                              2 * root_of(IQ24_MUL64(noise.b, noise.b) >> n) + 2,
                              2 * root_of(IQ24_MUL64(noise.c, noise.c) >> n) + 2};
    c->result.i_offset = c->offset.offset;
    c->result.i_offset_half = half;
    c->amplitude = COMMISSION_SEEK_STEP;
    commission_enter(c, IQFOC_COMMISSION_SEEK_ALPHA, 0);
}

/* True at the end of a block of settled cycles. */
static bool block_measured(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u)
{
    if (c->wait > 0) {
        c->wait--;
        return false;
    }
    c->sum[0] += i.d;
    c->sum[1] += u.d;
    c->sum[2] += i.q;
    c->sum[3] += u.q;
    c->in_block++;
    return c->in_block >> c->config->block_log2 != 0;
}

void commission_staircase(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u)
{
    const iqfoc_commission_config_t *config = c->config;
    if (!block_measured(c, i, u)) {
        return;
    }
    c->x[c->blocks] = commission_block_mean(c->sum[0], config->block_log2);
    c->y[c->blocks] = commission_block_mean(c->sum[1], config->block_log2);
    commission_clear(c);
    c->blocks++;
    if (c->blocks < IQFOC_COMMISSION_BLOCKS) {
        c->wait = c->blocks % LEVEL_BLOCKS == 0 ? config->settle_cycles : 0;
        return;
    }
    const commission_line_t line = commission_line(c->x, c->y);
    const iqfoc_abc_t o = c->result.i_offset_half;
    /* alpha = (2 a - b - c)/3 */
    const iq24_t offset =
        commission_both(iq24_mul_sat(o.a, IQ24(2.0 / 3.0)), iqfoc_third(commission_both(o.b, o.c)));
    const iq24_t half =
        iq24_add_sat(commission_both(line.at_zero.half, iq24_mul_sat(line.slope.value, offset)), ROUNDING);
    const iqfoc_commission_value_t v_dead = {iq24_mul_sat(line.at_zero.value, IQ24(0.75)),
                                             iq24_mul_sat(half, IQ24(0.75))};
    c->result.r = commission_taken(c, line.slope, config->share_r, 1, IQ24_ONE);
    c->result.v_dead = commission_taken(c, v_dead, 0, IQ24(-0.25), IQ24(0.25));
    int64_t bias = LEVEL_BLOCKS / 2;
    for (uint32_t k = 3 * LEVEL_BLOCKS; k < IQFOC_COMMISSION_BLOCKS; k++) {
        bias += c->y[k];
    }
    c->bias = (iq24_t)iq24_asr64(bias, 3);
    /* Half the target's voltage, which the first block scales: h U = L D, D = i_align/2. */
    c->amplitude = iq24_clamp(
        iq24_asr32(iq24_mul_sat(c->l_rough, config->start.i_align), 2 + config->half_log2), 1, config->u_max);
    commission_enter(c, IQFOC_COMMISSION_INDUCTANCE_D, config->settle_cycles);
}

iq24_t commission_level(const iqfoc_commission_t *c)
{
    const iq24_t level = (iq24_t)(c->blocks / LEVEL_BLOCKS);
    return iq24_mul_round(c->config->start.i_align, (2 + level) * IQ24(0.2));
}

void commission_spin(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u)
{
    const uint32_t n = c->config->block_log2;
    if (!block_measured(c, i, u)) {
        return;
    }
    const commission_means_t means = {
        {commission_block_mean(c->sum[0], n), commission_block_mean(c->sum[2], n)},
        {commission_block_mean(c->sum[1], n), commission_block_mean(c->sum[3], n)}};
    const iq24_t phi_s1 = iqfoc_rotor_from_speed(c->start.speed).phi_s1;
    c->x[c->blocks] = commission_flux(&c->result, &means, phi_s1);
    commission_clear(c);
    c->blocks++;
    if (c->blocks < IQFOC_COMMISSION_BLOCKS) {
        return;
    }
    iqfoc_commission_value_t psi = commission_spread(c->x);
    psi.half = iq24_add_sat(psi.half, commission_flux_half(&c->result, &means, phi_s1));
    c->result.psi = commission_taken(c, psi, c->config->share_psi, 0, IQ24(16.0));
    if (c->end == IQFOC_COMMISSION_RUNNING) {
        const bool aligns = commission_aligns(&c->result, c->across, c->config->start.i_align);
        c->end = psi.value / 4 <= psi.half ? IQFOC_COMMISSION_NOT_TURNING
                 : aligns                  ? IQFOC_COMMISSION_DONE
                                           : IQFOC_COMMISSION_NOT_ALIGNED;
    }
}
