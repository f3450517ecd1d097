/*
 * Golden vectors of the control cycle, one for each predictor, feedback and control that go together, and one of
 * six-step by a timer; part of golden_vectors.h.
 */
#ifndef TESTS_TARGET_GOLDEN_CYCLE_H
#define TESTS_TARGET_GOLDEN_CYCLE_H

#include "golden_vectors.h"

/* Reports each as `cycle/PREDICTOR/FEEDBACK/CONTROL`: its digest is over all modulations, with and without what a
 * diagnosis puts right. Returns how many there are, without six-step's. */
uint32_t golden_cycle(golden_report *report);

#endif
