/*
 * One drive with its methods chosen at compile time, the calls of its start and of its slower task, and no port. The image's size is the
 * memory that such a drive takes of the library (bench/size.py).
 */
#include "inputs.h"

#include "iqfoc/cycle_steps.h"

/* Defaults: mid-point sample, PI, PWM. */
#ifndef SIZE_FEEDBACK
#define SIZE_FEEDBACK MIDPOINT
#endif
#ifndef SIZE_CONTROL
#define SIZE_CONTROL PI
#endif
#ifndef SIZE_MODULATION
#define SIZE_MODULATION PWM
#endif
#ifndef SIZE_EXTENDED
#define SIZE_EXTENDED false
#endif

#define NAMED_(kind, name) IQFOC_##kind##_##name
#define NAMED(kind, name)  NAMED_(kind, name)

static const iqfoc_methods_t methods = {NAMED(MODEL, SIZE_MODEL), NAMED(FEEDBACK, SIZE_FEEDBACK),
                                        NAMED(CONTROL, SIZE_CONTROL), NAMED(MODULATION, SIZE_MODULATION),
                                        SIZE_EXTENDED};

/* Where a port's registers would be. */
static volatile iqfoc_sample_t samples;
static volatile iqfoc_command_t commands;

static iqfoc_cycle_t cycle;
static iqfoc_cycle_config_t config;

#if defined(SIZE_NEEDS_EXACT)
static void give_data(void)
{
    static iqfoc_exact_law_t law;
    law = iqfoc_exact_prediction(&bench_winding, IQ24_ONE);
    config.data.exact = &law;
    config.data.k_u_inverse = iqfoc_deadbeat_inverse(law.k_u_q26);
    config.data.k_psi = bench_config.predictor.k_psi;
    config.data.learning = IQ24(0.1);
}
#elif defined(SIZE_NEEDS_SALIENT)
static void give_data(void)
{
    static iqfoc_salient_t end;
    static iqfoc_salient_t mean;
    iqfoc_salient_at_speed(&bench_salient, samples.speed, IQ24_ONE, &end, &mean);
    config.data.salient = &end;
    config.data.salient_mean = &mean;
}
#elif defined(SIZE_NEEDS_FLUX)
static void give_data(void)
{
    static const iqfoc_extension_t acting = {
        .i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE}, .k_u = IQ24_ONE, .saturation = IQ24(0.05)};
    static const iqfoc_extension_t extension = {.i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE},
                                                .k_u = IQ24(0.99),
                                                .v_dead = IQ24(0.01),
                                                .knee_inverse = IQ24(30.0)};
    config.data.flux = &bench_flux;
    config.data.acting = &acting;
    config.data.extension = &extension;
}
#else
static void give_data(void)
{
}
#endif

int main(void)
{
    config = bench_config;
    give_data();
    if (iqfoc_cycle_init_by(methods, &cycle, &config) != IQFOC_OK) {
        return 1;
    }
    for (;;) {
        iqfoc_sample_t sample = samples;
        iqfoc_cycle_valley_by(methods, &cycle, &sample, sample.time);
        sample = samples;
        commands = iqfoc_cycle_peak_by(methods, &cycle, &sample, IQ24(1.5), sample.time);
    }
}
