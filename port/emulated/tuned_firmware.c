/* The tuned controller and the watch as firmware (tuned_firmware.h). */
#include "tuned_firmware.h"

#include "iqfoc/modulation.h"
#include "iqfoc/ripple.h"

void tuned_firmware_start(tuned_firmware_t *t, const tuned_firmware_config_t *config)
{
    const iqfoc_command_t no_voltage = {{{IQ24_ONE / 2, IQ24_ONE / 2, IQ24_ONE / 2}, IQ24_ONE}, false};
    const tuned_firmware_t fresh = {.config = *config, .law = config->law, .command = no_voltage};
    *t = fresh;
    iqfoc_watch_reset(&t->watch);
}

/* What the watch sees of the cycle that ends at this valley, after the controller's step. */
static void be_watched(tuned_firmware_t *t, const iqfoc_sample_t *sample)
{
    const iq24_sincos_t sc = iq24_sincos(sample->theta);
    const iqfoc_ab_t off = iqfoc_park_inverse(t->state.error, sc);
    if (iqfoc_watch_step(&t->watch, off, t->i_start, t->u_start, sc)) {
        if (t->config.adapted != 0) {
            iqfoc_adapt_block(&t->adapt, &t->config.adapt, &t->watch, &t->config.watch, sample->speed);
            t->law = iqfoc_adapt_law(&t->config.law, &t->adapt);
        }
        (void)iqfoc_watch_block(&t->watch, &t->config.watch, sample->speed, sample->theta);
        t->status |= t->watch.naming > 0 ? TUNED_FIRMWARE_ALARM : 0;
    }
    t->i_start = t->state.i;
    t->u_start = iqfoc_park(t->u_now, sc);
}

/* The legs' losses in the cycle that the duties are for: at its first current. */
static void compensate(tuned_firmware_t *t, const iqfoc_sample_t *sample, iq24_t u_dc_inverse)
{
    const iq24_sincos_t sc_next = iq24_sincos(iq24_add_wrap(sample->theta, sample->speed));
    iqfoc_extension_compensate(&t->config.extension, &t->command.duties,
                               iqfoc_clarke_inverse(iqfoc_park_inverse(t->state.i_next, sc_next)),
                               u_dc_inverse);
}

void tuned_firmware_valley(tuned_firmware_t *t, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample)
{
    const iqfoc_tuned_t tuned = iqfoc_tuned_at_speed(&t->law, sample->speed);
    const iq24_t u_dc_inverse = iq24_div(IQ24_ONE, sample->u_dc);
    if (t->sample.u_dc > 0) {
        /* Of the cycle that ends here: its duties, the link at its first valley. */
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(sample->speed);
        const iqfoc_ripple_t ripple = iqfoc_ripple_at_speed(&t->law.machine, &rotor);
        const iq24_t theta_mid = iq24_sub_wrap(sample->theta, iq24_asr32(sample->speed, 1));
        iqfoc_tuned_ripple(&t->state,
                           iqfoc_ripple_seen(&ripple, t->high_now, t->sample.u_dc, iq24_sincos(theta_mid)));
    }
    t->sample = *sample;
    t->high_now = t->command.duties.high;
    /* The mean link of the cycle that begins, if it goes on as in the last one. */
    const iq24_t before = t->link_before > 0 ? t->link_before : sample->u_dc;
    const iq24_t u_dc = iq24_add_sat(sample->u_dc, iq24_asr32(iq24_sub_wrap(sample->u_dc, before), 1));
    t->u_now.alpha = iq24_mul_round(t->share_next.alpha, u_dc);
    t->u_now.beta = iq24_mul_round(t->share_next.beta, u_dc);
    t->link_before = sample->u_dc;
    const iqfoc_ab_t u =
        iqfoc_tuned_step(&t->state, &tuned, iqfoc_clarke3(sample->i), t->u_now, i_ref, sample->theta);
    t->command.duties = iqfoc_modulate(u, u_dc_inverse, IQ24_ONE);
    t->command.gates = true;
    /* Without the correction of dead time, which the legs lose again. */
    t->share_next = iqfoc_clarke3(t->command.duties.high);
    if (t->config.extended != 0) {
        compensate(t, sample, u_dc_inverse);
    }
    if (t->config.watched != 0) {
        be_watched(t, sample);
    }
}

void tuned_firmware_peak(tuned_firmware_t *t, const iqfoc_sample_t *sample)
{
    iqfoc_tuned_peak(&t->state, iqfoc_clarke3(sample->i), sample->theta);
}
