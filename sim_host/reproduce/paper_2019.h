/* The 2019 paper's drive, its operating points and its tables. */
#ifndef SIM_HOST_REPRODUCE_PAPER_2019_H
#define SIM_HOST_REPRODUCE_PAPER_2019_H

#include "method_errors.h"
#include "rows.h"

/* 2019 Table 2. The DC link is not given; 750 V here. It enters through the ripple alone. */
motor paper_2019_motor(void);

/*
 * Rated current at a speed, peak, in the rotor frame. The paper does not give its i_d; its Table 1 is met at
 * 5000 rpm with i_d = 0 and at 8000 rpm with i_d between -0.6 and -0.8 of the current, as a drive does that
 * runs into its voltage limit on the way. So here: i_d = 0 up to 5000 rpm, and beyond it field weakening that
 * keeps the voltage of 5000 rpm.
 */
double complex paper_2019_current(const motor *m, double n_rpm);

/* The same with i_d a given share of it. */
double complex paper_2019_current_at(const motor *m, double id_ratio);

/* What the paper prints, %: Table 1 (simulated), in the order of `method`; 3 (measured), predictions. */
enum { PAPER_2019_TABLE_1 = 3, PAPER_2019_TABLE_3 = 2 };

extern const struct paper_2019_simulated {
    double n_rpm;
    double percent[METHOD_COUNT];
} paper_2019_table_1[PAPER_2019_TABLE_1];

extern const struct paper_2019_measured {
    double n_rpm;
    double standard, quasi_discrete;
} paper_2019_table_3[PAPER_2019_TABLE_3];

/* Switching over fundamental frequency. */
double paper_2019_sffr(const motor *m, double n_rpm);

bool paper_2019_compare(comparison *c, error *e);

#endif
