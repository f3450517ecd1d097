/* A machine's one-cycle predictions and means, in the firmware's arithmetic, by each of the library's methods. */
#include "data/motor.h"
#include "extension_host.h"
#include "interface.h"

#include "iqfoc/iqfoc.h"

#include <stdlib.h>
#include <string.h>

struct py_machine {
    iqfoc_predictor_t predictor;
    iqfoc_exact_law_t exact, exact_mean;
    iqfoc_salient_machine_t salient;
    iqfoc_flux_predictor_t flux;
    iqfoc_flux_map_t flux_map;
    iqfoc_extension_t acting; /* what the motor file's extensions make of the voltage */
};

/* One row: the current at the start, the voltage of the cycle, the angle at its start, the speed. */
typedef struct row {
    iqfoc_ab_t i, u;
    iq24_t theta, speed;
    iqfoc_rotor_t rotor;
    iq24_sincos_t start, middle;
} row;

static iqfoc_ab_t euler(const py_machine *p, const row *r)
{
    return iqfoc_predictor_euler(&p->predictor, r->i, r->u, &r->rotor, r->start);
}

static iqfoc_ab_t quasi_discrete(const py_machine *p, const row *r)
{
    return iqfoc_predictor_quasi_discrete(&p->predictor, r->i, r->u, &r->rotor, r->middle);
}

static iqfoc_ab_t quasi_discrete_mean(const py_machine *p, const row *r)
{
    return iqfoc_mean_current_quasi_discrete(&p->predictor, r->i, r->u, &r->rotor, r->middle);
}

static iqfoc_ab_t exact(const py_machine *p, const row *r)
{
    const iqfoc_exact_t law = iqfoc_exact_at_speed(&p->exact, r->speed);
    return iqfoc_exact_step(&law, r->i, r->u, r->middle);
}

static iqfoc_ab_t exact_mean(const py_machine *p, const row *r)
{
    const iqfoc_exact_t law = iqfoc_exact_at_speed(&p->exact_mean, r->speed);
    return iqfoc_exact_step(&law, r->i, r->u, r->middle);
}

/* In the rotor frame: what it gives is turned by the angle that it is seen from, at the end or in the middle. */
static iqfoc_ab_t by_salient(const py_machine *p, const row *r, bool mean)
{
    iqfoc_salient_t end;
    iqfoc_salient_t middle;
    iqfoc_salient_at_speed(&p->salient, r->speed, IQ24_ONE, &end, &middle);
    const iqfoc_dq_t i = iqfoc_park(r->i, r->start);
    const iqfoc_dq_t u = iqfoc_park(r->u, r->start);
    const iqfoc_dq_t next = iqfoc_salient_step(mean ? &middle : &end, i, u);
    return iqfoc_park_inverse(next, mean ? r->middle : iq24_sincos(iq24_add_wrap(r->theta, r->rotor.speed)));
}

static iqfoc_ab_t salient(const py_machine *p, const row *r)
{
    return by_salient(p, r, false);
}

static iqfoc_ab_t salient_mean(const py_machine *p, const row *r)
{
    return by_salient(p, r, true);
}

static iqfoc_ab_t flux(const py_machine *p, const row *r)
{
    return iqfoc_flux_predictor_step(&p->flux, &p->acting, r->i, r->u, r->start,
                                     iq24_sincos(iq24_add_wrap(r->theta, r->rotor.speed)));
}

static iqfoc_ab_t flux_map(const py_machine *p, const row *r)
{
    return iqfoc_flux_map_step(&p->flux_map, &p->acting, r->i, r->u, r->start,
                               iq24_sincos(iq24_add_wrap(r->theta, r->rotor.speed)));
}

static const struct {
    const char *name;
    iqfoc_ab_t (*step)(const py_machine *p, const row *r);
} methods[] = {{"euler", euler},
               {"quasi_discrete", quasi_discrete},
               {"exact", exact},
               {"salient", salient},
               {"flux", flux},
               {"flux_map", flux_map},
               {"quasi_discrete_mean", quasi_discrete_mean},
               {"exact_mean", exact_mean},
               {"salient_mean", salient_mean}};

py_machine *py_machine_new(const motor *m, error *e)
{
    iqfoc_exact_winding_t winding;
    py_machine made;
    memset(&made, 0, sizeof made);
    if (!predictor_from_motor(m, &made.predictor, e) || !winding_from_motor(m, &winding, e) ||
        !salient_from_motor(m, &made.salient, e) || !flux_predictor_from_motor(m, &made.flux, e) ||
        !flux_map_from_motor(m, &made.flux_map, e) || !extension_from_motor(m, &made.acting, e)) {
        return NULL;
    }
    made.exact = iqfoc_exact_prediction(&winding, IQ24_ONE);
    made.exact_mean = iqfoc_exact_mean(&winding, IQ24_ONE);
    py_machine *p = malloc(sizeof *p);
    if (p == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    *p = made;
    return p;
}

void py_machine_free(py_machine *p)
{
    free(p);
}

bool py_machine_predict(const py_machine *p, const char *method, size_t n, const int32_t *const *in,
                        int32_t *const *out)
{
    size_t m = 0;
    while (m < sizeof methods / sizeof methods[0] && strcmp(methods[m].name, method) != 0) {
        m++;
    }
    if (m == sizeof methods / sizeof methods[0]) {
        return false;
    }
    for (size_t k = 0; k < n; k++) {
        row r = {.i = {in[0][k], in[1][k]}, .u = {in[2][k], in[3][k]}, .theta = in[4][k], .speed = in[5][k]};
        r.rotor = iqfoc_rotor_from_speed(r.speed);
        r.start = iq24_sincos(r.theta);
        r.middle = iq24_sincos(iq24_add_wrap(r.theta, iq24_asr32(r.rotor.speed, 1)));
        const iqfoc_ab_t result = methods[m].step(p, &r);
        out[0][k] = result.alpha;
        out[1][k] = result.beta;
    }
    return true;
}

void py_machine_constants(const py_machine *p, int32_t *three)
{
    three[0] = p->predictor.k_u;
    three[1] = p->predictor.k_r;
    three[2] = p->predictor.k_psi;
}
