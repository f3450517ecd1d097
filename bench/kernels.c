/*
 * Compositions and straight lines for the benchmark (bench/kernels.h).
 */
#include "kernels.h"

#include "iqfoc/mean_current.h"
#include "iqfoc/transform.h"

#include "inputs.h"

BENCH_APART void bench_current_control(bench_drive_t *drive, iq24_t i_a, iq24_t i_b, iq24_t theta,
                                       iq24_t scale)
{
    const iq24_sincos_t sc = iq24_sincos_inline(theta);
    const iqfoc_dq_t i = iqfoc_park(iqfoc_clarke2(i_a, i_b), sc);
    const iqfoc_dq_t u = iqfoc_current_control_step(&drive->control, &drive->config->gains, drive->i_ref, i);
    iqfoc_current_control_limited(&drive->control, &drive->config->gains, u, scale);
    drive->u_next = iqfoc_park_inverse(u, sc);
}

BENCH_APART void bench_cycle(bench_drive_t *drive, iq24_t i_a, iq24_t i_b, iq24_t theta_mid,
                             iqfoc_duties_t *duties)
{
    const iqfoc_predictor_t *predictor = &drive->config->predictor;
    const iqfoc_rotor_t *rotor = &drive->rotor;
    const iqfoc_ab_t i = iqfoc_clarke2(i_a, i_b);
    const iq24_sincos_t sc = iq24_sincos_inline(theta_mid);
    const iq24_t w = iqfoc_predictor_emf(predictor, rotor);
    const iqfoc_ab_t i_next = iqfoc_predictor_step(predictor, i, drive->u_now, w, sc);
    const iqfoc_dq_t i_dq = iqfoc_mean_current_seen(i, i_next, w, rotor, sc);
    const iqfoc_dq_t u =
        iqfoc_current_control_step(&drive->control, &drive->config->gains, drive->i_ref, i_dq);
    drive->i_next = i_next;
    drive->u_now = iqfoc_park_inverse(u, sc);
    *duties = iqfoc_modulate(drive->u_now, drive->u_dc_inverse, drive->config->span_max);
    iqfoc_current_control_limited(&drive->control, &drive->config->gains, u, duties->scale);
}

/* BENCH_LINE times, by hand: a loop would be counted too. */
#define EIGHT_TIMES(call) call, call, call, call, call, call, call, call

static inline void park_once(const volatile iq24_t *from, volatile iq24_t *to)
{
    const iqfoc_ab_t ab = {from[0], from[1]};
    const iq24_sincos_t sc = {from[2], from[3]};
    const iqfoc_dq_t dq = iqfoc_park(ab, sc);
    to[0] = dq.d;
    to[1] = dq.q;
}

static inline void park_inverse_once(const volatile iq24_t *from, volatile iq24_t *to)
{
    const iqfoc_dq_t dq = {from[0], from[1]};
    const iq24_sincos_t sc = {from[2], from[3]};
    const iqfoc_ab_t ab = iqfoc_park_inverse(dq, sc);
    to[0] = ab.alpha;
    to[1] = ab.beta;
}

static inline void clarke_once(const volatile iq24_t *from, volatile iq24_t *to)
{
    const iq24_t a = from[0];
    const iq24_t b = from[1];
    const iqfoc_ab_t ab = iqfoc_clarke2(a, b);
    to[0] = ab.alpha;
    to[1] = ab.beta;
}

static inline void four_to_two_once(const volatile iq24_t *from, volatile iq24_t *to)
{
    const iq24_t x = from[0];
    const iq24_t y = from[1];
    (void)from[2];
    (void)from[3];
    to[0] = x;
    to[1] = y;
}

static inline void two_to_two_once(const volatile iq24_t *from, volatile iq24_t *to)
{
    const iq24_t x = from[0];
    const iq24_t y = from[1];
    to[0] = x;
    to[1] = y;
}

BENCH_APART void bench_park_line(const volatile iq24_t *from, volatile iq24_t *to)
{
    EIGHT_TIMES(park_once(from, to));
}

BENCH_APART void bench_park_inverse_line(const volatile iq24_t *from, volatile iq24_t *to)
{
    EIGHT_TIMES(park_inverse_once(from, to));
}

BENCH_APART void bench_clarke_line(const volatile iq24_t *from, volatile iq24_t *to)
{
    EIGHT_TIMES(clarke_once(from, to));
}

BENCH_APART void bench_four_to_two_line(const volatile iq24_t *from, volatile iq24_t *to)
{
    EIGHT_TIMES(four_to_two_once(from, to));
}

BENCH_APART void bench_two_to_two_line(const volatile iq24_t *from, volatile iq24_t *to)
{
    EIGHT_TIMES(two_to_two_once(from, to));
}

/* A label and a return: the compiler can neither inline it nor know which registers it leaves alone. */
__asm(".text\n.globl bench_nothing\n.type bench_nothing, %function\n"
#ifdef __arm__
      ".thumb_func\nbench_nothing: bx lr\n"
#else
      "bench_nothing: ret\n"
#endif
);
