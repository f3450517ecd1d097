/*
 * The job of bench/peers/peer.h by CMSIS-DSP's functions for Q31. The library has no modulator: the last lines are this project's. A quarter
 * of the per-unit value is in Q31, so currents may be up to 4.
 */
#include "arm_math_types.h"
#include "dsp/controller_functions.h"

#include "peer.h"

#define Q31(x) ((q31_t)((x)*2147483648.0))

static struct {
    arm_pid_instance_q31 pid_d;
    arm_pid_instance_q31 pid_q;
    q31_t ref_d;
    q31_t ref_q;
    q31_t u_dc_inverse; /* Q30 */
    q31_t i_a;
    q31_t i_b;
    q31_t theta; /* half turns */
    q31_t duty[3];
} job;

static void start_pid(arm_pid_instance_q31 *pid)
{
    /* The library's integral has the present error. */
    pid->Kp = Q31(PEER_KP - PEER_KI);
    pid->Ki = Q31(PEER_KI);
    pid->Kd = 0;
    arm_pid_init_q31(pid, 1);
}

void peer_start(void)
{
    start_pid(&job.pid_d);
    start_pid(&job.pid_q);
    job.ref_d = Q31(PEER_I_REF_D / 4.0);
    job.ref_q = Q31(PEER_I_REF_Q / 4.0);
    job.u_dc_inverse = Q31(0.5 / PEER_U_DC);
}

void peer_input(int32_t i_a, int32_t i_b, int32_t theta)
{
    job.i_a = i_a * 32;
    job.i_b = i_b * 32;
    job.theta = (q31_t)((uint32_t)theta << 8);
}

static inline q31_t least(q31_t a, q31_t b)
{
    return a < b ? a : b;
}

static inline q31_t greatest(q31_t a, q31_t b)
{
    return a > b ? a : b;
}

static inline q31_t over_u_dc(q31_t u)
{
    return (q31_t)((q63_t)u * job.u_dc_inverse >> 30);
}

void peer_job(void)
{
    q31_t sine;
    q31_t cosine;
    q31_t alpha;
    q31_t beta;
    q31_t d;
    q31_t q;
    q31_t a;
    q31_t b;
    arm_sin_cos_q31(job.theta, &sine, &cosine);
    arm_clarke_q31(job.i_a, job.i_b, &alpha, &beta);
    arm_park_q31(alpha, beta, &d, &q, sine, cosine);
    d = arm_pid_q31(&job.pid_d, job.ref_d - d);
    q = arm_pid_q31(&job.pid_q, job.ref_q - q);
    arm_inv_park_q31(d, q, &alpha, &beta, sine, cosine);
    arm_inv_clarke_q31(over_u_dc(alpha), over_u_dc(beta), &a, &b);
    const q31_t c = -a - b;
    const q31_t shift = Q31(0.125) - (greatest(greatest(a, b), c) + least(least(a, b), c)) / 2;
    job.duty[0] = a + shift;
    job.duty[1] = b + shift;
    job.duty[2] = c + shift;
}

void peer_duties(double duty[3])
{
    for (int k = 0; k < 3; k++) {
        duty[k] = job.duty[k] * 4.0 / 2147483648.0;
    }
}
