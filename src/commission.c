/* Self-commissioning (include/iqfoc/commission.h). */
#include "iqfoc/commission.h"

#include "commission_fit.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/rotor.h"
#include "root.h"

#include <stddef.h>

/* Current control, kp = w L, ki = kp/4 w: w T with the rough inductance, and with the measured ones. A rotor that swings in the field of a
 * slow current control swings up. */
#define W_T_ROUGH IQ24(0.1)
#define W_T       IQ24(0.35)
/* SEEK: step of the square wave's voltage, and its share. The smallest inductance then grows the current by 1/8 h/4 a step. */
#define SEEK_STEP    IQ24(0.001953125)
#define LEVEL_BLOCKS (IQFOC_COMMISSION_BLOCKS / 4)
#define CYCLES_MAX   (UINT32_C(1) << 24)
#define LONGEST_LOG2 12
#define ROUNDING     4 /* LSB of a voltage's mean, by the modulator */

static bool config_is_good(const iqfoc_commission_config_t *c)
{
    const iq24_t i = c->start.i_align;
    const iq24_t share_max = IQ24(0.25);
    return iq24_within(i, 1, IQ24(2.0)) && c->start.turns_end != 0 &&
           iq24_within(c->i_max, i + i / 2, IQ24(4.0)) &&
           iq24_within(c->turns_max, iq24_abs_sat(c->start.turns_end), IQFOC_ROTOR_TURNS_MAX) &&
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

static void clear_sums(iqfoc_commission_t *c)
{
    c->in_block = 0;
    for (uint32_t k = 0; k < 4; k++) {
        c->sum[k] = 0;
    }
}

/* Half a period of the square wave: 2^n cycles. */
static uint32_t half_log2(const iqfoc_commission_t *c)
{
    return c->config->half_log2 + (c->phase == IQFOC_COMMISSION_SHAFT ? 2 : 0);
}

/* Begins a phase that measures blocks after `wait` cycles. */
static void enter(iqfoc_commission_t *c, iqfoc_commission_phase_t phase, uint32_t wait)
{
    c->phase = phase;
    c->wait = wait;
    c->blocks = 0;
    c->position = UINT32_C(1) << (half_log2(c) - 1);
    clear_sums(c);
}

/* Range: l <= 8, so that kp <= 2. */
static void set_gains(iqfoc_commission_t *c, iq24_t l_d, iq24_t l_q, iq24_t w_t)
{
    c->gains.kp_d = iq24_mul_round(l_d, w_t);
    c->gains.kp_q = iq24_mul_round(l_q, w_t);
    c->gains.ki_d = iq24_mul_round(c->gains.kp_d, w_t * 2 / 7);
    c->gains.ki_q = iq24_mul_round(c->gains.kp_q, w_t * 2 / 7);
    c->gains.anti_windup = w_t;
}

/* Adds the systematic share; ends the run if the value is out of low ... high. */
static iqfoc_commission_value_t taken(iqfoc_commission_t *c, iqfoc_commission_value_t found, iq24_t share,
                                      iq24_t low, iq24_t high)
{
    if (!iq24_within(found.value, low, high)) {
        c->end = IQFOC_COMMISSION_OUT_OF_RANGE;
    }
    found.half = iq24_add_sat(found.half, iq24_abs_sat(iq24_mul_sat(found.value, share)));
    return found;
}

/* ---- OFFSET ---- */

static void measure_offset(iqfoc_commission_t *c, const iqfoc_sample_t *sample)
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
    c->amplitude = SEEK_STEP;
    enter(c, IQFOC_COMMISSION_SEEK_ALPHA, 0);
}

/* ---- The square wave ---- */

/* True once a period is complete: D and S of its cycles are in the sums, each times the number of half periods. */
static bool wave_measured(iqfoc_commission_t *c, iq24_t i)
{
    const uint32_t h = UINT32_C(1) << half_log2(c);
    const uint32_t first = h / 2;
    if (c->position <= first) {
        return false; /* the first cycle is still to begin */
    }
    const uint32_t now = (c->position - 1) % (2 * h);
    if (now == h) {
        c->sum[0] += 2 * (int64_t)i; /* the highest current, once for each half period that it bounds */
    } else if (now == 0) {
        c->sum[0] -= 2 * (int64_t)i;
    } else {
        c->sum[1] += now < h ? i : -(int64_t)i;
    }
    return now == (first + 2 * h - 1) % (2 * h);
}

/* The voltage of the next cycle. */
static iq24_t wave_next(iqfoc_commission_t *c)
{
    const uint32_t h = UINT32_C(1) << half_log2(c);
    const bool high = c->position % (2 * h) < h;
    c->position = c->position < 4 * h ? c->position + 1 : 2 * h + 1;
    return high ? c->amplitude : -c->amplitude;
}

/* ---- SEEK ---- */

static void seek_found(iqfoc_commission_t *c, iq24_t difference)
{
    const iq24_t h = (iq24_t)(INT32_C(1) << half_log2(c));
    const iq24_t l = iq24_clamp(iq24_div((c->amplitude - c->half_u) * h, iq24_max(difference - c->half_d, 1)),
                                IQ24(0.0625), IQ24(8.0));
    c->amplitude = SEEK_STEP;
    c->half_u = 0;
    c->half_d = 0;
    if (c->phase == IQFOC_COMMISSION_SEEK_ALPHA) {
        c->l_rough = l;
        enter(c, IQFOC_COMMISSION_SEEK_BETA, 0);
    } else {
        c->l_rough = iq24_min(c->l_rough, l);
        set_gains(c, c->l_rough, c->l_rough, W_T_ROUGH);
        enter(c, IQFOC_COMMISSION_ALIGN, 0);
    }
}

/* D of one period against the target, i_align/2. Range: |i| <= 16, D within 64. */
static void seek(iqfoc_commission_t *c, iq24_t i)
{
    if (!wave_measured(c, i)) {
        return;
    }
    const iq24_t target = c->config->start.i_align / 2;
    const iq24_t difference = (iq24_t)iq24_asr64(c->sum[0], 1);
    clear_sums(c);
    if (difference >= target || (c->amplitude >= c->config->u_max && difference >= target / 4)) {
        seek_found(c, difference);
    } else if (c->amplitude >= c->config->u_max) {
        c->end = IQFOC_COMMISSION_NO_CURRENT;
    } else {
        if (c->half_d == 0 && difference >= target / 2) {
            c->half_u = c->amplitude;
            c->half_d = difference;
        }
        c->amplitude = iq24_min(c->amplitude + iq24_max(SEEK_STEP, c->amplitude / 16), c->config->u_max);
    }
}

/* ---- Current control in the frame of the start's angle ---- */

static iqfoc_ab_t controlled(iqfoc_commission_t *c, iqfoc_dq_t i_ref, iqfoc_dq_t i)
{
    c->u_dq = iqfoc_current_control_step(&c->control, &c->gains, i_ref, i);
    const iq24_t ahead = iq24_mul_round(c->start.turns, IQ24(1.5));
    return iqfoc_park_inverse(c->u_dq, iq24_sincos(iq24_add_wrap(c->start.theta, ahead)));
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

/* Mean of a block's sum of 2^n terms, to nearest. */
static iq24_t mean_of(int64_t sum, uint32_t n)
{
    return (iq24_t)iq24_asr64(sum + (INT64_C(1) << (n - 1)), n);
}

static void staircase(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u)
{
    const iqfoc_commission_config_t *config = c->config;
    if (!block_measured(c, i, u)) {
        return;
    }
    c->x[c->blocks] = mean_of(c->sum[0], config->block_log2);
    c->y[c->blocks] = mean_of(c->sum[1], config->block_log2);
    clear_sums(c);
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
    c->result.r = taken(c, line.slope, config->share_r, 1, IQ24_ONE);
    c->result.v_dead = taken(c, v_dead, 0, IQ24(-0.25), IQ24(0.25));
    int64_t bias = LEVEL_BLOCKS / 2;
    for (uint32_t k = 3 * LEVEL_BLOCKS; k < IQFOC_COMMISSION_BLOCKS; k++) {
        bias += c->y[k];
    }
    c->bias = (iq24_t)iq24_asr64(bias, 3);
    /* Half the target's voltage, which the first block scales: h U = L D, D = i_align/2. */
    c->amplitude = iq24_clamp(
        iq24_asr32(iq24_mul_sat(c->l_rough, config->start.i_align), 2 + config->half_log2), 1, config->u_max);
    enter(c, IQFOC_COMMISSION_INDUCTANCE_D, config->settle_cycles);
}

/* i_align (2 + level)/5 */
static iq24_t staircase_level(const iqfoc_commission_t *c)
{
    const iq24_t level = (iq24_t)(c->blocks / LEVEL_BLOCKS);
    return iq24_mul_round(c->config->start.i_align, (2 + level) * IQ24(0.2));
}

/* ---- INDUCTANCE ---- */

/* The first block: the amplitude that makes D i_align/2, at most eight times the present one. */
static void scale_amplitude(iqfoc_commission_t *c, iq24_t d)
{
    const iq24_t factor =
        iq24_clamp(iq24_div(c->config->start.i_align / 2, iq24_max(d, 1)), IQ24(0.125), IQ24(8.0));
    c->amplitude = iq24_clamp(iq24_mul_sat(c->amplitude, factor), 1, c->config->u_max);
}

/* The shaft makes L_q too small by c h^2: found with four times the h, it is a fifteenth of the difference. */
static iqfoc_commission_value_t without_shaft(iqfoc_commission_value_t fast, iqfoc_commission_value_t slow)
{
    const iq24_t fifteenth = IQ24(1.0 / 15.0);
    const iqfoc_commission_value_t l = {
        iq24_add_sat(fast.value, iq24_mul_sat(iq24_sub_sat(fast.value, slow.value), fifteenth)),
        iq24_add_sat(iq24_mul_sat(fast.half, IQ24(16.0 / 15.0)), iq24_mul_sat(slow.half, fifteenth))};
    return l;
}

static void inductance_found(iqfoc_commission_t *c)
{
    const iqfoc_commission_config_t *config = c->config;
    const iq24_t share = config->share_l;
    const iq24_t low = IQ24(0.0625);
    const iq24_t high = IQ24(8.0);
    const iq24_t h_u = c->amplitude * (iq24_t)(INT32_C(1) << half_log2(c));
    const iqfoc_commission_value_t l = commission_inductance(c->x, c->y, h_u, c->result.r);
    if (c->phase == IQFOC_COMMISSION_INDUCTANCE_D) {
        c->result.l_d = taken(c, l, share, low, high);
        c->amplitude = c->amplitude / 2 + 1;
        enter(c, IQFOC_COMMISSION_INDUCTANCE_Q, config->settle_cycles);
    } else if (c->phase == IQFOC_COMMISSION_INDUCTANCE_Q) {
        c->result.l_q = l;
        c->amplitude = c->amplitude / 8 + 1;
        enter(c, IQFOC_COMMISSION_SHAFT, config->settle_cycles);
    } else {
        c->result.l_q = taken(c, without_shaft(c->result.l_q, l), share, low, high);
        set_gains(c, c->result.l_d.value, c->result.l_q.value, W_T);
        enter(c, IQFOC_COMMISSION_RUN_UP, 0);
    }
}

static void inductance(iqfoc_commission_t *c, iq24_t i)
{
    const uint32_t h_log2 = half_log2(c);
    const uint32_t periods_log2 = c->config->block_log2 - h_log2 - 1;
    if (!wave_measured(c, i)) {
        return;
    }
    if (c->wait > 0) {
        const uint32_t period = UINT32_C(2) << h_log2;
        c->wait -= c->wait < period ? c->wait : period;
        clear_sums(c);
        return;
    }
    c->in_block++;
    if (c->in_block >> periods_log2 == 0) {
        return;
    }
    /* Two half periods each. */
    const iq24_t d = mean_of(c->sum[0], periods_log2 + 1);
    const iq24_t s = mean_of(c->sum[1], periods_log2 + 1);
    clear_sums(c);
    if (c->blocks == 0) {
        scale_amplitude(c, d);
        c->wait = c->config->settle_cycles;
    } else {
        c->x[c->blocks - 1] = d;
        c->y[c->blocks - 1] = s;
    }
    c->blocks++;
    if (c->blocks > IQFOC_COMMISSION_BLOCKS) {
        inductance_found(c);
    }
}

/* ---- SPIN ---- */

static void spin(iqfoc_commission_t *c, iqfoc_dq_t i, iqfoc_dq_t u)
{
    const uint32_t n = c->config->block_log2;
    if (!block_measured(c, i, u)) {
        return;
    }
    const commission_means_t means = {{mean_of(c->sum[0], n), mean_of(c->sum[2], n)},
                                      {mean_of(c->sum[1], n), mean_of(c->sum[3], n)}};
    const iq24_t phi_s1 = iqfoc_rotor_from_turns(c->start.turns).phi_s1;
    c->x[c->blocks] = commission_flux(&c->result, &means, phi_s1);
    clear_sums(c);
    c->blocks++;
    if (c->blocks < IQFOC_COMMISSION_BLOCKS) {
        return;
    }
    iqfoc_commission_value_t psi = commission_spread(c->x);
    psi.half = iq24_add_sat(psi.half, commission_flux_half(&c->result, &means, phi_s1));
    c->result.psi = taken(c, psi, c->config->share_psi, 0, IQ24(16.0));
    if (c->end == IQFOC_COMMISSION_RUNNING) {
        const bool turns = psi.value / 4 > psi.half;
        c->end = turns ? IQFOC_COMMISSION_DONE : IQFOC_COMMISSION_NOT_TURNING;
    }
}

/* ---- The step ---- */

/* What this cycle's sample tells; may change the phase. */
static void measure(iqfoc_commission_t *c, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    const iqfoc_dq_t along_a = {i.alpha, i.beta};
    switch (c->phase) {
    case IQFOC_COMMISSION_OFFSET:
        measure_offset(c, sample);
        break;
    case IQFOC_COMMISSION_SEEK_ALPHA:
        seek(c, i.alpha);
        break;
    case IQFOC_COMMISSION_SEEK_BETA:
        seek(c, i.beta);
        break;
    case IQFOC_COMMISSION_STAIRCASE:
        staircase(c, along_a, c->u_dq);
        break;
    case IQFOC_COMMISSION_INDUCTANCE_D:
        inductance(c, i.alpha);
        break;
    case IQFOC_COMMISSION_INDUCTANCE_Q:
    case IQFOC_COMMISSION_SHAFT:
        inductance(c, i.beta);
        break;
    case IQFOC_COMMISSION_ALIGN:
        iqfoc_start_step(&c->start, sample->theta);
        if (c->start.stage == IQFOC_START_RUN_UP) {
            enter(c, IQFOC_COMMISSION_STAIRCASE, c->config->settle_cycles);
        }
        break;
    case IQFOC_COMMISSION_RUN_UP:
        iqfoc_start_step(&c->start, sample->theta);
        if (c->start.stage == IQFOC_START_OPEN_LOOP) {
            enter(c, IQFOC_COMMISSION_SPIN, c->config->start.hold_cycles);
        }
        break;
    case IQFOC_COMMISSION_SPIN:
    default:
        iqfoc_start_step(&c->start, sample->theta);
        spin(c, iqfoc_park(i, iq24_sincos(c->start.theta)), c->u_dq);
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
        u.alpha = wave_next(c);
        return u;
    case IQFOC_COMMISSION_INDUCTANCE_D:
        u.alpha = iq24_add_sat(c->bias, wave_next(c));
        return u;
    case IQFOC_COMMISSION_SEEK_BETA:
        u.beta = wave_next(c);
        return u;
    case IQFOC_COMMISSION_INDUCTANCE_Q:
    case IQFOC_COMMISSION_SHAFT:
        u.alpha = c->bias;
        u.beta = wave_next(c);
        return u;
    case IQFOC_COMMISSION_STAIRCASE:
        i_ref.d = staircase_level(c);
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
           : iq24_abs_sat(sample->turns) > config->turns_max  ? IQFOC_COMMISSION_OVER_SPEED
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
