/* A design as JSON (tune_report.h). */
#include "tune_report.h"

#include "base/json_file.h"

#include <math.h>

static json_t *margins_json(const tune_margins *m)
{
    return json_pack("{s:o, s:o, s:o, s:o}", "disk_margin", json_number(m->disk), "gain_margin_dB",
                     json_number(m->gain_dB), "phase_margin_deg", json_number(m->phase_deg),
                     "delay_margin_cycles", json_number(m->delay_cycles));
}

static json_t *poles_json(const tune_at_speed *at)
{
    json_t *list = json_array();
    for (int n = 0; n < at->poles; n++) {
        list = json_appended(list, json_pack("[f, f]", at->pole[n].re, at->pole[n].im));
    }
    return list;
}

static json_t *point_json(const tune_result *r, const tune_at_speed *at)
{
    json_t *o = json_pack("{s:f, s:o}", "rpm", at->rpm, "sffr", json_number(at->sffr));
    json_t *worst = margins_json(&at->worst);
    json_t *more =
        json_pack("{s:s, s:o, s:o, s:f}", "worst_machine", r->region.point[at->disk_worst].text, "nominal",
                  margins_json(&at->nominal), "poles", poles_json(at), "largest_pole", at->radius_worst);
    const bool ok = o != NULL && worst != NULL && more != NULL && json_object_update(o, worst) == 0 &&
                    json_object_update(o, more) == 0;
    json_free(worst);
    json_free(more);
    if (!ok) {
        json_free(o);
        return NULL;
    }
    return o;
}

static json_t *points_json(const tune_result *r)
{
    json_t *list = json_array();
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        list = json_appended(list, point_json(r, &r->at[s]));
    }
    return list;
}

static json_t *promise_json(const tune_promise *p)
{
    return json_pack("{s:f, s:f}", "overshoot_percent", p->overshoot_percent, "settling_cycles",
                     p->settling_cycles);
}

static json_t *trial_json(const tune_trial *t)
{
    return json_pack("{s:i, s:i, s:i, s:i, s:f, s:o, s:o, s:f, s:f, s:f}", "drives", t->drives, "unstable",
                     t->unstable, "late", t->late, "high", t->high, "rpm_most", t->rpm_most, "promised",
                     promise_json(&t->promised), "found", promise_json(&t->found), "overshoot_off_percent",
                     t->overshoot_off, "settling_off_cycles", t->settling_off, "rms_percent", t->rms_percent);
}

static json_t *loop_json(int ratio, int controller, int truth, const loop_result *l)
{
    return json_pack("{s:f, s:s, s:s, s:s, s:o, s:o, s:o, s:o}", "sffr", tune_ratios[ratio], "controller",
                     tune_controller_key[controller], "truth", tune_truth_text[truth], "outcome",
                     loop_outcome_text(l->outcome), "rms_percent", json_number(l->rms_percent),
                     "overshoot_percent", json_number(l->overshoot_percent), "settling_cycles",
                     l->outcome != LOOP_HOLDS ? json_null() : json_integer(l->settling_beside_cycles),
                     "start_percent", json_number(l->start_percent));
}

static json_t *comparison_json(const tune_comparison *c)
{
    json_t *list = json_array();
    for (int k = 0; k < TUNE_RATIOS; k++) {
        for (int n = 0; n < TUNE_CONTROLLERS; n++) {
            for (int t = 0; t < TUNE_TRUTHS && c->held[k]; t++) {
                list = json_appended(list, loop_json(k, n, t, &c->at[k][n][t]));
            }
        }
    }
    return json_pack("{s:f, s:f, s:o}", "rpm", c->rpm, "L_share", c->L_share, "loops", list);
}

static json_t *observer_points_json(const tune_observer *o)
{
    json_t *list = json_array();
    for (int s = 0; s < TUNE_OBSERVER_SPEEDS && list != NULL; s++) {
        const tune_observer_speed *at = &o->at[s];
        json_t *one =
            json_pack("{s:f, s:f, s:f, s:f, s:s, s:o, s:s, s:o, s:o}", "rpm", at->rpm, "sffr", at->sffr,
                      "disk_margin", at->disk, "disk_margin_nominal", at->disk_nominal, "worst_machine",
                      at->disk_worst, "angle_error_deg", json_number(at->angle_deg), "angle_worst_machine",
                      at->angle_worst, "angle_noise_deg", json_number(at->noise_deg), "speed_noise_percent",
                      json_number(at->speed_noise_percent));
        list = json_appended(list, one);
    }
    return list;
}

static json_t *observer_choices_json(const tune_observer *o)
{
    json_t *list = json_array();
    for (int n = 0; n < TUNE_OBSERVER_CHOICES && list != NULL; n++) {
        const tune_observer_choice *c = &o->choice[n];
        json_t *one =
            json_pack("{s:f, s:f, s:o, s:f}", "bandwidth_rad_s", c->bandwidth_rad_s, "run_up_s", c->run_up_s,
                      "angle_noise_deg", json_number(c->noise_deg), "disk_margin", c->disk);
        list = json_appended(list, one);
    }
    return list;
}

static json_t *observer_json(const tune_report *t)
{
    const tune_observer *o = &t->observer;
    const tune_observer_trial *trial = &t->observer_trial;
    if (o->none != NULL) {
        return json_null();
    }
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:b, s:o, s:o, s:{s:i, s:i, s:i, s:f, s:f, s:f}}",
                     "bandwidth_rad_s", o->bandwidth_rad_s, "gain_max", o->gain_max, "turns_min",
                     o->speed_min, "flux_max", o->flux_max, "run_up_s", o->run_up_s, "noise_A", o->noise_A,
                     "noise_measured", (int)o->noise_measured, "points", observer_points_json(o), "choices",
                     observer_choices_json(o), "trial", "drives", trial->drives, "unstable", trial->unstable,
                     "lost", trial->lost, "predicted_deg", trial->predicted_deg, "simulated_deg",
                     trial->simulated_deg, "off_deg", trial->off_deg);
}

static json_t *speed_json(const tune_speed *s)
{
    if (s->J_kgm2 == 0.0) {
        return json_null();
    }
    json_t *list = json_array();
    for (int n = 0; n < TUNE_SHAFTS && list != NULL; n++) {
        json_t *one =
            json_pack("{s:f, s:f, s:f, s:f, s:i, s:b}", "J_kgm2", tune_shafts[n] * s->J_kgm2, "overshoot_rpm",
                      s->overshoot_rpm[n], "dip_rpm", s->found_dip_rpm[n], "settled_s", s->settled_s[n],
                      "status", (int)s->status[n], "lost", (int)s->lost[n]);
        list = json_appended(list, one);
    }
    return json_pack("{s:f, s:f, s:f, s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:o}", "J_kgm2", s->J_kgm2,
                     "bandwidth_rad_s", s->bandwidth_rad_s, "tracker_rad_s", s->tracker_rad_s, "cycles",
                     s->cycles, "ramp_rpm_s", s->ramp_rpm_s, "disk_margin", s->disk, "disk_margin_nominal",
                     s->disk_nominal, "dip_rpm", s->dip_rpm, "load_share", s->load, "rpm", s->rpm, "trial",
                     list);
}

json_t *tune_report_json(const tune_report *t)
{
    const tune_result *r = &t->result;
    const tune_design *d = &r->design;
    return json_pack(
        "{s:i, s:s, s:i, s:s, s:f, s:f, s:f, s:s, s:{s:s, s:i, s:f, s:f, s:s}, s:{s:f, s:f, s:f, s:f}, "
        "s:{s:f, s:f, s:f, s:f}, s:o, s:o, s:o, s:o, s:o}",
        "schema", 1, "motor", r->motor.name, "updates", r->halves ? 2 : 1, "method",
        tune_method_text[r->method], "f_pwm_Hz", r->motor.f_pwm_Hz, "disk_margin_wanted", r->disk_wanted,
        "bandwidth_rad_s", r->bandwidth_rad_s, "limited_by", r->limited_by, "region", "source",
        r->region.source, "machines", r->region.points, "L_d_fall_percent", 100.0 * r->region.fall_d,
        "L_q_fall_percent", 100.0 * r->region.fall_q, "fall_source",
        r->region.fall_source != NULL ? r->region.fall_source : "stated tolerances", "machine", "R_ohm",
        d->machine.R_ohm, "L_d_H", d->machine.L_d_H, "L_q_H", d->machine.L_q_H, "psi_f_Wb",
        d->machine.psi_f_Wb, "controller", "keep", d->keep, "follow", d->follow, "learn", d->learn,
        "learn_offset", d->learn_offset, "points", points_json(r), "trial", trial_json(&t->trial), "observer",
        observer_json(t), "speed", speed_json(&t->speed), "comparison", comparison_json(&t->comparison));
}
