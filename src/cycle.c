/*
 * The control cycle (include/iqfoc/cycle.h): the order of the steps, the checks of time and data, and the safe state.
 * The computations are in the modules that it calls.
 */
#include "iqfoc/cycle.h"

#include "iqfoc/cycle_steps.h"

#include <stddef.h>

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

static bool safe_state_valid(iqfoc_safe_state_t s)
{
    return s == IQFOC_SAFE_GATES_OFF || s == IQFOC_SAFE_SHORT_CIRCUIT;
}

/* Methods of the ready-made cycle. */
static bool methods_valid(const iqfoc_cycle_config_t *c)
{
    return (c->feedback == IQFOC_FEEDBACK_MIDPOINT || c->feedback == IQFOC_FEEDBACK_CORRECTED_MEAN ||
            c->feedback == IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN) &&
           (c->modulation == IQFOC_MODULATION_PWM || c->modulation == IQFOC_MODULATION_SIX_STEP);
}

/* period + tolerance must not wrap; a time from 2^31 ticks on is one that ran backwards, and so already over. */
static bool times_valid(const iqfoc_cycle_config_t *c)
{
    return (c->period_ticks == 0) == c->time_unchecked && c->period_ticks <= INT32_MAX &&
           c->tolerance_ticks <= INT32_MAX - c->period_ticks;
}

/* Checks that every drive needs, whatever its methods. */
static iqfoc_error_t checked(const iqfoc_cycle_config_t *config)
{
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
    if (!safe_state_valid(config->safe_state)) {
        return IQFOC_ERROR_CHOICE;
    }
    return times_valid(config) ? IQFOC_OK : IQFOC_ERROR_TIMES;
}

iqfoc_error_t iqfoc_cycle_init_named(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config)
{
    if (cycle == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const iqfoc_error_t refused = checked(config);
    if (refused == IQFOC_OK) {
        const iqfoc_cycle_t fresh = {.config = config,
                                     .next = config,
                                     .offered = config,
                                     .phase = IQFOC_CYCLE_DUE_NOTHING,
                                     .rotor = {.s1 = IQ24_ONE},
                                     .u_dc_inverse = IQ24_ONE};
        *cycle = fresh;
    }
    return refused;
}

/*
 * A pointer is stored in one access, so that an interrupt reads either the old set or the new one. The contents of
 * the set must be in memory before that store.
 */
iqfoc_error_t iqfoc_cycle_offer_named(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config)
{
    if (cycle == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const iqfoc_error_t refused = checked(config);
    if (refused == IQFOC_OK) {
#ifdef __GNUC__
        __asm volatile("" : : : "memory");
#endif
        cycle->offered = config;
    }
    return refused;
}

iqfoc_error_t iqfoc_cycle_init(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config)
{
    return cycle != NULL && config != NULL && !methods_valid(config) ? IQFOC_ERROR_CHOICE
                                                                     : iqfoc_cycle_init_named(cycle, config);
}

iqfoc_error_t iqfoc_cycle_offer(iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *config)
{
    return cycle != NULL && config != NULL && !methods_valid(config) ? IQFOC_ERROR_CHOICE
                                                                     : iqfoc_cycle_offer_named(cycle, config);
}

bool iqfoc_cycle_taken(const iqfoc_cycle_t *cycle)
{
    return cycle->config == cycle->offered && cycle->next == cycle->offered;
}

uint32_t iqfoc_cycle_next_ticks(const iqfoc_cycle_t *cycle)
{
    return cycle->next->period_ticks;
}

/*
 * An interrupt may come at any instruction. Each store that matters is one access, in this order:
 *
 * - `raised` becomes 0, and from then on holds each bit that an interrupt sets.
 * - `tripped` becomes false: a later fault sets it again, and no later store clears it.
 * - `status` becomes the bits that were raised. If `tripped` is still false, its bits that trip belong to a fault
 *   ahead of the second store and are dropped. The loop ends once no interrupt came between its load and its store.
 */
void iqfoc_cycle_clear(iqfoc_cycle_t *cycle)
{
    const iqfoc_current_control_t no_control = {0, 0};
    volatile uint32_t *const raised = &cycle->raised;
    volatile bool *const tripped = &cycle->tripped;
    volatile uint32_t *const status = &cycle->status;
    if (!cycle->enabled || cycle->tripped) {
        cycle->phase = IQFOC_CYCLE_DUE_NOTHING;
        cycle->corrected = false;
        cycle->control = no_control;
    }
    *raised = 0;
    *tripped = false;
    uint32_t seen;
    do {
        seen = *raised;
        *status = *tripped ? seen : seen & ~cycle->config->trips;
    } while (*raised != seen);
}

/* Range: the phases leave components of the current within 21.3 and the vector within 32; u_dq is within 8, its
 * vector within 11.4: beyond 8 the integrators are held. */
void iqfoc_cycle_hand_over(iqfoc_cycle_t *cycle, iq24_t theta_before, const iqfoc_sample_t *sample)
{
    const iqfoc_dq_t nothing = {0, 0};
    const iq24_t speed = iq24_clamp(sample->speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const iqfoc_ab_t u =
        iqfoc_park_inverse(cycle->u_dq, iq24_sincos(iq24_sub_wrap(theta_before, sample->theta)));
    cycle->u_dq.d = u.alpha;
    cycle->u_dq.q = u.beta;
    cycle->i_ref = iqfoc_park(iqfoc_clarke3(sample->i), iq24_sincos(sample->theta));
    cycle->drift = nothing;
    iqfoc_current_control_preset(&cycle->control, &cycle->config->gains, cycle->u_dq, cycle->i_ref, speed);
}

iqfoc_command_t iqfoc_cycle_safe(const iqfoc_cycle_config_t *config)
{
    const iqfoc_command_t safe = {{{0, 0, 0}, IQ24_ONE}, config->safe_state == IQFOC_SAFE_SHORT_CIRCUIT};
    return safe;
}

void iqfoc_cycle_set_status(iqfoc_cycle_t *cycle, uint32_t bits)
{
    cycle->status |= bits;
    cycle->raised |= bits;
    cycle->tripped = cycle->tripped || (bits & cycle->config->trips) != 0;
}

/* Faults of one sample as status bits: values, and age when the call began. */
static uint32_t faults(const iqfoc_cycle_config_t *config, const iqfoc_sample_t *sample, iqfoc_ab_t i,
                       uint32_t now)
{
    uint32_t bits = sample->clipped ? IQFOC_STATUS_SAMPLE_CLIPPED : 0;
    if (beyond(i.alpha, config->current_limit) || beyond(i.beta, config->current_limit)) {
        bits |= IQFOC_STATUS_OVERCURRENT;
    }
    if (beyond(sample->speed, IQFOC_ROTOR_SPEED_MAX)) {
        bits |= IQFOC_STATUS_OVERSPEED;
    }
    if (!iq24_within(sample->u_dc, IQFOC_CYCLE_U_DC_MIN, IQFOC_CYCLE_U_DC_MAX)) {
        bits |= IQFOC_STATUS_DC_LINK;
    }
    if (config->period_ticks != 0 && iqfoc_ticks_since(sample->time, now) > config->stale_ticks) {
        bits |= IQFOC_STATUS_STALE;
    }
    return bits;
}

bool iqfoc_cycle_report_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    const iqfoc_cycle_config_t *config = cycle->config;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    uint32_t bits = faults(config, sample, i, now);
    bool whole = cycle->phase == IQFOC_CYCLE_DUE_VALLEY;
    const bool long_ago = config->period_ticks != 0 && iqfoc_ticks_since(cycle->valley_time, sample->time) >
                                                           config->period_ticks + config->tolerance_ticks;
    if (cycle->phase == IQFOC_CYCLE_DUE_PEAK || (whole && long_ago)) {
        bits |= IQFOC_STATUS_MISSED;
        whole = false;
    }
    iqfoc_cycle_set_status(cycle, bits);
    if (!whole) {
        cycle->i_next = i;
    }
    return whole;
}

void iqfoc_cycle_report_sample(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    iqfoc_cycle_set_status(cycle, faults(cycle->config, sample, iqfoc_clarke3(sample->i), now));
}

bool iqfoc_cycle_report_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    iqfoc_cycle_report_sample(cycle, sample, now);
    if (cycle->phase == IQFOC_CYCLE_DUE_VALLEY) {
        cycle->corrected = false;
        iqfoc_cycle_set_status(cycle, IQFOC_STATUS_MISSED);
    }
    return cycle->phase != IQFOC_CYCLE_DUE_NOTHING;
}

iqfoc_command_t iqfoc_cycle_stopped(iqfoc_cycle_t *cycle)
{
    const iqfoc_current_control_t no_control = {0, 0};
    const iqfoc_ab_t no_voltage = {0, 0};
    const iqfoc_dq_t nothing = {0, 0};
    const iqfoc_abc_t no_duties = {0, 0, 0};
    cycle->control = no_control;
    cycle->u_ab = no_voltage;
    cycle->u_dq = nothing;
    cycle->drift = nothing;
    cycle->duties_next = no_duties;
    return iqfoc_cycle_safe(cycle->config);
}

/*
 * Half a cycle of the present length is left after the peak. The part of output_mid beyond it lies in cycles of the
 * next length.
 *
 * Range: the quotient of two lengths saturates at 128, and so does its product with at most 7 cycles.
 */
iq24_t iqfoc_cycle_output_mid_scaled(const iqfoc_cycle_t *cycle, iq24_t output_mid)
{
    const uint32_t old = cycle->config->period_ticks;
    const uint32_t new = cycle->next->period_ticks;
    if (old == new || output_mid <= IQ24_ONE) {
        return output_mid;
    }
    const iq24_t longer = iq24_div((iq24_t) new, (iq24_t)old);
    return iq24_clamp(iq24_add_sat(IQ24_ONE, iq24_mul_sat(output_mid - IQ24_ONE, longer)), 0, IQ24(8.0));
}

bool iqfoc_cycle_in_time(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    const bool in_time = cycle->config->period_ticks == 0 ||
                         iqfoc_ticks_since(sample->time, now) <= cycle->config->deadline_ticks;
    if (!in_time) {
        iqfoc_cycle_set_status(cycle, IQFOC_STATUS_LATE);
        if (cycle->tripped) {
            (void)iqfoc_cycle_stopped(cycle);
        }
    }
    return in_time;
}

/* ---- The ready-made cycle: the papers' methods, feedback and modulation as the configuration says ---- */

static inline iqfoc_methods_t of_papers(const iqfoc_cycle_config_t *config)
{
    iqfoc_methods_t methods = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_PI,
                               IQFOC_MODULATION_PWM, false};
    if (config->feedback == IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN) {
        methods.feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN;
    } else if (config->feedback == IQFOC_FEEDBACK_CORRECTED_MEAN) {
        methods.feedback = IQFOC_FEEDBACK_CORRECTED_MEAN;
    }
    if (config->modulation == IQFOC_MODULATION_SIX_STEP) {
        methods.modulation = IQFOC_MODULATION_SIX_STEP;
    }
    return methods;
}

bool iqfoc_cycle_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now)
{
    return iqfoc_cycle_valley_by(of_papers(cycle->config), cycle, sample, now);
}

iqfoc_command_t iqfoc_cycle_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iq24_t output_mid,
                                 uint32_t now)
{
    return iqfoc_cycle_peak_by(of_papers(cycle->config), cycle, sample, output_mid, now);
}
