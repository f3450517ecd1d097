/*
 * The effects of a real drive, fitted together.
 *
 * A search that adds causes one by one needs a start at which one of them shows. On a real bench none does: the angle is off, its
 * sensor is eccentric, R, L and psi are another motor's, and an uncompensated dead time covers all of it. The reduction by each
 * alone is small and biased, and a free inductance or a flux map takes up the rest. So these are fitted all at once, in the order
 * in which one lets the next be seen:
 *
 *     angle offset  ->  R, L_d, L_q, psi_f  ->  orders 1 and 2 of the angle's error  ->  dead time  ->  sensors, EMF
 *
 * Then members leave, one by one, as long as the refitted rest keeps the held-out and the open-loop error within 2 %. A member that
 * is smaller than its reporting threshold, or has a value at a physical bound, leaves anyway.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_LIKELY_DRIVE_H
#define SIM_HOST_DIAGNOSE_CHOOSE_LIKELY_DRIVE_H

#include "diagnose/session.h"

/*
 * If w->state leaves more than the verdict allows: fits these effects, and takes them in place of w->state if they explain most of
 * the motor file's error, and reduce the error of w->state, effects without a name included, by a tenth. If w->state is of a fit of the
 * whole drive (whole_drive.h) already, an error that is at most 2 % larger is enough, and an open-loop error that is at
 * most a tenth larger, as these effects are the likelier ones. w->way says if they were taken. False: out of memory.
 */
bool likely_drive_fit(session *w);

#endif
