/*
 * What the named effects leave above the noise, as a share of what they explain.
 *
 * With the right model the innovations are white. A cause in the place of an effect of another shape leaves the difference of the two: of
 * a short between turns an iron loss takes the half that is alike in all phases, and an equal half turns the other way. The innovations
 * of each operating point are therefore fitted by vectors that turn with the electrical angle, of orders -12 to 12 in the stationary
 * frame. White noise alone is worth one in chi square for each number of that fit, and two standard deviations more are allowed for.
 * Where an effect is small, the noise of so many orders would cover what is left. So -3 to 3 are fitted alone as well: to these, the
 * saliency of the rotor takes what turns backwards once.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_DISCREPANCY_H
#define SIM_HOST_DIAGNOSE_WEIGH_DISCREPANCY_H

#include "diagnose/identify/fit_data.h"

/*
 * The chi square of that fit at a state, above the noise, over the one by which the drive reduces what the nominal drive leaves on the
 * rows `from`, by the filter and the noise of the state. 0 if it reduces nothing. Notes d->rows->no_memory if memory runs out.
 */
double discrepancy_share(fit_data *d, const fit_state *s, const averaged_drive *drive,
                         const diagnose_rows *from);

#endif
