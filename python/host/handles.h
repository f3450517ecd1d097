/* Declarations that the sources of this folder share, besides interface.h. */
#ifndef PYTHON_HOST_HANDLES_H
#define PYTHON_HOST_HANDLES_H

#include "drive/drive_loop.h"
#include "interface.h"

struct py_plant {
    drive_loop loop;
};

/* What Python's controllers have in common: the first member of each. */
struct py_firmware {
    drive_firmware calls;
    drive_answer answer; /* the last one */
    iqfoc_dq_t i_ref;    /* per unit */
    iq24_t
        output_mid; /* of the peak's call: middle of the time in which its command acts, cycles after the valley */
};

/* The answer before the first peak: equal duties. */
void py_firmware_begin(py_firmware *f, drive_firmware calls);

/* A motor of its own, called `label`. NULL with *e set: out of memory. */
motor *py_motor_keep(const motor *m, const char *label, error *e);

#endif
