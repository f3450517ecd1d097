/* A set from the fit of the whole drive (whole_drive.h). */
#include "whole_drive.h"

#include "diagnose/identify/edge_choice.h"
#include "diagnose/identify/fit.h"
#include "diagnose/identify/whole_fit.h"
#include "diagnose/weigh/evidence.h"
#include "diagnose/weigh/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a member must bring of all that is beyond the reporting thresholds, to be a cause. */
static const double SHARE_OF_CAUSE = 0.01;
/* What is certainly larger than this share of its reporting threshold is there. */
static const double SHARE_OF_MINOR = 0.15;
/* In chi square, a member and each of its numbers: odds of 0.99 against chance, as of a cause. */
static const double PAYS = 9.2;
static const double PAYS_A_NUMBER = 3.0;
/* And what a member must be worth where only several together are certain: without it the others would be wrong. */
static const double PAYS_TOGETHER = 60.0;
/* A cause whose chi square is so many times what it pays is sure without a fit that lacks it. */
static const double SURE = 30.0;
/* So many causes are replaced at most. */
enum { REPLACED_MOST = 3 };
/* The same drive by another factor has the same error but for rounding and small members: up to so much more. */
static const double AS_GOOD = 1.02;
/* By this lower a score, a search whose set is the same has ended at edges that are not the drive's. */
static const double OTHER_EDGES = 100.0;
/* Steps of the fit of a set's large members. */
enum { LARGE_STEPS = 5 };

/* What is fitted: one hypothesis or more a cause, and what was found already. */
static hypothesis_set parts_of(const session *w, hypothesis_set found)
{
    const bool map = hypotheses_hold(found, CAUSE_SATURATION_DQ);
    hypothesis_set parts = found;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        parts |= (hypothesis_in(w->possible, h) || (h == H_FALL && !map)) && hypothesis_table[h].in_whole
                     ? HYPOTHESIS_BIT(h)
                     : 0;
    }
    return parts;
}

/* The search's state with what was found, and ready for a compensation. */
static fit_state start_of(const session *w, hypothesis_set found)
{
    fit_state s = w->state;
    hypotheses_leave(s.set & ~found, s.z);
    s.set = found;
    if (!hypothesis_in(found, H_DEAD_TIME) && hypothesis_in(w->possible, H_COMPENSATED)) {
        s.set |= HYPOTHESIS_BIT(H_COMPENSATED);
        edge_of_set(&w->fitted, &s);
        s.set = found;
    }
    return s;
}

static double pays(hypothesis_id h)
{
    return PAYS + PAYS_A_NUMBER * (double)hypothesis_table[h].columns + hypothesis_table[h].surprise;
}

static double pays_of(hypothesis_set set)
{
    double sum = 0.0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        sum += hypothesis_in(set, h) ? pays(h) : 0.0;
    }
    return sum;
}

/* Whether it is there: certain by itself, or in what is certain of several together. */
static bool is_there(const whole_fit *f, hypothesis_id h)
{
    const bool large = hypothesis_size(h, f->state.z) > SHARE_OF_MINOR * hypothesis_table[h].least;
    return large && (whole_fit_certain(f, h) > pays(h) || whole_fit_needed(f, h) > PAYS_TOGETHER);
}

/* What is at least half as sure as a member: its size in thresholds, and both chi squares over what a member pays. */
static void tell_sizes(const session *w, const whole_fit *f, hypothesis_set parts)
{
    for (hypothesis_id h = 0; w->teller.trace && h < H_COUNT; h++) {
        const double certain = whole_fit_certain(f, h) / pays(h);
        if (hypothesis_in(parts, h) && (certain > 0.5 || is_there(f, h))) {
            session_trace(w, "    %-20s size %.3g, certain %.3g, needed %.3g\n", hypothesis_table[h].words,
                          hypothesis_size(h, f->state.z) / hypothesis_table[h].least, certain,
                          whole_fit_needed(f, h) / pays(h));
        }
    }
}

static void tell_scales(const session *w, const whole_fit *f)
{
    for (size_t which = 0; which < DRIVE_SCALES; which++) {
        if (f->scale[which].share > 0.01) {
            session_trace(w, "    share %.3f of the drives, by a factor %.4f:", f->scale[which].share,
                          f->scale[which].factor);
            for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
                session_trace(w, "%s%s", (which >> k & 1U) != 0 ? " " : "",
                              (which >> k & 1U) != 0 ? hypothesis_cause(hypotheses_scaled[k])->id : "");
            }
            session_trace(w, "\n");
        }
    }
}

/* The simplest hypothesis of both axes' inductance that holds what is there: a map, two inductances, or one. */
static hypothesis_set inductances_of(const session *w, const whole_fit *f, hypothesis_set found)
{
    if (hypotheses_hold(found, CAUSE_SATURATION_DQ)) {
        return found & hypotheses_of(CAUSE_SATURATION_DQ);
    }
    hypothesis_set set = 0;
    const double apart = hypothesis_size(H_SALIENCY, f->state.z);
    const bool salient =
        apart > hypothesis_table[H_SALIENCY].least && apart > 0.5 * hypothesis_size(H_BOTH_AXES, f->state.z);
    if (salient && hypothesis_in(w->possible, H_SALIENCY) && is_there(f, H_SALIENCY)) {
        set |= HYPOTHESIS_BIT(H_SALIENCY);
    } else if (hypothesis_in(w->possible, H_INDUCTANCE) && is_there(f, H_BOTH_AXES)) {
        set |= HYPOTHESIS_BIT(H_BOTH_AXES);
    }
    if (hypothesis_in(w->possible, H_SATURATION) && is_there(f, H_FALL) && f->state.z[P_SATURATION] > 0.0) {
        set |= HYPOTHESIS_BIT(H_FALL);
    }
    return set;
}

/* Of each cause the hypothesis that was found, if it is beyond its threshold, or the most needed one of those that are there. */
static hypothesis_set members_there(const session *w, const whole_fit *f, hypothesis_set found)
{
    hypothesis_set set = inductances_of(w, f, found);
    for (cause_id cause = 0; cause < CAUSE_COUNT; cause++) {
        hypothesis_id best = H_COUNT;
        double most = 0.0;
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            const hypothesis *hypo = &hypothesis_table[h];
            const bool of_both = (hypo->holds & HOLDS_INDUCTANCE) != 0 && h != H_INDUCTANCES;
            if (hypo->cause != cause || of_both || h == H_FALL || !hypothesis_in(w->possible, h)) {
                continue;
            }
            const bool own =
                hypothesis_in(found, h) && hypotheses_count(HYPOTHESIS_BIT(h), f->state.z, w->frame.of_least);
            const bool fixed = hypo->fixed == hypo->columns;
            const double need = own ? INFINITY : whole_fit_needed(f, h);
            if ((own || hypo->in_whole) && need > most && ((own && fixed) || is_there(f, h))) {
                most = need;
                best = h;
            }
        }
        set |= best < H_COUNT ? HYPOTHESIS_BIT(best) : 0;
    }
    return set;
}

/* How sure the whole drive's numbers are. */
static bool find_certainty(session *w, const whole_fit *f)
{
    certainty *c = &w->certainty;
    memset(c, 0, sizeof *c);
    c->inflation = 1.0;
    c->columns = f->columns;
    memcpy(c->column, f->column, sizeof c->column);
    return certainty_under(&w->fitted, &w->state, f->prior, f->columns, 1, c);
}

/* One fit of the whole drive, and the set that it gives with its score and error. */
typedef struct attempt {
    whole_fit fit;
    fit_state state;
    certainty certainty;
    double score, percent;
    bool explains_most;
} attempt;

/* Tries it with what was found, from w->state, which stays, and without some parts. False: out of memory. */
static bool try_with(session *w, hypothesis_set found, hypothesis_set without, attempt *a)
{
    const hypothesis_set parts = parts_of(w, found) & ~without;
    const fit_state first = w->state;
    const certainty first_certainty = w->certainty;
    const fit_state start = start_of(w, found);
    bool ok = whole_fit_find(&w->fitted, &start, parts, w->certainty.inflation, &a->fit, w->teller.trace);
    if (ok) {
        tell_sizes(w, &a->fit, parts);
        tell_scales(w, &a->fit);
        w->state = a->fit.state;
        w->state.set = members_there(w, &a->fit, found);
        a->percent = session_named_error(w, w->state.set);
        a->explains_most = session_explains_most(w, &w->state, a->percent);
        ok = find_certainty(w, &a->fit) && search_score(&w->fitted, &w->state, &a->score);
    }
    a->state = w->state;
    a->certainty = w->certainty;
    w->state = first;
    w->certainty = first_certainty;
    return ok;
}

/* What the fit without a member leaves more of -2 log posterior, both by the scatter of the one with it. */
static double more_without(const whole_fit *with, const whole_fit *without)
{
    const double scatter = without->state.objective * (1.0 / with->inflation - 1.0 / without->inflation);
    return without->goal + scatter - with->goal;
}

/* Takes the attempt that holds `more` as well, if that pays. False: out of memory. */
static bool try_more(session *w, hypothesis_set found, hypothesis_set more, attempt *best)
{
    if (more == 0) {
        return true;
    }
    attempt *with = malloc(sizeof *with);
    const bool ok = with && try_with(w, found | more, 0, with);
    if (ok && more_without(&with->fit, &best->fit) > pays_of(more)) {
        *best = *with;
    }
    free(with);
    return ok;
}

/*
 * The search may have taken a compensated dead time for a plain one, whose edges are others. If the attempt holds a compensation, it is tried
 * in the plain one's place, with edges of its own. *found: what the better one rests on.
 */
static bool try_compensated(session *w, hypothesis_set *found, attempt *best)
{
    if (!hypothesis_in(*found, H_DEAD_TIME) || !is_there(&best->fit, H_COMPENSATED)) {
        return true;
    }
    const hypothesis_set without = *found & ~HYPOTHESIS_BIT(H_DEAD_TIME);
    const bool ok = try_more(w, without, HYPOTHESIS_BIT(H_COMPENSATED), best);
    *found = without | (best->state.set & hypotheses_of(CAUSE_DEAD_TIME));
    return ok;
}

/*
 * The best one in *best. A flux map that the search found can be a saturation and two inductances that its few members could not hold:
 * without it is tried first, and the map must pay. So must an effect without a name, and if it does, the drive holds it: many small
 * causes together may else take its place.
 */
static bool try_whole(session *w, attempt *best)
{
    const hypothesis_set named = hypotheses_named(w->state.set);
    const hypothesis_set map = named & hypotheses_of(CAUSE_SATURATION_DQ);
    hypothesis_set found = named & ~map;
    return try_with(w, found, 0, best) && try_compensated(w, &found, best) && try_more(w, found, map, best) &&
           try_more(w, found | (best->state.set & map), w->state.set & ~named, best);
}

static void adopt(session *w, const attempt *a)
{
    w->state = a->state;
    w->certainty = a->certainty;
    memcpy(w->scale, a->fit.scale, sizeof w->scale);
}

/* An inductance and its fall as one saturation. */
static hypothesis_set with_saturation(hypothesis_set set)
{
    const hypothesis_set mean = HYPOTHESIS_BIT(H_INDUCTANCE) | HYPOTHESIS_BIT(H_BOTH_AXES);
    return hypothesis_in(set, H_FALL) && (set & mean) != 0
               ? (set & ~(mean | HYPOTHESIS_BIT(H_FALL))) | HYPOTHESIS_BIT(H_SATURATION)
               : set;
}

/* Its members beyond their reporting thresholds, without the others. */
static fit_state large_of(const session *w, const attempt *a)
{
    fit_state s = a->state;
    s.set = with_saturation(s.set);
    search_drop_small(&w->fitted, &s, w->possible);
    hypotheses_leave(~(hypothesis_set)0, s.z);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(s.set, h)) {
            hypothesis_copy(h, a->state.z, s.z);
        }
    }
    return s;
}

/*
 * Whether, of the drives that one factor makes of another, most have none of those off that a set has: to the search, which knows no
 * prior, the inductance and the flux fit as well as the resistance and the voltages' gain do by the inverse of the factor.
 */
static bool doubts_scale(const whole_fit *f, hypothesis_set set)
{
    size_t own = 0;
    double all = 0.0;
    double with = 0.0;
    for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
        own |= hypotheses_move_scaled(set, k) ? (size_t)1 << k : 0;
    }
    for (size_t which = 0; which < DRIVE_SCALES; which++) {
        all += f->scale[which].share;
        with += (which & own) != 0 ? f->scale[which].share : 0.0;
    }
    return own != 0 && with < 0.5 * all;
}

bool whole_drive_consider(session *w)
{
    const double percent = session_named_error(w, w->state.set);
    double score = 0.0;
    char words[256];
    attempt *best = malloc(sizeof *best);
    bool better = false;
    bool ok = best && try_whole(w, best) && search_score(&w->fitted, &w->state, &score);
    if (ok) {
        const bool other_scale = doubts_scale(&best->fit, w->state.set);
        const bool other_edges =
            hypotheses_hold(w->state.set, CAUSE_DEAD_TIME) && best->score < score - OTHER_EDGES;
        const bool is_new = (best->state.set != w->state.set || other_edges) &&
                            best->percent < (other_scale ? AS_GOOD : 1.0) * percent;
        /* A map that the whole drive does not need is there in place of other causes. */
        const bool no_map = hypotheses_hold(w->state.set, CAUSE_SATURATION_DQ) &&
                            !hypotheses_hold(best->state.set, CAUSE_SATURATION_DQ);
        better = (w->way == SESSION_WHOLE_DRIVE || is_new) && best->explains_most;
        /*
         * The whole drive holds what is small as well, and a set pays as much for that as for what is large. So the large ones alone are
         * fitted as the search fits a set. If they are its own, the two scores differ by what such fits miss.
         */
        double of_large = INFINITY;
        if (better && !no_map && !other_scale && best->score >= score) {
            fit_state large = large_of(w, best);
            const double missed = large.set == w->state.set ? fit_ranked(0.0).enough : 0.0;
            ok = fit_refine(&w->fitted, &large, LARGE_STEPS) && search_score(&w->fitted, &large, &of_large);
            better = of_large < score + missed;
        }
        session_trace(
            w, "  whole drive: %s, score %.1f, large ones %.1f (search %.1f), error %.4g %% (%.4g): %s\n",
            evidence_words(best->state.set, words, sizeof words), best->score, of_large, score, best->percent,
            percent, better ? "kept" : "not better");
    }
    if (better) {
        adopt(w, best);
        w->way = SESSION_WHOLE_DRIVE;
    }
    free(best);
    return ok;
}

/* The objective at fixed gains with a set's members cut to their reporting thresholds. */
static double cut_objective(session *w, hypothesis_set cut)
{
    fit_state s = w->state;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const double size = hypothesis_size(h, s.z);
        const double least = w->frame.of_least * hypothesis_table[h].least;
        if (hypothesis_in(cut, h) && size > least) {
            double z[P_COUNT] = {0.0};
            hypothesis_copy(h, s.z, z);
            for (size_t k = 0; k < P_COUNT; k++) {
                s.z[k] -= (1.0 - least / size) * z[k];
            }
        }
    }
    fit_noise(&w->fitted, &s);
    return isfinite(s.objective) ? s.objective : INFINITY;
}

static void divide(session *w)
{
    /* If the inductance is the motor file's at some current, its fall is all that is wrong. */
    if (!hypothesis_saturation_is_off(w->state.z, w->frame.of_least)) {
        w->state.set = with_saturation(w->state.set);
    }
    const hypothesis_set named = hypotheses_named(w->state.set);
    const double full = w->state.objective;
    const double all = cut_objective(w, named) - full;
    w->minor = w->undecided = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (!hypothesis_in(named, h)) {
            continue;
        }
        /* A dead time may be large although its compensation is not. */
        const bool large = session_is_large(w, h) || (h == H_COMPENSATED && session_is_large(w, H_DEAD_TIME));
        const double brings = cut_objective(w, HYPOTHESIS_BIT(h)) - full;
        if (!large || !(brings >= SHARE_OF_CAUSE * all)) {
            w->minor |= HYPOTHESIS_BIT(h);
        } else if (session_scale_doubt(w, h) > SESSION_SCALE_DOUBTED) {
            w->minor |= HYPOTHESIS_BIT(h);
            w->undecided |= HYPOTHESIS_BIT(h);
        }
    }
}

/*
 * A cause whose place others may take if they have a fit of their own. Where one factor scales the drive, others always do: of those
 * session_scale_doubt knows.
 */
static bool is_doubtful(const session *w, hypothesis_id h)
{
    const hypothesis *hypo = &hypothesis_table[h];
    return hypothesis_in(hypotheses_named(w->state.set) & ~w->minor, h) && !hypothesis_is_scaled(h) &&
           hypo->fixed < hypo->columns && hypo->in_whole && hypo->holds != HOLDS_INDUCTANCE &&
           certainty_chi_square(&w->certainty, &w->state, h) < SURE * pays(h);
}

/*
 * A fit of the whole drive may have ended at a cause that others replace. So the drive is fitted without each that is not
 * sure: what nothing misses is no cause, and the better fit stays. *changed: w->state is another.
 */
static bool try_without(session *w, bool *changed)
{
    const hypothesis_set named = hypotheses_named(w->state.set);
    attempt *fits = malloc(3 * sizeof *fits);
    attempt *full = fits;
    attempt *other = fits + 1;
    attempt *best = fits + 2;
    bool ok = fits != NULL;
    bool fitted = false;
    double least = -PAYS;
    *changed = false;
    for (hypothesis_id h = 0; ok && h < H_COUNT; h++) {
        if (!is_doubtful(w, h)) {
            continue;
        }
        ok = fitted || try_with(w, named, 0, full);
        fitted = true;
        const hypothesis_set without = hypotheses_of(hypothesis_table[h].cause);
        ok = ok && try_with(w, named & ~without, without, other);
        const double more = ok ? more_without(&full->fit, &other->fit) : 0.0;
        w->minor |= more < pays(h) ? HYPOTHESIS_BIT(h) : 0;
        if (ok) {
            session_trace(w, "  whole drive without %s: posterior %+.1f\n", hypothesis_table[h].words, more);
        }
        if (ok && more < least && other->explains_most) {
            least = more;
            *best = *other;
            *changed = true;
        }
    }
    if (ok && *changed) {
        adopt(w, best);
    }
    free(fits);
    return ok;
}

bool whole_drive_divide(session *w)
{
    bool changed = true;
    for (int round = 0; changed && round < REPLACED_MOST; round++) {
        divide(w);
        if (!try_without(w, &changed)) {
            return false;
        }
    }
    if (changed) {
        divide(w);
    }
    return true;
}
