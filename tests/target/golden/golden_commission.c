/*
 * Golden vectors of the self-commissioning: a step of each phase from a state drawn at random, every other one the last step of a block, and
 * of these half the last block of its phase.
 */
#include "golden_commission.h"

#include "digest.h"
#include "golden_types.h"

#include "iqfoc/commission.h"

static const iqfoc_commission_config_t config = {
    .offset = {.settle = 0, .count_log2 = 2, .offset_max = IQ24_ONE, .noise_max = IQ24(0.125)},
    .start = {IQ24(0.5), 20, 30, IQ24(-0.02), 50},
    .i_max = IQ24(4.0),
    .speed_max = IQ24(0.1),
    .u_max = IQ24(0.5),
    .cycles_max = 1000000,
    .settle_cycles = 5,
    .block_log2 = 6,
    .half_log2 = 1,
    .share_r = IQ24(0.01),
    .share_l = IQ24(0.02),
    .share_psi = IQ24(0.03)};

static void draw_blocks(golden_inputs_t *inputs, iqfoc_commission_t *c)
{
    const iq24_t slope = golden_positive(inputs, IQ24(0.5));
    for (int32_t k = 0; k < IQFOC_COMMISSION_BLOCKS; k++) {
        c->x[k] = IQ24(0.05) * (4 + k / 8) + golden_within(inputs, IQ24(0.01));
        c->y[k] = iq24_mul_round(slope, c->x[k]) + golden_within(inputs, IQ24(0.001));
    }
}

static void draw_state(golden_inputs_t *inputs, iqfoc_commission_t *c)
{
    const int64_t block = INT64_C(1) << config.block_log2;
    const bool ends = golden_positive(inputs, 1) != 0;
    c->phase = (iqfoc_commission_phase_t)golden_positive(inputs, (iq24_t)IQFOC_COMMISSION_SPIN);
    c->start.stage = (iqfoc_start_stage_t)golden_positive(inputs, (iq24_t)IQFOC_START_OPEN_LOOP);
    c->start.speed = config.start.speed_end;
    c->wait = ends ? 0 : (uint32_t)golden_positive(inputs, 9);
    c->in_block = ends ? UINT32_MAX >> (32 - config.block_log2) : 3;
    c->blocks = (uint32_t)golden_positive(inputs, 1) * (IQFOC_COMMISSION_BLOCKS / 2 - 1) + 16;
    if (c->phase >= IQFOC_COMMISSION_INDUCTANCE_D && c->phase <= IQFOC_COMMISSION_SHAFT) {
        c->in_block = ends ? 15 : 2;
        c->in_block = c->phase == IQFOC_COMMISSION_SHAFT && ends ? 3 : c->in_block;
        c->blocks++;
    }
    c->position = (uint32_t)golden_positive(inputs, 32);
    c->amplitude = 1 + golden_positive(inputs, IQ24(0.2));
    c->bias = golden_within(inputs, IQ24(0.1));
    c->l_rough = IQ24(0.1) + golden_positive(inputs, IQ24(4.0));
    c->gains.kp_d = golden_positive(inputs, IQ24(2.0));
    c->gains.kp_q = golden_positive(inputs, IQ24(2.0));
    c->gains.ki_d = golden_positive(inputs, IQ24(0.2));
    c->gains.ki_q = golden_positive(inputs, IQ24(0.2));
    c->gains.anti_windup = IQ24(0.25);
    c->u_dq.d = golden_within(inputs, IQ24(0.5));
    c->u_dq.q = golden_within(inputs, IQ24(0.5));
    for (uint32_t k = 0; k < 4; k++) {
        c->sum[k] = block * golden_within(inputs, IQ24(0.5));
    }
    c->result.r.value = golden_positive(inputs, IQ24(0.1));
    c->result.v_dead.value = golden_positive(inputs, IQ24(0.02));
    c->result.l_d.value = IQ24(0.1) + golden_positive(inputs, IQ24(4.0));
    c->result.l_q.value = IQ24(0.1) + golden_positive(inputs, IQ24(4.0));
    c->result.l_d.half = golden_positive(inputs, IQ24(0.01));
    c->result.r.half = golden_positive(inputs, IQ24(0.001));
    c->across = golden_within(inputs, IQ24(0.5));
}

static void digest_value(uint64_t *digest, iqfoc_commission_value_t x)
{
    digest_add(digest, x.value);
    digest_add(digest, x.half);
}

static void digest_state(uint64_t *digest, const iqfoc_commission_t *c)
{
    digest_add(digest, (int32_t)c->end);
    digest_add(digest, (int32_t)c->phase);
    digest_add(digest, (int32_t)c->blocks);
    digest_add(digest, (int32_t)c->position);
    digest_add(digest, c->amplitude);
    digest_add(digest, c->bias);
    digest_add(digest, c->across);
    digest_abc(digest, c->result.i_offset);
    digest_abc(digest, c->result.i_offset_half);
    digest_value(digest, c->result.r);
    digest_value(digest, c->result.v_dead);
    digest_value(digest, c->result.l_d);
    digest_value(digest, c->result.l_q);
    digest_value(digest, c->result.psi);
}

void golden_commission(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_commission_t c;
    inputs->number++;
    digest_add(digest, (int32_t)iqfoc_commission_init(&c, &config));
    draw_state(inputs, &c);
    draw_blocks(inputs, &c);
    iqfoc_sample_t sample = {.u_dc = IQ24_ONE};
    sample.i = golden_abc(inputs, IQ24(1.5));
    sample.theta = golden_within(inputs, IQ24_ONE);
    sample.u_dc += golden_within(inputs, IQ24(0.4));
    for (int32_t k = 0; k < 2; k++) {
        const iqfoc_command_t command = iqfoc_commission_step(&c, &sample);
        digest_abc(digest, command.duties.high);
        digest_add(digest, command.gates ? 1 : 0);
        digest_state(digest, &c);
        if (golden_positive(inputs, 15) == 0) {
            iqfoc_commission_abort(&c);
        }
    }
    iqfoc_flux_predictor_t predictor;
    iqfoc_extension_t extension;
    iqfoc_commission_parameters(&c.result, &predictor, &extension);
    digest_add(digest, predictor.k_d);
    digest_add(digest, predictor.k_q);
    digest_add(digest, predictor.psi);
    digest_add(digest, extension.v_dead);
}
