/*
 * Converts physical motor data to the library's per-unit constants at run time, by the formulas of iqfoc/params.h. On the host only this
 * file and extension_host.h convert ohm, henry and weber to fixed point. Inductances are those at zero current (motor_inductances).
 */
#ifndef PORT_HOST_PARAMS_HOST_H
#define PORT_HOST_PARAMS_HOST_H

#include "data/scenario.h"
#include "per_unit.h"

#include "iqfoc/cycle.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"

/*
 * One constant in Q(bits), if its value lies in low ... high. Else false, and *e names the motor file, the
 * key that makes the constant, and the constant; with line and column where the key is one of [motor] or
 * [inverter].
 */
bool constant_from_motor(const motor *m, const char *key, const char *name, double value, double low,
                         double high, int bits, int32_t *out, error *e);

/*
 * The predictor of a motor file. Its L is the mean of L_d and L_q: the papers' models are for non-salient
 * machines. False where a value does not fit the library's ranges, as above.
 */
bool predictor_from_motor(const motor *m, iqfoc_predictor_t *predictor, error *e);

/* The exact predictors, alike: the winding's of that mean, the salient machine's of L_d and L_q. */
bool winding_from_motor(const motor *m, iqfoc_exact_winding_t *winding, error *e);
bool salient_from_motor(const motor *m, iqfoc_salient_machine_t *machine, error *e);

/* And the gains of a closed loop of bandwidth_Hz. */
bool gains_from_motor(const motor *m, double bandwidth_Hz, iqfoc_current_control_gains_t *gains, error *e);

/* The scenario's bandwidth; without one f_pwm_Hz/20, and f_pwm_Hz/60 with the corrected mean. */
double control_bandwidth_Hz(const motor *m, const scenario_control *control);

/*
 * A whole configuration: the above, the scenario's choices, and the host's ticks (hal_host.h). The motor's
 * maximal speed must fit too: 1/3 turn per control cycle. A current beyond four times rated trips.
 */
bool config_from_motor(const motor *m, const scenario_control *control, iqfoc_cycle_config_t *config,
                       error *e);

#endif
