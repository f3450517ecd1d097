/*
 * The whole library in one line. What is not called is not linked, and macros cost nothing.
 */
#ifndef IQFOC_IQFOC_H
#define IQFOC_IQFOC_H

#include "current_control.h"
#include "cycle.h"
#include "deadbeat.h"
#include "deadbeat_drift.h"
#include "error.h"
#include "extension.h"
#include "extension_params.h"
#include "finite_set.h"
#include "flux_predictor.h"
#include "hal.h"
#include "induction.h"
#include "iq24.h"
#include "iq24_math.h"
#include "iq24_sincos.h"
#include "mean_current.h"
#include "mean_modulated.h"
#include "modulation.h"
#include "params.h"
#include "predictor.h"
#include "predictor_exact.h"
#include "predictor_form.h"
#include "predictor_salient.h"
#include "recorder.h"
#include "ripple.h"
#include "rotor.h"
#include "transform.h"
#include "valley_reference.h"
#include "vector.h"
#include "version.h"

#endif
