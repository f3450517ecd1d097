/* The study as JSON (loops_study.h). */
#include "loops_study.h"

#include "base/json_file.h"
#include "run_up_show.h"

static json_t *result_json(const loop_result *r)
{
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "outcome",
                     loop_outcome_text(r->outcome), "rms_percent", json_number(r->rms_percent),
                     "offset_percent", json_number(r->offset_percent), "wander_percent",
                     json_number(r->wander_percent), "i_d_offset_percent", json_number(r->i_d_offset_percent),
                     "i_q_offset_percent", json_number(r->i_q_offset_percent), "overshoot_percent",
                     json_number(r->overshoot_percent), "settling_cycles",
                     r->settling_cycles < 0 ? json_null() : json_integer(r->settling_cycles), "start_percent",
                     json_number(r->start_percent), "thd_percent", json_number(r->thd_percent),
                     "switching_Hz", json_number(r->switching_Hz));
}

/* Takes both references: the members of `more` go into `object`, and that into the list. */
static bool append(json_t *list, json_t *object, json_t *more)
{
    const bool ok = object != NULL && more != NULL && json_object_update(object, more) == 0;
    json_free(more);
    if (!ok) {
        json_free(object);
        return false;
    }
    return json_array_append_new(list, object) == 0;
}

static bool add_six_step(json_t *list, const loops_study *s)
{
    bool ok = true;
    for (int n = 0; n < SIX_STEP_LOOPS && ok; n++) {
        const six_step_loop *l = &s->six_step[n];
        json_t *o = json_pack("{s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "feedback", six_step_loop_text[n],
                              "i_q_reference_A", l->reference_A, "i_q_fed_back_A", l->i_q_fed_back_A, "i_q_A",
                              l->i_q_A, "i_d_A", l->i_d_A, "excess_percent", six_step_excess_percent(l),
                              "torque_Nm", l->torque_Nm, "torque_reference_Nm", l->torque_reference_Nm);
        ok = o != NULL && json_array_append_new(list, o) == 0;
    }
    return ok;
}

static bool add_current(json_t *list, const current_loops *all)
{
    bool ok = true;
    for (int k = 0; k < LOOP_RATIOS; k++) {
        for (int n = 0; n < LOOP_METHODS && ok; n++) {
            for (int b = 0; b <= LOOP_BELIEFS && ok; b++) {
                const bool noisy = b == LOOP_BELIEFS;
                json_t *o =
                    json_pack("{s:f, s:s, s:s, s:f}", "sffr", loop_ratios[k], "loop", loop_method_key[n],
                              "belief", noisy ? "noise" : loop_beliefs[b].key, "L_most", all->L_most[k][n]);
                ok = append(list, o, result_json(noisy ? &all->noisy[k][n] : &all->at[k][b][n]));
            }
        }
    }
    return ok;
}

static json_t *point_json(double ratio, const char *predictor, int horizon, double weight, double nodes)
{
    return json_pack("{s:f, s:s, s:i, s:f, s:f}", "intervals", ratio, "predictor", predictor, "horizon",
                     horizon, "weight", weight, "nodes", nodes);
}

static bool add_finite_set(json_t *list, const finite_set_loops *all)
{
    bool ok = true;
    for (int k = 0; k < FINITE_SET_RATIOS; k++) {
        for (int p = 0; p < FINITE_SET_PREDICTORS; p++) {
            for (int h = 0; h < IQFOC_FINITE_SET_HORIZON && ok; h++) {
                const finite_set_point *at = &all->at[k][p][h];
                json_t *o = point_json(finite_set_ratios[k], loop_model_text[p], h + 1, 0.0, at->nodes);
                ok = append(list, o, result_json(&at->loop));
            }
        }
    }
    return ok;
}

static bool add_trade(json_t *list, const finite_set_loops *all)
{
    bool ok = true;
    for (int w = 0; w < FINITE_SET_WEIGHTS; w++) {
        for (int h = 0; h < IQFOC_FINITE_SET_HORIZON && ok; h++) {
            const finite_set_point *at = &all->trade[h][w];
            json_t *o = point_json(FINITE_SET_TRADE_RATIO, "exact", h + 1, finite_set_weights[w], at->nodes);
            ok = append(list, o, result_json(&at->loop));
        }
        if (ok && all->pwm_ratio[w] > 0.0) {
            json_t *o =
                point_json(all->pwm_ratio[w], "exact, deadbeat with PWM", 0, finite_set_weights[w], 0);
            ok = append(list, o, result_json(&all->pwm[w]));
        }
    }
    return ok;
}

json_t *loops_study_json(const loops_study *s)
{
    json_t *root =
        json_pack("{s:I, s:[], s:[], s:[], s:[], s:o*, s:o*, s:o*, s:o*}", "seed", (json_int_t)LOOP_SEED,
                  "six_step", "current", "finite_set", "finite_set_trade", "run_up", run_ups_json(s->run_ups),
                  "updates", update_loops_json(&s->updates), "corrected_mean",
                  corrected_loops_json(&s->corrected), "sensorless", sensorless_loops_json(&s->sensorless));
    if (root == NULL || !add_six_step(json_object_get(root, "six_step"), s) ||
        !add_current(json_object_get(root, "current"), &s->current) ||
        !add_finite_set(json_object_get(root, "finite_set"), &s->finite_set) ||
        !add_trade(json_object_get(root, "finite_set_trade"), &s->finite_set)) {
        json_free(root);
        return NULL;
    }
    return root;
}
