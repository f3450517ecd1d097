/*
 * Recordings that are parabolas: how far each coordinate lowers the objective, and where. Tests of the decisions use them in place
 * of a fit and of a look. Each test program includes it once.
 */
#ifndef TESTS_UNIT_CHOOSE_PARABOLAS_H
#define TESTS_UNIT_CHOOSE_PARABOLAS_H

#include "choose_fixture.h"

#include <string.h>

/* Those of a crowd lean on one another by so much. */
static double best[P_COUNT], less[P_COUNT];
static bool crowd[P_COUNT];
static double lean;

static inline void parabolas_none(void)
{
    memset(best, 0, sizeof best);
    memset(less, 0, sizeof less);
    memset(crowd, 0, sizeof crowd);
    lean = 0.0;
}

static inline void takes(coordinate_id id, double at, double off)
{
    best[id] = at;
    less[id] = off;
}

/* A fit: each member of the set at its minimum. */
static inline void to_bottom(fit_state *s)
{
    s->objective = WORST;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; hypothesis_in(s->set, h) && k < hypothesis_table[h].columns; k++) {
            const int c = hypothesis_table[h].column[k];
            if (c < P_COUNT) {
                s->z[c] = best[c];
                s->objective -= less[c];
            }
        }
    }
}

/* A look from a state. */
static inline void parabolas_seen(const fit_state *s, evidence_view *seen)
{
    gram *t = &seen->sums;
    t->c = WORST;
    for (size_t k = 0; k < P_COUNT; k++) {
        t->h[k][k] = less[k] > 0.0 ? less[k] / (best[k] * best[k]) : 0.0;
        t->g[k] = -t->h[k][k] * best[k];
        seen->to_nominal[k] = -s->z[k];
    }
    for (size_t k = 0; k < P_COUNT; k++) {
        for (size_t j = 0; j < k; j++) {
            t->h[k][j] = t->h[j][k] = crowd[k] && crowd[j] ? lean * sqrt(t->h[k][k] * t->h[j][j]) : 0.0;
        }
    }
    double moved[P_COUNT];
    for (size_t k = 0; k < P_COUNT; k++) {
        moved[k] = 0.0;
        for (size_t j = 0; j < P_COUNT; j++) {
            moved[k] += t->h[k][j] * s->z[j];
        }
        t->c += s->z[k] * (2.0 * t->g[k] + moved[k]);
    }
    for (size_t k = 0; k < P_COUNT; k++) {
        t->g[k] += moved[k];
    }
    seen->total = seen->sums;
}

#endif
