/*
 * Causes and small deviations from a fit of the whole drive.
 *
 * A sparse search looks for a few causes in a drive that is exact otherwise. On a bench everything is a little off: then the
 * search leaves something, or takes one thing for another. So the whole drive is fitted (identify/whole_fit.h). Every hypothesis
 * whose numbers are certain there joins one set, small or large, and that set is fitted. It replaces the search's set if it is the better
 * one by the same score. Its members are then divided: a cause is certainly larger than its reporting threshold, and brings a stated
 * share of what all members bring. The rest are minor: fitted, with intervals, and in the extended motor file.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_WHOLE_DRIVE_H
#define SIM_HOST_DIAGNOSE_CHOOSE_WHOLE_DRIVE_H

#include "diagnose/session.h"

/* Tries the whole drive's set in place of that of w->state. Where that is one of the whole drive, rows have changed, and it need only
 * explain most. False: out of memory. */
bool whole_drive_consider(session *w);

/*
 * Divides the members of w->state into causes and w->minor. Of these, w->undecided gets those that another factor on the drive leaves
 * small. A cause that is not sure is tested by a fit without it: it is minor if that fit is as good, and leaves w->state if it is better.
 * False: out of memory.
 */
bool whole_drive_divide(session *w);

#endif
