/* The observer of angle and speed without a sensor, over the rows of a recording or of a simulation. */
#include "data/motor.h"
#include "extension_host.h"
#include "interface.h"

#include <stdlib.h>

struct py_observer {
    iqfoc_observer_config_t config;
    iqfoc_observer_t observer;
};

py_observer *py_observer_new(const motor *m, error *e)
{
    py_observer *p = calloc(1, sizeof *p);
    if (p == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    if (!observer_from_motor(m, &p->config, e)) {
        free(p);
        return NULL;
    }
    (void)iqfoc_observer_init(&p->observer, &p->config); /* checked before */
    return p;
}

void py_observer_free(py_observer *p)
{
    free(p);
}

void py_observer_start(py_observer *p, const int32_t *i_ab, int32_t theta, int32_t speed, bool known)
{
    const iqfoc_ab_t i = {i_ab[0], i_ab[1]};
    iqfoc_observer_start(&p->observer, i, theta, speed, known);
}

void py_observer_steps(py_observer *p, size_t n, const int32_t *const *in, int32_t *const *out)
{
    for (size_t k = 0; k < n; k++) {
        const iqfoc_ab_t u = {in[0][k], in[1][k]};
        const iqfoc_ab_t i_mean = {in[2][k], in[3][k]};
        const iqfoc_ab_t i = {in[4][k], in[5][k]};
        iqfoc_observer_step(&p->observer, u, i_mean, i);
        out[0][k] = iqfoc_observer_theta(&p->observer, 0);
        out[1][k] = iqfoc_observer_speed(&p->observer);
        out[2][k] = p->observer.locked ? 1 : 0;
    }
}

uint32_t py_observer_lost(const py_observer *p)
{
    return p->observer.status;
}
