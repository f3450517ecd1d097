/* PI control with the corrected mean (corrected_loops.h). */
#include "corrected_loops.h"

#include "base/json_file.h"
#include "corrected_mean.h"
#include "params_host.h"

#define BELOW 0.8

const double corrected_ratios[CORRECTED_RATIOS] = {5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 16.0, 20.0, 50.0};

static scenario_control control_of(double bandwidth_Hz)
{
    return (scenario_control){
        .feedback = FEEDBACK_CORRECTED_MEAN, .modulation = MODULATION_PWM, .bandwidth_Hz = bandwidth_Hz};
}

static double usual_Hz(int k)
{
    const motor m = loop_motor_at(corrected_ratios[k]);
    const scenario_control usual = control_of(0.0);
    return control_bandwidth_Hz(&m, &usual);
}

bool corrected_loop_run(double ratio, double bandwidth_Hz, loop_result *result, error *e)
{
    const loop_case c = current_loop_case(ratio, 0.0);
    const scenario_control control = control_of(bandwidth_Hz);
    return cycle_loop_run(&c, &c.truth, &control, NULL, result, e);
}

bool corrected_loops_run(corrected_loops *all, error *e)
{
    for (int k = 0; k < CORRECTED_RATIOS; k++) {
        const motor m = loop_motor_at(corrected_ratios[k]);
        all->most_Hz[k] = corrected_mean_bandwidth_Hz(&m, LOOP_RPM);
        if (!corrected_loop_run(corrected_ratios[k], 0.0, &all->usual[k], e) ||
            !corrected_loop_run(corrected_ratios[k], BELOW * all->most_Hz[k], &all->below[k], e)) {
            return false;
        }
    }
    return true;
}

static const char *most_text(const corrected_loops *all, int k, char text[16])
{
    if (!(all->most_Hz[k] > 0.0)) {
        return "none";
    }
    (void)snprintf(text, 16, "%.3g", all->most_Hz[k]);
    return text;
}

static const char *below_text(const corrected_loops *all, int k)
{
    return all->most_Hz[k] > 0.0 ? loop_outcome_text(all->below[k].outcome) : "-";
}

void corrected_loops_print(const corrected_loops *all, FILE *f)
{
    fprintf(f, "\nPI with the corrected mean at %g rpm: highest stable bandwidth\n  %5s%18s%18s%20s%18s\n",
            LOOP_RPM, "SFFR", "highest, Hz", "default, Hz", "default in plant", "80 % in plant");
    for (int k = 0; k < CORRECTED_RATIOS; k++) {
        char text[16];
        fprintf(f, "  %5g%18s%18.3g%20s%18s\n", corrected_ratios[k], most_text(all, k, text), usual_Hz(k),
                loop_outcome_text(all->usual[k].outcome), below_text(all, k));
    }
}

json_t *corrected_loops_json(const corrected_loops *all)
{
    json_t *list = json_array();
    for (int k = 0; k < CORRECTED_RATIOS && list != NULL; k++) {
        const bool some = all->most_Hz[k] > 0.0;
        json_t *o = json_pack("{s:f, s:f, s:f, s:s, s:o}", "sffr", corrected_ratios[k], "bandwidth_most_Hz",
                              all->most_Hz[k], "bandwidth_default_Hz", usual_Hz(k), "outcome_default",
                              loop_outcome_text(all->usual[k].outcome), "outcome_below",
                              some ? json_string(loop_outcome_text(all->below[k].outcome)) : json_null());
        list = json_appended(list, o);
    }
    return list;
}

void corrected_loops_part(page *p, const corrected_loops *all)
{
    static const char *const heads[] = {"\tSFFR", "\thighest stable bandwidth, Hz", "\tdefault, Hz",
                                        "default in the plant", "80 % of the highest in the plant"};
    page_heading(p, 2, "PI with the corrected mean");
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int k = 0; k < CORRECTED_RATIOS; k++) {
        char text[16];
        page_row_begin(p);
        page_cell(p, true, "%g", corrected_ratios[k]);
        page_cell(p, true, "%s", most_text(all, k, text));
        page_cell(p, true, "%.3g", usual_Hz(k));
        page_cell(p, false, "%s", loop_outcome_text(all->usual[k].outcome));
        page_cell(p, false, "%s", below_text(all, k));
        page_row_end(p);
    }
    page_table_end(p);
    page_note(
        p,
        "The corrected mean is one cycle old when it is used. iqfoc simulate refuses an unstable bandwidth.");
}
