/* Start value of the iron's time constant, by likelihood (branch_choice.h). */
#include "branch_choice.h"

#include "gram.h"
#include "model/iron_branch.h"

#include <math.h>
#include <stdlib.h>

/* Time constants that are tried, in cycles: the shortest follows single pulses, the longest lasts several cycles. */
static const double cycles[] = {0.1, 0.35, 1.0, 3.5};
static const double NOMINAL_CYCLES = 0.5;

/* The state without the other hypotheses of iron loss. With them, the time constant would be chosen for their residual. */
static fit_state without_stand_ins(const fit_state *s)
{
    fit_state out = *s;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (h != H_IRON_LOSS && (hypothesis_table[h].holds & hypothesis_table[H_IRON_LOSS].holds) != 0) {
            hypothesis_copy(h, hypothesis_nominal, out.z);
        }
    }
    return out;
}

bool branch_choose(fit_data *d, fit_state *s)
{
    const averaged_drive is = fit_drive(d, s);
    const bool none = !iron_branch_present(&is);
    double best = 0.0;
    double chosen = s->z[P_TAU_FE];
    fit_state trial = without_stand_ins(s);
    for (size_t k = 0; none && k < sizeof cycles / sizeof *cycles; k++) {
        const int column[] = {P_FE};
        trial.z[P_TAU_FE] = log(cycles[k] / NOMINAL_CYCLES);
        gram *grams = gram_blocks(d, &trial, column, 1);
        if (!grams) {
            return false;
        }
        double g = 0.0;
        double h = 0.0;
        for (size_t b = 0; b < d->blocks; b++) {
            g += grams[b].g[0];
            h += grams[b].h[0][0];
        }
        free(grams);
        if (h > 0.0 && g < 0.0 && g * g / h > best) {
            best = g * g / h;
            chosen = trial.z[P_TAU_FE];
        }
    }
    s->z[P_TAU_FE] = chosen;
    return true;
}
