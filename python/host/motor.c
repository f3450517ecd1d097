/* Motor files (interface.h). A motor keeps the name that messages call it by. */
#define _XOPEN_SOURCE 700 /* strdup */

#include "data/motor.h"

#include "handles.h"

#include <stdlib.h>
#include <string.h>

motor *py_motor_keep(const motor *m, const char *label, error *e)
{
    motor *kept = malloc(sizeof *kept);
    char *name = strdup(label);
    if (kept == NULL || name == NULL) {
        free(kept);
        free(name);
        error_failure(e, 0, "%s: out of memory", label);
        return NULL;
    }
    *kept = *m;
    kept->path = name;
    return kept;
}

motor *py_motor_read(const char *path, const char *label, error *e)
{
    motor m;
    return motor_read(path, &m, e) ? py_motor_keep(&m, label != NULL ? label : path, e) : NULL;
}

bool py_motor_write(const motor *m, const char *path, const char *comment, error *e)
{
    return motor_write(path, m, comment, e);
}

void py_motor_free(motor *m)
{
    if (m != NULL) {
        free((char *)m->path); /* its own */
        free(m);
    }
}
