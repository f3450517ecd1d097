/*
 * Physical motor data to the library's per-unit constants, at run time: the host's counterpart of
 * iqfoc/params.h, whose formulas it evaluates. The only place on the host where ohms, henries and webers
 * become IQ24.
 */
#ifndef PORT_HOST_PARAMS_HOST_H
#define PORT_HOST_PARAMS_HOST_H

#include "data/motor.h"
#include "data/scenario.h"

#include "iqfoc/cycle.h"

/* What turns per unit into physical and back (docs/units.md). */
typedef struct per_unit {
    double I_A; /* current base: peak rated current */
    double U_V; /* voltage base: nominal DC link */
    double T_s; /* control cycle */
} per_unit;

per_unit per_unit_of(const motor *m);

/* To the nearest IQ24; beyond its ends, the end. */
iq24_t iq24_from_double(double x);
double iq24_to_double(iq24_t x);

/* Electrical radians to turns (any number of them: a wrap loses nothing), and rad/s to turns per cycle. */
iq24_t turns_from_rad(double theta_rad);
iq24_t turns_from_speed(double omega_e_rad_s, double T_s);

/*
 * The predictor of a motor file. Its L is the mean of L_d and L_q: the papers' models are for non-salient
 * machines. False, with file, line, column and the coefficient named, where a value does not fit the
 * library's ranges.
 */
bool predictor_from_motor(const motor *m, const char *path, iqfoc_predictor_t *predictor, error *e);

/* The same for the gains of a closed loop of bandwidth_Hz. */
bool gains_from_motor(const motor *m, const char *path, double bandwidth_Hz,
                      iqfoc_current_control_gains_t *gains, error *e);

/*
 * A whole configuration: the above, the scenario's choices, and the host's ticks (hal_host.h). The motor's
 * maximal speed must fit too: 1/3 turn per control cycle. A current beyond four times rated trips.
 */
bool config_from_motor(const motor *m, const char *path, const scenario_control *control,
                       iqfoc_cycle_config_t *config, error *e);

#endif
