/*
 * The drive between two switching instants where it is not linear: Dormand and Prince's 5(4) pair (J. Comp.
 * Appl. Math. 6, 1980), its step chosen so that the estimated error of a step stays below SOLVER_TOLERANCE of
 * each state's scale; changes of conduction are located to rounding and never stepped over with the wrong
 * device on.
 */
#ifndef SIM_HOST_PLANT_PLANT_SOLVER_H
#define SIM_HOST_PLANT_PLANT_SOLVER_H

#include "plant_conduction.h"

/*
 * Per step, relative to the rated current (angles: 1 rad; speed: rated voltage's worth). The pair is used
 * with local extrapolation, so that the true error is well below: test_plant_cvode measures it.
 */
#define SOLVER_TOLERANCE 1e-11

/* A current within this share of the rated one is zero, at an edge or where a flow changes. */
#define SOLVER_ZERO_CURRENT 1e-12

/*
 * Advances the state from one time of the cycle to another, no leg changing its command or dead time between.
 * t_begin_s is when the cycle began, since plant_init. The legs' flow is settled at the start.
 */
void solver_advance(const plant_config *c, inverter_leg leg[3], double t_begin_s, double from_s, double to_s,
                    plant_state *s);

#endif
