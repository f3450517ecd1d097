/*
 * Ranges of all set-up functions: for every number of every configuration both ends of the range that its header
 * states, and the next number beyond each. A refused call leaves the object unchanged.
 */
#include "bits.h"

#include "iqfoc/iqfoc.h"

#include <stddef.h>
#include <string.h>

/* One member: 32 bits, signed or not, at an offset in the configuration. */
typedef struct member {
    size_t at;
    int64_t low, high;
    iqfoc_error_t error;
} member;

typedef iqfoc_error_t (*set_up)(const void *config);

void setUp(void)
{
}

void tearDown(void)
{
}

static iqfoc_error_t with(set_up function, const void *good, size_t size, size_t at, int64_t value)
{
    uint32_t words[256];
    const uint32_t bits = (uint32_t)(value & UINT32_MAX);
    TEST_ASSERT_TRUE(size <= sizeof words);
    memcpy(words, good, size);
    memcpy((char *)words + at, &bits, sizeof bits);
    return function(words);
}

static void check(set_up function, const void *good, size_t size, const member *members, size_t count)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, function(good));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, function(NULL));
    for (size_t n = 0; n < count; n++) {
        const member *m = &members[n];
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(function, good, size, m->at, m->low));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(function, good, size, m->at, m->high));
        TEST_ASSERT_EQUAL_INT(m->error, with(function, good, size, m->at, m->low - 1));
        TEST_ASSERT_EQUAL_INT(m->error, with(function, good, size, m->at, m->high + 1));
    }
}

#define CHECK(function, good, members)                                                                       \
    check(function, &(good), sizeof(good), members, sizeof(members) / sizeof *(members))

/* init(&object, config) for an object whose bytes must not change where it is refused; and for no object. */
#define SET_UP(name, type, init)                                                                             \
    static iqfoc_error_t name(const void *config)                                                            \
    {                                                                                                        \
        type object;                                                                                         \
        type before;                                                                                         \
        memset(&object, 0x5A, sizeof object);                                                                \
        before = object;                                                                                     \
        const iqfoc_error_t error = init(&object, config);                                                   \
        TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, init(NULL, config));                                         \
        if (error != IQFOC_OK) {                                                                             \
            TEST_ASSERT_EQUAL_MEMORY(&before, &object, sizeof object);                                       \
        }                                                                                                    \
        return error;                                                                                        \
    }

SET_UP(init_cycle, iqfoc_cycle_t, iqfoc_cycle_init)
SET_UP(init_encoder, iqfoc_encoder_t, iqfoc_encoder_init)
SET_UP(init_halls, iqfoc_halls_t, iqfoc_halls_init)
SET_UP(init_offset, iqfoc_offset_t, iqfoc_offset_init)
SET_UP(init_restart, iqfoc_restart_t, iqfoc_restart_init)
SET_UP(init_start, iqfoc_start_t, iqfoc_start_init)
SET_UP(init_supervision, iqfoc_supervision_t, iqfoc_supervision_init)
SET_UP(init_tracker, iqfoc_tracker_t, iqfoc_tracker_init)

static iqfoc_error_t check_flux(const void *config)
{
    return iqfoc_flux_predictor_check(config);
}

static iqfoc_error_t check_reference(const void *config)
{
    return iqfoc_reference_check(config);
}

static iqfoc_error_t check_resolver(const void *config)
{
    return iqfoc_resolver_check(config);
}

static iqfoc_error_t check_shunts(const void *config)
{
    return iqfoc_shunts_check(config);
}

static const iqfoc_cycle_config_t cycle_config = {.predictor = {IQ24_ONE, 0, 0},
                                                  .feedback = IQFOC_FEEDBACK_MIDPOINT,
                                                  .modulation = IQFOC_MODULATION_PWM,
                                                  .safe_state = IQFOC_SAFE_GATES_OFF,
                                                  .span_max = IQ24_ONE,
                                                  .current_limit = IQ24_ONE,
                                                  .period_ticks = 1000};

static void the_cycle(void)
{
    static const member members[] = {
        {offsetof(iqfoc_cycle_config_t, predictor.k_u), 1, IQ24(16.0), IQFOC_ERROR_PREDICTOR},
        {offsetof(iqfoc_cycle_config_t, predictor.k_r), 0, 1 << 24, IQFOC_ERROR_PREDICTOR},
        {offsetof(iqfoc_cycle_config_t, predictor.k_psi), 0, IQ24(8.0), IQFOC_ERROR_PREDICTOR},
        {offsetof(iqfoc_cycle_config_t, gains.kp_d), 0, IQ24(32.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.kp_q), 0, IQ24(32.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.ki_d), 0, IQ24(32.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.ki_q), 0, IQ24(32.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.anti_windup), 0, 1 << 24, IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.x_d), 0, IQ24(96.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.x_q), 0, IQ24(96.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, gains.emf), 0, IQ24(96.0), IQFOC_ERROR_GAINS},
        {offsetof(iqfoc_cycle_config_t, span_max), 1, 1 << 24, IQFOC_ERROR_SPAN},
        {offsetof(iqfoc_cycle_config_t, current_limit), 1, IQ24(16.0), IQFOC_ERROR_CURRENT_LIMIT},
        {offsetof(iqfoc_cycle_config_t, period_ticks), 1, INT32_MAX, IQFOC_ERROR_TIMES},
        {offsetof(iqfoc_cycle_config_t, tolerance_ticks), 0, INT32_MAX - 1000, IQFOC_ERROR_TIMES},
    };
    CHECK(init_cycle, cycle_config, members);
    iqfoc_cycle_config_t both = cycle_config;
    both.period_ticks = 1000;
    both.tolerance_ticks = INT32_MAX - 1000;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_cycle(&both));
    both.tolerance_ticks++;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_TIMES, init_cycle(&both));
}

/* Every choice that is offered, and no other; another set is offered under the same conditions. */
static void the_cycles_choices(void)
{
    static const iqfoc_feedback_t feedback[] = {IQFOC_FEEDBACK_MIDPOINT, IQFOC_FEEDBACK_CORRECTED_MEAN,
                                                IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN};
    iqfoc_cycle_t cycle;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &cycle_config));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_offer(&cycle, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_offer(NULL, &cycle_config));
    for (int n = 0; n < 64; n++) {
        iqfoc_cycle_config_t c = cycle_config;
        c.feedback = (iqfoc_feedback_t)n;
        bool good = false;
        for (size_t k = 0; k < sizeof feedback / sizeof *feedback; k++) {
            good = good || c.feedback == feedback[k];
        }
        TEST_ASSERT_EQUAL_INT(good ? IQFOC_OK : IQFOC_ERROR_CHOICE, init_cycle(&c));
        TEST_ASSERT_EQUAL_INT(good ? IQFOC_OK : IQFOC_ERROR_CHOICE, iqfoc_cycle_offer(&cycle, &c));
        TEST_ASSERT_TRUE(cycle.offered == (good ? &c : &cycle_config));
        TEST_ASSERT_EQUAL(!good, iqfoc_cycle_taken(&cycle));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_offer(&cycle, &cycle_config));
        c = cycle_config;
        c.modulation = (iqfoc_modulation_t)n;
        good = c.modulation == IQFOC_MODULATION_PWM || c.modulation == IQFOC_MODULATION_SIX_STEP;
        TEST_ASSERT_EQUAL_INT(good ? IQFOC_OK : IQFOC_ERROR_CHOICE, init_cycle(&c));
        c = cycle_config;
        c.safe_state = (iqfoc_safe_state_t)n;
        good = c.safe_state == IQFOC_SAFE_GATES_OFF || c.safe_state == IQFOC_SAFE_SHORT_CIRCUIT;
        TEST_ASSERT_EQUAL_INT(good ? IQFOC_OK : IQFOC_ERROR_CHOICE, init_cycle(&c));
    }
}

static void sensors(void)
{
    static const iqfoc_encoder_config_t encoder = {4096, 4, 0, false, 0};
    static const member of_encoder[] = {
        {offsetof(iqfoc_encoder_config_t, counts_per_turn), 4, 65536, IQFOC_ERROR_ENCODER},
        {offsetof(iqfoc_encoder_config_t, pole_pairs), 1, 64, IQFOC_ERROR_ENCODER},
    };
    static const iqfoc_halls_config_t halls = IQFOC_HALLS(100);
    static const member of_halls[] = {
        {offsetof(iqfoc_halls_config_t, stall_cycles), 1, 1 << 20, IQFOC_ERROR_HALLS},
    };
    static const iqfoc_resolver_t resolver = {0, 0, IQ24_ONE, IQ24_ONE, IQ24(0.8), IQ24(1.2), 1, 0};
    static const member of_resolver[] = {
        {offsetof(iqfoc_resolver_t, offset_sin), IQ24(-4.0), IQ24(4.0), IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, offset_cos), IQ24(-4.0), IQ24(4.0), IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, gain_sin), IQ24(0.0625), IQ24(16.0), IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, gain_cos), IQ24(0.0625), IQ24(16.0), IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, amplitude_min), 1, IQ24(1.2) - 1, IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, amplitude_max), IQ24(0.8) + 1, IQ24(2.0), IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, ratio), 1, 64, IQFOC_ERROR_RESOLVER},
        {offsetof(iqfoc_resolver_t, theta_0), -(1 << 24), 1 << 24, IQFOC_ERROR_RESOLVER},
    };
    static const iqfoc_shunts_t shunts = {IQ24(0.9)};
    static const member of_shunts[] = {
        {offsetof(iqfoc_shunts_t, duty_max), IQ24(0.25), 1 << 24, IQFOC_ERROR_SHUNTS},
    };
    static const iqfoc_offset_limits_t offset = {0, 6, IQ24(0.1), IQ24(0.02)};
    static const member of_offset[] = {
        {offsetof(iqfoc_offset_limits_t, count_log2), 2, 16, IQFOC_ERROR_OFFSET_LIMITS},
        {offsetof(iqfoc_offset_limits_t, offset_max), 1, 1 << 24, IQFOC_ERROR_OFFSET_LIMITS},
        {offsetof(iqfoc_offset_limits_t, noise_max), 1, IQ24(0.125), IQFOC_ERROR_OFFSET_LIMITS},
    };
    static const iqfoc_tracker_config_t tracker = {IQ24(0.1), IQ24(0.01), IQ24(0.001), IQ24(0.1), 3};
    static const member of_tracker[] = {
        {offsetof(iqfoc_tracker_config_t, k1), 1, 1 << 24, IQFOC_ERROR_TRACKER},
        {offsetof(iqfoc_tracker_config_t, k2), 1, 1 << 24, IQFOC_ERROR_TRACKER},
        {offsetof(iqfoc_tracker_config_t, k3), 0, 1 << 24, IQFOC_ERROR_TRACKER},
        {offsetof(iqfoc_tracker_config_t, far_max), 1, IQ24(0.5), IQFOC_ERROR_TRACKER},
    };
    CHECK(init_encoder, encoder, of_encoder);
    CHECK(init_halls, halls, of_halls);
    CHECK(check_resolver, resolver, of_resolver);
    CHECK(check_shunts, shunts, of_shunts);
    CHECK(init_offset, offset, of_offset);
    CHECK(init_tracker, tracker, of_tracker);
    /* slip_max is at most a quarter of the counts. */
    const size_t slip = offsetof(iqfoc_encoder_config_t, slip_max);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(init_encoder, &encoder, sizeof encoder, slip, 1024));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_ENCODER, with(init_encoder, &encoder, sizeof encoder, slip, 1025));
    /* Each border within 1/24 turn of its place. */
    for (int32_t k = 0; k < IQFOC_HALLS_SECTORS; k++) {
        const int64_t place = (2 * k - 1) * (IQ24_ONE / 12);
        const member border = {offsetof(iqfoc_halls_config_t, border) + (size_t)k * sizeof(iq24_t),
                               place - IQ24_ONE / 24, place + IQ24_ONE / 24, IQFOC_ERROR_HALLS};
        check(init_halls, &halls, sizeof halls, &border, 1);
    }
}

static void start_restart_and_supervision(void)
{
    static const iqfoc_start_config_t start = {IQ24_ONE, 10, 10, IQ24(0.1), 10};
    static const member of_start[] = {
        {offsetof(iqfoc_start_config_t, i_align), 1, IQ24(16.0), IQFOC_ERROR_START},
        {offsetof(iqfoc_start_config_t, ramp_cycles), 1, 1 << 24, IQFOC_ERROR_START},
        {offsetof(iqfoc_start_config_t, hold_cycles), 1, 1 << 24, IQFOC_ERROR_START},
        {offsetof(iqfoc_start_config_t, speed_end), -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX,
         IQFOC_ERROR_START},
        {offsetof(iqfoc_start_config_t, run_up_cycles), 1, 1 << 24, IQFOC_ERROR_START},
    };
    static const iqfoc_start_config_t alignment = {IQ24_ONE, 10, 10, 0, 0};
    static const iqfoc_restart_config_t restart = {0, 10, 0, 10};
    static const member of_restart[] = {
        {offsetof(iqfoc_restart_config_t, wait_cycles), 1, INT64_C(1) << 31, IQFOC_ERROR_RESTART},
        {offsetof(iqfoc_restart_config_t, forget_cycles), 1, INT64_C(1) << 31, IQFOC_ERROR_RESTART},
    };
    static const iqfoc_supervision_config_t supervision = {IQ24(0.1), IQ24(0.125), 12, 3, IQ24(0.2), 5};
    static const member of_supervision[] = {
        {offsetof(iqfoc_supervision_config_t, i_least), 1, IQ24(16.0), IQFOC_ERROR_SUPERVISION},
        {offsetof(iqfoc_supervision_config_t, share), 1, IQ24(0.5), IQFOC_ERROR_SUPERVISION},
        {offsetof(iqfoc_supervision_config_t, window_min), 6, 1 << 20, IQFOC_ERROR_SUPERVISION},
        {offsetof(iqfoc_supervision_config_t, windows_bad), 1, 1 << 20, IQFOC_ERROR_SUPERVISION},
        {offsetof(iqfoc_supervision_config_t, sum_max), 1, IQ24(16.0), IQFOC_ERROR_SUPERVISION},
        {offsetof(iqfoc_supervision_config_t, sums_bad), 1, 1 << 20, IQFOC_ERROR_SUPERVISION},
    };
    CHECK(init_start, start, of_start);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_start(&alignment));
    CHECK(init_restart, restart, of_restart);
    CHECK(init_supervision, supervision, of_supervision);
}

static void references(void)
{
    static const iqfoc_reference_config_t reference = {IQ24(1.0), IQ24(1.0), IQ24(-0.5), IQ24(1.0),
                                                       IQ24(1.0)};
    static const member members[] = {
        {offsetof(iqfoc_reference_config_t, saliency), IQ24(-11.0), IQ24(11.0), IQFOC_ERROR_SALIENCY},
        {offsetof(iqfoc_reference_config_t, i_max), IQ24(0.5), IQ24(4.0), IQFOC_ERROR_CURRENT_LIMIT},
        {offsetof(iqfoc_reference_config_t, i_d_min), -(1 << 24), 0, IQFOC_ERROR_CURRENT_LIMIT},
        {offsetof(iqfoc_reference_config_t, gain), 0, IQ24(8.0), IQFOC_ERROR_WEAKENING},
        {offsetof(iqfoc_reference_config_t, share), IQ24(0.5), IQ24(1.125), IQFOC_ERROR_WEAKENING},
    };
    CHECK(check_reference, reference, members);
    iqfoc_reference_config_t none = reference;
    none.i_d_min = 0;
    none.i_max = 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_reference_check(&none));
    none.i_max = 0;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_CURRENT_LIMIT, iqfoc_reference_check(&none));
    /* What counts is saliency times i_max, and it may not wrap. */
    none.i_max = IQ24(4.0);
    none.saliency = IQ24(100.0);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SALIENCY, iqfoc_reference_check(&none));
    none.saliency = IQ24(2.75);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_reference_check(&none));
}

/* k = 1/l to 2^-10 and skew to 2^-10; l at both ends of its range, each with its own k. */
static void flux_predictors(void)
{
    static const iqfoc_flux_predictor_t plain = {IQ24_ONE, IQ24_ONE, IQ24_ONE, IQ24_ONE, 0, 0, 0};
    static const member members[] = {
        {offsetof(iqfoc_flux_predictor_t, r), 0, 1 << 24, IQFOC_ERROR_RESISTANCE},
        {offsetof(iqfoc_flux_predictor_t, psi), 0, IQ24(16.0), IQFOC_ERROR_FLUX},
        {offsetof(iqfoc_flux_predictor_t, k_d), IQ24(1.0 - 1.0 / 1024.0), IQ24(1.0 + 1.0 / 1024.0),
         IQFOC_ERROR_INDUCTANCE_D},
        {offsetof(iqfoc_flux_predictor_t, k_q), IQ24(1.0 - 1.0 / 1024.0), IQ24(1.0 + 1.0 / 1024.0),
         IQFOC_ERROR_INDUCTANCE_Q},
        /* Of l_d + l_q = 2 and l_d = l_q: twice skew must be 0 to 2^-10. */
        {offsetof(iqfoc_flux_predictor_t, skew), IQ24(-1.0 / 2048.0), IQ24(1.0 / 2048.0),
         IQFOC_ERROR_INDUCTANCE_Q},
    };
    CHECK(check_flux, plain, members);
    for (int axis = 0; axis < 2; axis++) {
        for (int end = 0; end < 2; end++) {
            iqfoc_flux_predictor_t p = plain;
            iq24_t *l = axis == 0 ? &p.l_d : &p.l_q;
            iq24_t *k = axis == 0 ? &p.k_d : &p.k_q;
            const iqfoc_error_t error = axis == 0 ? IQFOC_ERROR_INDUCTANCE_D : IQFOC_ERROR_INDUCTANCE_Q;
            *l = end == 0 ? IQ24(0.0625) : IQ24(8.0);
            *k = end == 0 ? IQ24(16.0) : IQ24(0.125);
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&p));
            *k += end == 0 ? 1 : -1;
            TEST_ASSERT_EQUAL_INT(error, iqfoc_flux_predictor_check(&p));
            *k -= end == 0 ? 1 : -1;
            *l += end == 0 ? -1 : 1;
            TEST_ASSERT_EQUAL_INT(error, iqfoc_flux_predictor_check(&p));
        }
    }
    /* The product is rounded to nearest: one LSB less than the limit, but only just. */
    iqfoc_flux_predictor_t near = plain;
    near.l_d = IQ24_ONE + 1;
    near.k_d = IQ24(1.0 - 1.0 / 1024.0) - 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&near));
    near.l_q = near.l_d;
    near.k_q = near.k_d;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&near));
    /* skew between -1 and 1. */
    iqfoc_flux_predictor_t far = {IQ24(8.0), IQ24(0.0625),         IQ24(0.125), IQ24(16.0), 0,
                                  0,         IQ24(7.9375 / 8.0625)};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_flux_predictor_check(&far));
    far.skew = -far.skew;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_INDUCTANCE_Q, iqfoc_flux_predictor_check(&far));
}

/* Six-step by a timer is refused by the safe command. */
static iqfoc_error_t begin_six_step(const void *config)
{
    const iqfoc_sample_t sample = {.u_dc = IQ24_ONE};
    iqfoc_cycle_t cycle;
    iqfoc_six_step_t six;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &cycle_config));
    cycle.enabled = true;
    const iqfoc_six_step_command_t command =
        iqfoc_cycle_six_step_begin(&six, &cycle, (const iqfoc_six_step_config_t *)config, 0, &sample);
    TEST_ASSERT_TRUE(six.config == (command.command.gates ? config : NULL));
    return command.command.gates ? IQFOC_OK : config == NULL ? IQFOC_ERROR_NULL : IQFOC_ERROR_CHOICE;
}

static void six_step(void)
{
    static const iqfoc_six_step_config_t angles = {IQ24(0.01), IQ24(-0.1), IQ24(0.2), false};
    static const member members[] = {
        {offsetof(iqfoc_six_step_config_t, gain), 0, 1 << 24, IQFOC_ERROR_CHOICE},
        {offsetof(iqfoc_six_step_config_t, angle_min), IQ24(-0.5), IQ24(0.2) - 1, IQFOC_ERROR_CHOICE},
        {offsetof(iqfoc_six_step_config_t, angle_max), IQ24(-0.1) + 1, IQ24(0.5), IQFOC_ERROR_CHOICE},
    };
    CHECK(begin_six_step, angles, members);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_cycle);
    RUN_TEST(the_cycles_choices);
    RUN_TEST(sensors);
    RUN_TEST(start_restart_and_supervision);
    RUN_TEST(references);
    RUN_TEST(flux_predictors);
    RUN_TEST(six_step);
    return UNITY_END();
}
