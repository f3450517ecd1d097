/*
 * The 4,096 inputs that every function is counted with: the same on every target, from a fixed seed.
 */
#ifndef BENCH_INPUTS_H
#define BENCH_INPUTS_H

#include "iqfoc/cycle.h"
#include "iqfoc/flux_map.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/induction.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"
#include "iqfoc/watch.h"

#ifndef BENCH_INPUT_COUNT
#define BENCH_INPUT_COUNT 4096
#endif

/* Everything that any of the measured functions takes. */
typedef struct bench_input {
    iq24_t any_a;    /* all 32 bits, its magnitude spread evenly over the powers of two */
    iq24_t any_b;    /* the same */
    iq24_t positive; /* the same, above 0: a root's argument */
    iq24_t divisor;  /* the same, but large enough for |any_a / divisor| to fit IQ24 */
    iqfoc_ab_t i;    /* within +-2: twice the rated current */
    iqfoc_ab_t delta;
    iqfoc_ab_t u; /* within +-1: every fourth lies beyond the hexagon */
    iqfoc_dq_t i_ref;
    iqfoc_rotor_t rotor;
    iq24_sincos_t sc;
    iqfoc_sample_t sample; /* of a valley or a peak at that current and speed; nothing wrong with it */

    /* In addition to sample: a drive at an operating point, for the compositions. */
    iqfoc_dq_t u_steady;  /* voltage that holds the current at the speed of the rotor */
    iqfoc_dq_t u_winding; /* the part of it that the resistance takes */
    iq24_t u_dc_inverse;  /* 1/sample.u_dc */
} bench_input_t;

/* Input k of the series; to be called with k = 0, 1, 2 ... as each draws on the generator. */
void bench_input_draw(bench_input_t *input);

/* Back to the first input. */
void bench_input_restart(void);

/* The drive of the 2019 paper (data/motors/jarzebowicz2019.toml) at 5 kHz and 750 V. */
extern const iqfoc_cycle_config_t bench_config;
extern const iqfoc_exact_winding_t bench_winding;
extern const iqfoc_flux_predictor_t bench_flux;
extern const iqfoc_flux_map_t bench_flux_map;           /* of two parts */
extern const iqfoc_induction_machine_t bench_induction; /* 300 kW at 500 Hz and 1500 V */
extern const iqfoc_salient_machine_t bench_salient;     /* the same with L_q half as large again */
extern const iqfoc_watch_config_t bench_watch;

#endif
