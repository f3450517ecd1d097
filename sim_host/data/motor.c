#include "motor.h"

#include "../base/number.h"
#include "../base/out_file.h"
#include "toml_table.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char *const extension_names[EXT_COUNT] = {
    [EXT_SATURATION] = "saturation",           [EXT_DEAD_TIME] = "dead_time",
    [EXT_VOLTAGE_GAIN] = "voltage_gain",       [EXT_CURRENT_OFFSET] = "current_offset",
    [EXT_CURRENT_GAIN] = "current_gain",       [EXT_ANGLE_OFFSET] = "angle_offset",
    [EXT_ANGLE_HARMONIC] = "angle_harmonic",   [EXT_ANGLE_DELAY] = "angle_delay",
    [EXT_VOLTAGE_DELAY] = "voltage_delay",     [EXT_EMF_HARMONICS] = "emf_harmonics",
    [EXT_PHASE_ASYMMETRY] = "phase_asymmetry",
};

/* A key of [extension.<id>] that holds a real number: one table for reading and writing. */
typedef struct extension_key {
    extension_id id;
    const char *key;
    size_t offset; /* of the double within motor_extension */
    const toml_range *range;
    bool required; /* else the value that means "no effect" stands */
} extension_key;

#define AT(member) offsetof(motor_extension, member)

static const extension_key extension_keys[] = {
    {EXT_SATURATION, "L_0_H", AT(L_0_H), &TOML_POSITIVE, true},
    {EXT_SATURATION, "I_sat_A", AT(I_sat_A), &TOML_POSITIVE, true},
    {EXT_DEAD_TIME, "v_dead_V", AT(v_dead_V), &TOML_ANY, true},
    {EXT_DEAD_TIME, "i_knee_A", AT(i_knee_A), &TOML_NOT_NEGATIVE, true},
    {EXT_VOLTAGE_GAIN, "k_u", AT(k_u), &TOML_POSITIVE, true},
    {EXT_CURRENT_OFFSET, "o_a_A", AT(o_A[0]), &TOML_ANY, false},
    {EXT_CURRENT_OFFSET, "o_b_A", AT(o_A[1]), &TOML_ANY, false},
    {EXT_CURRENT_OFFSET, "o_c_A", AT(o_A[2]), &TOML_ANY, false},
    {EXT_CURRENT_GAIN, "g_a", AT(g[0]), &TOML_POSITIVE, false},
    {EXT_CURRENT_GAIN, "g_b", AT(g[1]), &TOML_POSITIVE, false},
    {EXT_CURRENT_GAIN, "g_c", AT(g[2]), &TOML_POSITIVE, false},
    {EXT_ANGLE_OFFSET, "theta_0_rad", AT(theta_0_rad), &TOML_ANY, true},
    {EXT_ANGLE_HARMONIC, "amplitude_rad", AT(harmonic_amplitude_rad), &TOML_ANY, true},
    {EXT_ANGLE_HARMONIC, "phase_rad", AT(harmonic_phase_rad), &TOML_ANY, true},
    {EXT_ANGLE_DELAY, "t_delay_s", AT(t_delay_s), &TOML_ANY, true},
    {EXT_EMF_HARMONICS, "psi_5_Wb", AT(psi_5_Wb), &TOML_ANY, false},
    {EXT_EMF_HARMONICS, "psi_7_Wb", AT(psi_7_Wb), &TOML_ANY, false},
    {EXT_PHASE_ASYMMETRY, "dR_a_ohm", AT(dR_ohm[0]), &TOML_ANY, false},
    {EXT_PHASE_ASYMMETRY, "dR_b_ohm", AT(dR_ohm[1]), &TOML_ANY, false},
    {EXT_PHASE_ASYMMETRY, "dR_c_ohm", AT(dR_ohm[2]), &TOML_ANY, false},
};

enum {
    EXTENSION_KEYS = sizeof extension_keys / sizeof extension_keys[0],
    POLE_PAIRS_MAX = 1000,  /* well beyond any machine built; catches a speed in the wrong place */
    DELAY_CYCLES_MAX = 100, /* likewise */
};

static double *extension_value(motor_extension *ext, const extension_key *k)
{
    return (double *)(void *)((char *)ext + k->offset);
}

motor motor_blank(void)
{
    motor m = {0};
    m.ext.k_u = 1.0;
    for (int phase = 0; phase < 3; phase++) {
        m.ext.g[phase] = 1.0;
    }
    return m;
}

const char *motor_extension_id(extension_id id)
{
    return extension_names[id];
}

/* ---- reading ---- */

static void read_extension(toml_table *all, extension_id id, motor *m)
{
    toml_table *t = toml_table_inner_or_null(all, extension_names[id]);
    if (t == NULL) {
        return;
    }
    m->ext.has[id] = true;
    for (size_t i = 0; i < EXTENSION_KEYS; i++) {
        const extension_key *k = &extension_keys[i];
        if (k->id != id) {
            continue;
        }
        double *value = extension_value(&m->ext, k);
        *value =
            k->required ? toml_number(t, k->key, *k->range) : toml_number_or(t, k->key, *k->range, *value);
    }
    if (id == EXT_VOLTAGE_DELAY) {
        m->ext.voltage_delay_cycles = (int)toml_integer(t, "cycles", 0, DELAY_CYCLES_MAX);
    }
    if (id == EXT_ANGLE_HARMONIC) {
        m->ext.harmonic_order = (double)toml_integer(t, "order", 1, 2);
    }
    if (id == EXT_PHASE_ASYMMETRY) {
        static const char *const keys[3] = {"dR_a_ohm", "dR_b_ohm", "dR_c_ohm"};
        for (int phase = 0; phase < 3; phase++) {
            if (m->R_ohm + m->ext.dR_ohm[phase] < 0.0) {
                toml_refuse(t, keys[phase], "%s must leave the phase a resistance >= 0, but R_ohm is %g",
                            keys[phase], m->R_ohm);
            }
        }
    }
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
    read.R_ohm = toml_number(t, "R_ohm", TOML_NOT_NEGATIVE);
    read.L_d_H = toml_number(t, "L_d_H", TOML_POSITIVE);
    read.L_q_H = toml_number(t, "L_q_H", TOML_POSITIVE);
    read.psi_f_Wb = toml_number(t, "psi_f_Wb", TOML_NOT_NEGATIVE);
    read.I_rated_A_rms = toml_number(t, "I_rated_A_rms", TOML_POSITIVE);
    read.n_max_rpm = toml_number(t, "n_max_rpm", TOML_POSITIVE);

    t = toml_table_inner(root, "inverter");
    read.f_pwm_Hz = toml_number(t, "f_pwm_Hz", TOML_POSITIVE);
    read.u_dc_V = toml_number(t, "u_dc_V", TOML_POSITIVE);

    t = toml_table_inner_or_null(root, "extension");
    for (int id = 0; id < EXT_COUNT; id++) {
        read_extension(t, (extension_id)id, &read);
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
    toml_file *file = toml_file_open(path, &unread);
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

static void put_extension(FILE *out, extension_id id, motor_extension ext)
{
    fprintf(out, "\n[extension.%s]\n", extension_names[id]);
    if (id == EXT_VOLTAGE_DELAY) {
        fprintf(out, "cycles = %d\n", ext.voltage_delay_cycles);
    }
    if (id == EXT_ANGLE_HARMONIC) {
        put_number(out, "order", ext.harmonic_order);
    }
    for (size_t i = 0; i < EXTENSION_KEYS; i++) {
        if (extension_keys[i].id == id) {
            put_number(out, extension_keys[i].key, *extension_value(&ext, &extension_keys[i]));
        }
    }
}

/* A fit that ran away must not become a file that cannot be read. */
static bool is_finite(const motor *m)
{
    double sum = m->R_ohm + m->L_d_H + m->L_q_H + m->psi_f_Wb + m->I_rated_A_rms + m->n_max_rpm +
                 m->f_pwm_Hz + m->u_dc_V;
    motor_extension ext = m->ext;
    for (size_t i = 0; i < EXTENSION_KEYS; i++) {
        if (ext.has[extension_keys[i].id]) {
            sum += *extension_value(&ext, &extension_keys[i]);
        }
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

    for (int id = 0; id < EXT_COUNT; id++) {
        if (m->ext.has[id]) {
            put_extension(out, (extension_id)id, m->ext);
        }
    }
    return out_file_commit(&f, e);
}
