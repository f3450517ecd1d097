/*
 * Causes that no fit of the averaged drive finds: the columns tell them by themselves (a speed that is late against the angle, a
 * sensor that breaks the sum of three), or the rows one by one (missed updates, a ripple of the link). The rows are given what
 * was true, so that the search sees what else is wrong; those as recorded are kept, for what the mending gains.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_MENDED_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_MENDED_H

#include "rows.h"

/* Whether it says more than the motor file does: a value there lies outside its interval. */
bool mended_is_news(const row_mend *found, const motor *file);

/* Of what is news the rows are kept as they are now; call it before they are changed. False: out of memory. */
bool mended_keep(diagnose_rows *r, const row_mend *found, const motor *file);

/* The rows with the first n of r->mend; borrows all of r. None: as recorded, but for what the motor file knows. */
diagnose_rows mended_rows(const diagnose_rows *r, size_t n);

#endif
