/* Predictors beyond the papers', their means, and their controllers: predictor_exact.h to finite_set.h. */
#include "any_drive.h"

#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/finite_set.h"
#include "iqfoc/flux_map.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/induction.h"
#include "iqfoc/mean_modulated.h"
#include "iqfoc/predictor_form.h"
#include "iqfoc/ripple.h"

static iqfoc_exact_winding_t any_winding(void)
{
    iqfoc_exact_winding_t winding;
    winding.rho_q30 = any_within(0, 1 << 30);
    winding.k_u_q26 = any_within(1, 1 << 30);
    winding.k_psi_q27 = any_within(0, 1 << 30);
    return winding;
}

/* A model within deadbeat.h: what any of the three predictors makes of its machine. */
static iqfoc_exact_t any_model(void)
{
    iqfoc_exact_t model;
    model.stays_q26 = any_within(0, 1 << 26);
    model.k_u_q26 = any_within(1, 1 << 30);
    model.w_real_q26 = any_within(-1127428916, 1127428916); /* 16.8 */
    model.w_imag_q26 = any_within(-1127428916, 1127428916);
    return model;
}

static iqfoc_valley_reference_t any_valley_reference(void)
{
    iqfoc_valley_reference_t reference;
    reference.gain = any_within(IQ24_ONE, IQ24(1.4626));
    reference.magnet_pu = any_within(0, IQ24(3.8));
    return reference;
}

/* Exact prediction and mean: any winding within predictor_exact.h, any span, any speed; |i| <= 32, |u| <= 2. */
void prove_exact(void)
{
    const iqfoc_exact_winding_t winding = any_winding();
    const iq24_t span = any_within(1, IQ24_ONE);
    const iqfoc_exact_law_t end = iqfoc_exact_prediction(&winding, span);
    const iqfoc_exact_law_t mean = iqfoc_exact_mean(&winding, span);
    const iqfoc_exact_t end_now = iqfoc_exact_at_speed(&end, any());
    const iqfoc_exact_t mean_now = iqfoc_exact_at_speed(&mean, any());
    (void)iqfoc_exact_step(&end_now, any_ab(IQ24(32.0)), any_ab(IQ24(2.0)), any_sincos());
    (void)iqfoc_exact_step(&mean_now, any_ab(IQ24(32.0)), any_ab(IQ24(2.0)), any_sincos());
}

/* The papers' predictors as coefficients of that step: any machine within predictor.h, any speed. */
void prove_predictor_form(void)
{
    iqfoc_predictor_t machine;
    machine.k_u = any_within(1, IQ24(16.0));
    machine.k_r = any_within(0, IQ24_ONE);
    machine.k_psi = any_within(0, IQ24(8.0));
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(any());
    const iqfoc_exact_t euler = iqfoc_form_euler(&machine, &rotor);
    const iqfoc_exact_t quasi = iqfoc_form_quasi_discrete(&machine, &rotor);
    (void)iqfoc_exact_step(&euler, any_ab(IQ24(32.0)), any_ab(IQ24(2.0)), any_sincos());
    (void)iqfoc_exact_step(&quasi, any_ab(IQ24(32.0)), any_ab(IQ24(2.0)), any_sincos());
}

/* Salient prediction and mean: any machine within predictor_salient.h, any span, any speed; |i| <= 8, |u| <= 2. */
void prove_salient(void)
{
    const iqfoc_salient_machine_t machine = any_salient(1);
    iqfoc_salient_t end;
    iqfoc_salient_t mean;
    iqfoc_salient_at_speed(&machine, any(), any_within(1, IQ24_ONE), &end, &mean);
    (void)iqfoc_salient_step(&end, any_dq(IQ24(8.0)), any_dq(IQ24(2.0)));
    (void)iqfoc_salient_step(&mean, any_dq(IQ24(8.0)), any_dq(IQ24(2.0)));
}

/* Induction machine: any within induction.h, any span, any speed; |i| <= 8, |flux| <= 16, |u| <= 2. */
void prove_induction(void)
{
    iqfoc_induction_machine_t machine;
    machine.rho_s_q30 = any_within(0, 1 << 29);
    machine.rho_r_q30 = any_within(0, 1 << 29);
    machine.a_q30 = any_within(0, 107374183);
    machine.k_u_q26 = any_within(1, 1 << 30);
    const iqfoc_induction_t law = iqfoc_induction_at_speed(&machine, any(), any_within(1, IQ24_ONE));
    const iqfoc_induction_state_t x = {any_ab(IQ24(8.0)), any_ab(IQ24(16.0))};
    const iqfoc_induction_state_t next = iqfoc_induction_step(&law, x, any_ab(IQ24(2.0)));
    const iqfoc_ab_t mean = iqfoc_induction_mean(&law, x, any_ab(IQ24(2.0)));
    (void)iqfoc_induction_with_ripple(&law.i, next.i, any_ab(IQ24(0.52)));
    (void)iqfoc_induction_with_ripple(&law.i_mean, mean, any_ab(IQ24(0.52)));
}

/* Ripple, over a cycle and over a half, and the mean under modulation: any machine, any speed, any duties. */
void prove_ripple_and_modulated_mean(void)
{
    const iqfoc_salient_machine_t machine = any_salient(1);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(any());
    const iqfoc_ripple_t ripple = iqfoc_ripple_at_speed(&machine, &rotor);
    const iqfoc_ripple_half_t half = iqfoc_ripple_half_at_speed(&machine, &rotor);
    const iqfoc_abc_t high = any_abc(0, IQ24_ONE);
    const iq24_t u_dc = any_within(0, IQ24(2.0));
    (void)iqfoc_ripple_seen(&ripple, high, u_dc, any_sincos());
    (void)iqfoc_ripple_half_seen(&half, high, u_dc, any_bool(), any_sincos());
    iqfoc_predictor_t plain;
    plain.k_u = any_within(1, IQ24(16.0));
    plain.k_r = any_within(0, IQ24_ONE);
    plain.k_psi = any_within(0, IQ24(8.0));
    const iqfoc_mean_modulated_t mean = iqfoc_mean_modulated_at_speed(&plain, &rotor);
    (void)iqfoc_mean_modulated(&mean, any_ab(IQ24(32.0)), any_ab(IQ24(32.0)), high, u_dc, any_sincos());
}

/* Flux predictor: any that is not refused, with any extension that is not refused; |i| <= 8, |u| <= 2. */
void prove_flux_predictor(void)
{
    const iqfoc_flux_predictor_t p = {any(), any(), any(), any(), any(), any(), any()};
    const iqfoc_extension_t x = any_extension();
    if (iqfoc_flux_predictor_check(&p) == IQFOC_OK && iqfoc_extension_check(&x) == IQFOC_OK) {
        (void)iqfoc_flux_predictor_step(&p, &x, any_ab(IQ24(8.0)), any_ab(IQ24(2.0)), any_sincos(),
                                        any_sincos());
    }
}

/* Of the ranges that iqfoc_flux_map_check holds a part to. */
static iqfoc_flux_map_part_t any_part(void)
{
    iqfoc_flux_map_part_t part;
    part.e = any_within(0, IQ24(64.0));
    part.k_d = any_within(IQ24(0.0625), IQ24(10.0));
    part.k_q = any_within(IQ24(0.0625), IQ24(10.0));
    part.x_0 = any_within(IQ24(-16.0), IQ24(16.0));
    return part;
}

/* Flux map: any that is not refused, with any extension that is not refused; |i| <= 8, |u| <= 2. */
void prove_flux_map(void)
{
    const iqfoc_flux_map_t map = {any(), any(), any(), any(), {any_part(), any_part()}};
    const iqfoc_extension_t x = any_extension();
    if (iqfoc_flux_map_check(&map) == IQFOC_OK && iqfoc_extension_check(&x) == IQFOC_OK) {
        (void)iqfoc_flux_map_step(&map, &x, any_ab(IQ24(8.0)), any_ab(IQ24(2.0)), any_sincos(), any_sincos());
    }
}

/* Deadbeat control, with and without disturbance observer: any model, any speed; |i| <= 15, |u| <= 1, |i_ref| <= 20. */
void prove_deadbeat(void)
{
    const iqfoc_exact_t model = any_model();
    const iqfoc_deadbeat_t deadbeat = {model, iqfoc_deadbeat_inverse(model.k_u_q26), any_valley_reference()};
    const iq24_t speed = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    (void)iqfoc_deadbeat_step(&deadbeat, any_ab(IQ24(15.0)), any_ab(IQ24_ONE), any_dq(IQ24(20.0)), any(),
                              speed);
    iqfoc_deadbeat_drift_t learnt = {any_dq(IQFOC_DEADBEAT_DRIFT_LIMIT), any_ab(IQ24_MAX), any_bool()};
    (void)iqfoc_deadbeat_drift_step(&learnt, &deadbeat, any_within(0, IQ24_ONE), any_ab(IQ24(15.0)),
                                    any_ab(IQ24_ONE), any_dq(IQ24(20.0)), any(), speed);
}

/* Finite set: any model, any speed, any horizon, weight 0 ... 1; |i| <= 15, |i_ref| <= 20, u_dc 0 ... 2. */
void prove_finite_set(void)
{
    const iqfoc_finite_set_t set = {any_model(), any_valley_reference(), any_within(0, IQ24_ONE), any()};
    uint32_t nodes = 0;
    (void)iqfoc_finite_set_choose(&set, any_ab(IQ24(15.0)), any_within(0, 7), any_dq(IQ24(20.0)), any(),
                                  any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX),
                                  any_within(0, IQ24(2.0)), &nodes);
}
