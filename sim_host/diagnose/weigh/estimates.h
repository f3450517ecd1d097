/*
 * What the recording says of a coordinate whether it is named or not: its value with everything else within its tolerance, and
 * how sure, or that the recording does not excite it.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_ESTIMATES_H
#define SIM_HOST_DIAGNOSE_WEIGH_ESTIMATES_H

#include "evidence.h"

typedef struct estimate {
    double z, half_width; /* 95 % */
    bool excited;         /* a hundred rows would tell it better than what drives show anyhow (`usual`) */
} estimate;

/* By the information in the sums of a view at the state: the members and the coordinate free, the others with the prior of their
 * tolerance. */
estimate estimate_of(const fit_data *d, const evidence_view *view, const fit_state *s, coordinate_id id,
                     double inflation);

#endif
