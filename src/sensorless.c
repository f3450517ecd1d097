/* The angle of a drive without a sensor (include/iqfoc/sensorless.h). */
#include "iqfoc/sensorless.h"

#include "iqfoc/cycle_guard.h"
#include "iqfoc/transform.h"

#include "angle.h"

#include <stddef.h>

/* Enabled at a valley, the peak's command acts from the next valley to the one after it. */
#define ON_CYCLES UINT32_C(3)

iqfoc_error_t iqfoc_sensorless_init(iqfoc_sensorless_t *s, const iqfoc_observer_config_t *observer,
                                    const iqfoc_start_config_t *start, const iqfoc_extension_t *acting)
{
    const iqfoc_ab_t none = {0, 0};
    if (s == NULL) {
        return IQFOC_ERROR_NULL;
    }
    iqfoc_error_t error = iqfoc_observer_check(observer);
    if (error == IQFOC_OK && start != NULL) {
        error = iqfoc_start_init(&s->start, start);
    }
    if (error == IQFOC_OK) {
        error = iqfoc_observer_init(&s->observer, observer);
        s->start_config = start;
        s->acting = acting;
        s->source = IQFOC_ANGLE_MEASURED;
        s->wanted = IQFOC_ANGLE_MEASURED;
        s->i_peak = none;
        s->on = 0;
        s->difference = 0;
    }
    return error;
}

void iqfoc_sensorless_start(iqfoc_sensorless_t *s)
{
    (void)iqfoc_start_init(&s->start, s->start_config); /* checked before */
    s->source = IQFOC_ANGLE_START;
    s->wanted = IQFOC_ANGLE_OBSERVED;
}

void iqfoc_sensorless_catch(iqfoc_sensorless_t *s, iq24_t speed)
{
    const iqfoc_ab_t none = {0, 0};
    iqfoc_observer_start(&s->observer, none, 0, speed, false);
    s->source = IQFOC_ANGLE_CATCH;
    s->wanted = IQFOC_ANGLE_OBSERVED;
}

/* Range: clarke3 of phases within 15.9 is within 21.2. */
static iqfoc_ab_t held_current(const iqfoc_sample_t *sample)
{
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    const iqfoc_ab_t held = {IQ24_HOLD_BITS(i.alpha, 28), IQ24_HOLD_BITS(i.beta, 28)};
    return held;
}

static iqfoc_ab_t mean_of(iqfoc_ab_t x, iqfoc_ab_t y)
{
    const iqfoc_ab_t mean = {iq24_asr32(x.alpha + y.alpha, 1), iq24_asr32(x.beta + y.beta, 1)};
    return mean;
}

/* What the legs have in common. */
typedef struct edge_loss {
    iq24_t three_l;  /* 3 L/T */
    iq24_t v_dead;   /* without its sign */
    iq24_t u_middle; /* mean of the highest and the lowest phase voltage */
    iq24_t u_dc_inverse;
    iq24_t least; /* a pulse is longer than this share of the period, or it does not come */
} edge_loss;

/* A leg: its phase voltage and those of the others, and its current at the samples. */
typedef struct leg_cycle {
    iq24_t u, y, z;
    iq24_t start, middle, end;
} leg_cycle;

static iq24_t lost_at(const edge_loss *e, iq24_t i, iq24_t ripple)
{
    return iq24_clamp(iq24_add_sat(iq24_mul_sat(e->three_l, i), ripple), -e->v_dead, e->v_dead);
}

/*
 * Range: u within 2.8, so the share is within 5.6 and `above` within 11.2, and the ripple within 1.5 (3.8 + 2.8). A sample is within 11.4, a
 * difference of two within 22.8, and the sum for `level` within 45.6. The duty is below 1, and d (1 - d) at most 1/4.
 */
static iq24_t loss_of_leg(const edge_loss *e, const leg_cycle *x)
{
    const int32_t third_q32 = INT32_C(1431655765);
    const iq24_t duty = IQ24_ONE / 2 + iq24_mul_round(iq24_sub_wrap(x->u, e->u_middle), e->u_dc_inverse);
    if (duty <= e->least || duty >= IQ24_ONE - e->least) {
        return 0;
    }
    const int32_t d_q31 = duty * 128;
    const iq24_t above = iq24_max(iq24_sub_wrap(x->u, x->y), 0) + iq24_max(iq24_sub_wrap(x->u, x->z), 0);
    const iq24_t area = iq24_mul_high_round(above, third_q32) - iq24_mul_high_round(2 * x->u, d_q31);
    const iq24_t ripple = area + iq24_asr32(area, 1);                       /* 3 l times its current */
    const int32_t both_q30 = iq24_mul_high(d_q31, (IQ24_ONE - duty) * 128); /* d (1 - d) */
    const iq24_t level = x->middle - iq24_mul_high_round(x->start - 2 * x->middle + x->end, 2 * both_q30);
    const iq24_t rise = level + iq24_mul_high_round(2 * (x->start - x->middle), d_q31);
    const iq24_t fall = level + iq24_mul_high_round(2 * (x->end - x->middle), d_q31);
    return iq24_asr32(lost_at(e, rise, -ripple) + lost_at(e, fall, ripple), 1);
}

iqfoc_ab_t iqfoc_sensorless_acting(const iqfoc_extension_t *acting, const iqfoc_flux_predictor_t *machine,
                                   iqfoc_ab_t u, iq24_t u_dc_inverse, const iqfoc_ab_t i[3])
{
    if (acting == NULL) {
        return u;
    }
    if (machine == NULL) {
        const iqfoc_ab_t first = iqfoc_extension_acting(acting, u, mean_of(i[0], i[1]));
        return mean_of(first, iqfoc_extension_acting(acting, u, mean_of(i[1], i[2])));
    }
    const iqfoc_abc_t v = iqfoc_clarke_inverse(u);
    const iqfoc_abc_t start = iqfoc_clarke_inverse(i[0]);
    const iqfoc_abc_t middle = iqfoc_clarke_inverse(i[1]);
    const iqfoc_abc_t end = iqfoc_clarke_inverse(i[2]);
    const iq24_t high = iq24_max(iq24_max(v.a, v.b), v.c);
    const iq24_t low = iq24_min(iq24_min(v.a, v.b), v.c);
    const iq24_t v_dead = iq24_abs_sat(acting->v_dead);
    const edge_loss e = {iq24_asr32(3 * (machine->l_d + machine->l_q), 1), v_dead, iq24_asr32(high + low, 1),
                         u_dc_inverse, iq24_mul_round(v_dead, u_dc_inverse)};
    const leg_cycle a = {v.a, v.b, v.c, start.a, middle.a, end.a};
    const leg_cycle b = {v.b, v.c, v.a, start.b, middle.b, end.b};
    const leg_cycle c = {v.c, v.a, v.b, start.c, middle.c, end.c};
    const iqfoc_abc_t lost = {loss_of_leg(&e, &a), loss_of_leg(&e, &b), loss_of_leg(&e, &c)};
    const iqfoc_ab_t ab = iqfoc_clarke3(lost);
    const bool gains = acting->v_dead < 0;
    const iqfoc_ab_t acts = {
        iq24_sub_wrap(iq24_mul_round(acting->k_u, u.alpha), gains ? -ab.alpha : ab.alpha),
        iq24_sub_wrap(iq24_mul_round(acting->k_u, u.beta), gains ? -ab.beta : ab.beta)};
    return acts;
}

static void step_observer(iqfoc_sensorless_t *s, const iqfoc_cycle_t *cycle, iqfoc_ab_t i)
{
    const iqfoc_ab_t start = {IQ24_HOLD_BITS(cycle->i_valley.alpha, 28),
                              IQ24_HOLD_BITS(cycle->i_valley.beta, 28)};
    const iqfoc_ab_t samples[3] = {start, s->i_peak, i};
    const iqfoc_ab_t u = iqfoc_sensorless_acting(s->acting, &s->observer.config->machine, cycle->u_now,
                                                 cycle->u_dc_inverse, samples);
    iqfoc_observer_step(&s->observer, u, iqfoc_observer_mean(start, s->i_peak, i), i);
}

/* No voltage is known, or none that shows the angle: the observer begins at the best angle there is. */
static void restart_observer(iqfoc_sensorless_t *s, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    iqfoc_observer_t *o = &s->observer;
    if (s->source == IQFOC_ANGLE_MEASURED) {
        iqfoc_observer_start(o, i, sample->theta, sample->speed, true);
    } else if (s->source == IQFOC_ANGLE_START) {
        iqfoc_observer_start(o, i, s->start.theta, s->start.speed, false);
    } else {
        iqfoc_observer_start(o, i, iqfoc_observer_theta(o, IQ24_ONE), iqfoc_observer_speed(o), false);
    }
}

static bool start_is_slow(const iqfoc_sensorless_t *s)
{
    const iq24_t speed_min = s->observer.config->speed_min;
    return s->source == IQFOC_ANGLE_START && iq24_within(s->start.speed, -speed_min, speed_min);
}

/* Angle and speed of the present source. */
static void put_angle(const iqfoc_sensorless_t *s, iqfoc_sample_t *sample)
{
    if (s->source == IQFOC_ANGLE_START) {
        sample->theta = iqfoc_start_theta(&s->start, sample->instant);
        sample->speed = s->start.speed;
    } else if (s->source == IQFOC_ANGLE_CATCH) {
        sample->theta = 0;
        sample->speed = 0;
    } else if (s->source == IQFOC_ANGLE_OBSERVED) {
        sample->theta = iqfoc_observer_theta(&s->observer, sample->instant);
        sample->speed = iqfoc_observer_speed(&s->observer);
    } else {
        /* the sensor's, as they are */
    }
}

static void change_source(iqfoc_sensorless_t *s, iqfoc_cycle_t *cycle, const iqfoc_sample_t *measured)
{
    const bool ready = s->wanted == IQFOC_ANGLE_MEASURED ||
                       (s->observer.locked && s->on >= ON_CYCLES &&
                        (s->source != IQFOC_ANGLE_START || s->start.stage == IQFOC_START_OPEN_LOOP));
    if (s->source != s->wanted && ready) {
        const bool other_frame = s->source == IQFOC_ANGLE_START || s->source == IQFOC_ANGLE_CATCH;
        iqfoc_sample_t before = *measured;
        iqfoc_sample_t after = *measured;
        put_angle(s, &before);
        s->source = s->wanted;
        put_angle(s, &after);
        if (other_frame) {
            iqfoc_cycle_hand_over(cycle, before.theta, &after);
        }
    }
}

void iqfoc_sensorless_valley(iqfoc_sensorless_t *s, iqfoc_cycle_t *cycle, iqfoc_sample_t *sample)
{
    const iqfoc_dq_t none = {0, 0};
    const iqfoc_ab_t i = held_current(sample);
    s->on = cycle->enabled && !cycle->tripped ? s->on + (s->on < ON_CYCLES ? 1U : 0U) : 0;
    if (s->source == IQFOC_ANGLE_OBSERVED && s->on == 0) {
        s->source = IQFOC_ANGLE_CATCH;
    }
    if (s->source == IQFOC_ANGLE_START && s->on > 0) {
        iqfoc_start_step(&s->start, sample->theta);
        cycle->i_ref = s->start.i_ref;
    }
    if (s->on < ON_CYCLES || start_is_slow(s)) {
        restart_observer(s, sample, i);
    } else {
        step_observer(s, cycle, i);
    }
    s->difference = angle_less_turns((int64_t)iqfoc_observer_theta(&s->observer, 0) - sample->theta);
    change_source(s, cycle, sample);
    if (s->source == IQFOC_ANGLE_CATCH) {
        cycle->i_ref = none;
    }
    if (s->source == IQFOC_ANGLE_OBSERVED && !s->observer.locked) {
        iqfoc_cycle_set_status(cycle, IQFOC_STATUS_ANGLE_LOST);
    }
    put_angle(s, sample);
}

void iqfoc_sensorless_peak(iqfoc_sensorless_t *s, iqfoc_sample_t *sample)
{
    s->i_peak = held_current(sample);
    put_angle(s, sample);
}
