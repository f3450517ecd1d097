/*
 * The diagnosis in words: the one sentence that leads, and the table for the terminal.
 */
#ifndef SIM_HOST_DIAGNOSE_DIAGNOSE_TEXT_H
#define SIM_HOST_DIAGNOSE_DIAGNOSE_TEXT_H

#include "diagnose_result.h"

#include <stdio.h>

/* Fills d->sentence. */
void diagnose_sentence(diagnosis *d);

void diagnose_print(FILE *out, const diagnosis *d, const char *recording_path, const char *motor_path);

#endif
