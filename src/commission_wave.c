/* Phases of self-commissioning with a square wave of voltage: SEEK, and the inductances on a constant current. */
#include "commission_fit.h"
#include "commission_phases.h"
#include "iqfoc/iq24_math.h"

/* Current control, kp = w L, ki = (2/7) w T kp: w T with the rough inductance, and with the measured ones. A rotor that swings in the field
 * of a slow current control swings up. */
#define W_T_ROUGH IQ24(0.1)
#define W_T       IQ24(0.35)

uint32_t commission_half_log2(const iqfoc_commission_t *c)
{
    return c->config->half_log2 + (c->phase == IQFOC_COMMISSION_SHAFT ? 2 : 0);
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

/* True once a period is complete: D, S and k D of its cycles are in the sums, each times the number of half periods. */
static bool wave_measured(iqfoc_commission_t *c, iq24_t i, iq24_t across)
{
    const uint32_t h = UINT32_C(1) << commission_half_log2(c);
    const uint32_t first = h / 2;
    if (c->position <= first) {
        return false; /* the first cycle is still to begin */
    }
    const uint32_t now = (c->position - 1) % (2 * h);
    if (now == h) {
        c->sum[0] += 2 * (int64_t)i; /* the highest current, once for each half period that it bounds */
        c->sum[2] += 2 * (int64_t)across;
    } else if (now == 0) {
        c->sum[0] -= 2 * (int64_t)i;
        c->sum[2] -= 2 * (int64_t)across;
    } else {
        c->sum[1] += now < h ? i : -(int64_t)i;
    }
    return now == (first + 2 * h - 1) % (2 * h);
}

iq24_t commission_wave(iqfoc_commission_t *c)
{
    const uint32_t h = UINT32_C(1) << commission_half_log2(c);
    const bool high = c->position % (2 * h) < h;
    c->position = c->position < 4 * h ? c->position + 1 : 2 * h + 1;
    return high ? c->amplitude : -c->amplitude;
}

static void seek_found(iqfoc_commission_t *c, iq24_t difference)
{
    const iq24_t h = (iq24_t)(INT32_C(1) << commission_half_log2(c));
    const iq24_t l = iq24_clamp(iq24_div((c->amplitude - c->half_u) * h, iq24_max(difference - c->half_d, 1)),
                                IQ24(0.0625), IQ24(8.0));
    c->amplitude = COMMISSION_SEEK_STEP;
    c->half_u = 0;
    c->half_d = 0;
    if (c->phase == IQFOC_COMMISSION_SEEK_ALPHA) {
        c->l_rough = l;
        commission_enter(c, IQFOC_COMMISSION_SEEK_BETA, 0);
    } else {
        c->l_rough = iq24_min(c->l_rough, l);
        set_gains(c, c->l_rough, c->l_rough, W_T_ROUGH);
        commission_enter(c, IQFOC_COMMISSION_ALIGN, 0);
    }
}

/* D of one period against the target, i_align/2. Range: |i| <= 16, D within 64. */
void commission_seek(iqfoc_commission_t *c, iq24_t i)
{
    if (!wave_measured(c, i, 0)) {
        return;
    }
    const iq24_t target = c->config->start.i_align / 2;
    const iq24_t difference = (iq24_t)iq24_asr64(c->sum[0], 1);
    commission_clear(c);
    if (difference >= target || (c->amplitude >= c->config->u_max && difference >= target / 4)) {
        seek_found(c, difference);
    } else if (c->amplitude >= c->config->u_max) {
        c->end = IQFOC_COMMISSION_NO_CURRENT;
    } else {
        if (c->half_d == 0 && difference >= target / 2) {
            c->half_u = c->amplitude;
            c->half_d = difference;
        }
        c->amplitude =
            iq24_min(c->amplitude + iq24_max(COMMISSION_SEEK_STEP, c->amplitude / 16), c->config->u_max);
    }
}

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
    const iq24_t h_u = c->amplitude * (iq24_t)(INT32_C(1) << commission_half_log2(c));
    const iqfoc_commission_value_t l = commission_inductance(&c->result, c->x, c->y, h_u);
    if (c->phase == IQFOC_COMMISSION_INDUCTANCE_D) {
        c->result.l_d = commission_taken(c, l, share, low, high);
        c->across = iq24_div(c->across, commission_mean(c->x));
        c->amplitude = c->amplitude / 2 + 1;
        commission_enter(c, IQFOC_COMMISSION_INDUCTANCE_Q, config->settle_cycles);
    } else if (c->phase == IQFOC_COMMISSION_INDUCTANCE_Q) {
        c->result.l_q = l;
        c->amplitude = c->amplitude / 8 + 1;
        commission_enter(c, IQFOC_COMMISSION_SHAFT, config->settle_cycles);
    } else {
        c->result.l_q = commission_taken(c, without_shaft(c->result.l_q, l), share, low, high);
        set_gains(c, c->result.l_d.value, c->result.l_q.value, W_T);
        commission_enter(c, IQFOC_COMMISSION_RUN_UP, 0);
    }
}

void commission_pulses(iqfoc_commission_t *c, iq24_t i, iq24_t across)
{
    const uint32_t h_log2 = commission_half_log2(c);
    const uint32_t periods_log2 = c->config->block_log2 - h_log2 - 1;
    if (!wave_measured(c, i, across)) {
        return;
    }
    if (c->wait > 0) {
        const uint32_t period = UINT32_C(2) << h_log2;
        c->wait -= c->wait < period ? c->wait : period;
        commission_clear(c);
        return;
    }
    c->in_block++;
    if (c->in_block >> periods_log2 == 0) {
        return;
    }
    /* Two half periods each. */
    const iq24_t d = commission_block_mean(c->sum[0], periods_log2 + 1);
    const iq24_t s = commission_block_mean(c->sum[1], periods_log2 + 1);
    const iq24_t k_d = commission_block_mean(c->sum[2], periods_log2 + 1);
    commission_clear(c);
    if (c->blocks == 0) {
        scale_amplitude(c, d);
        c->wait = c->config->settle_cycles;
    } else {
        c->x[c->blocks - 1] = d;
        c->y[c->blocks - 1] = s;
        c->across += c->phase == IQFOC_COMMISSION_INDUCTANCE_D ? k_d / IQFOC_COMMISSION_BLOCKS : 0;
    }
    c->blocks++;
    if (c->blocks > IQFOC_COMMISSION_BLOCKS) {
        inductance_found(c);
    }
}
