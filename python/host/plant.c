/* The switching-level drive, cycle by cycle, under whatever controller Python has. */
#include "plant/plant.h"

#include "handles.h"
#include "plant/plant_effect.h"

#include <stdlib.h>
#include <string.h>

py_plant *py_plant_new(const motor *m, size_t effects, const char *const *effect, long seed, double J_kgm2,
                       double friction_Nms, error *e)
{
    plant_config c = plant_config_from_motor(m);
    c.seed = (uint64_t)seed;
    c.shaft.mode = J_kgm2 > 0.0 ? PLANT_SHAFT_INERTIA : PLANT_SHAFT_GIVEN;
    c.shaft.J_kgm2 = J_kgm2;
    c.shaft.friction_Nms = friction_Nms;
    for (size_t k = 0; k < effects; k++) {
        if (!plant_effect_apply(&c, effect[k], e)) {
            return NULL;
        }
    }
    if (!plant_config_check(&c, e)) {
        return NULL;
    }
    py_plant *p = malloc(sizeof *p);
    if (p == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    drive_loop_begin(&p->loop, m, &c, NULL);
    return p;
}

void py_plant_free(py_plant *p)
{
    free(p);
}

void py_plant_set_speed(py_plant *p, double omega_e_rad_s, double accel_e_rad_s2)
{
    plant_set_speed(&p->loop.drive, omega_e_rad_s, accel_e_rad_s2);
}

void py_plant_set_load(py_plant *p, double T_load_Nm)
{
    plant_set_load(&p->loop.drive, T_load_Nm);
}

static py_reading reading_of(const plant_samples *s)
{
    py_reading r = {.t_s = s->t_s,
                    .theta_e_rad = s->theta_e_rad,
                    .theta_mech_rad = s->theta_mech_rad,
                    .omega_e_rad_s = s->omega_e_rad_s,
                    .u_dc_V = s->u_dc_V,
                    .temp_C = s->temp_C};
    memcpy(r.i_A, s->i_A, sizeof r.i_A);
    return r;
}

static py_means means_of(const plant_means *m)
{
    py_means means = {.duration_s = m->duration_s, .i_dq_A = {m->i_dq_A.d, m->i_dq_A.q}};
    memcpy(means.i_A, m->i_A, sizeof means.i_A);
    memcpy(means.u_V, m->u_V, sizeof means.u_V);
    return means;
}

void py_plant_cycle(py_plant *p, const double *duty, py_reading *valley, py_reading *peak, py_means *means)
{
    plant_samples at_valley;
    plant_samples at_peak;
    plant_means m;
    plant_cycle(&p->loop.drive, duty, &at_valley, &at_peak, &m);
    *valley = reading_of(&at_valley);
    *peak = reading_of(&at_peak);
    *means = means_of(&m);
}

void py_plant_interval(py_plant *p, const double *duty, double interval_s, py_reading *start, py_reading *end,
                       py_means *means)
{
    plant *const drive = &p->loop.drive;
    const bool high[3] = {duty[0] > 0.5, duty[1] > 0.5, duty[2] > 0.5};
    py_plant_sample(p, start);
    plant_begin_interval(drive, high, interval_s);
    plant_advance_to(drive, interval_s);
    py_plant_sample(p, end);
    const plant_means m = plant_mean(drive);
    *means = means_of(&m);
}

void py_plant_sample(py_plant *p, py_reading *now)
{
    plant_samples s;
    plant_advance_to(&p->loop.drive, p->loop.drive.duration_s);
    plant_sample(&p->loop.drive, &s);
    *now = reading_of(&s);
}

void py_plant_state(const py_plant *p, py_now *now)
{
    const plant_point at = plant_now(&p->loop.drive);
    *now = (py_now){.t_s = at.t_s,
                    .theta_e_rad = at.theta_e_rad,
                    .omega_e_rad_s = at.omega_e_rad_s,
                    .i_dq_A = {at.i_dq_A.d, at.i_dq_A.q},
                    .torque_Nm = at.torque_Nm};
    memcpy(now->i_A, at.i_A, sizeof now->i_A);
}
