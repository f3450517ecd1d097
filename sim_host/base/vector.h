/*
 * The host's vectors in double: two components with their frame in the type, so that a rotor-frame vector
 * cannot be added to a stationary one by mistake. Amplitude-invariant Clarke; theta_e is the angle of the d
 * axis from phase A. Arithmetic only, used by plant and model; it contains no model of a drive.
 */
#ifndef SIM_HOST_BASE_VECTOR_H
#define SIM_HOST_BASE_VECTOR_H

#include <math.h>

typedef struct vec_ab {
    double alpha, beta;
} vec_ab;

typedef struct vec_dq {
    double d, q;
} vec_dq;

/* e^{j theta} as a pair, computed once and used for every rotation by that angle. */
typedef struct vec_rotor {
    double cos, sin;
} vec_rotor;

#define VEC_HALF_SQRT3 0.86602540378443864676
#define VEC_1_SQRT3    0.57735026918962576451
#define VEC_THIRD      0.33333333333333333333
#define VEC_PI         3.14159265358979323846
#define VEC_TWO_PI     6.28318530717958647693

/* The phases' axes in the stationary frame: phase x of a vector v is axis[x] . v. */
static const vec_ab vec_phase_axis[3] = {{1.0, 0.0}, {-0.5, VEC_HALF_SQRT3}, {-0.5, -VEC_HALF_SQRT3}};

static inline vec_rotor rotor_at(double theta_e_rad)
{
    vec_rotor r = {cos(theta_e_rad), sin(theta_e_rad)};
    return r;
}

/* The first turned by the second. */
static inline vec_rotor rotor_turned(vec_rotor r, vec_rotor by)
{
    return (vec_rotor){r.cos * by.cos - r.sin * by.sin, r.cos * by.sin + r.sin * by.cos};
}

static inline vec_dq vec_to_dq(vec_ab v, vec_rotor r)
{
    vec_dq w = {r.cos * v.alpha + r.sin * v.beta, r.cos * v.beta - r.sin * v.alpha};
    return w;
}

static inline vec_ab vec_to_ab(vec_dq v, vec_rotor r)
{
    vec_ab w = {r.cos * v.d - r.sin * v.q, r.cos * v.q + r.sin * v.d};
    return w;
}

static inline double vec_phase(vec_ab v, int x)
{
    return vec_phase_axis[x].alpha * v.alpha + vec_phase_axis[x].beta * v.beta;
}

/* The three phases of a vector. */
static inline void vec_to_phases(vec_ab v, double abc[3])
{
    for (int x = 0; x < 3; x++) {
        abc[x] = vec_phase(v, x);
    }
}

/* Clarke, amplitude invariant; what the three have in common drops out. */
static inline vec_ab vec_from_phases(const double abc[3])
{
    vec_ab v = {(2.0 * abc[0] - abc[1] - abc[2]) * VEC_THIRD, (abc[1] - abc[2]) * VEC_1_SQRT3};
    return v;
}

/* Each phase of a vector times a factor of its own. */
static inline vec_ab vec_times_phases(vec_ab v, const double by[3])
{
    const double across = 0.5 * VEC_1_SQRT3 * (by[2] - by[1]);
    vec_ab w = {(4.0 * by[0] + by[1] + by[2]) / 6.0 * v.alpha + across * v.beta,
                across * v.alpha + 0.5 * (by[1] + by[2]) * v.beta};
    return w;
}

#endif
