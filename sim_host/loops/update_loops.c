/* Two updates per carrier period against one (update_loops.h). */
#include "update_loops.h"

#include "base/json_file.h"

const double update_ratios[UPDATE_RATIOS] = {4.0, 5.0, 6.0, 8.0, 12.0};
const loop_method update_methods[UPDATE_METHODS] = {LOOP_PI_MEAN, LOOP_DEADBEAT_QUASI_DISCRETE,
                                                    LOOP_DEADBEAT_EXACT};

bool update_loop_run(double ratio, loop_method how, bool twice, loop_result *result, error *e)
{
    loop_case c = current_loop_case(twice ? 2.0 * ratio : ratio, 0.0);
    c.halves = twice;
    return loop_method_run(&c, &c.truth, how, result, e);
}

bool update_loops_run(update_loops *all, error *e)
{
    for (int k = 0; k < UPDATE_RATIOS; k++) {
        for (int n = 0; n < UPDATE_METHODS; n++) {
            for (int u = 0; u < UPDATES; u++) {
                if (!update_loop_run(update_ratios[k], update_methods[n], u == 1, &all->at[k][n][u], e)) {
                    return false;
                }
            }
        }
    }
    return true;
}

/* In carrier periods; -1: never. */
static double settling_periods(const loop_result *r, int update)
{
    return r->settling_cycles < 0 ? -1.0 : r->settling_cycles / (update + 1.0);
}

static const char *settling_text(const loop_result *r, int update, char text[16])
{
    if (r->settling_cycles < 0) {
        return "-";
    }
    (void)snprintf(text, 16, "%g", settling_periods(r, update));
    return text;
}

void update_loops_print(const update_loops *all, FILE *f)
{
    fprintf(f,
            "\nOne and two updates per carrier period, step of i_q from 30 %% to 70 %% of rated; percent of "
            "the rated "
            "peak\n  %5s  %-26s%8s  %-10s%10s%10s%10s%10s%10s\n",
            "SFFR", "loop", "updates", "outcome", "constant", "rest", "start", "overshoot", "settling");
    for (int k = 0; k < UPDATE_RATIOS; k++) {
        for (int n = 0; n < UPDATE_METHODS; n++) {
            for (int u = 0; u < UPDATES; u++) {
                const loop_result *r = &all->at[k][n][u];
                char text[16];
                fprintf(f, "  %5g  %-26s%8d  %-10s%10.3f%10.3f%10.1f%10.1f%10s\n", update_ratios[k],
                        loop_method_text[update_methods[n]], u + 1, loop_outcome_text(r->outcome),
                        r->offset_percent, r->wander_percent, r->start_percent, r->overshoot_percent,
                        settling_text(r, u, text));
            }
        }
    }
}

json_t *update_loops_json(const update_loops *all)
{
    json_t *list = json_array();
    for (int row = 0; row < UPDATE_RATIOS * UPDATE_METHODS * UPDATES && list != NULL; row++) {
        const int k = row / (UPDATE_METHODS * UPDATES);
        const int n = row / UPDATES % UPDATE_METHODS;
        const int u = row % UPDATES;
        const loop_result *r = &all->at[k][n][u];
        json_t *o = json_pack("{s:f, s:s, s:i, s:s, s:o, s:o, s:o, s:o, s:o}", "sffr", update_ratios[k],
                              "loop", loop_method_key[update_methods[n]], "updates", u + 1, "outcome",
                              loop_outcome_text(r->outcome), "wander_percent", json_number(r->wander_percent),
                              "offset_percent", json_number(r->offset_percent), "start_percent",
                              json_number(r->start_percent), "overshoot_percent",
                              json_number(r->overshoot_percent), "settling_periods",
                              r->settling_cycles < 0 ? json_null() : json_real(settling_periods(r, u)));
        list = json_appended(list, o);
    }
    return list;
}

void update_loops_part(page *p, const update_loops *all)
{
    static const char *const heads[] = {
        "\tSFFR",     "loop",           "\tupdates",          "", "\tconstant error, %", "\tnot constant, %",
        "\tstart, %", "\tovershoot, %", "\tsettling, periods"};
    page_heading(p, 2, "Two updates per carrier period");
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int k = 0; k < UPDATE_RATIOS; k++) {
        for (int n = 0; n < UPDATE_METHODS; n++) {
            for (int u = 0; u < UPDATES; u++) {
                const loop_result *r = &all->at[k][n][u];
                char text[16];
                page_row_begin(p);
                page_cell(p, true, "%g", update_ratios[k]);
                page_cell(p, false, "%s", loop_method_text[update_methods[n]]);
                page_cell(p, true, "%d", u + 1);
                page_cell(p, false, "%s", loop_outcome_text(r->outcome));
                page_cell(p, true, "%.3g", r->offset_percent);
                page_cell(p, true, "%.3g", r->wander_percent);
                page_cell(p, true, "%.3g", r->start_percent);
                page_cell(p, true, "%.3g", r->overshoot_percent);
                page_cell(p, true, "%s", settling_text(r, u, text));
                page_row_end(p);
            }
        }
    }
    page_table_end(p);
    page_note(
        p, "The carrier and the switching are the same. Errors are those of the mean over a carrier period.");
}
