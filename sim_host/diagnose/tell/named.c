/* The named causes in order (named.h). */
#include "named.h"

#include "diagnose/measure/errors.h"
#include "plain_knee.h"
#include "values.h"

#include <math.h>
#include <string.h>

void named_tell(const session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES])
{
    double z[P_COUNT] = {0};
    /* Of the rows as they were mended: what that gained is told apart. */
    double before = measure_one_cycle(&w->rows, &d->nominal_drive, MEASURE_ALL, true);
    hypothesis_set left = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        left |= hypothesis_cause(h)->named ? w->state.set & HYPOTHESIS_BIT(h) : 0;
    }
    while (left && d->causes < DIAGNOSIS_CAUSES) {
        double best = INFINITY;
        hypothesis_id chosen = H_COUNT;
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            if (left & HYPOTHESIS_BIT(h)) {
                double trial[P_COUNT];
                memcpy(trial, z, sizeof trial);
                session_adopt(w, h, trial);
                averaged_drive drive = session_drive(w, trial);
                double after = measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true);
                if (after < best) {
                    best = after;
                    chosen = h;
                }
            }
        }
        diagnosis_cause *cause = &d->cause[d->causes];
        values_tell(w, chosen, cause);
        cause->certainty = certainty_chi_square(&w->certainty, &w->state, chosen);
        cause->gain = best > 0.0 ? before / best : 1.0;
        member[d->causes++] = chosen;
        session_adopt(w, chosen, z);
        before = best;
        left &= ~HYPOTHESIS_BIT(chosen);
    }
    /* The extended model holds what was named and nothing else; it is written with the firmware's plain law
     * of dead time. */
    z[P_OFFSET_ZERO] = w->state.z[P_OFFSET_ZERO];
    d->extended_drive = session_drive(w, z);
    averaged_drive plain = d->extended_drive;
    if (z[P_V_DEAD] != 0.0) {
        plain.i_knee_A = plain_knee_A(&plain, &w->rows, w->frame.i_rated_peak_A);
    }
    d->extended_motor = averaged_drive_motor(&plain, &d->extended_motor);
}
