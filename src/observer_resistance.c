/* R and psi_f of the observer from its radial error (include/iqfoc/observer_resistance.h). */
#include "iqfoc/observer_resistance.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include <stddef.h>

#define R_OVER_PSI_MAX IQ24(8.0)

/* Range: |share| <= 1/2 and nominal <= 16. */
static iq24_t changed(iq24_t nominal, iq24_t share)
{
    return nominal + iq24_mul_round(nominal, share);
}

static iqfoc_error_t check_with(const iqfoc_observer_config_t *nominal, iq24_t r_share, iq24_t psi_share)
{
    iqfoc_observer_config_t end = *nominal;
    end.machine.r = changed(end.machine.r, r_share);
    end.machine.psi = changed(end.machine.psi, psi_share);
    return iqfoc_observer_check(&end);
}

iqfoc_error_t iqfoc_observer_resistance_init(iqfoc_observer_resistance_t *resistance,
                                             const iqfoc_observer_resistance_config_t *config,
                                             iqfoc_observer_config_t *adapted)
{
    const iqfoc_ab_t none = {0, 0};
    if (resistance == NULL || config == NULL || adapted == NULL) {
        return IQFOC_ERROR_NULL;
    }
    iqfoc_error_t error = iqfoc_observer_check(adapted);
    if (error != IQFOC_OK) {
        return error;
    }
    const iq24_t r_over_psi = iq24_div(adapted->machine.r, adapted->machine.psi);
    const bool good =
        iq24_within(config->gain, 1, IQ24_ONE) && iq24_within(config->r_share, IQ24(0.0625), IQ24(0.5)) &&
        iq24_within(config->psi_share, IQ24(0.015625), IQ24(0.25)) && r_over_psi <= R_OVER_PSI_MAX;
    if (!good) {
        return IQFOC_ERROR_OBSERVER;
    }
    error = check_with(adapted, config->r_share, config->psi_share);
    if (error == IQFOC_OK) {
        error = check_with(adapted, -config->r_share, -config->psi_share);
    }
    if (error == IQFOC_OK) {
        resistance->config = config;
        resistance->adapted = adapted;
        resistance->r_nominal = adapted->machine.r;
        resistance->psi_nominal = adapted->machine.psi;
        resistance->r_over_psi = r_over_psi;
        resistance->psi_inverse = iq24_div(IQ24_ONE, adapted->machine.psi);
        resistance->least = iq24_div(config->psi_share, config->r_share);
        resistance->r = 0;
        resistance->psi = 0;
        resistance->s = none;
    }
    return error;
}

/* s - k i. Range: the header's. */
static iq24_t driven(iq24_t s, iq24_t k, iq24_t i)
{
    const iq24_t by = IQ24_HOLD_BITS(iq24_mul_trunc(k, i), 30);
    return IQ24_HOLD_BITS(s - by, 30);
}

static void adapt_r(iqfoc_observer_resistance_t *resistance, iqfoc_observer_t *o, iq24_t step)
{
    const iq24_t share = resistance->config->r_share;
    const iq24_t r = iq24_clamp(resistance->r - step, -share, share);
    const iq24_t moved = iq24_mul_sat(resistance->psi_nominal, r - resistance->r);
    o->psi.alpha = IQ24_HOLD_BITS(iq24_add_sat(o->psi.alpha, iq24_mul_sat(moved, resistance->s.alpha)), 30);
    o->psi.beta = IQ24_HOLD_BITS(iq24_add_sat(o->psi.beta, iq24_mul_sat(moved, resistance->s.beta)), 30);
    resistance->r = r;
    resistance->adapted->machine.r = changed(resistance->r_nominal, r);
}

static void adapt_psi(iqfoc_observer_resistance_t *resistance, iq24_t step)
{
    const iq24_t share = resistance->config->psi_share;
    resistance->psi = iq24_clamp(resistance->psi - step, -share, share);
    resistance->adapted->machine.psi = changed(resistance->psi_nominal, resistance->psi);
}

void iqfoc_observer_resistance_step(iqfoc_observer_resistance_t *resistance, iqfoc_observer_t *observer,
                                    iqfoc_ab_t i)
{
    const iqfoc_observer_resistance_config_t *c = resistance->config;
    if (!observer->locked) {
        const iqfoc_ab_t none = {0, 0};
        resistance->s = none;
        return;
    }
    const iq24_sincos_t d = iq24_sincos(iqfoc_observer_theta(observer, 0));
    const iqfoc_ab_t s = {driven(resistance->s.alpha, resistance->r_over_psi, i.alpha),
                          driven(resistance->s.beta, resistance->r_over_psi, i.beta)};
    const iqfoc_dq_t parts = iqfoc_park(s, d);
    const iq24_t speed = iq24_abs_sat(iqfoc_observer_speed(observer));
    const iq24_t g = iq24_min(resistance->adapted->gain_max, iq24_mul_round(IQFOC_OBSERVER_GAIN, speed));
    const iq24_t by = iq24_mul_round(g, parts.d);
    resistance->s.alpha = IQ24_HOLD_BITS(s.alpha - iq24_mul_round(by, d.cos), 30);
    resistance->s.beta = IQ24_HOLD_BITS(s.beta - iq24_mul_round(by, d.sin), 30);
    const iq24_t off = IQ24_HOLD_BITS(iq24_mul_sat(resistance->psi_inverse, observer->flux_error), 25);
    const iq24_t along = iq24_abs_sat(parts.d);
    const iq24_t across = iq24_abs_sat(parts.q);
    if (along >= resistance->least && along >= across) {
        const iq24_t change = iq24_div(off, -parts.d);
        /*@ assert resistance_change: -536870912 <= change <= 536870912; */
        adapt_r(resistance, observer, iq24_mul_round(c->gain, change));
    } else if (iq24_max(along, across) < resistance->least / 2 && speed >= resistance->adapted->speed_min) {
        adapt_psi(resistance, iq24_mul_round(c->gain, off));
    } else {
        /* neither can be seen */
    }
}
