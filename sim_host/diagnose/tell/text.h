/*
 * The diagnosis as the terminal shows it.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_TEXT_H
#define SIM_HOST_DIAGNOSE_TELL_TEXT_H

#include "diagnose/result.h"

#include <stdio.h>

void text_print(FILE *out, const diagnosis *d);

#endif
