/*
 * The job of bench/peers/peer.h by CMSIS-DSP's functions for float. The library has no modulator: the last lines are this project's.
 */
#include "arm_math_types.h"
#include "dsp/controller_functions.h"

#include "peer.h"

static struct {
    arm_pid_instance_f32 pid_d;
    arm_pid_instance_f32 pid_q;
    float32_t ref_d;
    float32_t ref_q;
    float32_t u_dc_inverse;
    float32_t i_a;
    float32_t i_b;
    float32_t theta; /* degrees */
    float32_t duty[3];
} job;

static void start_pid(arm_pid_instance_f32 *pid)
{
    /* The library's integral has the present error. */
    pid->Kp = (float32_t)(PEER_KP - PEER_KI);
    pid->Ki = (float32_t)PEER_KI;
    pid->Kd = 0.0f;
    arm_pid_init_f32(pid, 1);
}

void peer_start(void)
{
    start_pid(&job.pid_d);
    start_pid(&job.pid_q);
    job.ref_d = (float32_t)PEER_I_REF_D;
    job.ref_q = (float32_t)PEER_I_REF_Q;
    job.u_dc_inverse = (float32_t)(1.0 / PEER_U_DC);
}

void peer_input(int32_t i_a, int32_t i_b, int32_t theta)
{
    job.i_a = (float32_t)i_a / 16777216.0f;
    job.i_b = (float32_t)i_b / 16777216.0f;
    job.theta = (float32_t)theta * (360.0f / 16777216.0f);
}

static inline float32_t least(float32_t a, float32_t b)
{
    return a < b ? a : b;
}

static inline float32_t greatest(float32_t a, float32_t b)
{
    return a > b ? a : b;
}

void peer_job(void)
{
    float32_t sine;
    float32_t cosine;
    float32_t alpha;
    float32_t beta;
    float32_t d;
    float32_t q;
    float32_t a;
    float32_t b;
    arm_sin_cos_f32(job.theta, &sine, &cosine);
    arm_clarke_f32(job.i_a, job.i_b, &alpha, &beta);
    arm_park_f32(alpha, beta, &d, &q, sine, cosine);
    d = arm_pid_f32(&job.pid_d, job.ref_d - d);
    q = arm_pid_f32(&job.pid_q, job.ref_q - q);
    arm_inv_park_f32(d, q, &alpha, &beta, sine, cosine);
    arm_inv_clarke_f32(alpha * job.u_dc_inverse, beta * job.u_dc_inverse, &a, &b);
    const float32_t c = -a - b;
    const float32_t shift = 0.5f - 0.5f * (greatest(greatest(a, b), c) + least(least(a, b), c));
    job.duty[0] = a + shift;
    job.duty[1] = b + shift;
    job.duty[2] = c + shift;
}

void peer_duties(double duty[3])
{
    for (int k = 0; k < 3; k++) {
        duty[k] = (double)job.duty[k];
    }
}
