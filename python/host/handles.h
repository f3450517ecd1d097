/* What the sources of this folder share beside interface.h. */
#ifndef PYTHON_HOST_HANDLES_H
#define PYTHON_HOST_HANDLES_H

#include "interface.h"

/* A motor of its own, called `label`. NULL with *e set: out of memory. */
motor *py_motor_keep(const motor *m, const char *label, error *e);

#endif
