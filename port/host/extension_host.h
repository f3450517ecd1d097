/*
 * A motor file's extensions to the constants of the firmware's corrections, at run time: the host's
 * counterpart of iqfoc/extension_params.h, whose formulas it evaluates.
 */
#ifndef PORT_HOST_EXTENSION_HOST_H
#define PORT_HOST_EXTENSION_HOST_H

#include "params_host.h"

#include "iqfoc/extension.h"
#include "iqfoc/flux_map.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/observer.h"

/*
 * What the firmware can put right of the file's extensions: those that have a FIRMWARE row in
 * data/causes.def. The others have no constant there. False, with the file and the constant named, where a value does
 * not fit the library's ranges.
 */
bool extension_from_motor(const motor *m, iqfoc_extension_t *extension, error *e);

/* Highest bandwidth of the observer's phase-locked loop times the cycle that its gains allow. */
#define OBSERVER_LOOP_RAD_MOST 1.0

/*
 * The usual one of a motor: 0.65 turns^(2/3) within 0.01 ... 0.16, with its turns per cycle at the top speed. A sensor's noise
 * of 0.5 % then leaves up to 0.02 % of noise in the top speed, at each carrier frequency (docs/sensorless.md).
 */
double observer_loop_rad(const motor *m);

/* k1 and k2 for this bandwidth times the cycle: 0 < bandwidth_rad <= OBSERVER_LOOP_RAD_MOST. */
void observer_set_loop(iqfoc_observer_config_t *config, double bandwidth_rad);

/*
 * The observer of a motor file: gain and limits of IQFOC_OBSERVER_CONFIG, the usual bandwidth for its top speed, and a
 * twentieth of the top speed as the least speed.
 */
bool observer_from_motor(const motor *m, iqfoc_observer_config_t *config, error *e);

/* The flux predictor of a motor file. */
bool flux_predictor_from_motor(const motor *m, iqfoc_flux_predictor_t *predictor, error *e);

/* What IQFOC_FLUX_MAP takes: straight iron, the magnet with what the parts add at no current, and the parts. E_J = 0: no part. */
typedef struct flux_map_values {
    double L_d_H, L_q_H, psi_Wb;
    struct {
        double E_J, I_d_A, I_q_A, I_c_A;
    } part[IQFOC_FLUX_MAP_PARTS];
} flux_map_values;

flux_map_values flux_map_values_of(const motor *m);

/* The flux map of a motor file. Without a map of parts it has no part, and terms and I_sat of the file are left out. */
bool flux_map_from_motor(const motor *m, iqfoc_flux_map_t *map, error *e);

#endif
