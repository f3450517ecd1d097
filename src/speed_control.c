/* Speed control (include/iqfoc/speed_control.h). */
#include "iqfoc/speed_control.h"

#include "iqfoc/iq24_math.h"

#include <stddef.h>

/* 1/3 turn per cycle in Q32, and the largest ramp. */
#define TURNS_MAX (IQFOC_ROTOR_SPEED_MAX * INT32_C(256))
#define RAMP_MAX  (INT32_C(1) << 30)
#define I_MAX     IQ24(4.0)

iqfoc_error_t iqfoc_speed_control_init(iqfoc_speed_control_t *control,
                                       const iqfoc_speed_control_config_t *config)
{
    if (control == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (config->kp_q16 <= 0 || !iq24_within(config->share, 0, IQ24_ONE) ||
        !iq24_within(config->ramp_q32, 1, RAMP_MAX) || !iq24_within(config->i_max, 1, I_MAX) ||
        !iq24_within(config->i_ramp, 0, config->i_max) || config->cycles == 0) {
        return IQFOC_ERROR_SPEED_CONTROL;
    }
    control->config = config;
    iqfoc_speed_control_start(control, 0, 0);
    return IQFOC_OK;
}

static int32_t turns_in_q32(iq24_t speed)
{
    return iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX) * INT32_C(256);
}

void iqfoc_speed_control_start(iqfoc_speed_control_t *control, iq24_t speed, iq24_t i_q)
{
    const iq24_t i_max = control->config->i_max;
    control->i_q = iq24_clamp(i_q, -i_max, i_max);
    control->integral = iq24_acc_mul(control->i_q, IQ24_ONE);
    control->set_point_q32 = turns_in_q32(speed);
    control->wait = 0;
}

/* x held to -limit ... limit; 0 <= limit. */
static iq24_acc_t held(iq24_acc_t x, iq24_acc_t limit)
{
    return x > limit ? limit : x < -limit ? -limit : x;
}

/*
 * Range: speeds are within 1/3 turn, 2^30.5 in Q32, so that a difference saturates only beyond half a turn. kp e: 2^62; |I| <= 8 and |i_ramp| <= 4
 * are below 2^52. What the limit leaves is within 16 per unit.
 */
static void step(iqfoc_speed_control_t *control, int32_t target, int32_t speed, iq24_t limit)
{
    const iqfoc_speed_control_config_t *config = control->config;
    const int32_t ramp = config->ramp_q32;
    const int32_t moved = iq24_clamp(iq24_sub_sat(target, control->set_point_q32), -ramp, ramp);
    const iq24_t i_ramp = iq24_min(config->i_ramp, limit);
    const iq24_t feed_forward = moved == ramp ? i_ramp : moved == -ramp ? -i_ramp : 0;
    control->set_point_q32 = iq24_add_sat(control->set_point_q32, moved);

    const iq24_acc_t rest = iq24_acc_mac(control->integral, feed_forward, IQ24_ONE);
    const iq24_acc_t wanted = iq24_acc_mac(rest, config->kp_q16, iq24_sub_sat(control->set_point_q32, speed));
    const iq24_acc_t i_q = held(wanted, iq24_acc_mul(limit, IQ24_ONE));
    const iq24_t left = iq24_acc_round(i_q - rest);
    if (i_q != wanted) {
        const int32_t error = iq24_div(left, config->kp_q16); /* Q24 by Q16: in Q32 */
        control->set_point_q32 = iq24_clamp(iq24_add_sat(speed, error), -TURNS_MAX, TURNS_MAX);
    }
    control->i_q = iq24_acc_round(i_q);
    control->integral = iq24_acc_mac(control->integral, config->share, left);
}

iq24_t iqfoc_speed_control_step(iqfoc_speed_control_t *control, iq24_t target, iq24_t speed, iq24_t limit)
{
    if (control->wait == 0) {
        control->wait = control->config->cycles;
        step(control, turns_in_q32(target), turns_in_q32(speed),
             iq24_clamp(limit, 0, control->config->i_max));
    }
    control->wait--;
    return control->i_q;
}
