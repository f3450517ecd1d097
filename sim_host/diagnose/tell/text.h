/*
 * The diagnosis as text for the terminal: verdict, causes with intervals, estimates, errors, next recording.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_TEXT_H
#define SIM_HOST_DIAGNOSE_TELL_TEXT_H

#include "diagnose/result.h"

#include <stdio.h>

void text_print(FILE *out, const diagnosis *d);

#endif
