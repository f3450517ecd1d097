/* Choice of test segments by their information (plan.h). */
#include "plan.h"

#include "base/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST_ROWS = 250 }; /* of a slot: three blocks of eighty */

typedef struct choice {
    size_t pieces;
    plan_piece piece[PLAN_PIECES];
    double (*information)[PLAN_ASKED][PLAN_ASKED]; /* of a slot of each */
    int slots[PLAN_PIECES];
    double sum[PLAN_ASKED][PLAN_ASKED];
} choice;

static void change(choice *c, size_t k, int by)
{
    c->slots[k] += by;
    for (size_t i = 0; i < PLAN_ASKED; i++) {
        for (size_t j = 0; j < PLAN_ASKED; j++) {
            c->sum[i][j] += by * c->information[k][i][j];
        }
    }
}

static size_t runs_of(const choice *c)
{
    size_t runs = 0;
    for (size_t k = 0; k < c->pieces; k++) {
        runs += c->slots[k] > 0 ? 1 : 0;
    }
    return runs;
}

/* The slot that leaves the smallest uncertainty, and that uncertainty. */
static size_t best_slot(choice *c, double *left)
{
    size_t best = 0;
    *left = INFINITY;
    for (size_t k = 0; k < c->pieces; k++) {
        if (c->slots[k] == 0 && runs_of(c) == PLAN_RUNS) {
            continue;
        }
        change(c, k, 1);
        const double now = plan_unknown(c->sum);
        change(c, k, -1);
        if (now < *left) {
            *left = now;
            best = k;
        }
    }
    return best;
}

/* Exchanges slots if that helps; true if any exchange did. */
static bool exchange(choice *c)
{
    bool any = false;
    for (size_t k = 0; k < c->pieces; k++) {
        if (c->slots[k] == 0) {
            continue;
        }
        const double before = plan_unknown(c->sum);
        double after;
        change(c, k, -1);
        const size_t other = best_slot(c, &after);
        const bool helps = after < before - 1e-9;
        change(c, helps ? other : k, 1);
        any = any || helps;
    }
    return any;
}

static void choose(choice *c)
{
    enum { ROUNDS = 8 };
    double left;
    for (int n = 0; n < PLAN_SLOTS; n++) {
        change(c, best_slot(c, &left), 1);
    }
    for (int n = 0; n < ROUNDS && exchange(c); n++) {
    }
}

/* Leaves out the segments that the drive does not follow. */
static bool inform(const motor *m, const plan_limits *limits, long cycles, long seed, choice *c, error *e)
{
    plan_information *info = calloc(1, sizeof *info);
    size_t kept = 0;
    error last = {0};
    if (info == NULL) {
        return error_failure(e, 0, "plan: out of memory");
    }
    progress shown = progress_begin("plan", (double)c->pieces, "pieces");
    bool ok = true;
    for (size_t k = 0; ok && k < c->pieces; k++) {
        scenario_run run = plan_piece_run(&c->piece[k], m, limits, cycles);
        const scenario s = plan_scenario(limits, &run, 1);
        last = (error){0};
        if (plan_information_of(m, &s, seed, info, &last)) {
            memcpy(c->information[kept], info->h, sizeof info->h);
            c->piece[kept++] = c->piece[k];
        } else if (last.status == STATUS_FAILED) {
            *e = last;
            ok = false;
        }
        progress_update(&shown, (double)(k + 1));
    }
    progress_end(&shown);
    free(info);
    c->pieces = kept;
    return ok &&
           (kept > 0 || error_input(e, m->path, 0, 0,
                                    "within these limits the drive follows no test segment: %s", last.text));
}

/* The chosen segments as runs that fill the time. */
static void settle(const choice *c, const motor *m, const plan_limits *limits, double cycles, plan *p)
{
    p->tried = c->pieces;
    const double slot = (cycles - (double)(runs_of(c) * PLAN_SETTLE_CYCLES)) / PLAN_SLOTS;
    for (size_t k = 0; k < c->pieces; k++) {
        if (c->slots[k] > 0) {
            p->piece[p->pieces] = c->piece[k];
            p->slots[p->pieces] = c->slots[k];
            p->run[p->pieces] = plan_piece_run(&c->piece[k], m, limits, lround(floor(slot * c->slots[k])));
            p->pieces++;
        }
    }
    p->scenario = plan_scenario(limits, p->run, p->pieces);
    p->seconds = plan_cycles_of(m, &p->scenario) / m->f_pwm_Hz;
}

bool plan_make(const motor *m, const plan_limits *limits, long seed, plan *p, error *e)
{
    const double cycles = limits->seconds * m->f_pwm_Hz;
    const double slot = cycles / PLAN_SLOTS - PLAN_SETTLE_CYCLES;
    memset(p, 0, sizeof *p);
    if (slot < LEAST_ROWS) {
        return error_input(e, NULL, 0, 0, "plan: --seconds %g: at %g Hz expected at least %.3g",
                           limits->seconds, m->f_pwm_Hz,
                           PLAN_SLOTS * (LEAST_ROWS + PLAN_SETTLE_CYCLES) / m->f_pwm_Hz);
    }
    choice *c = calloc(1, sizeof *c);
    if (c == NULL) {
        return error_failure(e, 0, "plan: out of memory");
    }
    c->pieces = plan_pieces_list(m, limits, c->piece);
    c->information = calloc(c->pieces + 1, sizeof *c->information);
    if (c->information == NULL) {
        free(c);
        return error_failure(e, 0, "plan: out of memory");
    }
    bool ok = inform(m, limits, lround(slot), seed, c, e);
    if (ok) {
        choose(c);
        settle(c, m, limits, cycles, p);
        ok = plan_look(m, &p->scenario, seed, &p->outlook, e);
    }
    free(c->information);
    free(c);
    return ok;
}
