/* The iron's time constant, by likelihood (branch_choice.h). */
#include "branch_choice.h"

#include "gram.h"

#include <math.h>

/* Of a cycle: from what sees single pulses to what follows several cycles. */
static const double cycles[] = {0.1, 0.35, 1.0, 3.5};
enum { CYCLES = sizeof cycles / sizeof *cycles };
static const double NOMINAL_CYCLES = 0.5;

bool branch_choose(fit_data *d, fit_state *s)
{
    if (s->z[P_FE] != 0.0) {
        return true;
    }
    fit_state trial[CYCLES];
    double g[CYCLES];
    double h[CYCLES];
    for (size_t k = 0; k < CYCLES; k++) {
        trial[k] = *s;
        trial[k].z[P_TAU_FE] = log(cycles[k] / NOMINAL_CYCLES);
    }
    if (!gram_of_each(d, s, trial, CYCLES, P_FE, g, h)) {
        return false;
    }
    double best = 0.0;
    for (size_t k = 0; k < CYCLES; k++) {
        if (h[k] > 0.0 && g[k] < 0.0 && g[k] * g[k] / h[k] > best) {
            best = g[k] * g[k] / h[k];
            *s = trial[k];
        }
    }
    return true;
}
