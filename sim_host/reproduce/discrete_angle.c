/* The three processing paths of 2016, Section 5 (discrete_angle.h). */
#include "discrete_angle.h"

#include "per_unit.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/mean_current.h"
#include "iqfoc/rotor.h"
#include "iqfoc/transform.h"

#include <math.h>

discrete_angle discrete_angle_of(const six_step_interval *at)
{
    const discrete_angle d = {
        .change = papers_change_of(at->i_start * vec_turn(-at->theta_rad),
                                   at->i_end * vec_turn(-at->theta_rad - at->Theta_rad)),
        .path_a = papers_error_of(
            papers_mean_normalised(papers_movement_of(at->i_start, at->i_end, at->Theta_rad))),
        .path_bc = papers_error_of(
            at->i_mean_dq / papers_mean_discrete_angle_dq(at->i_mean, at->theta_rad + 0.5 * at->Theta_rad))};
    return d;
}

static double modulus_iq24(iqfoc_dq_t v)
{
    return iq24_to_double(iq24_sqrt(iq24_acc_round(iq24_acc_mac(iq24_acc_mul(v.d, v.d), v.q, v.q))));
}

static double angle_iq24(iqfoc_dq_t from, iqfoc_dq_t to)
{
    /* Differences of angles wrap by themselves: a turn is 2^24. */
    const int32_t turns_q24 = (iq24_atan2(to.q, to.d) - iq24_atan2(from.q, from.d)) & 0xFFFFFF;
    return VEC_TWO_PI * iq24_to_double(turns_q24 < 0x800000 ? turns_q24 : turns_q24 - 0x1000000);
}

discrete_angle discrete_angle_of_iq24(const six_step_interval *at)
{
    const double theta_m_rad = at->theta_rad + 0.5 * at->Theta_rad;
    const iqfoc_ab_t start = ab_from_complex(at->i_start, 1.0);
    const iqfoc_ab_t end = ab_from_complex(at->i_end, 1.0);
    const iqfoc_ab_t mean = {iq24_asr32(iq24_add_wrap(start.alpha, end.alpha), 1),
                             iq24_asr32(iq24_add_wrap(start.beta, end.beta), 1)};
    const iqfoc_ab_t delta = {iq24_sub_wrap(end.alpha, start.alpha), iq24_sub_wrap(end.beta, start.beta)};
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(turns_from_rad(at->Theta_rad));
    const iq24_sincos_t sc_mid = iq24_sincos(turns_from_rad(theta_m_rad));

    const iqfoc_dq_t corrected = iqfoc_mean_current_correct(mean, delta, &rotor, sc_mid);
    const iqfoc_dq_t uncorrected = iqfoc_park(mean, sc_mid);
    const iqfoc_dq_t discrete = iqfoc_park(ab_from_complex(at->i_mean, 1.0), sc_mid);
    const iqfoc_dq_t start_dq = iqfoc_park(start, iq24_sincos(turns_from_rad(at->theta_rad)));
    const iqfoc_dq_t end_dq = iqfoc_park(end, iq24_sincos(turns_from_rad(at->theta_rad + at->Theta_rad)));
    const discrete_angle d = {
        .change = {modulus_iq24(end_dq) - modulus_iq24(start_dq), angle_iq24(start_dq, end_dq)},
        .path_a = papers_error_of(complex_from_dq(corrected, 1.0) / complex_from_dq(uncorrected, 1.0)),
        .path_bc = papers_error_of(at->i_mean_dq / complex_from_dq(discrete, 1.0))};
    return d;
}

static void keep_peak(double *peak, double value)
{
    *peak = fmax(*peak, fabs(value));
}

discrete_angle_summary discrete_angle_summarise(const six_step_run *run, discrete_angle_function *of)
{
    const discrete_angle steady = of(&run->interval[0]);
    discrete_angle_summary s = {.steady_gain_a = steady.path_a.gain,
                                .steady_gain_bc = steady.path_bc.gain,
                                .steady_gain_difference = fabs(steady.path_a.gain - steady.path_bc.gain),
                                .steady_phase_difference_rad =
                                    fabs(steady.path_a.phase_rad - steady.path_bc.phase_rad)};
    for (size_t n = run->step_index; n < run->count; n++) {
        const discrete_angle d = of(&run->interval[n]);
        keep_peak(&s.peak_modulus_change, d.change.modulus);
        keep_peak(&s.peak_angle_change_rad, d.change.angle_rad);
        keep_peak(&s.peak_gain, d.path_a.gain);
        keep_peak(&s.peak_phase_rad, d.path_a.phase_rad);
        keep_peak(&s.peak_gain_difference, d.path_a.gain - d.path_bc.gain);
        keep_peak(&s.peak_phase_difference_rad, d.path_a.phase_rad - d.path_bc.phase_rad);
    }
    return s;
}
