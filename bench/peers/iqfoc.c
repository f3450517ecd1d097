/*
 * The job of bench/peers/peer.h by iqfoc, with the limits of voltage and integrators.
 */
#include "iqfoc/current_control.h"
#include "iqfoc/modulation.h"
#include "iqfoc/transform.h"

#include "peer.h"

static struct {
    iqfoc_current_control_gains_t gains;
    iqfoc_current_control_t control;
    iqfoc_dq_t i_ref;
    iq24_t u_dc_inverse;
    iq24_t span_max;
    iq24_t i_a;
    iq24_t i_b;
    iq24_t theta;
    iqfoc_abc_t duty;
} job;

void peer_start(void)
{
    job.gains.kp_d = job.gains.kp_q = IQ24(PEER_KP);
    job.gains.ki_d = job.gains.ki_q = IQ24(PEER_KI);
    job.gains.anti_windup = IQ24_ONE;
    job.i_ref.d = IQ24(PEER_I_REF_D);
    job.i_ref.q = IQ24(PEER_I_REF_Q);
    job.u_dc_inverse = IQ24(1.0 / PEER_U_DC);
    job.span_max = IQ24_ONE;
}

void peer_input(int32_t i_a, int32_t i_b, int32_t theta)
{
    job.i_a = i_a;
    job.i_b = i_b;
    job.theta = theta;
}

void peer_job(void)
{
    const iq24_sincos_t sc = iq24_sincos_inline(job.theta);
    const iqfoc_dq_t i = iqfoc_park(iqfoc_clarke2(job.i_a, job.i_b), sc);
    const iqfoc_dq_t u = iqfoc_current_control_step(&job.control, &job.gains, job.i_ref, i);
    const iqfoc_duties_t duties = iqfoc_modulate(iqfoc_park_inverse(u, sc), job.u_dc_inverse, job.span_max);
    iqfoc_current_control_limited(&job.control, &job.gains, u, duties.scale);
    job.duty = duties.high;
}

void peer_duties(double duty[3])
{
    duty[0] = job.duty.a / 16777216.0;
    duty[1] = job.duty.b / 16777216.0;
    duty[2] = job.duty.c / 16777216.0;
}
