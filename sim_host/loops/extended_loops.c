/* Control with nominal and with diagnosed parameters (extended_loops.h). */
#include "extended_loops.h"

#include "base/json_file.h"
#include "current_loops.h"
#include "drive/firmware_host.h"
#include "extension_host.h"

static const double speed_shares[EXTENDED_SPEEDS] = {0.02, 0.1, 0.5};
static const char *const method_text[EXTENDED_METHODS] = {"PI, mid-point sample", "deadbeat, exact",
                                                          "observer, exact"};
static const char *const belief_text[EXTENDED_BELIEFS] = {"nominal", "extended"};

static bool run(const loop_case *c, extended_method how, const motor *belief, loop_result *result, error *e)
{
    if (how == EXTENDED_PI) {
        const scenario_control control = {.feedback = FEEDBACK_MIDPOINT, .modulation = MODULATION_PWM};
        iqfoc_extension_t extension;
        return extension_from_motor(belief, &extension, e) &&
               cycle_loop_run(c, belief, &control, &extension, result, e);
    }
    return deadbeat_loop_run(c, belief, IQFOC_MODEL_EXACT, how == EXTENDED_LEARNING ? LOOP_LEARNING : 0.0,
                             true, result, e);
}

bool extended_loops_run(const motor *const belief[EXTENDED_BELIEFS], const plant_config *drive,
                        extended_loops *all, error *e)
{
    const motor *m = belief[0];
    const double rated_A = per_unit_of(m).I_A;
    for (int s = 0; s < EXTENDED_SPEEDS; s++) {
        all->rpm[s] = speed_shares[s] * m->n_max_rpm;
        const loop_case c = {.truth = *m,
                             .drive = drive,
                             .omega_e_rad_s = motor_speed_rad_s(m, all->rpm[s]),
                             .i_q_before_A = 0.3 * rated_A,
                             .i_q_after_A = 0.7 * rated_A,
                             .periods = s == 0 ? 2 : 6};
        for (int n = 0; n < EXTENDED_METHODS; n++) {
            for (int b = 0; b < EXTENDED_BELIEFS; b++) {
                if (!run(&c, (extended_method)n, belief[b], &all->at[s][n][b], e)) {
                    return false;
                }
            }
        }
    }
    return true;
}

void extended_loops_print(const extended_loops *all, FILE *stream)
{
    fprintf(stream,
            "The true drive under firmware with either motor file; error in percent of the rated peak,\n"
            "torque in percent of what was asked for\n  %8s  %-24s%-10s%10s%10s%14s%14s\n",
            "rpm", "loop", "belief", "outcome", "rms", "torque error", "torque ripple");
    for (int s = 0; s < EXTENDED_SPEEDS; s++) {
        for (int n = 0; n < EXTENDED_METHODS; n++) {
            for (int b = 0; b < EXTENDED_BELIEFS; b++) {
                const loop_result *r = &all->at[s][n][b];
                fprintf(stream, "  %8g  %-24s%-10s%10s%10.3f%14.3f%14.3f\n", all->rpm[s], method_text[n],
                        belief_text[b], loop_outcome_text(r->outcome), r->rms_percent,
                        r->torque_error_percent, r->torque_ripple_percent);
            }
        }
    }
}

json_t *extended_loops_json(const extended_loops *all)
{
    json_t *root = json_pack("{s:[]}", "extended");
    json_t *list = json_object_get(root, "extended");
    for (int s = 0; s < EXTENDED_SPEEDS; s++) {
        for (int n = 0; n < EXTENDED_METHODS; n++) {
            for (int b = 0; b < EXTENDED_BELIEFS; b++) {
                const loop_result *r = &all->at[s][n][b];
                json_t *o = json_pack(
                    "{s:f, s:s, s:s, s:s, s:o, s:o, s:o}", "rpm", all->rpm[s], "loop", method_text[n],
                    "belief", belief_text[b], "outcome", loop_outcome_text(r->outcome), "rms_percent",
                    json_number(r->rms_percent), "torque_error_percent", json_number(r->torque_error_percent),
                    "torque_ripple_percent", json_number(r->torque_ripple_percent));
                if (o == NULL || json_array_append_new(list, o) != 0) {
                    json_free(root);
                    return NULL;
                }
            }
        }
    }
    return root;
}
