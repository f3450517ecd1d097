/* A design with its trial and its comparison (tune_report.h). */
#include "tune_report.h"

/* The library allows at most a third of an electrical period per control cycle. */
static bool speed_fits(const motor *m, error *e)
{
    const double per_turn = m->f_pwm_Hz / (m->n_max_rpm / 60.0 * m->pole_pairs);
    return per_turn >= 3.0 || motor_refuse(m->path, "f_pwm_Hz", e,
                                           "f_pwm_Hz gives %.3g control cycles per electrical period at "
                                           "n_max_rpm; at least 3 are needed: "
                                           "f_pwm_Hz = %.5g",
                                           per_turn, 3.0 * m->n_max_rpm / 60.0 * m->pole_pairs);
}

tune_choice tune_choice_usual(void)
{
    return (tune_choice){.updates = 1,
                         .margin = 0.5,
                         .run_up_s = TUNE_RUN_UP_S,
                         .tolerances = {TUNE_TOLERANCE_R, TUNE_TOLERANCE_L, TUNE_TOLERANCE_PSI_F},
                         .drives = 50,
                         .seed = 1};
}

bool tune_report_make(tune_report *t, const motor *m, const tune_choice *choice, error *e)
{
    tune_result *result = &t->result;
    result->motor = *m;
    if (choice->ratio > 0.0) {
        result->motor.f_pwm_Hz = choice->ratio * m->n_max_rpm / 60.0 * m->pole_pairs;
    }
    result->halves = choice->updates == 2;
    result->motor.f_pwm_Hz *= (double)choice->updates;
    result->method = choice->method;
    result->disk_wanted = choice->margin;
    t->diagnosis_path = choice->diagnosis_path;
    if (!speed_fits(&result->motor, e)) {
        return false;
    }
    if (choice->diagnosis_path == NULL) {
        tune_region_of_tolerances(&result->motor, &choice->tolerances, &result->region);
    } else if (!tune_region_of_diagnosis(&result->motor, choice->diagnosis_path, &choice->tolerances,
                                         &result->region, e)) {
        return false;
    }
    if (!tune_design_find(result, e)) {
        return false;
    }
    tune_observer_find(result, choice->run_up_s, &t->observer);
    return tune_trial_run(result, (int)choice->drives, (uint64_t)choice->seed, &t->trial, e) &&
           (t->observer.none != NULL ||
            tune_observer_trial_run(result, &t->observer, (int)choice->drives, (uint64_t)choice->seed,
                                    &t->observer_trial, e)) &&
           (choice->J_kgm2 == 0.0 ||
            (tune_speed_find(result, choice->J_kgm2, choice->run_up_s, &t->speed, e) &&
             tune_speed_trial(result, &t->speed, e))) &&
           (!choice->compares || result->halves ||
            tune_compare(result, &choice->tolerances, &t->comparison, e));
}
