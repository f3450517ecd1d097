/* The plant, and controller plus plant, at a simulator's pace (fmu_model.h). */
#include "fmu_model.h"

#include "drive/drive_scenario.h"
#include "plant/plant_effect.h"

#include <math.h>
#include <string.h>

/* Of a control cycle: as near to a valley or a peak is at it. A simulator's times are sums of steps. */
#define AT_CYCLES 1e-6

enum { SETTLE_CYCLES = 200 };

/* The plant alone: no firmware uses the samples. */
static bool no_start(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    (void)context, (void)config, (void)e;
    return true;
}

static bool no_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    (void)context, (void)i_ref, (void)sample, (void)e;
    return true;
}

static bool no_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                    error *e)
{
    (void)context, (void)i_ref, (void)sample, (void)e;
    answer->command.gates = true;
    return true;
}

static double *parameter_of(plant_config *c, int id)
{
    return (double *)((char *)c + fmu_variables[id].offset);
}

/* The drive with the parameters' present values. */
static plant_config drive_of(const fmu_model *m)
{
    plant_config c = m->as_filed;
    for (int id = 0; id < FMU_VARIABLES; id++) {
        if (fmu_variables[id].offset != 0) {
            *parameter_of(&c, id) = m->value[id];
        }
    }
    return c;
}

static bool check(const fmu_model *m, error *e)
{
    plant_config c = drive_of(m);
    if (m->value[FMU_shaft_has_inertia] != 0.0) {
        c.shaft.mode = PLANT_SHAFT_INERTIA;
    }
    return plant_config_check(&c, e);
}

void fmu_model_reset(fmu_model *m)
{
    const fmu_setup *s = &m->setup;
    const scenario_run *run = s->has_scenario ? &s->scenario.run[s->run] : NULL;
    memset(m->value, 0, sizeof m->value);
    for (int id = 0; id < FMU_VARIABLES; id++) {
        if (fmu_variables[id].offset != 0) {
            m->value[id] = *parameter_of(&m->as_filed, id);
        }
    }
    m->value[FMU_d_a] = m->value[FMU_d_b] = m->value[FMU_d_c] = 0.5;
    m->value[FMU_settle_cycles] = s->kind == FMU_KIND_DRIVE ? SETTLE_CYCLES : 0;
    m->value[FMU_seed] = (double)s->seed;
    m->value[FMU_cycle_s] = m->as_filed.T_s;
    m->value[FMU_pole_pairs] = m->as_filed.machine.pole_pairs;
    if (run != NULL) {
        m->value[FMU_follow_scenario] = 1.0;
        m->value[FMU_shaft_has_inertia] = run->shaft == SHAFT_INERTIA ? 1.0 : 0.0;
        m->value[FMU_theta_mech_start_rad] = run->theta_mech_start_rad;
        m->value[FMU_J_kgm2] = run->J_kgm2;
        m->value[FMU_friction_Nms] = run->friction_Nms;
        m->value[FMU_u_dc_V] = run->u_dc_V > 0.0 ? run->u_dc_V : m->as_filed.inverter.u_dc_V;
        m->value[FMU_settle_cycles] = s->kind == FMU_KIND_DRIVE ? (double)run->settle_cycles : 0.0;
    }
    m->begun = false;
}

bool fmu_model_load(fmu_model *m, const fmu_setup *setup, error *e)
{
    memset(m, 0, sizeof *m);
    m->setup = *setup;
    const fmu_setup *s = &m->setup;
    plant_config c = drive_scenario_plant(&s->motor, &s->scenario);
    bool good = true;
    for (int k = 0; k < s->effects && good; k++) {
        good = plant_effect_apply(&c, s->effect[k], e);
    }
    c.clock_s = drive_recording_run_s(&s->scenario, s->run, c.T_s);
    m->as_filed = c;
    fmu_model_reset(m);
    return good && check(m, e);
}

void fmu_model_free(fmu_model *m)
{
    fmu_setup_free(&m->setup);
}

/* What a value by itself may be. */
static bool value_fits(const fmu_model *m, fmu_id id, double value, error *e)
{
    const char *name = fmu_variables[id].name;
    if (!isfinite(value)) {
        return error_input(e, NULL, 0, 0, "%s must be a finite number", name);
    }
    if ((id == FMU_settle_cycles || id == FMU_seed) && value < 0.0) {
        return error_input(e, NULL, 0, 0, "%s must not be negative", name);
    }
    if (id == FMU_settle_cycles && value > (double)FMU_CYCLES_MOST) {
        return error_input(e, NULL, 0, 0, "%s must be at most ten million", name);
    }
    return id != FMU_follow_scenario || value == 0.0 || m->setup.has_scenario ||
           error_input(e, NULL, 0, 0, "%s: this FMU was exported without a scenario", name);
}

bool fmu_model_set(fmu_model *m, fmu_id id, double value, error *e)
{
    const double before = m->value[id];
    if (!value_fits(m, id, value, e)) {
        return false;
    }
    m->value[id] = value;
    if (fmu_variables[id].offset != 0 && m->begun) {
        if (!check(m, e)) {
            m->value[id] = before;
            return false;
        }
        m->retuned = true;
    }
    return true;
}

/* The course of one cycle from the inputs: the speed is a ramp over it, all other inputs are constant. */
static void take_inputs(fmu_model *m)
{
    const double *v = m->value;
    scenario_run *run = &m->run;
    const double T_s = v[FMU_cycle_s];
    const double from_s = m->k < 0 ? 0.0 : (double)m->k * T_s;
    run->speed_rpm = profile_constant(v[FMU_speed_rpm]);
    if (m->k >= 0 && v[FMU_accel_rpm_s] != 0.0) {
        run->speed_rpm.points = 2;
        run->speed_rpm.ramps = true;
        run->speed_rpm.t_s[0] = from_s;
        run->speed_rpm.t_s[1] = from_s + T_s;
        run->speed_rpm.value[1] = v[FMU_speed_rpm] + v[FMU_accel_rpm_s] * T_s;
    }
    run->load_Nm = profile_constant(v[FMU_load_Nm]);
    run->i_d_A = profile_constant(v[FMU_i_d_ref_A]);
    run->i_q_A = profile_constant(v[FMU_i_q_ref_A]);
}

/* Shaft, load, references and, of the plant alone, the duties of the cycle that is to begin. */
static void prepare_cycle(fmu_model *m)
{
    drive_loop *l = &m->loop;
    if (m->value[FMU_follow_scenario] == 0.0) {
        take_inputs(m);
    }
    m->i_ref = drive_run_cycle(l, &m->setup.motor, &m->run, m->k);
    if (m->setup.kind == FMU_KIND_PLANT) {
        memcpy(l->duty, &m->value[FMU_d_a], sizeof l->duty);
    }
}

/* What the cycle that has ended has shown. */
static void note_cycle(fmu_model *m)
{
    const drive_row *row = &m->row;
    m->value[FMU_i_d_mean_A] = row->truth.i_dq_A.d;
    m->value[FMU_i_q_mean_A] = row->truth.i_dq_A.q;
    m->value[FMU_status] = (double)row->answer.status;
    m->k++;
}

/* A tunable parameter acts from a valley on. What the course of the run has put into the configuration stays. */
static void take_parameters(fmu_model *m)
{
    plant *p = &m->loop.drive;
    plant_config c = p->config;
    m->retuned = false;
    for (int id = 0; id < FMU_VARIABLES; id++) {
        if (fmu_variables[id].offset != 0) {
            *parameter_of(&c, id) = m->value[id];
        }
    }
    plant_set_config(p, &c);
}

static void show(fmu_model *m)
{
    const plant_point now = plant_now(&m->loop.drive);
    const drive_row *row = &m->row;
    double *v = m->value;
    for (int x = 0; x < 3; x++) {
        v[FMU_i_a_A + x] = now.i_A[x];
        v[FMU_u_a_V + x] = now.u_V[x];
        v[FMU_i_a_valley_A + x] = row->valley.i_A[x];
        v[FMU_i_a_mid_A + x] = row->peak.i_A[x];
        v[FMU_d_a_force + x] = row->duty[x];
    }
    v[FMU_i_d_A] = now.i_dq_A.d;
    v[FMU_i_q_A] = now.i_dq_A.q;
    v[FMU_theta_e_rad] = now.theta_e_rad;
    v[FMU_shaft_rpm] = now.omega_e_rad_s / motor_speed_rad_s(&m->setup.motor, 1.0);
    v[FMU_torque_Nm] = now.torque_Nm;
    v[FMU_theta_valley_rad] = row->valley.theta_e_rad;
}

bool fmu_model_begin(fmu_model *m, double start_s, error *e)
{
    const fmu_setup *s = &m->setup;
    const double *v = m->value;
    iqfoc_cycle_config_t config;
    if (!check(m, e) || !config_from_motor(&s->motor, &s->scenario.control, &config, e)) {
        return false;
    }
    m->run = (scenario_run){.shaft = SHAFT_GIVEN};
    if (v[FMU_follow_scenario] != 0.0) {
        m->run = s->scenario.run[s->run];
    }
    m->run.shaft = v[FMU_shaft_has_inertia] != 0.0 ? SHAFT_INERTIA : SHAFT_GIVEN;
    m->run.theta_mech_start_rad = v[FMU_theta_mech_start_rad];
    m->run.settle_cycles = (long)v[FMU_settle_cycles];
    m->run.J_kgm2 = v[FMU_J_kgm2];
    m->run.friction_Nms = v[FMU_friction_Nms];
    m->run.u_dc_V = v[FMU_u_dc_V];
    m->k = -m->run.settle_cycles;
    m->start_s = start_s;
    m->stage = FMU_AT_VALLEY;
    m->retuned = false;
    m->row = (drive_row){.run = (long)s->run + 1};
    m->firmware = s->kind == FMU_KIND_DRIVE ? drive_firmware_host(&m->host, NULL)
                                            : (drive_firmware){NULL, no_start, no_valley, no_peak};
    plant_config c = drive_of(m);
    c.seed = drive_scenario_seed((long)v[FMU_seed], s->run);
    bool good = drive_run_begin(&m->loop, &s->motor, &c, &m->run, &config, &m->firmware, e);
    m->begun = good;
    while (good && m->k < 0) {
        prepare_cycle(m);
        good = drive_loop_span(&m->loop, m->i_ref, &m->row, e) && !drive_run_stopped(&m->row, e);
        note_cycle(m);
    }
    if (good) {
        show(m);
    }
    return good;
}

/* The drive's next valley, its peak, or the valley behind that: the first that is ahead. */
static bool pass(fmu_model *m, error *e)
{
    switch (m->stage) {
    case FMU_AT_VALLEY:
        if (m->retuned) {
            take_parameters(m);
        }
        prepare_cycle(m);
        m->stage = FMU_TO_PEAK;
        return drive_loop_open(&m->loop, m->i_ref, &m->row, e);
    case FMU_TO_PEAK:
        m->stage = FMU_TO_VALLEY;
        return drive_loop_sample(&m->loop, m->i_ref, &m->row, e) && !drive_run_stopped(&m->row, e);
    default:
        m->stage = FMU_AT_VALLEY;
        drive_loop_close(&m->loop, &m->row);
        note_cycle(m);
        return true;
    }
}

bool fmu_model_reaches(const fmu_model *m, double t_s)
{
    return (t_s - m->start_s) / m->value[FMU_cycle_s] - (double)m->k <= (double)FMU_CYCLES_MOST;
}

bool fmu_model_advance(fmu_model *m, double t_s, error *e)
{
    static const double at[] = {[FMU_AT_VALLEY] = 0.0, [FMU_TO_PEAK] = 0.5, [FMU_TO_VALLEY] = 1.0};
    plant *p = &m->loop.drive;
    const double to_cycles = (t_s - m->start_s) / m->value[FMU_cycle_s];
    bool good = true;
    /* A valley that the step ends at is passed by the next one, whose inputs it takes. */
    while (good && to_cycles - (double)m->k > AT_CYCLES) {
        const double left = to_cycles - (double)m->k;
        if (left < at[m->stage] - AT_CYCLES) {
            plant_advance_to(p, left * p->duration_s);
            break;
        }
        if (m->stage != FMU_AT_VALLEY) {
            plant_advance_to(p, at[m->stage] * p->duration_s);
        }
        good = pass(m, e);
    }
    if (good) {
        show(m);
    }
    return good;
}
