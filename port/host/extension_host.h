/*
 * A motor file's extensions to the constants of the firmware's corrections, at run time: the host's
 * counterpart of iqfoc/extension_params.h, whose formulas it evaluates.
 */
#ifndef PORT_HOST_EXTENSION_HOST_H
#define PORT_HOST_EXTENSION_HOST_H

#include "params_host.h"

#include "iqfoc/flux_predictor.h"

/*
 * What the firmware can put right of the file's extensions: saturation, dead time, voltage gain, current
 * offset and gain, angle offset and delay. The others (angle_harmonic, voltage_delay, emf_harmonics,
 * phase_asymmetry) have no constant there. False, with the file and the constant named, where a value does
 * not fit the library's ranges.
 */
bool extension_from_motor(const motor *m, iqfoc_extension_t *extension, error *e);

/* The flux predictor of a motor file. */
bool flux_predictor_from_motor(const motor *m, iqfoc_flux_predictor_t *predictor, error *e);

#endif
