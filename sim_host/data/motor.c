/* Reading and writing motor files, driven by causes.def (motor.h). */
#include "motor.h"

#include "../base/number.h"
#include "../base/out_file.h"
#include "../base/vector.h"
#include "toml_table.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { NEEDED = true, OPTIONAL = false };

const motor_value motor_values[] = {
#define MACHINE_VALUE(ID, field, kind, name, unit)                                                           \
    {CAUSE_##ID, true, #field, name, unit, VALUE_##kind, offsetof(motor, field), NEEDED, NAN},
#define VALUE(ID, field, key, name, unit, kind, range, need, absent)                                         \
    {CAUSE_##ID, false, key, name, unit, VALUE_##kind, offsetof(motor, ext.field), need, absent},
#include "causes.def"
};

const size_t motor_values_length = sizeof motor_values / sizeof motor_values[0];

static toml_range between(double low, double high)
{
    return (toml_range){low, high, false};
}

/* Something added to the rest must not take more than that away. */
static toml_range leaves(double rest)
{
    return (toml_range){-rest, INFINITY, false};
}

static double least_inductance(const motor *m)
{
    double L_d_H;
    double L_q_H;
    motor_inductances(m, &L_d_H, &L_q_H);
    return fmin(L_d_H, L_q_H);
}

/* The range of a value; it may depend on values of [motor]. */
static toml_range range_of(const motor_value *v, const motor *m)
{
#define ANY          TOML_ANY
#define POSITIVE     TOML_POSITIVE
#define NOT_NEGATIVE TOML_NOT_NEGATIVE
    const toml_range range[] = {
#define MACHINE_VALUE(...)                                           TOML_ANY,
#define VALUE(ID, field, key, name, unit, kind, range, need, absent) range,
#include "causes.def"
    };
    return range[v - motor_values];
}

enum { POLE_PAIRS_MAX = 1000 }; /* well beyond any machine built; catches a speed in the wrong place */

static double *place_of(motor *m, const motor_value *v)
{
    return (double *)(void *)((char *)m + v->offset);
}

double motor_value_of(const motor *m, const motor_value *v)
{
    if (v->kind == VALUE_MEAN_INDUCTANCE) {
        return 0.5 * (m->L_d_H + m->L_q_H);
    }
    double value;
    memcpy(&value, (const char *)m + v->offset, sizeof value);
    return value;
}

void motor_note_extension(motor *m, cause_id cause)
{
    m->ext.has[cause] = false;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        const bool of_effect = v->cause == cause && !v->of_machine && !isnan(v->absent);
        m->ext.has[cause] = m->ext.has[cause] || (of_effect && motor_value_of(m, v) != v->absent);
    }
}

bool motor_has_first(const motor *m, cause_id id)
{
    bool first = m->ext.has[id];
    for (int other = 0; other < (int)id; other++) {
        first = first && !(m->ext.has[other] && cause_table[other].of == cause_table[id].of);
    }
    return first;
}

motor motor_blank(void)
{
    motor m = {.pwm = pwm_updates_plain()};
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (!v->of_machine && !isnan(v->absent)) {
            *place_of(&m, v) = v->absent;
        }
    }
    return m;
}

void motor_inductances(const motor *m, double *L_d_H, double *L_q_H)
{
    *L_d_H = m->L_d_H;
    *L_q_H = m->L_q_H;
    if (m->ext.has[CAUSE_SATURATION_DQ]) {
        *L_d_H = m->ext.L_d0_H;
        *L_q_H = m->ext.L_q0_H;
    } else if (m->ext.has[CAUSE_SATURATION]) {
        *L_d_H = m->ext.L_0_H * 2.0 * m->L_d_H / (m->L_d_H + m->L_q_H);
        *L_q_H = m->ext.L_0_H * 2.0 * m->L_q_H / (m->L_d_H + m->L_q_H);
    }
}

bool motor_has_parts_alone(const motor *m)
{
    const motor_extension *x = &m->ext;
    return x->has[CAUSE_SATURATION_DQ] && (x->E_1_J > 0.0 || x->E_2_J > 0.0) && x->w_ddd == 0.0 &&
           x->w_dqq == 0.0 && x->w_dddd == 0.0 && x->w_ddqq == 0.0 && x->w_qqqq == 0.0 &&
           x->I_sat_dq_A == 0.0;
}

size_t motor_angle_order(const motor *m, double order)
{
    size_t n = 0;
    while (n < ANGLE_ORDERS && order != motor_order_of(m, n)) {
        n++;
    }
    return n;
}

motor_harmonic motor_harmonic_of(motor_extension *x, size_t n)
{
    const motor_harmonic entry[ANGLE_ORDERS] = {
        {CAUSE_ANGLE_HARMONIC, &x->harmonic_order, &x->harmonic_amplitude_rad, &x->harmonic_phase_rad},
        {CAUSE_ANGLE_HARMONIC_2, &x->harmonic_2_order, &x->harmonic_2_amplitude_rad,
         &x->harmonic_2_phase_rad},
        {CAUSE_ANGLE_HARMONIC_P, &x->harmonic_p_order, &x->harmonic_p_amplitude_rad,
         &x->harmonic_p_phase_rad},
        {CAUSE_ANGLE_HARMONIC_2P, &x->harmonic_2p_order, &x->harmonic_2p_amplitude_rad,
         &x->harmonic_2p_phase_rad}};
    return entry[n];
}

double motor_order_of(const motor *m, size_t n)
{
    const double order[ANGLE_ORDERS] = {1.0, 2.0, m->pole_pairs, 2.0 * m->pole_pairs};
    return order[n];
}

double motor_rated_peak_A(const motor *m)
{
    return sqrt(2.0) * m->I_rated_A_rms;
}

double motor_speed_rad_s(const motor *m, double n_rpm)
{
    return n_rpm / 60.0 * VEC_TWO_PI * m->pole_pairs;
}

/* ---- reading ---- */

/*
 * What a machine or an inverter may be, with orders of magnitude to spare: beyond these a number was read or
 * written wrongly, and what is made of it would overflow. interfaces.md gives the reasons.
 */
static double bounded(toml_table *t, const char *key, double value, double least, double most)
{
    const double size = fabs(value);
    if (size > most || (size < least && value != 0.0)) {
        toml_refuse(t, key, "%s = %g is absurd; expected a number from %g to %g", key, value, least, most);
    }
    return value;
}

static void read_value(toml_table *t, const motor_value *v, motor *m)
{
    double *value = place_of(m, v);
    const toml_range range = range_of(v, m);
    if (v->kind == VALUE_WHOLE) {
        *value = (double)toml_integer(t, v->key, (long)range.min, (long)range.max);
    } else {
        *value = v->needed ? toml_number(t, v->key, range) : toml_number_or(t, v->key, range, *value);
        /* Generous: a fit that ran away is written here too, and must be read. */
        bounded(t, v->key, *value, 1e-100, 1e12);
    }
}

/* A part of the iron saturates at currents. */
static void check_part(toml_table *t, const char *part, double E_J, double I_d_A, double I_q_A)
{
    if (E_J > 0.0 && !(I_d_A > 0.0 && I_q_A > 0.0)) {
        char key[8];
        (void)snprintf(key, sizeof key, "E_%s_J", part);
        toml_refuse(t, key, "%s without I_d%s_A and I_q%s_A; expected both, in A", key, part, part);
    }
}

/* The values of one entry. */
static void read_entry(toml_table *t, cause_id id, motor *m)
{
    m->ext.has[id] = true;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (v->cause == id && !v->of_machine) {
            read_value(t, v, m);
        }
    }
    if (id == CAUSE_SATURATION_DQ) {
        const motor_extension *x = &m->ext;
        check_part(t, "1", x->E_1_J, x->I_d1_A, x->I_q1_A);
        check_part(t, "2", x->E_2_J, x->I_d2_A, x->I_q2_A);
    }
}

/* The order of an angle error says which entry it is. */
static void read_harmonic(toml_table *t, motor *m)
{
    motor_extension *x = &m->ext;
    const motor_harmonic first = motor_harmonic_of(x, 0);
    const double held[3] = {*first.order, *first.amplitude_rad, *first.phase_rad};
    const bool has = x->has[first.cause];
    read_entry(t, first.cause, m);
    const double order = *first.order;
    const size_t n = motor_angle_order(m, order);
    if (n == ANGLE_ORDERS) {
        toml_refuse(t, "order", "order = %g, expected 1, 2, or once or twice pole_pairs", order);
        return;
    }
    const motor_harmonic at = motor_harmonic_of(x, n);
    if (n == 0 ? has : x->has[at.cause]) {
        toml_refuse(t, "order", "order = %g is given twice; expected one entry an order", order);
        return;
    }
    if (n > 0) {
        *at.order = order;
        *at.amplitude_rad = *first.amplitude_rad;
        *at.phase_rad = *first.phase_rad;
        x->has[at.cause] = true;
        *first.order = held[0];
        *first.amplitude_rad = held[1];
        *first.phase_rad = held[2];
        x->has[first.cause] = has;
    }
}

/* [extension.<id>], or [[extension.<id>]] of a cause that may be there more than once. */
static void read_extension(toml_table *all, cause_id id, motor *m)
{
    const char *key = cause_table[id].id;
    if (cause_table[id].of != id || !toml_has(all, key)) {
        return;
    }
    if (id != CAUSE_ANGLE_HARMONIC) {
        read_entry(toml_table_inner(all, key), id, m);
        return;
    }
    if (toml_is_table(all, key)) {
        read_harmonic(toml_table_inner(all, key), m);
        return;
    }
    for (size_t n = 0; n < toml_table_count(all, key); n++) {
        read_harmonic(toml_table_at(all, key, n), m);
    }
}

bool motor_is_extension(cause_id id)
{
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (v->cause == id && !v->of_machine) {
            return true;
        }
    }
    return false;
}

/* A motor without a name is called by its file. */
static void name_after_file(motor *m, const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash != NULL ? slash + 1 : path;
    strncpy(m->name, base, sizeof m->name - 1);
}

bool motor_read(const char *path, motor *m, error *e)
{
    toml_file *file = toml_file_open(path, e);
    if (file == NULL) {
        return false;
    }
    motor read = motor_blank();
    name_after_file(&read, path);

    toml_table *root = toml_file_root(file);
    toml_text_or_keep(root, "name", read.name, sizeof read.name);

    toml_table *t = toml_table_inner(root, "motor");
    read.pole_pairs = (int)toml_integer(t, "pole_pairs", 1, POLE_PAIRS_MAX);
    read.R_ohm = bounded(t, "R_ohm", toml_number(t, "R_ohm", TOML_NOT_NEGATIVE), 1e-9, 1e5);
    read.L_d_H = bounded(t, "L_d_H", toml_number(t, "L_d_H", TOML_POSITIVE), 1e-9, 100.0);
    read.L_q_H = bounded(t, "L_q_H", toml_number(t, "L_q_H", TOML_POSITIVE), 1e-9, 100.0);
    read.psi_f_Wb = bounded(t, "psi_f_Wb", toml_number(t, "psi_f_Wb", TOML_NOT_NEGATIVE), 1e-9, 1e4);
    read.I_rated_A_rms =
        bounded(t, "I_rated_A_rms", toml_number(t, "I_rated_A_rms", TOML_POSITIVE), 1e-6, 1e6);
    read.n_max_rpm = bounded(t, "n_max_rpm", toml_number(t, "n_max_rpm", TOML_POSITIVE), 1e-3, 1e7);

    t = toml_table_inner(root, "inverter");
    read.f_pwm_Hz = bounded(t, "f_pwm_Hz", toml_number(t, "f_pwm_Hz", TOML_POSITIVE), 1e-3, 1e9);
    read.u_dc_V = bounded(t, "u_dc_V", toml_number(t, "u_dc_V", TOML_POSITIVE), 1e-3, 1e6);

    read.pwm =
        pwm_updates_read(toml_table_inner_or_null(root, "pwm"), toml_table_inner_or_null(root, "sensors"));

    t = toml_table_inner_or_null(root, "extension");
    for (int id = 0; id < CAUSE_COUNT; id++) {
        if (motor_is_extension((cause_id)id)) {
            read_extension(t, (cause_id)id, &read);
        }
    }

    if (read.ext.has[CAUSE_SATURATION] && read.ext.has[CAUSE_SATURATION_DQ]) {
        toml_refuse(t, cause_table[CAUSE_SATURATION_DQ].id,
                    "both laws of saturation; expected one of [extension.%s] and [extension.%s]",
                    cause_table[CAUSE_SATURATION].id, cause_table[CAUSE_SATURATION_DQ].id);
    }
    if (!toml_file_close(file)) {
        return false;
    }
    read.path = path;
    *m = read;
    return true;
}

bool motor_refuse(const char *path, const char *key, error *e, const char *format, ...)
{
    /* If the file cannot be read again the message goes without a position. */
    long line = 0;
    long column = 0;
    error unread = {0};
    toml_file *file = path != NULL ? toml_file_open(path, &unread) : NULL;
    toml_table *root = toml_file_root(file);
    if (!toml_position(toml_table_inner_or_null(root, "motor"), key, &line, &column)) {
        toml_position(toml_table_inner_or_null(root, "inverter"), key, &line, &column);
    }
    toml_file_close(file);
    va_list args;
    va_start(args, format);
    error_input_args(e, path, line, column, format, args);
    va_end(args);
    return false;
}

/* ---- writing ---- */

static void put_number(FILE *out, const char *key, double value)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(value, text);
    fprintf(out, "%s = %s\n", key, text);
}

/* A TOML basic string: quotes, backslashes and control characters escaped. */
static void put_string(FILE *out, const char *key, const char *text)
{
    fprintf(out, "%s = \"", key);
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\') {
            fprintf(out, "\\%c", c);
        } else if (c < 0x20 || c == 0x7f) {
            fprintf(out, "\\u%04X", c);
        } else {
            fputc(c, out);
        }
    }
    fputs("\"\n", out);
}

/* Each line of the comment behind "# ". */
static void put_comment(FILE *out, const char *comment)
{
    while (comment != NULL && *comment != '\0') {
        const size_t length = strcspn(comment, "\n");
        fprintf(out, "# %.*s\n", (int)length, comment);
        comment += length + (comment[length] == '\n' ? 1 : 0);
    }
}

/* How many entries of its cause the motor has. */
static int entries_of(cause_id id, const motor *m)
{
    int n = 0;
    for (int other = 0; other < CAUSE_COUNT; other++) {
        n += m->ext.has[other] && cause_table[other].of == cause_table[id].of ? 1 : 0;
    }
    return n;
}

static void put_extension(FILE *out, cause_id id, const motor *m)
{
    fprintf(out, entries_of(id, m) > 1 ? "\n[[extension.%s]]\n" : "\n[extension.%s]\n", cause_table[id].id);
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (v->cause == id && !v->of_machine && (!motor_value_is_extra(v) || motor_value_of(m, v) != 0.0)) {
            put_number(out, v->key, motor_value_of(m, v));
        }
    }
}

/* A fit that ran away must not become a file that cannot be read. */
static bool is_finite(const motor *m)
{
    double sum = m->R_ohm + m->L_d_H + m->L_q_H + m->psi_f_Wb + m->I_rated_A_rms + m->n_max_rpm +
                 m->f_pwm_Hz + m->u_dc_V;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        sum += v->of_machine || m->ext.has[v->cause] ? motor_value_of(m, v) : 0.0;
    }
    return isfinite(sum) != 0;
}

bool motor_write(const char *path, const motor *m, const char *comment, error *e)
{
    if (!is_finite(m)) {
        return error_failure(e, 0, "%s: not written, a motor value is not finite", path);
    }
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    put_comment(out, comment);
    put_string(out, "name", m->name);

    fputs("\n[motor]\n", out);
    fprintf(out, "pole_pairs = %d\n", m->pole_pairs);
    put_number(out, "R_ohm", m->R_ohm);
    put_number(out, "L_d_H", m->L_d_H);
    put_number(out, "L_q_H", m->L_q_H);
    put_number(out, "psi_f_Wb", m->psi_f_Wb);
    put_number(out, "I_rated_A_rms", m->I_rated_A_rms);
    put_number(out, "n_max_rpm", m->n_max_rpm);

    fputs("\n[inverter]\n", out);
    put_number(out, "f_pwm_Hz", m->f_pwm_Hz);
    put_number(out, "u_dc_V", m->u_dc_V);
    pwm_updates_print(out, &m->pwm);

    for (int id = 0; id < CAUSE_COUNT; id++) {
        if (m->ext.has[id] && motor_is_extension((cause_id)id)) {
            put_extension(out, (cause_id)id, m);
        }
    }
    return out_file_commit(&f, e);
}
