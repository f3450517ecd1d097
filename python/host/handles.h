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

iqfoc_sample_t py_sample_of(const py_sample *s);
py_command py_command_of(const drive_answer *answer);

/* Row k of a run's columns; without carrier the columns of the peak stay as they are. */
void py_run_put(const drive_row *r, double torque_Nm, bool carrier, double *const *column, size_t k);

/* A cycle, with its status after it; then the line gets its octets of that time. */
void py_recorder_take(py_recorder *r, const drive_row *row, const plant_sensors *sensors);

/* A recording called `label` that takes over all of *made, if ok; NULL, with *e set, if not, or out of memory. */
recording *py_recording_keep(recording *made, const char *label, bool ok, error *e);

/* A motor of its own, called `label`. NULL with *e set: out of memory. */
motor *py_motor_keep(const motor *m, const char *label, error *e);

#endif
