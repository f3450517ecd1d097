/* The study of the induction machine: run, printed, written (induction_study.h). */
#include "induction_study.h"

#include "induction_table.h"

#include "base/json_file.h"

#include <stdio.h>
#include <string.h>

static void print_induction(const induction_errors points[INDUCTION_POINTS])
{
    static const char *const columns[2] = {"mean", "prediction"};
    printf("Traction induction machine, rated current, 500 Hz switching; errors in percent of the rms "
           "current\n");
    printf("%10s  %8s  %8s", "", "", "");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s  %12s", columns[k], columns[k], columns[k], columns[k]);
    }
    printf("\n%10s  %8s  %8s", "stator Hz", "SFFR", "psi Wb");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s  %12s", "standard", "quasi-discrete", "exact", "with ripple");
    }
    putchar('\n');
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        const induction_errors *p = &points[n];
        printf("%10.4g  %8.4g  %8.3g", p->f_stator_Hz, p->sffr, p->psi_Wb);
        printf("  %10.4g  %14.4g  %10.4g  %12.4g", p->mean_standard, p->mean_quasi_discrete, p->mean_exact,
               p->mean_pulses_iq24);
        printf("  %10.4g  %14.4g  %10.4g  %12.4g\n", p->prediction_standard, p->prediction_quasi_discrete,
               p->prediction_exact, p->prediction_pulses_iq24);
    }
}

bool induction_study(const char *json_path, error *e)
{
    induction_errors points[INDUCTION_POINTS];
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        if (!induction_errors_at(induction_table_Hz[n], &points[n], e)) {
            return false;
        }
    }
    if (json_path != NULL) {
        json_t *root = induction_table_json(points);
        const bool ok = json_file_write(json_path, root, e);
        json_decref(root);
        if (!ok) {
            return false;
        }
    }
    if (json_path == NULL || strcmp(json_path, "-") != 0) {
        print_induction(points);
    }
    return true;
}
