/*
 * Digest of the tuned controller with the change detector and the adaptation of resistance and magnet flux
 * (golden_vectors.h): a rotor at constant speed, currents near their prediction, and errors that grow through a
 * thousand inputs, so that the detector raises an alarm and names a group.
 */
#include "golden_tuned.h"

#include "golden_types.h"

#include "iqfoc/adapt.h"
#include "iqfoc/tuned_control.h"
#include "iqfoc/watch.h"

#define AGAIN 4000 /* inputs until all states are initialised again: 125 blocks */

/* The compressor of data/motors/ at 8 kHz. */
#define R_OHM    0.9
#define L_D_H    8e-3
#define L_Q_H    11e-3
#define PSI_WB   0.2
#define T_S      125e-6
#define I_BASE_A IQFOC_I_BASE(6.0)
#define U_DC_V   565.0

static const iqfoc_tuned_law_t law = {
    IQFOC_SALIENT_MACHINE(R_OHM, L_D_H, L_Q_H, PSI_WB, T_S, I_BASE_A, U_DC_V), IQ24(0.55), IQ24(0.5),
    IQ24(0.2), IQ24(0.05)};
static const iqfoc_watch_config_t config =
    IQFOC_WATCH_CONFIG(R_OHM, L_D_H, L_Q_H, PSI_WB, 3, T_S, I_BASE_A, U_DC_V, 0.003);

static const iqfoc_adapt_config_t adapt_config = IQFOC_ADAPT_CONFIG;

static iqfoc_tuned_t tuned;
static iqfoc_tuned_state_t state;
static iqfoc_watch_t watch;
static iqfoc_adapt_t adapt;
static iqfoc_dq_t i_start, u_start, i_ref;
static iqfoc_ab_t u_now;
static iq24_t theta, speed, grows;

static void begin(golden_inputs_t *inputs)
{
    const iqfoc_tuned_state_t fresh = {.predicted = false};
    speed = golden_within(inputs, IQ24(0.06));
    grows = golden_within(inputs, IQ24(0.01));
    i_ref = golden_dq(inputs, IQ24(0.9));
    tuned = iqfoc_tuned_at_speed(&law, speed);
    state = fresh;
    theta = 0;
    u_now.alpha = u_now.beta = 0;
    i_start.d = i_start.q = u_start.d = u_start.q = 0;
    adapt.r = golden_within(inputs, IQ24(0.2));
    adapt.psi = golden_within(inputs, IQ24(0.03));
    iqfoc_watch_reset(&watch);
}

static void add_watch(uint64_t *digest)
{
    digest_add(digest, watch.naming);
    digest_add(digest, (int32_t)watch.group);
    digest_add(digest, watch.amount_q16);
    digest_add(digest, (int32_t)watch.since);
    for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        digest_add(digest, watch.up_q16[n]);
        digest_add(digest, watch.down_q16[n]);
        digest_add(digest, watch.xy_q6[n]);
    }
}

static void add_adapt(uint64_t *digest)
{
    const iqfoc_tuned_law_t adapted = iqfoc_adapt_law(&law, &adapt);
    digest_add(digest, adapt.r);
    digest_add(digest, adapt.psi);
    digest_add(digest, adapted.machine.rho_d_q30);
    digest_add(digest, adapted.machine.rho_q_q30);
    digest_add(digest, adapted.machine.k_psi_d_q27);
    digest_add(digest, adapted.machine.k_psi_q_q27);
}

void golden_tuned_and_watched(golden_inputs_t *inputs, uint64_t *digest)
{
    if (inputs->number % AGAIN == 0) {
        begin(inputs);
    }
    inputs->number++;
    const iq24_sincos_t sc = iq24_sincos(theta);
    const iqfoc_dq_t noise = golden_dq(inputs, IQ24(0.005));
    const iqfoc_dq_t i = {iq24_add_wrap(state.i_next.d, noise.d) + grows,
                          iq24_add_wrap(state.i_next.q, noise.q)};
    iqfoc_tuned_ripple(&state, golden_dq(inputs, IQ24(0.01)));
    const iqfoc_ab_t u = iqfoc_tuned_step(&state, &tuned, iqfoc_park_inverse(i, sc), u_now, i_ref, theta);
    iqfoc_tuned_peak(&state, iqfoc_park_inverse(i_ref, sc), iq24_add_wrap(theta, speed / 2));
    digest_ab(digest, u);
    digest_dq(digest, state.error);
    if (iqfoc_watch_step(&watch, iqfoc_park_inverse(state.error, sc), i_start, u_start, sc)) {
        iqfoc_adapt_block(&adapt, &adapt_config, &watch, &config, speed);
        (void)iqfoc_watch_block(&watch, &config, speed, theta);
        add_watch(digest);
        add_adapt(digest);
    }
    i_start = state.i;
    u_now.alpha = iq24_clamp(u.alpha, -IQ24_ONE, IQ24_ONE);
    u_now.beta = iq24_clamp(u.beta, -IQ24_ONE, IQ24_ONE);
    u_start = iqfoc_park(u_now, sc);
    theta = iq24_add_wrap(theta, speed) & (IQ24_ONE - 1);
}
