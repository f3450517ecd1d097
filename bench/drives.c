/*
 * Configurations of the control cycle (bench/drives.h).
 */
#include "drives.h"

#include "iqfoc/cycle_steps.h"

#include "kernels.h"

#define DRIVE(name, model, feedback, control, modulation, extended)                                          \
    static const iqfoc_methods_t name##_methods = {model, feedback, control, modulation, extended};          \
    BENCH_APART bool bench_##name##_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now) \
    {                                                                                                        \
        return iqfoc_cycle_valley_by(name##_methods, cycle, sample, now);                                    \
    }                                                                                                        \
    BENCH_APART iqfoc_command_t bench_##name##_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample,      \
                                                    iq24_t output_mid, uint32_t now)                         \
    {                                                                                                        \
        return iqfoc_cycle_peak_by(name##_methods, cycle, sample, output_mid, now);                          \
    }

#define QUASI_DISCRETE IQFOC_MODEL_QUASI_DISCRETE
#define EXACT          IQFOC_MODEL_EXACT
#define SALIENT        IQFOC_MODEL_SALIENT
#define FLUX           IQFOC_MODEL_FLUX
#define FLUX_MAP       IQFOC_MODEL_FLUX_MAP
#define MIDPOINT       IQFOC_FEEDBACK_MIDPOINT
#define CORRECTED      IQFOC_FEEDBACK_CORRECTED_MEAN
#define QUASI_MEAN     IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN
#define EXACT_MEAN     IQFOC_FEEDBACK_EXACT_MEAN
#define MODULATED      IQFOC_FEEDBACK_MODULATED_MEAN
#define PI             IQFOC_CONTROL_PI
#define PWM            IQFOC_MODULATION_PWM

DRIVE(isr_cycle, QUASI_DISCRETE, QUASI_MEAN, PI, PWM, false)
DRIVE(isr_midpoint, QUASI_DISCRETE, MIDPOINT, PI, PWM, false)
DRIVE(isr_corrected_mean, QUASI_DISCRETE, CORRECTED, PI, PWM, false)
DRIVE(isr_exact, EXACT, EXACT_MEAN, PI, PWM, false)
DRIVE(isr_salient, SALIENT, EXACT_MEAN, PI, PWM, false)
DRIVE(isr_flux, FLUX, MIDPOINT, PI, PWM, false)
DRIVE(isr_flux_map, FLUX_MAP, MIDPOINT, PI, PWM, false)
DRIVE(isr_mean_modulated, QUASI_DISCRETE, MODULATED, PI, PWM, false)
DRIVE(isr_six_step, QUASI_DISCRETE, QUASI_MEAN, PI, IQFOC_MODULATION_SIX_STEP, false)
DRIVE(isr_extended, QUASI_DISCRETE, QUASI_MEAN, PI, PWM, true)
DRIVE(isr_deadbeat, QUASI_DISCRETE, MIDPOINT, IQFOC_CONTROL_DEADBEAT, PWM, false)
DRIVE(isr_deadbeat_exact, EXACT, MIDPOINT, IQFOC_CONTROL_DEADBEAT, PWM, false)
DRIVE(isr_deadbeat_learning, EXACT, MIDPOINT, IQFOC_CONTROL_DEADBEAT_LEARNING, PWM, false)

/* Sensors, angle, dead time and saturation, each a little off. */
static const iqfoc_extension_t extension = {
    .i_offset = {IQ24(0.01), IQ24(-0.005), IQ24(-0.005)},
    .i_gain_inverse = {IQ24(1.01), IQ24(0.99), IQ24(1.0)},
    .theta_0 = IQ24(0.002),
    .theta_delay = IQ24(0.05),
    .k_u = IQ24(0.99),
    .v_dead = IQ24(0.01),
    .knee_inverse = IQ24(30.0),
    .saturation = IQ24(0.05),
};
static const iqfoc_extension_t acting = {
    .i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE}, .k_u = IQ24_ONE, .saturation = IQ24(0.05)};

const iqfoc_cycle_config_t *bench_drives_config(void)
{
    static iqfoc_cycle_config_t config;
    static iqfoc_exact_law_t law;
    static iqfoc_exact_law_t mean_law;
    static iqfoc_salient_t end;
    static iqfoc_salient_t mean;
    law = iqfoc_exact_prediction(&bench_winding, IQ24_ONE);
    mean_law = iqfoc_exact_mean(&bench_winding, IQ24_ONE);
    iqfoc_salient_at_speed(&bench_salient, IQ24(0.08), IQ24_ONE, &end, &mean);
    config = bench_config;
    config.data.exact = &law;
    config.data.exact_mean = &mean_law;
    config.data.salient = &end;
    config.data.salient_mean = &mean;
    config.data.flux = &bench_flux;
    config.data.flux_map = &bench_flux_map;
    config.data.acting = &acting;
    config.data.extension = &extension;
    config.data.k_u_inverse = iqfoc_deadbeat_inverse(law.k_u_q26);
    config.data.k_psi = bench_config.predictor.k_psi;
    config.data.learning = IQ24(0.1);
    return &config;
}
