/* Self-commissioning (include/iqfoc/commission.h): configuration, limits and the order of the phases. */
#include "commission_phases.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/rotor.h"

#include <stddef.h>

#define CYCLES_MAX   (UINT32_C(1) << 24)
#define LONGEST_LOG2 12

static bool config_is_good(const iqfoc_commission_config_t *c)
{
    const iq24_t i = c->start.i_align;
    const iq24_t share_max = IQ24(0.25);
    return iq24_within(i, 1, IQ24(2.0)) && c->start.speed_end != 0 &&
           iq24_within(c->i_max, i + i / 2, IQ24(4.0)) &&
           iq24_within(c->speed_max, iq24_abs_sat(c->start.speed_end), IQFOC_ROTOR_SPEED_MAX) &&
           iq24_within(c->u_max, 1, IQ24(0.5)) && c->cycles_max >= 1 && c->settle_cycles >= 1 &&
           c->settle_cycles <= CYCLES_MAX && c->block_log2 >= 6 && c->block_log2 <= LONGEST_LOG2 &&
           c->half_log2 >= 1 && c->half_log2 <= 2 && iq24_within(c->share_r, 0, share_max) &&
           iq24_within(c->share_l, 0, share_max) && iq24_within(c->share_psi, 0, share_max);
}

iqfoc_error_t iqfoc_commission_init(iqfoc_commission_t *commission, const iqfoc_commission_config_t *config)
{
    static const iqfoc_commission_t fresh;
    iqfoc_offset_t offset;
    iqfoc_start_t start;
    if (commission == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!config_is_good(config) || iqfoc_offset_init(&offset, &config->offset) != IQFOC_OK ||
        iqfoc_start_init(&start, &config->start) != IQFOC_OK) {
        return IQFOC_ERROR_COMMISSION;
    }
    *commission = fresh;
    commission->config = config;
    commission->offset = offset;
    commission->start = start;
    return IQFOC_OK;
}

void commission_clear(iqfoc_commission_t *c)
{
    c->in_block = 0;
    for (uint32_t k = 0; k < 4; k++) {
        c->sum[k] = 0;
    }
}

void commission_enter(iqfoc_commission_t *c, iqfoc_commission_phase_t phase, uint32_t wait)
{
    c->phase = phase;
    c->wait = wait;
    c->blocks = 0;
    c->position = UINT32_C(1) << (commission_half_log2(c) - 1);
    commission_clear(c);
}

iqfoc_commission_value_t commission_taken(iqfoc_commission_t *c, iqfoc_commission_value_t found, iq24_t share,
                                          iq24_t low, iq24_t high)
{
    if (!iq24_within(found.value, low, high)) {
        c->end = IQFOC_COMMISSION_OUT_OF_RANGE;
    }
    found.half = iq24_add_sat(found.half, iq24_abs_sat(iq24_mul_sat(found.value, share)));
    return found;
}

static iqfoc_ab_t controlled(iqfoc_commission_t *c, iqfoc_dq_t i_ref, iqfoc_dq_t i)
{
    c->u_dq = iqfoc_current_control_step(&c->control, &c->gains, i_ref, i);
    const iq24_t ahead = iq24_mul_round(c->start.speed, IQ24(1.5));
    return iqfoc_park_inverse(c->u_dq, iq24_sincos(iq24_add_wrap(c->start.theta, ahead)));
}

/* What this cycle's sample tells; may change the phase. */
static void measure(iqfoc_commission_t *c, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    const iqfoc_dq_t along_a = {i.alpha, i.beta};
    switch (c->phase) {
    case IQFOC_COMMISSION_OFFSET:
        commission_offset(c, sample);
        break;
    case IQFOC_COMMISSION_SEEK_ALPHA:
        commission_seek(c, i.alpha);
        break;
    case IQFOC_COMMISSION_SEEK_BETA:
        commission_seek(c, i.beta);
        break;
    case IQFOC_COMMISSION_STAIRCASE:
        commission_staircase(c, along_a, c->u_dq);
        break;
    case IQFOC_COMMISSION_INDUCTANCE_D:
        commission_pulses(c, i.alpha, i.beta);
        break;
    case IQFOC_COMMISSION_INDUCTANCE_Q:
    case IQFOC_COMMISSION_SHAFT:
        commission_pulses(c, i.beta, i.alpha);
        break;
    case IQFOC_COMMISSION_ALIGN:
        iqfoc_start_step(&c->start, sample->theta);
        if (c->start.stage == IQFOC_START_RUN_UP) {
            commission_enter(c, IQFOC_COMMISSION_STAIRCASE, c->config->settle_cycles);
        }
        break;
    case IQFOC_COMMISSION_RUN_UP:
        iqfoc_start_step(&c->start, sample->theta);
        if (c->start.stage == IQFOC_START_OPEN_LOOP) {
            commission_enter(c, IQFOC_COMMISSION_SPIN, c->config->start.hold_cycles);
        }
        break;
    case IQFOC_COMMISSION_SPIN:
    default:
        iqfoc_start_step(&c->start, sample->theta);
        commission_spin(c, iqfoc_park(i, iq24_sincos(c->start.theta)), c->u_dq);
        break;
    }
}

/* The voltage of the next cycle. */
static iqfoc_ab_t voltage(iqfoc_commission_t *c, iqfoc_ab_t i)
{
    iqfoc_ab_t u = {0, 0};
    iqfoc_dq_t i_ref = c->start.i_ref;
    switch (c->phase) {
    case IQFOC_COMMISSION_OFFSET:
        return u;
    case IQFOC_COMMISSION_SEEK_ALPHA:
        u.alpha = commission_wave(c);
        return u;
    case IQFOC_COMMISSION_INDUCTANCE_D:
        u.alpha = iq24_add_sat(c->bias, commission_wave(c));
        return u;
    case IQFOC_COMMISSION_SEEK_BETA:
        u.beta = commission_wave(c);
        return u;
    case IQFOC_COMMISSION_INDUCTANCE_Q:
    case IQFOC_COMMISSION_SHAFT:
        u.alpha = c->bias;
        u.beta = commission_wave(c);
        return u;
    case IQFOC_COMMISSION_STAIRCASE:
        i_ref.d = commission_level(c);
        break;
    case IQFOC_COMMISSION_ALIGN:
    case IQFOC_COMMISSION_RUN_UP:
    case IQFOC_COMMISSION_SPIN:
    default:
        break;
    }
    return controlled(c, i_ref, iqfoc_park(i, iq24_sincos(c->start.theta)));
}

static bool beyond(iqfoc_abc_t i, iq24_t limit)
{
    return iq24_abs_sat(i.a) > limit || iq24_abs_sat(i.b) > limit || iq24_abs_sat(i.c) > limit;
}

/* Why the run has to end before this cycle, or RUNNING. */
static iqfoc_commission_end_t guard(const iqfoc_commission_t *c, const iqfoc_sample_t *sample, iqfoc_abc_t i)
{
    const iqfoc_commission_config_t *config = c->config;
    return c->abort_requested                                 ? IQFOC_COMMISSION_ABORTED
           : sample->clipped || beyond(i, config->i_max)      ? IQFOC_COMMISSION_OVER_CURRENT
           : iq24_abs_sat(sample->speed) > config->speed_max  ? IQFOC_COMMISSION_OVER_SPEED
           : !iq24_within(sample->u_dc, IQ24(0.5), IQ24(1.5)) ? IQFOC_COMMISSION_DC_LINK
           : c->cycles >= config->cycles_max                  ? IQFOC_COMMISSION_TOO_SLOW
                                                              : IQFOC_COMMISSION_RUNNING;
}

iqfoc_command_t iqfoc_commission_step(iqfoc_commission_t *commission, const iqfoc_sample_t *sample)
{
    iqfoc_commission_t *const c = commission;
    const iqfoc_command_t safe = {{{0, 0, 0}, IQ24_ONE}, false};
    const iqfoc_abc_t i = iqfoc_offset_removed(&c->offset, sample->i);
    if (c->end == IQFOC_COMMISSION_RUNNING) {
        c->end = guard(c, sample, i);
    }
    if (c->end != IQFOC_COMMISSION_RUNNING) {
        return safe;
    }
    c->cycles++;
    const iqfoc_ab_t i_ab = iqfoc_clarke3(i);
    measure(c, sample, i_ab);
    const iqfoc_ab_t u = voltage(c, i_ab);
    if (c->end != IQFOC_COMMISSION_RUNNING || c->phase == IQFOC_COMMISSION_OFFSET) {
        return safe;
    }
    const iqfoc_command_t command = {iqfoc_modulate(u, iq24_div(IQ24_ONE, sample->u_dc), IQ24_ONE), true};
    if (command.duties.scale < IQ24_ONE) {
        iqfoc_current_control_limited(&c->control, &c->gains, c->u_dq, command.duties.scale);
        c->u_dq.d = iq24_mul_trunc(c->u_dq.d, command.duties.scale);
        c->u_dq.q = iq24_mul_trunc(c->u_dq.q, command.duties.scale);
    }
    return command;
}

void iqfoc_commission_parameters(const iqfoc_commission_result_t *result, iqfoc_flux_predictor_t *predictor,
                                 iqfoc_extension_t *extension)
{
    const iqfoc_flux_predictor_t found = {result->l_d.value,
                                          result->l_q.value,
                                          iq24_div(IQ24_ONE, result->l_d.value),
                                          iq24_div(IQ24_ONE, result->l_q.value),
                                          result->r.value,
                                          result->psi.value,
                                          0};
    const iqfoc_extension_t corrections = {result->i_offset, {IQ24_ONE, IQ24_ONE, IQ24_ONE}, 0,           0,
                                           IQ24_ONE,         result->v_dead.value,           IQ24(127.0), 0};
    *predictor = found;
    *extension = corrections;
}
