/* predictor.h, mean_current.h, current_control.h, modulation.h. */
#include "any.h"

#include "iqfoc/current_control.h"
#include "iqfoc/mean_current.h"
#include "iqfoc/modulation.h"
#include "iqfoc/predictor.h"

static iqfoc_predictor_t any_machine(void)
{
    iqfoc_predictor_t machine;
    machine.k_u = any_within(1, IQ24(16.0));
    machine.k_r = any_within(0, IQ24_ONE);
    machine.k_psi = any_within(0, IQ24(8.0));
    return machine;
}

/* Predictions and mean currents: |i| <= 32, |u| <= 2, any machine within predictor.h, any speed. */
void prove_prediction_and_mean(void)
{
    const iqfoc_predictor_t machine = any_machine();
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(any());
    const iqfoc_ab_t i = any_ab(IQ24(32.0));
    const iqfoc_ab_t u = any_ab(IQ24(2.0));
    (void)iqfoc_predictor_euler(&machine, i, u, &rotor, any_sincos());
    (void)iqfoc_predictor_quasi_discrete(&machine, i, u, &rotor, any_sincos());
    (void)iqfoc_mean_current_quasi_discrete(&machine, i, u, &rotor, any_sincos());
    (void)iqfoc_mean_current_correct(i, any_ab(IQ24(32.0)), &rotor, any_sincos());
    (void)iqfoc_mean_current_correct_steady(i, iqfoc_rotor_steady_gain(any()), any_sincos());
    (void)iqfoc_mean_current_seen(any_ab(IQ24(21.2)), any_ab(IQ24(51.1)),
                                  iqfoc_predictor_emf(&machine, &rotor), &rotor, any_sincos());
}

/* Current control with decoupling and anti-windup: |i| <= 32, any gains within current_control.h. */
void prove_current_control(void)
{
    iqfoc_current_control_gains_t gains;
    iqfoc_current_control_t integrators;
    gains.kp_d = any_within(0, IQ24(32.0));
    gains.kp_q = any_within(0, IQ24(32.0));
    gains.ki_d = any_within(0, IQ24(32.0));
    gains.ki_q = any_within(0, IQ24(32.0));
    gains.anti_windup = any_within(0, IQ24_ONE);
    gains.x_d = any_within(0, IQ24(96.0));
    gains.x_q = any_within(0, IQ24(96.0));
    gains.emf = any_within(0, IQ24(96.0));
    /* Held to 8 per unit, Q48, by the step itself. */
    integrators.integral_d =
        (int64_t)any_within(-(1 << 27), (1 << 27) - 1) * (1 << 24) + any_within(0, (1 << 24) - 1);
    integrators.integral_q =
        (int64_t)any_within(-(1 << 27), (1 << 27) - 1) * (1 << 24) + any_within(0, (1 << 24) - 1);
    const iqfoc_dq_t u =
        iqfoc_current_control_step(&integrators, &gains, any_dq(IQ24(32.0)), any_dq(IQ24(32.0)));
    (void)iqfoc_current_control_decoupling(&gains, any_dq(IQ24(32.0)),
                                           any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
    iqfoc_current_control_limited(&integrators, &gains, u, any_within(0, IQ24_ONE));
}

/* Modulation: |u| <= 32, 0 < 1/u_dc <= 2, 0 < span_max <= 1. */
void prove_modulation(void)
{
    (void)iqfoc_modulate(any_ab(IQ24(32.0)), any_within(1, IQ24(2.0)), any_within(1, IQ24_ONE));
}

/* Six-step: any angle, any speed, |u_dc| <= 64. */
void prove_six_step(void)
{
    (void)iqfoc_six_step_state(any());
    (void)iqfoc_six_step_duties(any());
    (void)iqfoc_six_step_voltage(any_within(0, 5), any_within(-IQ24(64.0), IQ24(64.0)));
    (void)iqfoc_six_step_remaining(any(), any());
}
