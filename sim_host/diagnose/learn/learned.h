/*
 * What has no name is modelled too: a few terms of a stated dictionary (dictionary.h), fitted to what the extended
 * drive leaves on the fitted blocks and measured on the others. Nothing is named by it.
 */
#ifndef SIM_HOST_DIAGNOSE_LEARN_LEARNED_H
#define SIM_HOST_DIAGNOSE_LEARN_LEARNED_H

#include "diagnose/identify/rows.h"
#include "diagnose/result.h"

/* Fills d->learned; without terms where the held-out error would not fall by 3 %. The drive is d->extended_drive.
 * False: out of memory. */
bool learned_find(const diagnose_rows *r, diagnosis *d);

#endif
