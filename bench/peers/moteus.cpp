/*
 * The job of bench/peers/peer.h by the classes of moteus (fw/foc.h, fw/simple_pi.h), with the CORDIC of an STM32G4. Modulation, the limit
 * of each duty and, with PEER_LIMITS, those of voltage and integrators are this project's, of the kind that moteus' control has: there they
 * are parts of a class that needs the whole firmware.
 */
#include <cmath>
#include <type_traits>

#include "fw/foc.h"
#include "fw/simple_pi.h"

#include "peer.h"

namespace
{

/* The third argument of Apply: the rate in hertz in some versions, the period in seconds in others. */
template <typename Time> Time time_of(float (moteus::SimplePI::*)(float, float, Time));
using Time = decltype(time_of(&moteus::SimplePI::Apply));
constexpr int kRate = 8192;

struct Job {
    moteus::SimplePI::Config config;
    Time time;
    moteus::SimplePI::State state_d;
    moteus::SimplePI::State state_q;
    float ref_d;
    float ref_q;
    float u_dc;
    float u_max;
    float i_a;
    float i_b;
    int32_t theta; /* half turns in Q31 */
    float duty[3];
};

Job job;
const moteus::Cordic cordic;

inline float least(float a, float b)
{
    return a < b ? a : b;
}

inline float greatest(float a, float b)
{
    return a > b ? a : b;
}

inline float within(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

inline uint32_t in_q31(double x)
{
    return static_cast<uint32_t>(
        static_cast<int32_t>(std::fmin(std::floor(x * 2147483648.0 + 0.5), 2147483647.0)));
}

} // namespace

void peer_start(void)
{
    /* Their integral has the present error. */
    job.config.kp = static_cast<float>(PEER_KP - PEER_KI);
    job.config.ki = static_cast<float>(PEER_KI * kRate);
    job.time = std::is_integral<Time>::value ? static_cast<Time>(kRate) : static_cast<Time>(1.0 / kRate);
    job.state_d.Clear();
    job.state_q.Clear();
    job.ref_d = static_cast<float>(PEER_I_REF_D);
    job.ref_q = static_cast<float>(PEER_I_REF_Q);
    job.u_dc = static_cast<float>(PEER_U_DC);
    job.u_max = static_cast<float>(PEER_U_DC / 1.7320508);
}

void peer_input(int32_t i_a, int32_t i_b, int32_t theta)
{
    job.i_a = static_cast<float>(i_a) / 16777216.0f;
    job.i_b = static_cast<float>(i_b) / 16777216.0f;
    job.theta = static_cast<int32_t>(static_cast<uint32_t>(theta) << 8);
    const double angle = theta * (6.283185307179586 / 16777216.0);
    CORDIC->rdata[0] = in_q31(std::cos(angle));
    CORDIC->rdata[1] = in_q31(std::sin(angle));
}

void peer_job(void)
{
    const moteus::SinCos sc = cordic(job.theta);
    const moteus::DqTransform i(sc, job.i_a, job.i_b, -job.i_a - job.i_b);
    float d = moteus::SimplePI(&job.config, &job.state_d).Apply(i.d, job.ref_d, job.time);
    float q = moteus::SimplePI(&job.config, &job.state_q).Apply(i.q, job.ref_q, job.time);
#if PEER_LIMITS
    const float most = job.u_max * job.u_max;
    if (d * d + q * q >= most) {
        d = within(d, -job.u_max, job.u_max);
        const float rest = std::sqrt(most - d * d);
        q = within(q, -rest, rest);
    }
    job.state_d.integral = within(job.state_d.integral, -job.u_max, job.u_max);
    job.state_q.integral = within(job.state_q.integral, -job.u_max, job.u_max);
#endif
    const moteus::InverseDqTransform u(sc, d, q);
    const float a = u.a / job.u_dc;
    const float b = u.b / job.u_dc;
    const float c = u.c / job.u_dc;
    const float shift = 0.5f - 0.5f * (greatest(a, greatest(b, c)) + least(a, least(b, c)));
    job.duty[0] = within(a + shift, 0.0f, 1.0f);
    job.duty[1] = within(b + shift, 0.0f, 1.0f);
    job.duty[2] = within(c + shift, 0.0f, 1.0f);
}

void peer_duties(double duty[3])
{
    for (int k = 0; k < 3; k++) {
        duty[k] = static_cast<double>(job.duty[k]);
    }
}
