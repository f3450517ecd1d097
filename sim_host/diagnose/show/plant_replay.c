/* The recording's operating points in the switching-level plant (plant_replay.h). */
#include "plant_replay.h"

#include "drive/drive_recording.h"
#include "drive/firmware_host.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    RUNS_MAX = 48,
    CYCLES_MAX = 24000,  /* simulated in total */
    SETTLE_CYCLES = 400, /* 20 time constants of a current control of f_pwm/20 */
    NOISE_SEED = 20160215
};

/* Does the nominal file, or the extended one, differ by more than what is written down? */
static bool differs(double x, double y)
{
    return fabs(x - y) > 1e-9 * fmax(fabs(x), fabs(y));
}

static void tell(char *text, size_t size, const char *format, ...) ERROR_PRINTF(3, 4);

static void tell(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list args;
    if (used + 3 >= size) {
        return;
    }
    if (used > 0) {
        strcat(text, "; ");
    }
    va_start(args, format);
    vsnprintf(text + strlen(text), size - strlen(text), format, args);
    va_end(args);
}

/* Each leg is late once a period: v_dead + compensation = u_dc t_dead f_pwm. A voltage gain has no physics in an inverter. */
static void laws_of_plant(plant_config *c, const motor *m, double u_dc_V)
{
    const double takes_V = m->ext.has[CAUSE_DEAD_TIME] ? m->ext.v_dead_V + m->ext.compensation_V : 0.0;
    c->inverter.t_dead_s = fmax(takes_V, 0.0) * c->T_s / u_dc_V;
    /* Its registers load at the valley or at the peak. */
    c->inverter.delay_cycles =
        m->ext.has[CAUSE_VOLTAGE_DELAY] ? 0.5 * round(2.0 * m->ext.voltage_delay_cycles) : 0.0;
}

/* The named effects as the plant's own physics. */
static void physics(plant_config *c, const motor *m, double u_dc_V)
{
    for (cause_id id = 0; id < CAUSE_COUNT; id++) {
        plant_config_extend(c, m, id);
    }
    laws_of_plant(c, m, u_dc_V);
}

/* Whether the plant has physics of its own for a value; those of [motor] it takes as they are. */
static bool in_plant(const motor_value *v)
{
    static const size_t offsets[] = {
#define PLANT(ID, field, member) offsetof(motor, ext.field),
#define PLANT_LAW(ID, field)     offsetof(motor, ext.field),
#include "data/causes.def"
    };
    bool found = v->of_machine;
    for (size_t k = 0; k < sizeof offsets / sizeof *offsets; k++) {
        found = found || offsets[k] == v->offset;
    }
    return found;
}

/* "a dead time (v_dead = 3.39 V); windings (R = 0.8 ohm)": effects of the plant that the motor file has not. */
static void describe(const motor *file, const motor *is, char *text, size_t size)
{
    motor was = *file;
    motor_inductances(file, &was.L_d_H, &was.L_q_H); /* in the extended motor's form */
    for (int id = 0; id < CAUSE_COUNT; id++) {
        char values[200] = "";
        bool differ = is->ext.has[id] && !was.ext.has[id];
        for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
            const size_t used = strlen(values);
            if ((int)v->cause != id || !in_plant(v)) {
                continue;
            }
            differ = differ || ((v->of_machine || is->ext.has[id]) &&
                                differs(motor_value_of(&was, v), motor_value_of(is, v)));
            snprintf(values + used, sizeof values - used, "%s%s = %.4g%s%s", used > 0 ? ", " : "", v->name,
                     motor_value_of(is, v), strcmp(v->unit, "1") == 0 ? "" : " ",
                     strcmp(v->unit, "1") == 0 ? "" : v->unit);
        }
        /* L or L_d and L_q, not both. */
        const bool salient = differs(is->L_d_H, is->L_q_H);
        if (differ && values[0] != '\0' && !(id == CAUSE_INDUCTANCE && salient) &&
            !(id == CAUSE_SALIENCY && !salient)) {
            tell(text, size, "%s (%s)", cause_table[id].noun, values);
        }
    }
}

static double link_of(const recording *rec, size_t first, size_t count, double nominal_V)
{
    double sum = 0.0;
    for (size_t k = first; rec->u_dc_V != NULL && k < first + count; k++) {
        sum += rec->u_dc_V[k];
    }
    return rec->u_dc_V != NULL ? sum / (double)count : nominal_V;
}

/* One stretch as a run: references and speed as steps of means. */
static void follow(const recording *rec, const motor *m, size_t first, size_t count, scenario_run *run)
{
    const size_t points = count < PROFILE_POINTS_MAX ? count : PROFILE_POINTS_MAX;
    *run = (scenario_run){.cycles = (long)count, .settle_cycles = SETTLE_CYCLES, .shaft = SHAFT_GIVEN};
    run->speed_rpm.ramps = true;
    for (size_t p = 0; p < points; p++) {
        const size_t from = first + p * count / points;
        const size_t to = first + (p + 1) * count / points;
        double sum[3] = {0.0, 0.0, 0.0};
        for (size_t k = from; k < to; k++) {
            /* In the frame of the recorded angle: what the firmware's references are. */
            const vec_dq i = vec_to_dq(recording_current(rec, k), rotor_at(rec->theta_e_rad[k]));
            sum[0] += i.d;
            sum[1] += i.q;
            sum[2] += rec->omega_e_rad_s[k];
        }
        const double n = (double)(to - from);
        const double t_s = (double)(from - first) * rec->T_s;
        run->i_d_A.t_s[p] = run->i_q_A.t_s[p] = t_s;
        run->speed_rpm.t_s[p] = t_s + 0.5 * (n - 1.0) * rec->T_s;
        run->i_d_A.value[p] = sum[0] / n;
        run->i_q_A.value[p] = sum[1] / n;
        run->speed_rpm.value[p] = sum[2] / n * 60.0 / (VEC_TWO_PI * m->pole_pairs);
    }
    run->i_d_A.points = run->i_q_A.points = run->speed_rpm.points = points;
    run->load_Nm = profile_constant(0.0);
    run->u_dc_V = link_of(rec, first, count, m->u_dc_V);
    const double ahead = m->ext.has[CAUSE_ANGLE_OFFSET] ? m->ext.theta_0_rad : 0.0;
    run->theta_mech_start_rad = (rec->theta_e_rad[first] - ahead) / m->pole_pairs;
}

/* The third current of a drive with two sensors, as the recording's reader fills it in. */
static bool fill_third_current(recording *r)
{
    if (r->i_A[2] == NULL) {
        r->i_A[2] = calloc(r->rows + 1, sizeof *r->i_A[2]);
        for (size_t k = 0; r->i_A[2] != NULL && k < r->rows; k++) {
            r->i_A[2][k] = -r->i_A[0][k] - r->i_A[1][k];
        }
    }
    return r->i_A[2] != NULL;
}

/* The longest stretch of each run, in the recording's order. Returns how many. */
static size_t choose_stretches(const recording *rec, stretch chosen[RUNS_MAX])
{
    size_t runs = 0;
    for (size_t n = 0; n < rec->stretches; n++) {
        const stretch *s = &rec->stretch[n];
        size_t at = 0;
        while (at < runs && chosen[at].run != s->run) {
            at++;
        }
        if (at == runs && runs < RUNS_MAX && s->count >= 32) {
            chosen[runs++] = *s;
        } else if (at < runs && s->count > chosen[at].count) {
            chosen[at] = *s;
        }
    }
    return runs;
}

/* Time of the middle of all runs: drifting parameters have their values there. */
static double middle_of(const scenario *s, double T_s)
{
    double rows = 0.0;
    for (size_t k = 0; k < s->runs; k++) {
        rows += (double)s->run[k].cycles;
    }
    return 0.5 * rows * T_s;
}

static bool run_all(const scenario *s, const stretch *chosen, const motor *told, const plant_config *drive,
                    drive_recording *out, error *e)
{
    drive_host *host = calloc(1, sizeof *host);
    iqfoc_cycle_config_t config;
    bool good = (host != NULL || error_failure(e, 0, "out of memory")) &&
                config_from_motor(told, &s->control, &config, e);
    for (size_t k = 0; k < s->runs && good; k++) {
        const drive_firmware firmware = drive_firmware_host(host, NULL);
        const drive_log log = drive_recording_log(out);
        plant_config c = *drive;
        uint32_t status = 0;
        c.seed = NOISE_SEED + k;
        c.clock_s = drive_recording_next_s(out) - middle_of(s, c.T_s);
        good = drive_run(told, &c, &s->run[k], chosen[k].run, &config, &firmware, &log, &status, e);
    }
    free(host);
    return good;
}

bool plant_replay(const recording *rec, const motor *nominal, const motor *extended, double noise_A,
                  recording *out, char *effect, size_t size, error *e)
{
    stretch chosen[RUNS_MAX];
    scenario s = {.control = {.feedback = FEEDBACK_MIDPOINT, .modulation = MODULATION_PWM},
                  .log = {.voltages = true,
                          .duties = true,
                          .u_dc = true,
                          .third_current = recording_three_sensors(rec),
                          .mechanical_angle = true}};
    motor told = *nominal;
    motor is = *extended;
    memset(out, 0, sizeof *out);
    effect[0] = '\0';
    told.path = NULL; /* a copy: messages name no file */
    told.f_pwm_Hz = is.f_pwm_Hz = 1.0 / rec->T_s;
    s.runs = choose_stretches(rec, chosen);
    s.run = calloc(s.runs + 1, sizeof *s.run);
    if (s.runs == 0 || s.run == NULL) {
        free(s.run);
        return error_failure(e, 0, "no stretch of 32 rows to simulate");
    }
    const size_t most = CYCLES_MAX / s.runs;
    for (size_t k = 0; k < s.runs; k++) {
        follow(rec, &is, chosen[k].first, chosen[k].count < most ? chosen[k].count : most, &s.run[k]);
    }
    plant_config drive = plant_config_from_motor(&is);
    drive.sensors.current_noise_A = noise_A;
    physics(&drive, &is, s.run[0].u_dc_V);
    describe(nominal, &is, effect, size);
    drive_recording made = {.run = 0};
    const bool good = drive_recording_begin(&made, &s, drive.T_s, e) &&
                      run_all(&s, chosen, &told, &drive, &made, e) &&
                      ((fill_third_current(&made.recording) && recording_find_stretches(&made.recording)) ||
                       error_failure(e, 0, "out of memory"));
    free(s.run);
    if (!good) {
        recording_free(&made.recording);
        return false;
    }
    *out = made.recording;
    return true;
}
