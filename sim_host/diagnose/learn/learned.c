/* What is left as a few terms of the dictionary, measured on held-out rows (learned.h). */
#include "learned.h"

#include "cycles.h"
#include "diagnose/measure/errors.h"
#include "terms.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)TERMS_MOST == (int)DIAGNOSIS_LEARNED, "a place for each term");

/* Of more fitted rows evenly spread blocks are learned from. */
enum { LEARN_ROWS = 12000, LEAST_ROWS = 12 /* of a point of the curve */ };

/* The held-out error must fall to this share at least. */
static const double KEPT = 0.97;

typedef struct workshop {
    learn_model model;
    vec_ab *wrong;
    learn_left *left;
    terms_sums *group, all;
} workshop;

static size_t longest_block(const diagnose_rows *r)
{
    size_t longest = 1;
    for (size_t b = 0; b < r->blocks; b++) {
        longest = r->block[b].count > longest ? r->block[b].count : longest;
    }
    return longest;
}

static void gather(workshop *w)
{
    const diagnose_rows *r = w->model.rows;
    size_t rows = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        rows += r->block[b].held_out ? 0 : r->block[b].count;
    }
    const size_t every = 1 + rows / LEARN_ROWS;
    size_t fitted = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        if (r->block[b].held_out || fitted++ % every != 0) {
            continue;
        }
        const size_t n = cycles_of(&w->model, &r->block[b], w->wrong, w->left);
        for (size_t j = 0; j < n; j++) {
            if (!w->left[j].glitch) {
                double entry[ENTRIES];
                dictionary_at(&w->left[j].cycle, entry);
                terms_add(&w->group[r->block[b].group], entry, w->left[j].v_V);
                terms_add(&w->all, entry, w->left[j].v_V);
            }
        }
    }
}

/* Over the held-out rows: errors without and with the terms, and the strongest term's axis from end to end. */
typedef struct measured {
    double rows, nominal, extended; /* sums of squares */
    double low, high;
} measured;

static void add_point(diagnosis_learned *found, const measured *m, double at, double over, double left,
                      double learned)
{
    const double share = (at - m->low) / (m->high - m->low);
    if (share >= 0.0 && share <= 1.0) {
        const size_t n = (size_t)fmin(share * DIAGNOSIS_LEARNED_POINTS, DIAGNOSIS_LEARNED_POINTS - 1.0);
        diagnosis_learned_point *p = &found->point[n];
        p->x += at;
        p->left += over * left;
        p->learned += over * learned;
        p->weight += over * over;
        p->rows++;
    }
}

/* Twice: for the sums and the axis' ends, then, with these, for the curve. */
static void measure(workshop *w, const terms_chosen *t, measured *m, diagnosis_learned *curve)
{
    const diagnose_rows *r = w->model.rows;
    for (size_t b = 0; b < r->blocks; b++) {
        const size_t n = r->block[b].held_out ? cycles_of(&w->model, &r->block[b], w->wrong, w->left) : 0;
        for (size_t j = 0; j < n; j++) {
            const learn_left *left = &w->left[j];
            double entry[ENTRIES];
            double over;
            dictionary_at(&left->cycle, entry);
            const vec_dq v = terms_voltage(t, entry);
            const double at = dictionary_place(t->strongest_entry, &left->cycle, &over);
            if (curve != NULL) {
                const bool q = t->strongest_axis == 1;
                add_point(curve, m, at, over, q ? left->v_V.q : left->v_V.d, q ? v.q : v.d);
                continue;
            }
            const vec_ab by = cycles_error(&w->model, left, v);
            const vec_ab rest = {left->wrong_A.alpha - by.alpha, left->wrong_A.beta - by.beta};
            m->low = m->rows == 0.0 ? at : fmin(m->low, at);
            m->high = m->rows == 0.0 ? at : fmax(m->high, at);
            m->rows += 1.0;
            m->nominal += left->wrong_A.alpha * left->wrong_A.alpha + left->wrong_A.beta * left->wrong_A.beta;
            m->extended += rest.alpha * rest.alpha + rest.beta * rest.beta;
        }
    }
}

static void finish_curve(diagnosis_learned *found)
{
    size_t used = 0;
    for (size_t n = 0; n < DIAGNOSIS_LEARNED_POINTS; n++) {
        diagnosis_learned_point p = found->point[n];
        if (p.rows >= LEAST_ROWS && p.weight > 0.0) {
            p.x /= (double)p.rows;
            p.left /= p.weight;
            p.learned /= p.weight;
            found->point[used++] = p;
        }
    }
    found->points = used;
}

/* Orders have a cosine and a sine, and an entry may act along both axes: each is said once. */
static void say_what_it_depends_on(const terms_chosen *t, diagnosis_learned *found)
{
    char said[TERMS_MOST][80];
    size_t count = 0;
    for (size_t a = 0; a < 2; a++) {
        for (size_t i = 0; i < t->count[a]; i++) {
            bool again = false;
            dictionary_words(t->entry[a][i], said[count], sizeof said[count]);
            for (size_t k = 0; k < count; k++) {
                again = again || strcmp(said[k], said[count]) == 0;
            }
            count += again ? 0 : 1;
        }
    }
    size_t used = (size_t)snprintf(found->words, sizeof found->words, "what is left depends on ");
    for (size_t k = 0; k < count; k++) {
        used += (size_t)snprintf(found->words + used, sizeof found->words - used, "%s%s",
                                 k == 0 ? "" : (k + 1 == count ? " and " : ", "), said[k]);
    }
}

static void tell(const terms_chosen *t, diagnosis_learned *found)
{
    double over;
    for (size_t a = 0; a < 2; a++) {
        for (size_t i = 0; i < t->count[a]; i++) {
            diagnosis_learned_term *term = &found->term[found->terms++];
            char name[40];
            dictionary_name(t->entry[a][i], name, sizeof name);
            snprintf(term->name, sizeof term->name, "v_%s: %s", a == 0 ? "d" : "q", name);
            snprintf(term->unit, sizeof term->unit, "%s", dictionary_unit(t->entry[a][i]));
            term->value = t->value[a][i];
        }
    }
    say_what_it_depends_on(t, found);
    (void)dictionary_place(t->strongest_entry, &(learn_cycle){.omega_rad_s = 0.0}, &over);
    snprintf(found->axis, sizeof found->axis, "%s", dictionary_axis(t->strongest_entry));
    snprintf(found->voltage, sizeof found->voltage, "v_%s%s", t->strongest_axis == 0 ? "d" : "q",
             over == 0.0 ? " per speed, V s" : ", V");
    found->turns = dictionary_turns(t->strongest_entry);
}

static void learn(workshop *w, diagnosis *d)
{
    gather(w);
    const terms_chosen t = terms_choose(w->group, w->model.rows->groups, &w->all);
    if (t.count[0] + t.count[1] == 0) {
        return;
    }
    measured m = {.rows = 0.0};
    measure(w, &t, &m, NULL);
    const double current = measure_current(w->model.rows, MEASURE_ALL, true);
    if (!(m.rows > 0.0 && current > 0.0 && sqrt(m.extended) <= KEPT * sqrt(m.nominal))) {
        return;
    }
    diagnosis_learned *found = &d->learned;
    found->nominal = 100.0 * sqrt(m.nominal / m.rows) / current;
    found->extended = 100.0 * sqrt(m.extended / m.rows) / current;
    found->gain = sqrt(m.nominal / m.extended);
    tell(&t, found);
    if (m.high > m.low) {
        measure(w, &t, &m, found);
    }
    finish_curve(found);
}

bool learned_find(const diagnose_rows *r, diagnosis *d)
{
    const size_t longest = longest_block(r);
    workshop *w = calloc(1, sizeof *w);
    averaged_node *nodes = rows_nodes(r, &d->extended_drive);
    bool good = w && nodes;
    d->learned = (diagnosis_learned){.terms = 0};
    if (good) {
        w->model = (learn_model){r, &d->extended_drive, nodes, d->extended_motor.pole_pairs};
        w->wrong = calloc(longest + 1, sizeof *w->wrong);
        w->left = calloc(longest, sizeof *w->left);
        w->group = calloc(r->groups, sizeof *w->group);
        good = w->wrong && w->left && w->group;
        if (good) {
            learn(w, d);
        }
        free(w->wrong);
        free(w->left);
        free(w->group);
    }
    free(nodes);
    free(w);
    return good;
}
