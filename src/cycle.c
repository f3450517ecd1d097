/*
 * The control cycle (include/iqfoc/cycle.h). What it computes is in the modules it calls; what is here is
 * order, time and the guarding of both.
 */
#include "iqfoc/cycle.h"

#include "iqfoc/mean_current.h"
#include "iqfoc/transform.h"

#include <stddef.h>

#define U_DC_MIN IQ24(0.5)
#define U_DC_MAX IQ24(1.5)

static bool beyond(iq24_t x, iq24_t limit)
{
    return x > limit || x < -limit;
}

static bool predictor_valid(const iqfoc_predictor_t *p)
{
    return iq24_within(p->k_u, 1, IQ24(16.0)) && iq24_within(p->k_r, 0, IQ24_ONE) &&
           iq24_within(p->k_psi, 0, IQ24(8.0));
}

static bool gains_valid(const iqfoc_current_control_gains_t *g)
{
    return iq24_within(g->kp_d, 0, IQ24(32.0)) && iq24_within(g->kp_q, 0, IQ24(32.0)) &&
           iq24_within(g->ki_d, 0, IQ24(32.0)) && iq24_within(g->ki_q, 0, IQ24(32.0)) &&
           iq24_within(g->anti_windup, 0, IQ24_ONE) && iq24_within(g->x_d, 0, IQ24(96.0)) &&
           iq24_within(g->x_q, 0, IQ24(96.0)) && iq24_within(g->emf, 0, IQ24(96.0));
}

static bool choices_valid(const iqfoc_cycle_config_t *c)
{
    return (c->feedback == IQFOC_FEEDBACK_MIDPOINT || c->feedback == IQFOC_FEEDBACK_CORRECTED_MEAN ||
            c->feedback == IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN) &&
           (c->modulation == IQFOC_MODULATION_PWM || c->modulation == IQFOC_MODULATION_SIX_STEP) &&
           (c->safe_state == IQFOC_SAFE_GATES_OFF || c->safe_state == IQFOC_SAFE_SHORT_CIRCUIT);
}

iqfoc_error_t iqfoc_cycle_init(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config)
{
    if (cycle == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!predictor_valid(&config->predictor)) {
        return IQFOC_ERROR_PREDICTOR;
    }
    if (!gains_valid(&config->gains)) {
        return IQFOC_ERROR_GAINS;
    }
    if (!iq24_within(config->span_max, 1, IQ24_ONE)) {
        return IQFOC_ERROR_SPAN;
    }
    if (!iq24_within(config->current_limit, 1, IQ24(16.0))) {
        return IQFOC_ERROR_CURRENT_LIMIT;
    }
    if (!choices_valid(config)) {
        return IQFOC_ERROR_CHOICE;
    }
    const iqfoc_cycle_t fresh = {.config = config, .rotor = {.s1 = IQ24_ONE}, .u_dc_inverse = IQ24_ONE};
    *cycle = fresh;
    return IQFOC_OK;
}

void iqfoc_cycle_clear(iqfoc_cycle_t *cycle)
{
    const iqfoc_current_control_t no_control = {0, 0};
    cycle->status = 0;
    cycle->tripped = false;
    cycle->started = false;
    cycle->corrected = false;
    cycle->control = no_control;
}

iqfoc_command_t iqfoc_cycle_safe(const iqfoc_cycle_config_t *config)
{
    const iqfoc_command_t safe = {{{0, 0, 0}, IQ24_ONE}, config->safe_state == IQFOC_SAFE_SHORT_CIRCUIT};
    return safe;
}

static void set_status(iqfoc_cycle_t *cycle, uint32_t bits)
{
    cycle->status |= bits;
    cycle->tripped = cycle->tripped || (bits & cycle->config->trips) != 0;
}

/* Ticks from one time to a later one. They wrap: the difference modulo 2^32 is right across the wrap. */
static uint32_t ticks_since(uint32_t then, uint32_t now)
{
    return (uint32_t)(UINT64_C(0x100000000) + now - then);
}

/* What a sample shows of its own, as status bits. */
static uint32_t sample_faults(const iqfoc_cycle_config_t *config, const iqfoc_sample_t *sample,
                              iq24_t i_alpha, iq24_t i_beta)
{
    uint32_t bits = sample->clipped ? IQFOC_STATUS_SAMPLE_CLIPPED : 0;
    if (beyond(i_alpha, config->current_limit) || beyond(i_beta, config->current_limit)) {
        bits |= IQFOC_STATUS_OVERCURRENT;
    }
    if (beyond(sample->turns, IQFOC_ROTOR_TURNS_MAX)) {
        bits |= IQFOC_STATUS_OVERSPEED;
    }
    if (!iq24_within(sample->u_dc, U_DC_MIN, U_DC_MAX)) {
        bits |= IQFOC_STATUS_DC_LINK;
    }
    return bits;
}

/* The same and its age when the call began. */
static uint32_t faults(const iqfoc_cycle_config_t *config, const iqfoc_sample_t *sample, iqfoc_ab_t i,
                       uint32_t now)
{
    const uint32_t bits = sample_faults(config, sample, i.alpha, i.beta);
    const bool stale = config->period_ticks != 0 && ticks_since(sample->time, now) > config->stale_ticks;
    return stale ? bits | IQFOC_STATUS_STALE : bits;
}

/*
 * theta moved by a number of cycles at the present speed.
 *
 * Range: |turns| <= 1/3 and |cycles| <= 9 give at most 3 turns; the sum wraps at 128 turns, which are whole.
 */
static iq24_t theta_after(iq24_t theta, iq24_t turns, iq24_t cycles)
{
    return iq24_add_wrap(theta, iq24_mul_round(turns, cycles));
}

/* theta half a cycle on. */
static iq24_t theta_half_on(iq24_t theta, iq24_t turns)
{
    return iq24_add_wrap(theta, iq24_asr32(turns, 1));
}

/*
 * Mean over the cycle that ends at this valley: its ends are the two valleys' samples, and the sample at its
 * middle is the mean of a current that changes linearly; a port that averages gives a better one.
 */
static iqfoc_dq_t corrected_mean(const iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    const iqfoc_ab_t i_mean = sample->has_mean ? iqfoc_clarke3(sample->i_mean) : cycle->i_peak;
    const iqfoc_ab_t delta = {iq24_sub_wrap(i.alpha, cycle->i_valley.alpha),
                              iq24_sub_wrap(i.beta, cycle->i_valley.beta)};
    const iq24_t theta_mid = theta_half_on(cycle->theta_valley, cycle->rotor.turns);
    return iqfoc_mean_current_correct(i_mean, delta, &cycle->rotor, iq24_sincos(theta_mid));
}

/*
 * Range: phases within 15.9 give |alpha| <= 21.2 and |beta| <= 18.4; u_now is what the DC link can make, |u|
 * <= 1. So |i_next| <= 21.2 + 16 + 13.9 = 51.1 a component, which is what iqfoc_mean_current_seen asks for.
 */
void iqfoc_cycle_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    const iqfoc_cycle_config_t *config = cycle->config;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    const iqfoc_ab_t none = {0, 0};
    bool whole = cycle->started; /* the cycle that ends here was seen from its valley on */
    uint32_t status = faults(config, sample, i, now);
    if (cycle->started && (cycle->at_valley || (config->period_ticks != 0 &&
                                                ticks_since(cycle->valley_time, sample->time) >
                                                    config->period_ticks + config->tolerance_ticks))) {
        status |= IQFOC_STATUS_MISSED;
        whole = false;
    }
    set_status(cycle, status);
    const iqfoc_ab_t error = {iq24_sub_wrap(i.alpha, cycle->i_next.alpha),
                              iq24_sub_wrap(i.beta, cycle->i_next.beta)};
    cycle->error = whole ? error : none;
    cycle->corrected = whole && config->feedback == IQFOC_FEEDBACK_CORRECTED_MEAN;
    if (cycle->corrected) {
        cycle->i_corrected_dq = corrected_mean(cycle, sample, i);
    }
    cycle->u_now = cycle->u_ab;
    cycle->i_valley = i;
    cycle->valley_time = sample->time;
    cycle->at_valley = true;
    cycle->started = true;

    cycle->rotor = iqfoc_rotor_from_turns(sample->turns);
    cycle->theta_valley = theta_after(sample->theta, cycle->rotor.turns, -sample->at);
    const iq24_sincos_t sc_mid = iq24_sincos(theta_half_on(cycle->theta_valley, cycle->rotor.turns));
    const iq24_t w = iqfoc_predictor_emf(&config->predictor, &cycle->rotor);
    cycle->i_next = iqfoc_predictor_step(&config->predictor, i, cycle->u_now, w, sc_mid);
    cycle->i_mean_dq = iqfoc_mean_current_seen(i, cycle->i_next, w, &cycle->rotor, sc_mid);
}

static iqfoc_dq_t feedback(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    switch (cycle->config->feedback) {
    case IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN:
        return cycle->i_mean_dq;
    case IQFOC_FEEDBACK_CORRECTED_MEAN:
        if (cycle->corrected) {
            return cycle->i_corrected_dq;
        }
        set_status(cycle, IQFOC_STATUS_NO_INTERVAL);
        break;
    case IQFOC_FEEDBACK_MIDPOINT:
    default:
        break;
    }
    return iqfoc_park(i, iq24_sincos(sample->theta));
}

/*
 * One Newton step towards 1/u: r (2 - u r).
 *
 * Range: 0.5 <= u <= 1.5 and 0 < r <= 2 at entry; p = u r >= 0 is held to 1.5, so the factor 2 - p is at
 * least 0.5, and r stays positive: half of 1 LSB is rounded up. r (2 - u r) <= 1/u <= 2, but for its
 * rounding. The relative error e becomes e^2 a cycle: after a step of 10 % in u_dc it is 1 %, then 0.01 %,
 * then below 1 LSB.
 */
static iq24_t inverse_followed(iq24_t r, iq24_t u)
{
    const iq24_t p = iq24_min(iq24_mul_round(iq24_clamp(u, U_DC_MIN, U_DC_MAX), r), IQ24(1.5));
    return iq24_min(iq24_mul_round(r, 2 * IQ24_ONE - p), 2 * IQ24_ONE);
}

/* Duties for u, and in u what they really make of it. */
static iqfoc_duties_t modulated(const iqfoc_cycle_t *cycle, iqfoc_ab_t *u, iq24_t u_dc)
{
    iqfoc_duties_t duties = iqfoc_modulate(*u, cycle->u_dc_inverse, cycle->config->span_max);
    if (cycle->config->modulation == IQFOC_MODULATION_SIX_STEP) {
        const int32_t state = iqfoc_six_step_state(iq24_atan2(u->beta, u->alpha));
        const iq24_t scale = duties.scale;
        duties = iqfoc_six_step_duties(state);
        duties.scale = scale;
        *u = iqfoc_six_step_voltage(state, u_dc);
    } else if (duties.scale < IQ24_ONE) {
        u->alpha = iq24_mul_round(u->alpha, duties.scale);
        u->beta = iq24_mul_round(u->beta, duties.scale);
    }
    return duties;
}

static void stop(iqfoc_cycle_t *cycle)
{
    const iqfoc_current_control_t no_control = {0, 0};
    const iqfoc_ab_t no_voltage = {0, 0};
    const iqfoc_dq_t nothing = {0, 0};
    cycle->control = no_control;
    cycle->u_ab = no_voltage;
    cycle->u_dq = nothing;
}

iqfoc_command_t iqfoc_cycle_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iq24_t output_mid,
                                 uint32_t now)
{
    const iqfoc_cycle_config_t *config = cycle->config;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    const iq24_t turns = iq24_clamp(sample->turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX);
    uint32_t status = faults(config, sample, i, now);
    if (!cycle->at_valley) {
        status |= IQFOC_STATUS_MISSED;
        cycle->corrected = false;
    }
    set_status(cycle, status);
    cycle->at_valley = false;
    cycle->i_dq = feedback(cycle, sample, i);
    cycle->i_peak = i;
    cycle->u_dc_inverse = inverse_followed(cycle->u_dc_inverse, sample->u_dc);
    if (!cycle->enabled || cycle->tripped) {
        stop(cycle);
        return iqfoc_cycle_safe(config);
    }

    const iqfoc_dq_t control =
        iqfoc_current_control_step(&cycle->control, &config->gains, cycle->i_ref, cycle->i_dq);
    const iqfoc_dq_t apart = iqfoc_current_control_decoupling(&config->gains, cycle->i_dq, turns);
    cycle->u_dq.d = control.d + apart.d;
    cycle->u_dq.q = control.q + apart.q;
    cycle->u_ab = iqfoc_park_inverse(cycle->u_dq,
                                     iq24_sincos(theta_after(sample->theta, turns, output_mid - sample->at)));
    const iqfoc_command_t command = {modulated(cycle, &cycle->u_ab, sample->u_dc), true};
    if (command.duties.scale < IQ24_ONE) {
        set_status(cycle, IQFOC_STATUS_VOLTAGE_LIMIT);
        iqfoc_current_control_limited(&cycle->control, &config->gains, cycle->u_dq, command.duties.scale);
    }
    if (cycle->tripped) {
        stop(cycle);
        return iqfoc_cycle_safe(config);
    }
    return command;
}

bool iqfoc_cycle_in_time(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    const bool in_time =
        cycle->config->period_ticks == 0 || ticks_since(sample->time, now) <= cycle->config->deadline_ticks;
    if (!in_time) {
        set_status(cycle, IQFOC_STATUS_LATE);
        if (cycle->tripped) {
            stop(cycle);
        }
    }
    return in_time;
}
