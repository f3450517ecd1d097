/* A design with its trial and comparison, and its output: text, JSON, page, and the firmware's header. */
#ifndef SIM_HOST_TUNE_TUNE_REPORT_H
#define SIM_HOST_TUNE_TUNE_REPORT_H

#include "base/json.h"
#include "tune_speed.h"
#include "tune_trial.h"

#include <stdio.h>

typedef struct tune_report {
    tune_result result;
    tune_trial trial;
    tune_observer observer;
    tune_observer_trial observer_trial; /* not set if there is no observer */
    tune_speed speed;
    tune_comparison comparison;
    const char *diagnosis_path; /* NULL: none */
} tune_report;

typedef struct tune_choice {
    const char *diagnosis_path; /* NULL: none */
    double ratio;               /* SFFR at n_max; 0: the motor file's f_pwm_Hz */
    tune_method method;
    long updates; /* a carrier period: 1 or 2 */
    double margin;
    double run_up_s; /* from standstill to n_max, for observer and speed control */
    double J_kgm2;   /* of the shaft; 0: no speed control */
    tune_tolerances tolerances;
    long drives, seed;
    bool compares; /* with the library's other controllers; not with two updates */
} tune_choice;

/* What is chosen where nobody says otherwise. */
tune_choice tune_choice_usual(void);

/* Designs, simulates and compares. False with *e set: no design, or an input that cannot be used. */
bool tune_report_make(tune_report *t, const motor *m, const tune_choice *choice, error *e);

void tune_report_print(const tune_report *t, FILE *stream);

/* NULL when memory runs out. */
json_t *tune_report_json(const tune_report *t);

bool tune_report_page(const tune_report *t, const char *directory, error *e);

/* DIRECTORY/iqfoc_tuned.h: the constants of iqfoc/tuned_control.h. */
bool tune_report_header(const tune_report *t, const char *directory, error *e);

#endif
