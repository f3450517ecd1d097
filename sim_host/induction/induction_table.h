/*
 * The 2019 paper's Table 1 for an induction machine: errors of mean and predicted current of a traction drive
 * that switches at 500 Hz, standard, quasi-discrete with the rotor flux for the magnet, and exact.
 *
 * The machine has values usual for a 300 kW traction motor at 1500 V; it is no particular one. Field oriented, rated
 * current, flux weakened as far as the DC link requires. The flux is not measured: an observer that started without
 * flux has settled when the record begins, and every method uses its flux.
 */
#ifndef SIM_HOST_INDUCTION_INDUCTION_TABLE_H
#define SIM_HOST_INDUCTION_INDUCTION_TABLE_H

#include "../base/error.h"

#include <stdbool.h>

typedef struct induction_errors {
    double f_stator_Hz, sffr;
    double i_d_A, i_q_A, psi_Wb, slip_Hz;
    double modulation_index;
    /* rms error over the rms current, percent */
    double mean_standard, mean_quasi_discrete, mean_exact;
    double prediction_standard, prediction_quasi_discrete, prediction_exact;
    double mean_exact_iq24, prediction_exact_iq24;   /* firmware */
    double mean_pulses_iq24, prediction_pulses_iq24; /* the same with the ripple of the pulses */
} induction_errors;

/* f_rotor_Hz: electrical; negative: reverse. False where fewer than three cycles are left of a period. */
bool induction_errors_at(double f_rotor_Hz, induction_errors *at, error *e);

enum { INDUCTION_POINTS = 6 };
extern const double induction_table_Hz[INDUCTION_POINTS];

/*
 * `iqfoc sweep --induction`: prints the table, and writes it as JSON if json_path is not NULL ("-" is standard
 * output, without the table): {"machine": {...}, "points": [...]}.
 */
bool induction_table(const char *json_path, error *e);

#endif
