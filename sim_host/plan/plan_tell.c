/* A plan as text and JSON (plan_tell.h). */
#include "plan_tell.h"

#include "base/json_file.h"

#include <math.h>

/* The most visible hypothesis of a cause: a reader asks for the cause. */
static hypothesis_id best_of(const plan_outlook *o, int cause)
{
    hypothesis_id best = H_COUNT;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((int)hypothesis_cause(h)->of == cause && o->limit[h] > 0.0 &&
            (best == H_COUNT || (o->never[best] && !o->never[h]) ||
             (o->never[best] == o->never[h] && o->limit[h] < o->limit[best]))) {
            best = h;
        }
    }
    return best;
}

static const char *rival_of(const plan_outlook *o, hypothesis_id h)
{
    return o->rival[h] == H_COUNT ? "" : hypothesis_cause(o->rival[h])->id;
}

static void print_runs(const plan *p, FILE *out)
{
    for (size_t k = 0; k < p->pieces; k++) {
        const plan_piece *piece = &p->piece[k];
        fprintf(out, "  %6ld cycles  %-38s%8.0f to %6.0f rpm  i_d %6.2f to %6.2f A  i_q %6.2f to %6.2f A\n",
                p->run[k].cycles, piece->words, piece->rpm[0], piece->rpm[1], piece->i_d_A[0],
                piece->i_d_A[1], piece->i_q_A[0], piece->i_q_A[1]);
    }
}

static void print_asked(const plan_report *r, FILE *out)
{
    const plan_outlook *o = &r->plan.outlook;
    fprintf(out, "\n95 %% intervals with all others unknown, +-\n  %-20s%14s  %-8s%18s", "", "", "",
            "over threshold");
    fprintf(out, "%s\n", r->against_path != NULL ? " scenario" : "");
    for (int n = 0; n < PLAN_ASKED; n++) {
        fprintf(out, "  %-20s", plan_asked_list[n].name);
        if (o->determined[n]) {
            fprintf(out, "%14.3g  %-8.8s%18.2f", o->half_width[n], plan_asked_list[n].unit, o->over_least[n]);
        } else {
            fprintf(out, "%14s  %-8.8s%18s", "unknown", "", "-");
        }
        if (r->against_path != NULL && r->against.determined[n]) {
            fprintf(out, "%13.2f", r->against.over_least[n]);
        } else if (r->against_path != NULL) {
            fprintf(out, "%13s", "unknown");
        }
        fputc('\n', out);
    }
}

static void print_worst(const char *what, double seconds, const plan_outlook *o, FILE *out)
{
    fprintf(out, "  %-24.24s%8.3g s   median interval %.3g   worst correlation %.3f (%s, %s)\n", what,
            seconds, o->median_over_least, o->worst_correlation, plan_asked_list[o->worst[0]].name,
            plan_asked_list[o->worst[1]].name);
}

static void print_limits(const plan_outlook *o, FILE *out)
{
    fprintf(out, "\nSmallest reported size over the reporting threshold, and the closest alternative\n");
    for (int cause = 0; cause < CAUSE_COUNT; cause++) {
        const hypothesis_id h = best_of(o, cause);
        if (h == H_COUNT) {
            continue;
        }
        if (o->never[h]) {
            fprintf(out, "  %-20s%10s   %s\n", hypothesis_cause(h)->id, "never", rival_of(o, h));
        } else {
            fprintf(out, "  %-20s%10.2f   %s\n", hypothesis_cause(h)->id, o->limit[h], rival_of(o, h));
        }
    }
}

void plan_print(const plan_report *r, FILE *out)
{
    const plan *p = &r->plan;
    fprintf(out, "%s, %g Hz: %zu of %zu test segments, %.3g s\n", r->motor->name, r->motor->f_pwm_Hz,
            p->pieces, p->tried, p->seconds);
    print_runs(p, out);
    print_asked(r, out);
    fputc('\n', out);
    print_worst("this plan", p->seconds, &p->outlook, out);
    if (r->against_path != NULL) {
        print_worst(r->against_path, r->against_seconds, &r->against, out);
    }
    print_limits(&p->outlook, out);
}

/* ---- JSON ---- */

static json_t *runs_json(const plan *p)
{
    json_t *runs = json_array();
    bool ok = runs != NULL;
    for (size_t k = 0; k < p->pieces && ok; k++) {
        const plan_piece *piece = &p->piece[k];
        ok = json_array_append_new(runs,
                                   json_pack("{s:s, s:i, s:[f, f], s:[f, f], s:[f, f]}", "what", piece->words,
                                             "cycles", (int)p->run[k].cycles, "rpm", piece->rpm[0],
                                             piece->rpm[1], "i_d_A", piece->i_d_A[0], piece->i_d_A[1],
                                             "i_q_A", piece->i_q_A[0], piece->i_q_A[1])) == 0;
    }
    if (!ok) {
        json_free(runs);
        return NULL;
    }
    return runs;
}

static json_t *asked_json(const plan_outlook *o)
{
    json_t *list = json_array();
    bool ok = list != NULL;
    for (int n = 0; n < PLAN_ASKED && ok; n++) {
        const bool determined = o->determined[n];
        ok = json_array_append_new(list,
                                   json_pack("{s:s, s:s, s:o, s:o}", "name", plan_asked_list[n].name, "unit",
                                             plan_asked_list[n].unit, "half_width",
                                             json_number(determined ? o->half_width[n] : NAN), "over_least",
                                             json_number(determined ? o->over_least[n] : NAN))) == 0;
    }
    if (!ok) {
        json_free(list);
        return NULL;
    }
    return list;
}

static json_t *limits_json(const plan_outlook *o)
{
    json_t *list = json_array();
    bool ok = list != NULL;
    for (int cause = 0; cause < CAUSE_COUNT && ok; cause++) {
        const hypothesis_id h = best_of(o, cause);
        if (h != H_COUNT) {
            ok = json_array_append_new(list,
                                       json_pack("{s:s, s:o, s:s}", "cause", hypothesis_cause(h)->id,
                                                 "over_least", json_number(o->never[h] ? NAN : o->limit[h]),
                                                 "rival", rival_of(o, h))) == 0;
        }
    }
    if (!ok) {
        json_free(list);
        return NULL;
    }
    return list;
}

static json_t *outlook_json(const plan_outlook *o, double seconds)
{
    return json_pack("{s:f, s:f, s:f, s:[s, s], s:o, s:o}", "seconds", seconds, "median_over_least",
                     o->median_over_least, "worst_correlation", o->worst_correlation, "worst_pair",
                     plan_asked_list[o->worst[0]].name, plan_asked_list[o->worst[1]].name, "parameters",
                     asked_json(o), "causes", limits_json(o));
}

json_t *plan_json(const plan_report *r)
{
    json_t *against = r->against_path != NULL ? outlook_json(&r->against, r->against_seconds) : json_null();
    return json_pack("{s:i, s:s, s:f, s:o, s:o, s:o}", "schema", 1, "motor", r->motor->name, "f_pwm_Hz",
                     r->motor->f_pwm_Hz, "runs", runs_json(&r->plan), "plan",
                     outlook_json(&r->plan.outlook, r->plan.seconds), "against", against);
}
