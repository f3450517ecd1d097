/*
 * Which device of each leg conducts, and the voltages that follow.
 *
 * If a leg can have more than one voltage (plant_inverter.h: dead time, device drops), the sign of its
 * phase current decides; a current that reaches zero stays there while the voltage that keeps it there lies
 * within what the leg can hold. "Flow" is that three-way state; it changes only at instants which the solver
 * finds as zeros of conduction_margin.
 */
#ifndef SIM_HOST_PLANT_PLANT_CONDUCTION_H
#define SIM_HOST_PLANT_PLANT_CONDUCTION_H

#include "plant_inverter.h"
#include "plant_machine.h"

/* The legs at one instant: what each can hold. */
typedef struct conduction {
    inverter_leg *leg; /* three; their flow is read, and written by conduction_settle */
    bool off[3];       /* both switches off, over the whole span */
    double least_V[3], most_V[3];
    bool ideal; /* every leg has one voltage only: flow does not matter */
} conduction;

/* Voltages that the legs can hold at a time since plant_init; `off` must be set. */
void conduction_bounds(conduction *k, const plant_inverter *inverter, double t_s);

/* The voltage vector for the present flows; of a clamped leg the one that keeps its current at zero. */
vec_ab conduction_voltage(const conduction *k, const machine_terms *t);

/*
 * How far leg x is from a change of flow: positive inside, relative to I_scale (a current that flows) or to
 * u_scale (a clamp). INFINITY for a leg whose flow does not matter.
 */
double conduction_margin(const conduction *k, const machine_terms *t, int x, double I_scale_A,
                         double u_scale_V);

/*
 * Sets every flow again after a change. Currents below the given size are zero, and are
 * set to zero in the state: then it returns true, and machine_linearise must be called again.
 */
bool conduction_settle(conduction *k, const machine_terms *t, double zero_A, plant_state *s);

#endif
