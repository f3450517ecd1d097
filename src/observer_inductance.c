/* L_q of the observer from steps of the current (include/iqfoc/observer_inductance.h). */
#include "iqfoc/observer_inductance.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include <stddef.h>

#define TWO_PI IQ24(6.283185307179586)

iqfoc_error_t iqfoc_observer_inductance_init(iqfoc_observer_inductance_t *inductance,
                                             const iqfoc_observer_inductance_config_t *config,
                                             const iqfoc_observer_config_t *nominal)
{
    if (inductance == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const iqfoc_error_t error = iqfoc_observer_check(nominal);
    if (error != IQFOC_OK) {
        return error;
    }
    const iq24_t l_d = nominal->machine.l_d;
    const bool good =
        iq24_within(config->gain, 1, IQ24_ONE) && iq24_within(config->least, IQ24(0.0625), IQ24_ONE) &&
        iq24_within(config->u_least, 0, IQ24_ONE) && iq24_within(config->low, 1, nominal->machine.l_q) &&
        iq24_within(config->high, nominal->machine.l_q, IQ24(8.0)) &&
        iq24_within(l_d - config->low, IQ24(-4.0), IQ24(4.0)) &&
        iq24_within(l_d - config->high, IQ24(-4.0), IQ24(4.0));
    if (!good) {
        return IQFOC_ERROR_OBSERVER;
    }
    inductance->config = config;
    inductance->adapted = *nominal;
    inductance->level = 0;
    inductance->slope = 0;
    inductance->follows = false;
    return IQFOC_OK;
}

/* x of this cycle. Range: the header's. */
static iq24_t filtered(iqfoc_observer_inductance_t *inductance, iq24_t i_q)
{
    const iq24_t expected = inductance->level + inductance->slope;
    const iq24_t x = IQ24_HOLD_BITS(i_q - expected, 28);
    inductance->level = IQ24_HOLD_BITS(expected + iq24_mul_trunc(inductance->adapted.k1, x), 29);
    inductance->slope = IQ24_HOLD_BITS(inductance->slope + iq24_mul_trunc(inductance->adapted.k2, x), 28);
    return x;
}

/* The voltage of L_q in the step. Range: the header's. */
static iq24_t voltage_of(const iqfoc_observer_inductance_t *inductance, iq24_t speed, iq24_t x)
{
    const iq24_t flux = iq24_mul_trunc(inductance->adapted.machine.l_q, x);
    return iq24_abs_sat(iq24_mul_sat(iq24_mul_trunc(TWO_PI, speed), flux));
}

void iqfoc_observer_inductance_step(iqfoc_observer_inductance_t *inductance, const iqfoc_observer_t *observer,
                                    iqfoc_ab_t i)
{
    const iqfoc_observer_inductance_config_t *c = inductance->config;
    const iq24_t i_q = IQ24_HOLD_BITS(iqfoc_park(i, iq24_sincos(iqfoc_observer_theta(observer, 0))).q, 27);
    if (!observer->locked || !inductance->follows) {
        inductance->level = i_q;
        inductance->slope = 0;
        inductance->follows = observer->locked;
        return;
    }
    const iq24_t x = filtered(inductance, i_q);
    if (iq24_within(x, 1 - c->least, c->least - 1) ||
        voltage_of(inductance, iqfoc_observer_speed(observer), x) < c->u_least) {
        return;
    }
    const iq24_t squares = iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(x, x), c->least, c->least));
    const iq24_t turned = iq24_mul_sat(TWO_PI, observer->error);
    const iq24_t across = IQ24_HOLD_BITS(iq24_mul_sat(inductance->adapted.machine.psi, turned), 28);
    const iq24_t share = iq24_div(x, squares);
    /*@ assert inductance_share: -150994944 <= share <= 150994944; */
    const iq24_t step = iq24_mul_round(c->gain, iq24_mul_round(across, share));
    inductance->adapted.machine.l_q = iq24_clamp(inductance->adapted.machine.l_q + step, c->low, c->high);
}
