/*
 * A motor file's extensions to the constants of the firmware's corrections, at run time: the host's
 * counterpart of iqfoc/extension_params.h, whose formulas it evaluates.
 */
#ifndef PORT_HOST_EXTENSION_HOST_H
#define PORT_HOST_EXTENSION_HOST_H

#include "params_host.h"

#include "iqfoc/extension.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/observer.h"

/*
 * What the firmware can put right of the file's extensions: those that have a FIRMWARE row in
 * data/causes.def. The others have no constant there. False, with the file and the constant named, where a value does
 * not fit the library's ranges.
 */
bool extension_from_motor(const motor *m, iqfoc_extension_t *extension, error *e);

/*
 * The observer of a motor file: gain and limits of IQFOC_OBSERVER_CONFIG, a bandwidth of 0.16/T, and a twentieth of the
 * top speed as the least speed.
 */
bool observer_from_motor(const motor *m, iqfoc_observer_config_t *config, error *e);

/* The flux predictor of a motor file. */
bool flux_predictor_from_motor(const motor *m, iqfoc_flux_predictor_t *predictor, error *e);

#endif
