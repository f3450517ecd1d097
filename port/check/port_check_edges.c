/* The porting checklist for iqfoc_hal_write_edges (port_check.h). */
#include "port_check.h"

#include <stdlib.h>

#define CYCLES 60

static uint32_t drawn(uint32_t below)
{
    static uint32_t state = 77;
    state = (uint32_t)((state * UINT64_C(1664525) + 1013904223u) & UINT32_MAX);
    return (state >> 8) % below;
}

/* The level of a leg in a tick of its cycle. */
static int level_at(const iqfoc_leg_edges_t *leg, uint32_t tick)
{
    int level = leg->level;
    for (int k = 0; k < leg->edges && leg->instant[k] <= tick; k++) {
        level = -level;
    }
    return level;
}

static iqfoc_edges_t held(const iqfoc_edges_t *before)
{
    iqfoc_edges_t edges = {.period_ticks = before->period_ticks};
    for (int x = 0; x < 3; x++) {
        edges.leg[x].level = level_at(&before->leg[x], before->period_ticks);
    }
    return edges;
}

/*
 * Watches the coming cycle, tick by tick; three tenths into it, the edges of the next one are written. An edge may be a tick late.
 * NULL: the legs are as they should be.
 */
static const char *play(const port_rig *rig, const iqfoc_edges_t *acting, const iqfoc_edges_t *next)
{
    const uint32_t period = acting->period_ticks;
    for (uint32_t t = 0; t < period; t++) {
        rig->go_to((t + 0.5) / period);
        for (int x = 0; x < 3; x++) {
            const int seen = rig->leg_high(x) ? 1 : -1;
            const int want = level_at(&acting->leg[x], t);
            const bool late = t == 0 || seen == level_at(&acting->leg[x], t - 1);
            if (seen != want && !late) {
                return port_check_wrong("leg %c is %s in tick %u of %u: instant, sense or order", "ABC"[x],
                                        seen > 0 ? "high" : "low", (unsigned)t, (unsigned)period);
            }
        }
        if (next != NULL && t == period * 3 / 10) {
            iqfoc_hal_write_edges(rig->hal, next);
        }
    }
    return NULL;
}

/* All legs low, in the cycle that comes. */
static iqfoc_edges_t begin(const port_rig *rig)
{
    const iqfoc_edges_t low = {rig->period_ticks(), {{-1, 0, {0}}, {-1, 0, {0}}, {-1, 0, {0}}}};
    rig->go_to(0.3);
    iqfoc_hal_write_edges(rig->hal, &low);
    rig->go_to(0.999);
    return low;
}

/* At distances from the least one on, also at the borders of the cycle. */
static iqfoc_edges_t drawn_edges(const iqfoc_edges_t *before, uint32_t period, uint32_t least)
{
    iqfoc_edges_t edges = {.period_ticks = period};
    for (int x = 0; x < 3; x++) {
        const iqfoc_leg_edges_t *last = &before->leg[x];
        iqfoc_leg_edges_t *leg = &edges.leg[x];
        const uint32_t since =
            last->edges == 0 ? least : before->period_ticks - last->instant[last->edges - 1];
        const uint32_t first = since < least ? least - since : 0;
        uint32_t at = drawn(3) == 0 ? first : drawn(6) == 0 ? period - 1 : first + drawn(period - first);
        const int most = drawn(4) == 0 ? 0 : drawn(3) == 0 ? IQFOC_PATTERN_EDGES_MAX : 1;
        leg->level = level_at(last, before->period_ticks);
        while (leg->edges < most && at < period) {
            leg->instant[leg->edges++] = at;
            at += least + (drawn(2) == 0 ? 0 : drawn(period / 4));
        }
    }
    return edges;
}

static const char *edges_in_time(port_rig_start *start)
{
    const port_rig *rig = start();
    iqfoc_edges_t acting = begin(rig);
    for (int n = 0; n < CYCLES; n++) {
        const iqfoc_edges_t next = drawn_edges(&acting, rig->period_ticks(), rig->edges_least);
        const char *off = play(rig, &acting, &next);
        if (off != NULL) {
            return off;
        }
        acting = next;
    }
    return NULL;
}

static const char *length(port_rig_start *start)
{
    const port_rig *rig = start();
    const uint32_t period = rig->period_ticks();
    const uint32_t lengths[4] = {period + period / 5, period - 1, period, period + period / 10 + 1};
    iqfoc_edges_t acting = begin(rig);
    for (int n = 0; n < 4; n++) {
        const iqfoc_edges_t next = drawn_edges(&acting, lengths[n], rig->edges_least + rig->edges_least / 4);
        const char *off = play(rig, &acting, &next);
        rig->go_to(0.0);
        const uint32_t valley = iqfoc_hal_now(rig->hal);
        off = off != NULL ? off : play(rig, &next, NULL);
        rig->go_to(0.0);
        const uint32_t took = (iqfoc_hal_now(rig->hal) - valley) & UINT32_MAX;
        if (off != NULL) {
            return off;
        }
        if (took != lengths[n]) {
            return port_check_wrong("a cycle of %u ticks took %u", (unsigned)lengths[n], (unsigned)took);
        }
        acting = held(&next);
    }
    return NULL;
}

static const char *levels(port_rig_start *start)
{
    const port_rig *rig = start();
    const iqfoc_edges_t low = begin(rig);
    const uint32_t period = low.period_ticks;
    const iqfoc_edges_t next = {period, {{1, 0, {0}}, {-1, 1, {period / 2}}, {1, 1, {period - 1}}}};
    const iqfoc_edges_t after = held(&next);
    const char *off = play(rig, &low, &next);
    off = off != NULL ? off : play(rig, &next, NULL);
    off = off != NULL ? off : play(rig, &after, NULL);
    return off != NULL ? off : play(rig, &after, NULL);
}

static const char *safe_output(port_rig_start *start)
{
    const iqfoc_command_t safe = {{{0, 0, 0}, IQ24_ONE}, false};
    const iqfoc_command_t half = {{{IQ24(0.5), IQ24(0.5), IQ24(0.5)}, IQ24_ONE}, true};
    const port_rig *rig = start();
    if (rig->outputs_on()) {
        return port_check_wrong("the gates are on before any command");
    }
    const iqfoc_edges_t low = begin(rig);
    const iqfoc_edges_t high = {low.period_ticks, {{1, 0, {0}}, {1, 0, {0}}, {1, 0, {0}}}};
    if (!rig->outputs_on()) {
        return port_check_wrong("edges do not bring the gates on");
    }
    rig->go_to(0.2);
    iqfoc_hal_write_edges(rig->hal, &high);
    iqfoc_hal_write(rig->hal, &safe);
    if (rig->outputs_on()) {
        return port_check_wrong("gates off must act at once");
    }
    rig->go_to(0.1);
    if (rig->outputs_on()) {
        return port_check_wrong("edges that waited bring the gates back");
    }
    iqfoc_hal_write_edges(rig->hal, &low);
    rig->go_to(0.999);
    const char *off = play(rig, &low, &high);
    rig->go_to(0.3);
    iqfoc_hal_write(rig->hal, &half);
    iqfoc_edges_t centred;
    iqfoc_edges_of_duties(half.duties.high, low.period_ticks, &centred);
    rig->go_to(0.999);
    off = off != NULL ? off : play(rig, &centred, NULL);
    return off != NULL ? off : play(rig, &centred, NULL);
}

const port_check_item port_check_edges_items[PORT_CHECK_EDGES_ITEMS] = {
    {"edges: instants, sense, order of the legs", edges_in_time},
    {"edges: length of the cycle", length},
    {"edges: none keeps the levels, another level at the valley", levels},
    {"edges: gates on, off at once; duties after them", safe_output},
};

int port_check_edges(port_rig_start *start, FILE *out)
{
    return port_check_run(port_check_edges_items, PORT_CHECK_EDGES_ITEMS, start, out);
}
