/*
 * Speed control: a PI controller with a ramp for the set-point, feed-forward of the ramp's torque, and a current limit. It is optional:
 * the caller writes its result into the cycle's i_ref, or gives it to iqfoc_reference_step as torque.
 *
 * Every `cycles` cycles one step:
 *
 *     set_point += target - set_point,   held to +-ramp a step
 *     e    = set_point - speed
 *     f    = +-i_ramp while the set-point moves by +-ramp, else 0;   held to +-limit
 *     i_q  = kp e + I + f,   held to +-limit
 *     I   += share (i_q - I - f)
 *
 * Where no limit acts, the last line is I += share kp e, a PI controller with ki = share kp. Where one acts, I approaches what the limit
 * leaves, so that it cannot wind up. The set-point is then moved to the one that asks for just the limit, speed + (i_q - I -
 * f)/kp, from where the ramp goes on. So a drive whose torque does not suffice runs up as fast as it can, and arrives without
 * an overshoot of the integrator.
 *
 * A shaft accelerates by a = (3/2) pairs^2 psi_f I_b T^2/(2 pi J) turns per cycle^2 for 1 per unit of i_q. With
 *
 *     p = 1/(1 + w N T),   kp = 2 (1 - p)/(a N),   share = (1 - p)/2          N = cycles
 *
 * both poles of the loop are at p. A step of the load by di per unit of i_q then changes the speed by a di/(e w T) turns per cycle at most
 * (e = 2.718), 1/w after the step, and with this rate by a share of 1.5 w N T more. For that the current control and the filter of the
 * speed must be faster: w at most a tenth of the bandwidth of the current control, a tenth of a tracker's, and 1/(10 N T).
 *
 * All functions change only `control`: call them in one context, that of the cycle's valley.
 */
#ifndef IQFOC_SPEED_CONTROL_H
#define IQFOC_SPEED_CONTROL_H

#include "error.h"
#include "params.h"
#include "rotor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fixed while it runs. Currents per unit, IQ24. */
typedef struct iqfoc_speed_control_config {
    int32_t kp_q16;   /* current per speed in turns per cycle, Q15.16: above 0 */
    iq24_t share;     /* ki/kp: share of the integral per step, 0 ... 1; 0: no integral */
    int32_t ramp_q32; /* change of the set-point per step, turns per cycle in Q32: 1 ... 2^30 */
    iq24_t i_ramp;    /* the current that accelerates the shaft by the ramp: 0 ... i_max */
    iq24_t i_max;     /* the largest current: 0 < i_max <= 4 */
    uint32_t cycles;  /* cycles per step, at least 1 */
} iqfoc_speed_control_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_speed_control {
    const iqfoc_speed_control_config_t *config;
    iq24_acc_t integral;   /* I: current per unit with 48 fractional bits, within +-9 */
    int32_t set_point_q32; /* turns per cycle in Q32, within +-1/3 */
    iq24_t i_q;            /* the result of the last step */
    uint32_t wait;         /* cycles until the next step */
} iqfoc_speed_control_t;

/*
 * Ready for standstill: set-point, integral and i_q are 0. config must outlive the object. Errors: IQFOC_ERROR_NULL;
 * IQFOC_ERROR_SPEED_CONTROL, a value of config is out of its range. Call it before the first interrupt.
 */
iqfoc_error_t iqfoc_speed_control_init(iqfoc_speed_control_t *control,
                                       const iqfoc_speed_control_config_t *config);

/*
 * Takes a drive over that turns and carries a current: the set-point begins at `speed` and the integral at i_q. speed: electrical speed in
 * turns per cycle, held to +-1/3. i_q: per unit, held to +-i_max. The next call of iqfoc_speed_control_step makes a step.
 */
void iqfoc_speed_control_start(iqfoc_speed_control_t *control, iq24_t speed, iq24_t i_q);

/*
 * Once a cycle. Out: i_q, per unit, of the last step; it changes every config->cycles calls.
 *
 * target and turns: wanted and measured electrical speed, turns per cycle, held to +-1/3. limit: the largest |i_q| now, held to 0 ...
 * i_max: i_max itself, or what iqfoc_reference_step or a thermal model leaves of it. An error beyond half a turn per cycle counts as half.
 *
 * Largest error of 400000 drawn, against the lines above in double with the same state: i_q 0.51 LSB, I 0.51 LSB, and of the set-point in a
 * limit 0.51 LSB over kp and half a unit of Q32; else the set-point is exact.
 *
 * Range: |e| is below 2^31 in Q32 and kp below 2^31 in Q16: |kp e| is below 2^62 with 48 fractional bits, and I and i_ramp below 2^52. |I| stays
 * within 8 per unit: it is a mean of itself and of i_q - i_ramp, with weights from 0 to 1.
 */
iq24_t iqfoc_speed_control_step(iqfoc_speed_control_t *control, iq24_t target, iq24_t speed, iq24_t limit);

/* ---- The formulas in double, with limits, and an initialiser (params.h has the bases). ---- */
/* a: turns per cycle^2 for 1 per unit of i_q. */
#define IQFOC_RAW_SPEED_ACCELERATION(J_kgm2, pole_pairs, psi_Wb, I_b_A, T_s)                                 \
    (1.5 * (pole_pairs) * (pole_pairs) * (psi_Wb) * (I_b_A) * (T_s) * (T_s) / (IQFOC_TWO_PI_ * (J_kgm2)))
#define IQFOC_RAW_SPEED_POLE(w_rad_s, T_s, cycles) (1.0 / (1.0 + (w_rad_s) * (T_s) * (cycles)))
#define IQFOC_RAW_SPEED_KP(w_rad_s, a, T_s, cycles)                                                          \
    (2.0 * (1.0 - IQFOC_RAW_SPEED_POLE(w_rad_s, T_s, cycles)) / ((a) * (cycles)))
#define IQFOC_RAW_SPEED_SHARE(w_rad_s, T_s, cycles) (0.5 * (1.0 - IQFOC_RAW_SPEED_POLE(w_rad_s, T_s, cycles)))
#define IQFOC_RAW_SPEED_RAMP(rpm_per_s, pole_pairs, T_s, cycles)                                             \
    ((rpm_per_s) / 60.0 * (pole_pairs) * (T_s) * (T_s) * (cycles))
#define IQFOC_MIN_SPEED_KP   1e-3
#define IQFOC_MAX_SPEED_KP   32767.0
#define IQFOC_MIN_SPEED_RAMP 1e-8
#define IQFOC_MAX_SPEED_RAMP 0.25

#define IQFOC_SPEED_Q_(x, bits, low, high)                                                                   \
    (IQ24_CAST_(int32_t, IQ24_RAISED_(x, bits) + 0.5) / IQFOC_WITHIN_(x, low, high))
#define IQFOC_SPEED_KP_IS_0_001_TO_32767_ELSE_ANOTHER_BANDWIDTH_OR_N(x)                                      \
    IQFOC_SPEED_Q_(x, 16, IQFOC_MIN_SPEED_KP, IQFOC_MAX_SPEED_KP)
#define IQFOC_SPEED_RAMP_IS_1E_8_TO_0_25_PER_STEP_ELSE_ANOTHER_N(x)                                          \
    IQFOC_SPEED_Q_(x, 32, IQFOC_MIN_SPEED_RAMP, IQFOC_MAX_SPEED_RAMP)
#define IQFOC_I_RAMP_IS_0_TO_4_ELSE_A_SLOWER_RAMP(x)  IQFOC_CHECKED(x, 0.0, 4.0)
#define IQFOC_I_MAX_IS_0_TO_4_ELSE_A_LARGER_I_BASE(x) IQFOC_CHECKED(x, 1e-6, 4.0)

/*
 * iqfoc_speed_control_config_t of a bandwidth w in rad/s, a shaft's inertia with its load, a ramp in rpm per second and a largest current in A
 * (peak), a step every `cycles` cycles. i_ramp is what this ramp needs without friction.
 */
#define IQFOC_SPEED_CONTROL(w_rad_s, J_kgm2, pole_pairs, psi_Wb, T_s, I_b_A, rpm_per_s, i_max_A, cycles)     \
    {                                                                                                        \
        IQFOC_SPEED_KP_IS_0_001_TO_32767_ELSE_ANOTHER_BANDWIDTH_OR_N(IQFOC_RAW_SPEED_KP(                     \
            w_rad_s, IQFOC_RAW_SPEED_ACCELERATION(J_kgm2, pole_pairs, psi_Wb, I_b_A, T_s), T_s, cycles)),    \
            IQ24(IQFOC_RAW_SPEED_SHARE(w_rad_s, T_s, cycles)),                                               \
            IQFOC_SPEED_RAMP_IS_1E_8_TO_0_25_PER_STEP_ELSE_ANOTHER_N(                                        \
                IQFOC_RAW_SPEED_RAMP(rpm_per_s, pole_pairs, T_s, cycles)),                                   \
            IQFOC_I_RAMP_IS_0_TO_4_ELSE_A_SLOWER_RAMP(                                                       \
                IQFOC_RAW_SPEED_RAMP(rpm_per_s, pole_pairs, T_s, 1.0) /                                      \
                IQFOC_RAW_SPEED_ACCELERATION(J_kgm2, pole_pairs, psi_Wb, I_b_A, T_s)),                       \
            IQFOC_I_MAX_IS_0_TO_4_ELSE_A_LARGER_I_BASE((i_max_A) / (I_b_A)), (cycles)                        \
    }

#ifdef __cplusplus
}
#endif

#endif
