/* Observer of angle and speed without a sensor (include/iqfoc/observer.h). */
#include "iqfoc/observer.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include <stddef.h>

#define TURNS_MAX_Q32 (IQFOC_ROTOR_SPEED_MAX * INT32_C(256))

/*
 * While the observer seeks. Two poles at 1/2: theta + speed + 3/4 e, which is arg a - 1/4 e; and a correction also where the
 * assumed speed is too low.
 */
#define SEEK_K1   IQ24(-0.25)
#define SEEK_K2   IQ24(0.25)
#define SEEK_GAIN IQ24(0.125)

/* Least length of the active flux that the angle is divided by; 2^32/(2 pi), rounded. */
#define RADIUS_MIN IQ24(0.015625)
#define RADIAN_Q32 UINT32_C(683565276)

iqfoc_error_t iqfoc_observer_check(const iqfoc_observer_config_t *c)
{
    if (c == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const iqfoc_flux_predictor_t *m = &c->machine;
    const iqfoc_error_t error = iqfoc_flux_predictor_check(m);
    if (error != IQFOC_OK) {
        return error;
    }
    const bool good =
        iq24_within(m->l_d - m->l_q, IQ24(-4.0), IQ24(4.0)) && m->psi >= RADIUS_MIN &&
        iq24_within(c->saturation, 0, IQ24(4.0)) && iq24_within(c->gain_max, SEEK_GAIN, IQ24_ONE) &&
        iq24_within(c->k1, 1, IQ24_ONE) && iq24_within(c->k2, 1, IQ24(0.25)) &&
        iq24_within(c->speed_min, 0, IQFOC_ROTOR_SPEED_MAX) && iq24_within(c->angle_max, 1, IQ24(0.5)) &&
        iq24_within(c->flux_max, 1, IQ24(8.0) - 1) && c->lock_cycles >= 1;
    return good ? IQFOC_OK : IQFOC_ERROR_OBSERVER;
}

iqfoc_error_t iqfoc_observer_init(iqfoc_observer_t *observer, const iqfoc_observer_config_t *config)
{
    if (observer == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const iqfoc_error_t error = iqfoc_observer_check(config);
    if (error == IQFOC_OK) {
        const iqfoc_ab_t none = {0, 0};
        observer->config = config;
        iqfoc_observer_start(observer, none, 0, 0, false);
    }
    return error;
}

/* L_d and L_q at a current. */
typedef struct inductances {
    iq24_t d;
    iq24_t q;
} inductances;

/* 1 + saturation |i|^2, held to 2. Range: |i|^2 <= 506 saturates at 128, times saturation likewise. */
static iq24_t divisor_of(iq24_t saturation, iq24_t alpha, iq24_t beta)
{
    const iq24_t square = iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(alpha, alpha), beta, beta));
    return IQ24_ONE + iq24_min(iq24_mul_sat(saturation, square), IQ24_ONE);
}

static inline inductances inductances_at(const iqfoc_observer_config_t *c, iqfoc_ab_t i)
{
    inductances l = {c->machine.l_d, c->machine.l_q};
    if (c->saturation != 0) {
        const iq24_t divisor = divisor_of(c->saturation, i.alpha, i.beta);
        l.d = iq24_div(l.d, divisor);
        l.q = iq24_div(l.q, divisor);
    }
    return l;
}

/* l_q i, held to +-32. Range: 8 * 15.9 < 128. */
static iqfoc_ab_t flux_of(iq24_t l_q, iqfoc_ab_t i)
{
    const iqfoc_ab_t flux = {IQ24_HOLD_BITS(iq24_mul_trunc(l_q, i.alpha), 30),
                             IQ24_HOLD_BITS(iq24_mul_trunc(l_q, i.beta), 30)};
    return flux;
}

/* The part of x along d. Range: |x| <= 64 a component, so the sum of both products is within 2^61. */
static iq24_t part_of(iqfoc_ab_t x, iq24_sincos_t d_q30)
{
    return iq24_shift_wrap(IQ24_MAC64(IQ24_MUL64(x.alpha, d_q30.cos), x.beta, d_q30.sin), 30);
}

/* Length of the active flux. Range: 16 + 4 * 4, held to 32. */
static iq24_t radius_of(iq24_t psi_f, iq24_t more, iqfoc_ab_t i, iq24_sincos_t d_q30)
{
    const iq24_t i_d = IQ24_HOLD_BITS(part_of(i, d_q30), 27);
    return IQ24_HOLD_BITS(iq24_add_wrap(psi_f, iq24_mul_trunc(more, i_d)), 30);
}

void iqfoc_observer_start(iqfoc_observer_t *o, iqfoc_ab_t i, iq24_t theta, iq24_t speed, bool known)
{
    const iqfoc_observer_config_t *c = o->config;
    const inductances l = inductances_at(c, i);
    const iq24_sincos_t d_q30 = iq24_sincos_q30_inline(theta);
    /* Unknown: a = 0, so that the next a is the chord. */
    const iq24_t radius = known ? radius_of(c->machine.psi, iq24_sub_wrap(l.d, l.q), i, d_q30) : 0;
    const iqfoc_ab_t of_current = flux_of(l.q, i);
    o->psi.alpha = IQ24_HOLD_BITS(iq24_add_wrap(of_current.alpha, iq24_mul_shift(radius, d_q30.cos, 30)), 30);
    o->psi.beta = IQ24_HOLD_BITS(iq24_add_wrap(of_current.beta, iq24_mul_shift(radius, d_q30.sin, 30)), 30);
    o->theta_q32 = iq24_wrap((int64_t)theta * 256);
    o->speed_q32 = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX) * 256;
    o->error = 0;
    o->flux_error = 0;
    o->count = 0;
    o->slow = 0;
    o->status = 0;
    o->locked = known;
    o->begins = !known;
}

/* The angle from the EMF of the first cycle, whose a began at 0. Range: within 1/2 + 1/4 + 1/6 turn. */
static void begin(iqfoc_observer_t *o, iqfoc_ab_t a, iq24_t i_alpha, iq24_t i_beta)
{
    const iqfoc_ab_t i = {i_alpha, i_beta};
    const iq24_t speed = iqfoc_observer_speed(o);
    const iq24_t across = speed < 0 ? IQ24(0.25) : IQ24(-0.25);
    iqfoc_observer_start(o, i, iq24_atan2(a.beta, a.alpha) + across + iq24_asr32(speed, 1), speed, true);
    o->locked = false;
}

static uint32_t one_more(uint32_t count)
{
    return count < UINT32_MAX ? count + 1 : count;
}

static void lose(iqfoc_observer_t *o, uint32_t reason)
{
    o->status |= reason;
    o->locked = false;
    o->count = 0;
}

/* |x| > most, in one comparison of 32 bits: x + most wraps where it is negative. Range: most >= 0 and |x| + most below 2^32. */
static inline bool beyond(iq24_t x, iq24_t most)
{
    const uint32_t above = (uint32_t)(((uint64_t)(uint32_t)x + (uint32_t)most) & UINT32_MAX);
    return above > 2U * (uint32_t)most;
}

/* x, held to +-most: short if it is within. Range: as beyond. */
static inline iq24_t within_most(iq24_t x, iq24_t most)
{
#ifdef __FRAMAC__
    return iq24_clamp(x, -most, most); /* a form that a proof over ranges can follow; no build has this */
#else
    if (beyond(x, most)) {
        return x < 0 ? -most : most;
    }
    return x;
#endif
}

static void judge(iqfoc_observer_t *o, const iqfoc_observer_config_t *c, bool slow)
{
    const bool angle_far = beyond(o->error, c->angle_max);
    const bool far = angle_far || beyond(o->flux_error, c->flux_max);
    if (o->locked && !far && !slow) {
        o->slow = 0;
        o->count = 0;
        return;
    }
    o->slow = slow ? one_more(o->slow) : 0;
    o->count = far == o->locked ? one_more(o->count) : 0;
    if (o->locked) {
        if (o->count > c->lost_cycles) {
            lose(o, angle_far ? IQFOC_OBSERVER_LOST_ANGLE : IQFOC_OBSERVER_LOST_FLUX);
        } else if (o->slow > c->slow_cycles) {
            lose(o, IQFOC_OBSERVER_LOST_SLOW);
        } else {
            /* locked as before */
        }
    } else if (slow) {
        o->count = 0;
    } else if (o->count >= c->lock_cycles) {
        o->locked = true;
        o->count = 0;
    } else {
        /* seeks on */
    }
}

/* What one step uses: e, the gain of the radial correction ahead of its limit, and the gains of the phase-locked loop. */
typedef struct loop_step {
    int32_t e_q32;
    int32_t gain_q28;
    iq24_t k1;
    iq24_t k2;
} loop_step;

/*
 * Range: across is held to 1.5 radius, radius is 1/64 ... 32: Q24 over 2^9 is 2^9 ... 2^20 and the quotient
 * below 2^20.4, so the product is below 2^52 and 2^-9 of it below 1.04e9.
 */
static inline loop_step locked_step(const iqfoc_observer_config_t *c, int32_t speed_q32, iq24_t across,
                                    iq24_t radius)
{
    const iq24_t divisor = iq24_max(radius, RADIUS_MIN);
    const iq24_t most = divisor + iq24_asr32(divisor, 1);
    const int64_t e_q41 =
        IQ24_MUL64(within_most(across, most), (int32_t)(RADIAN_Q32 / ((uint32_t)divisor >> 9)));
    const loop_step by = {iq24_shift_wrap(e_q41, 9), iq24_mul_high(speed_q32, IQFOC_OBSERVER_GAIN * 16),
                          c->k1, c->k2};
    return by;
}

static inline loop_step seeking_step(int32_t speed_q32, int32_t e_q32)
{
    const int32_t phi_q28 = iq24_mul_high(speed_q32, IQFOC_Q28_2_PI);
    const loop_step by = {e_q32, iq24_max(phi_q28, SEEK_GAIN * 16), SEEK_K1, SEEK_K2};
    return by;
}

void iqfoc_observer_step(iqfoc_observer_t *o, iqfoc_ab_t u, iqfoc_ab_t i_mean, iqfoc_ab_t i)
{
    const iqfoc_observer_config_t *c = o->config;
    const inductances l = inductances_at(c, i);
    /* Range: r <= 1 and |i_mean| <= 15.9, so both fit. Q29 times Q27 is Q24. */
    const int32_t r_q29 = c->machine.r * 32;
    const iqfoc_ab_t psi = {
        IQ24_HOLD_BITS(o->psi.alpha + u.alpha - iq24_mul_high(r_q29, i_mean.alpha * 8), 30),
        IQ24_HOLD_BITS(o->psi.beta + u.beta - iq24_mul_high(r_q29, i_mean.beta * 8), 30)};
    const iqfoc_ab_t of_current = flux_of(l.q, i);
    const iqfoc_ab_t a = {psi.alpha - of_current.alpha, psi.beta - of_current.beta};
    int32_t along_q32 = iq24_add_wrap(o->theta_q32, o->speed_q32); /* the angle of d */
    if (!o->locked) {
        if (o->begins) {
            begin(o, a, i.alpha, i.beta);
            return;
        }
        o->theta_q32 = along_q32;
        along_q32 = iq24_wrap((int64_t)iq24_atan2(a.beta, a.alpha) * 256);
    }
    const iq24_sincos_t d_q30 = iq24_sincos_q30_inline(iq24_asr32(along_q32, 8));
    const iq24_t radius = radius_of(c->machine.psi, iq24_sub_wrap(l.d, l.q), i, d_q30);
    const iq24_t along = part_of(a, d_q30);
    /* Range: as part_of. The sine changes its sign, as it is in a register. */
    const iq24_t across = iq24_shift_wrap(IQ24_MAC64(IQ24_MUL64(a.beta, d_q30.cos), a.alpha, -d_q30.sin), 30);
    const iq24_t off = IQ24_HOLD_BITS(iq24_sub_wrap(radius, along), 28);
    /* Q32 times Q28 is Q28, within 2.1. Q30 times Q28 is Q26, and that times Q30 is Q24. */
    const int32_t abs_q32 = o->speed_q32 < 0 ? -o->speed_q32 : o->speed_q32;
    const loop_step by = o->locked ? locked_step(c, abs_q32, across, radius)
                                   : seeking_step(abs_q32, iq24_sub_wrap(along_q32, o->theta_q32));
    const int32_t by_q26 = iq24_mul_high(iq24_min(c->gain_max * 16, by.gain_q28) * 4, off * 16);
    const iqfoc_ab_t corrected = {IQ24_HOLD_BITS(iq24_mac_high(psi.alpha, by_q26, d_q30.cos), 30),
                                  IQ24_HOLD_BITS(iq24_mac_high(psi.beta, by_q26, d_q30.sin), 30)};
    /* Range: |k1| <= 1, so a product is within 2^31; |k2| <= 1/4, so its product and the speed are within 2^29 + 1.44e9. */
    const int32_t theta_q32 = iq24_add_wrap(along_q32, iq24_mul_trunc(by.k1, by.e_q32));
    const int32_t speed_q32 = within_most(o->speed_q32 + iq24_mul_high(256 * by.k2, by.e_q32), TURNS_MAX_Q32);
    o->psi = corrected;
    o->theta_q32 = theta_q32;
    o->speed_q32 = speed_q32;
    o->error = iq24_asr32(by.e_q32, 8);
    o->flux_error = off;
    judge(o, c, abs_q32 < c->speed_min * 256);
}
