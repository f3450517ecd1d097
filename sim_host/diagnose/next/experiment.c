/* The next experiment by information (experiment.h). */
#include "experiment.h"

#include "diagnose/tell/values.h"
#include "question.h"
#include "trial.h"

#include <math.h>
#include <string.h>

/* How long it may last: the shortest that leaves nothing open. */
static const double seconds_tried[] = {0.5, 1.0, 2.0, 5.0, 10.0};
enum { LENGTHS = sizeof seconds_tried / sizeof *seconds_tried };

/* A pair's correlation counts as in a plan. */
static const double PAIR_COUNTS = 10.0;

/* Chi square by which one of a pair must lose the other's place: below 15 they are confused (weigh/confusion.c), and
 * what is expected must leave room for what comes. */
static const double APART = 60.0;

static bool is_pair(const question *q)
{
    return q->pair[0] != H_COUNT;
}

/* What is left open, in the measure that pieces are ranked by. */
static double left_open(const question *q, const answer *a)
{
    if (is_pair(q)) {
        return -2.0 * log(fmax(a->apart, 1e-300)) -
               PAIR_COUNTS * log(fmax(1.0 - a->correlation * a->correlation, 1e-12));
    }
    double sum = 0.0;
    for (size_t n = 0; n < q->numbers; n++) {
        sum += 2.0 * log(a->half_width[n] / q->enough[n]);
    }
    return sum;
}

static bool is_enough(const question *q, const answer *a)
{
    bool enough = !is_pair(q) || a->apart >= APART;
    for (size_t n = 0; n < q->numbers && !is_pair(q); n++) {
        enough = enough && a->half_width[n] <= q->enough[n];
    }
    return enough;
}

/* Puts a candidate in its place, behind those that leave as little open. */
static void insert(diagnosis_experiment *out, const diagnosis_candidate *c)
{
    size_t k = out->candidates++;
    for (; k > 0 && out->candidate[k - 1].open > c->open; k--) {
        out->candidate[k] = out->candidate[k - 1];
    }
    out->candidate[k] = *c;
}

/* Ranks the pieces at this length. True if the best one leaves nothing open. */
static bool rank(const question *q, const trial *t, double seconds, diagnosis_experiment *out)
{
    out->seconds = seconds;
    out->candidates = 0;
    for (size_t p = 0; p < t->pieces; p++) {
        answer a;
        if (!question_ask(q, (const double(*)[COLUMN_COUNT])t->h[p], seconds / q->w->rows.T_s, &a)) {
            continue;
        }
        diagnosis_candidate c = {.piece = t->piece[p],
                                 .open = left_open(q, &a),
                                 .enough = is_enough(q, &a),
                                 .correlation = a.correlation};
        memcpy(c.half_width, a.half_width, sizeof c.half_width);
        insert(out, &c);
    }
    return out->candidates > 0 && out->candidate[0].enough;
}

/* Asks the question of every piece. False if there is nothing to say. */
static bool settle(const question *q, diagnosis *d)
{
    diagnosis_experiment *out = &d->experiment;
    trial t;
    answer now;
    if (!question_ask(q, NULL, 0.0, &now) ||
        !trial_run(&t, q->w, &d->extended_motor, q->column, q->columns)) {
        return false;
    }
    bool enough = false;
    for (size_t n = 0; n < LENGTHS && !enough; n++) {
        enough = rank(q, &t, seconds_tried[n], out);
    }
    trial_free(&t);
    out->numbers = out->candidates > 0 ? q->numbers : 0;
    out->correlation = now.correlation;
    for (size_t n = 0; n < q->numbers; n++) {
        out->number[n] = (diagnosis_open){.name = q->number[n]->name,
                                          .unit = q->number[n]->unit,
                                          .value = values_at(q->w, q->number[n], 0, 0.0),
                                          .half_width = now.half_width[n]};
    }
    return out->numbers > 0;
}

/* Asks about a member of w->state and another cause. False if there is nothing to say. */
static bool tell_apart(const session *w, const evidence_view *view, hypothesis_id member, const char *other,
                       diagnosis *d)
{
    question q;
    const cause_row *row = cause_find(other);
    if (row == NULL || !question_of_pair(&q, w, view, member, (cause_id)(row - cause_table)) ||
        !settle(&q, d)) {
        return false;
    }
    d->experiment.tell[0] = hypothesis_cause(member)->id;
    d->experiment.tell[1] = other;
    return true;
}

void experiment_of_explanations(const session *w, const evidence_view *view, hypothesis_set undecided,
                                diagnosis *d)
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; hypothesis_in(undecided, h) && k < d->explanations; k++) {
            const diagnosis_explanation *e = &d->explanation[k];
            for (size_t n = 0; n < e->count; n++) {
                if (strcmp(e->id[n], hypothesis_cause(h)->id) != 0 && tell_apart(w, view, h, e->id[n], d)) {
                    return;
                }
            }
        }
    }
}

void experiment_find(const session *w, const evidence_view *view, const hypothesis_id *member, diagnosis *d)
{
    question q;
    for (size_t k = 0; k < d->causes; k++) {
        for (size_t n = 0; n < d->cause[k].confused; n++) {
            if (tell_apart(w, view, member[k], d->cause[k].confused_with[n], d)) {
                return;
            }
        }
    }
    if (question_of_estimates(&q, w, view, d)) {
        (void)settle(&q, d);
    }
}
