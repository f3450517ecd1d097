/*
 * Fits the voltage equation by plain regression to a recording, as it is or with rearranged columns:
 *
 *     u_dq = R i_dq + (L_d di_d/dt - omega L_q i_q, L_q di_q/dt + omega L_d i_d) + omega (-psi_q, psi_d)
 *
 * with R, L_d, L_q and the two parts of the magnet's flux free. An exchange of columns changes what it leaves by
 * factors. All currents reversed leave the same and turn the signs of R, L_d and L_q; all voltages reversed turn
 * the flux as well.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_VOLTAGE_EQUATION_H
#define SIM_HOST_DIAGNOSE_CHECK_VOLTAGE_EQUATION_H

#include "data/recording.h"

enum { VOLTAGE_UNKNOWNS = 5, VOLTAGE_NONE_DERIVED = -1 };

typedef struct voltage_arrangement {
    int i_from[3], u_from[3]; /* phase x is read from column ... */
    double i_sign[3];         /* of each column */
    int i_derived;            /* the column that is minus the sum of the others, or VOLTAGE_NONE_DERIVED */
    double angle_sign,
        angle_zero;  /* angle = angle_sign * recorded - angle_zero; +-1, or pole pairs for a mechanical one */
    int late_halves; /* the command of a row acts so many half cycles after the row, >= 0 */
} voltage_arrangement;

extern const voltage_arrangement voltage_as_recorded;

typedef struct voltage_fit {
    double left;                /* share of the voltage's power that is not explained */
    double x[VOLTAGE_UNKNOWNS]; /* R, L_d, L_q, psi_d, psi_q */
} voltage_fit;

/* Fits about `rows_most` rows, spread over the recording. `left` is 1 if nothing can be fitted. */
voltage_fit voltage_equation_fit(const recording *rec, const voltage_arrangement *a, size_t rows_most);

#endif
