/* The firmware's header (extension_header.h). */
#include "extension_header.h"

#include "base/number.h"
#include "base/out_file.h"
#include "base/text_out.h"
#include "extension_host.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* A double as a C constant: with a point or an exponent, so that no integer arithmetic creeps in. */
static void put_value(FILE *out, double x)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(x, text);
    fputs(text, out);
    if (strpbrk(text, ".eE") == NULL) {
        fputs(".0", out);
    }
}

static const diagnosis_parameter *found(const diagnosis *d, const char *name)
{
    for (size_t k = 0; k < d->causes + d->minors; k++) {
        const diagnosis_cause *cause = k < d->causes ? &d->cause[k] : &d->minor[k - d->causes];
        for (size_t n = 0; n < cause->parameters; n++) {
            if (strcmp(cause->parameter[n].name, name) == 0) {
                return &cause->parameter[n];
            }
        }
    }
    return NULL;
}

/* One macro; behind it the diagnosed interval of the parameter `name` of interfaces.md. */
static void define(FILE *out, const diagnosis *d, const char *macro, double value, const char *unit,
                   const char *name, const char *otherwise)
{
    const diagnosis_parameter *p = name != NULL ? found(d, name) : NULL;
    fprintf(out, "#define %s ", macro);
    put_value(out, value);
    fprintf(out, " /* %s", unit);
    if (p != NULL && p->high > p->low) {
        fprintf(out, "; diagnosed, 95 %%: %.6g to %.6g; motor file %.6g", p->low, p->high, p->nominal);
    } else if (p != NULL) {
        fprintf(out, "; diagnosed; motor file %.6g", p->nominal);
    } else {
        fprintf(out, "; %s", otherwise);
    }
    fputs(" */\n", out);
}

static void define_machine(FILE *out, const diagnosis *d)
{
    static const char same[] = "as in the motor file";
    const motor *m = &d->extended_motor;
    const bool both = found(d, "L") != NULL;
    const bool map = found(d, "L_d0") != NULL;
    const bool zero = map || found(d, "L_0") != NULL;
    fputs("/* ---- Bases and machine: what iqfoc/params.h takes ---- */\n", out);
    define(out, d, "IQFOC_DIAGNOSED_T_S", 1.0 / m->f_pwm_Hz, "s, control cycle", NULL, same);
    define(out, d, "IQFOC_DIAGNOSED_I_RATED_A", m->I_rated_A_rms, "A rms", NULL, same);
    define(out, d, "IQFOC_DIAGNOSED_U_DC_V", m->u_dc_V, "V", NULL, same);
    define(out, d, "IQFOC_DIAGNOSED_R_OHM", m->R_ohm, "ohm", "R", same);
    define(out, d, "IQFOC_DIAGNOSED_L_D_H", m->L_d_H, zero ? "H, at zero current" : "H",
           both ? "L" : (map ? "L_d0" : (zero ? "L_0" : "L_d")), same);
    define(out, d, "IQFOC_DIAGNOSED_L_Q_H", m->L_q_H, zero ? "H, at zero current" : "H",
           both ? "L" : (map ? "L_q0" : (zero ? "L_0" : "L_q")), same);
    define(out, d, "IQFOC_DIAGNOSED_PSI_WB", m->psi_f_Wb, "Wb", "psi_f", same);
    fputs("#define IQFOC_DIAGNOSED_I_BASE_A IQFOC_I_BASE(IQFOC_DIAGNOSED_I_RATED_A)\n\n", out);
}

/* "v_dead_V" -> "IQFOC_DIAGNOSED_V_DEAD_V". */
static void macro_of(const motor_value *v, char *text, size_t size)
{
    snprintf(text, size, "IQFOC_DIAGNOSED_%s", v->key);
    for (char *c = text; *c != '\0'; c++) {
        *c = (char)toupper((unsigned char)*c);
    }
}

/* The parameters of all causes that the library has a correction for. */
static void define_corrections(FILE *out, const diagnosis *d)
{
    const motor *m = &d->extended_motor;
    fputs("/* ---- Sensors: measured = g * true + o, recorded angle = true + theta_0, and true at t + "
          "t_delay.\n"
          " * Voltage: applied = k_u * recorded, less v_dead * sat(i / i_knee) of each leg. L = L_0 / (1 + "
          "(i/I_sat)^2). ---- */\n",
          out);
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        const bool there = m->ext.has[v->cause];
        /* The inductances are above; I_sat is there only if the iron saturates. */
        const bool beyond = isnan(v->absent);
        char macro[64];
        /* A rate is that of one recording: no constant of a firmware follows it. */
        if (v->of_machine || v->kind == VALUE_RATE || cause_table[v->cause].firmware != FIRMWARE_HOLDS ||
            (v->cause == CAUSE_SATURATION && (!there || v->offset != offsetof(motor, ext.I_sat_A)))) {
            continue;
        }
        macro_of(v, macro, sizeof macro);
        const double absent = beyond ? 0.0 : v->absent;
        define(out, d, macro, there ? motor_value_of(m, v) : absent, v->unit, v->name,
               there ? "as in the motor file" : "none seen");
    }
    fputc('\n', out);
}

static void put_initialisers(FILE *out, bool saturates, bool map)
{
    fprintf(out,
            "/* iqfoc_extension_t: the corrections of samples, duties and acting voltage, in the order of "
            "its members. */\n"
            "#define IQFOC_DIAGNOSED_EXTENSION \\\n"
            "    {{IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_A_A, IQFOC_DIAGNOSED_I_BASE_A), \\\n"
            "      IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_B_A, IQFOC_DIAGNOSED_I_BASE_A), \\\n"
            "      IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_C_A, IQFOC_DIAGNOSED_I_BASE_A)}, \\\n"
            "     {IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_A), \\\n"
            "      IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_B), \\\n"
            "      IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_C)}, \\\n"
            "     IQFOC_EXT_ANGLE(IQFOC_DIAGNOSED_THETA_0_RAD), \\\n"
            "     IQFOC_EXT_DELAY(IQFOC_DIAGNOSED_T_DELAY_S, IQFOC_DIAGNOSED_T_S), \\\n"
            "     IQFOC_EXT_K_U(IQFOC_DIAGNOSED_K_U), \\\n"
            "     IQFOC_EXT_VOLTAGE(IQFOC_DIAGNOSED_V_DEAD_V, IQFOC_DIAGNOSED_U_DC_V), \\\n"
            "     IQFOC_EXT_KNEE_INVERSE(IQFOC_DIAGNOSED_I_KNEE_A, "
            "IQFOC_DIAGNOSED_I_BASE_A), \\\n"
            "     %s}\n\n",
            saturates ? "IQFOC_EXT_SATURATION(IQFOC_DIAGNOSED_I_SAT_A, IQFOC_DIAGNOSED_I_BASE_A)" : "0");
    fputs("/* iqfoc_predictor_t, for a machine with L_d = L_q: it uses their mean. */\n"
          "#define IQFOC_DIAGNOSED_PREDICTOR \\\n"
          "    IQFOC_PREDICTOR(IQFOC_DIAGNOSED_R_OHM, 0.5 * (IQFOC_DIAGNOSED_L_D_H + IQFOC_DIAGNOSED_L_Q_H), "
          "\\\n"
          "                    IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A, \\\n"
          "                    IQFOC_DIAGNOSED_U_DC_V)\n\n",
          out);
    fputs(map ? "/* iqfoc_flux_predictor_t, near zero current: beyond, "
                "IQFOC_DIAGNOSED_FLUX_MAP takes its place. */\n"
              : "/* iqfoc_flux_predictor_t, for any machine. */\n",
          out);
    fputs(
        "#define IQFOC_DIAGNOSED_FLUX_PREDICTOR \\\n"
        "    IQFOC_FLUX_PREDICTOR(IQFOC_DIAGNOSED_R_OHM, IQFOC_DIAGNOSED_L_D_H, IQFOC_DIAGNOSED_L_Q_H, \\\n"
        "                         IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A, \\\n"
        "                         IQFOC_DIAGNOSED_U_DC_V)\n\n"
        "/* iqfoc_current_control_gains_t for a closed loop of w_rad_s. */\n"
        "#define IQFOC_DIAGNOSED_GAINS(w_rad_s) \\\n"
        "    IQFOC_GAINS(w_rad_s, IQFOC_DIAGNOSED_R_OHM, IQFOC_DIAGNOSED_L_D_H, IQFOC_DIAGNOSED_L_Q_H, \\\n"
        "                IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A, "
        "IQFOC_DIAGNOSED_U_DC_V)\n\n",
        out);
}

/* Numbers and initialiser of part k of a flux map. */
static void define_part(FILE *out, const diagnosis *d, const firmware_map *map, size_t k)
{
    static const char *const name[IQFOC_FLUX_MAP_PARTS][4] = {{"E_1", "I_d1", "I_q1", "I_c1"},
                                                              {"E_2", "I_d2", "I_q2", "I_c2"}};
    static const char *const macro[IQFOC_FLUX_MAP_PARTS][4] = {
        {"IQFOC_DIAGNOSED_E_1_J", "IQFOC_DIAGNOSED_I_D1_A", "IQFOC_DIAGNOSED_I_Q1_A",
         "IQFOC_DIAGNOSED_I_C1_A"},
        {"IQFOC_DIAGNOSED_E_2_J", "IQFOC_DIAGNOSED_I_D2_A", "IQFOC_DIAGNOSED_I_Q2_A",
         "IQFOC_DIAGNOSED_I_C2_A"}};
    const flux_map_values *v = &map->values;
    const double value[] = {v->part[k].E_J, v->part[k].I_d_A, v->part[k].I_q_A, v->part[k].I_c_A};
    if (v->part[k].E_J == 0.0) {
        fprintf(out, "#define IQFOC_DIAGNOSED_PART_%zu IQFOC_FLUX_MAP_NO_PART\n", k + 1);
        return;
    }
    for (size_t n = 0; n < 4; n++) {
        define(out, d, macro[k][n], value[n], n == 0 ? "J" : "A", map->fitted ? NULL : name[k][n],
               map->fitted ? "fitted" : "as in the motor file");
    }
    fprintf(
        out,
        "#define IQFOC_DIAGNOSED_PART_%zu \\\n"
        "    IQFOC_FLUX_MAP_PART(%s, %s, %s, %s, \\\n"
        "                        IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A, IQFOC_DIAGNOSED_U_DC_V)\n",
        k + 1, macro[k][0], macro[k][1], macro[k][2], macro[k][3]);
}

/* A flux map of parts that saturate, for iqfoc/flux_map.h. */
static void define_map(FILE *out, const diagnosis *d, const firmware_map *map)
{
    const flux_map_values *v = &map->values;
    const char *made = map->fitted ? "fitted" : "made of the numbers of the map";
    fputs("/* ---- Flux map: straight iron, and parts that saturate, E sqrt(1 + ((i_d - I_c)/I_d)^2 + "
          "(i_q/I_q)^2) "
          "of the energy. ---- */\n",
          out);
    if (map->fitted) {
        fprintf(out,
                "/* Fitted to the map of motor_extended.toml: their flux is %.2g %% off it over the recorded "
                "currents, rms. */\n",
                100.0 * map->off);
    }
    define(out, d, "IQFOC_DIAGNOSED_L_D_STRAIGHT_H", v->L_d_H, "H, of straight iron", NULL, made);
    define(out, d, "IQFOC_DIAGNOSED_L_Q_STRAIGHT_H", v->L_q_H, "H, of straight iron", NULL, made);
    define(out, d, "IQFOC_DIAGNOSED_PSI_MAP_WB", v->psi_Wb, "Wb, psi_f and the parts' at their centres", NULL,
           made);
    for (size_t k = 0; k < IQFOC_FLUX_MAP_PARTS; k++) {
        define_part(out, d, map, k);
    }
    fputs(
        "\n/* iqfoc_flux_map_t, in place of iqfoc_flux_predictor_t: IQFOC_MODEL_FLUX_MAP, or "
        "iqfoc_flux_map_step. */\n"
        "#define IQFOC_DIAGNOSED_FLUX_MAP \\\n"
        "    IQFOC_FLUX_MAP(IQFOC_DIAGNOSED_R_OHM, IQFOC_DIAGNOSED_L_D_STRAIGHT_H, "
        "IQFOC_DIAGNOSED_L_Q_STRAIGHT_H, \\\n"
        "                   IQFOC_DIAGNOSED_PSI_MAP_WB, IQFOC_DIAGNOSED_PART_1, IQFOC_DIAGNOSED_PART_2, \\\n"
        "                   IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A, IQFOC_DIAGNOSED_U_DC_V)\n\n",
        out);
}

/* Named effects that the firmware has no constant for. */
static void put_rest(FILE *out, const diagnosis *d, const firmware_map *map)
{
    for (int id = 0; id < CAUSE_COUNT; id++) {
        if (motor_has_first(&d->extended_motor, (cause_id)id) &&
            firmware_correction(map, (cause_id)id) != FIRMWARE_HOLDS) {
            fprintf(out,
                    "/* Not in this header: the library has no correction for %s. See motor_extended.toml. "
                    "*/\n",
                    cause_table[id].id);
        }
    }
}

bool extension_header_write(const char *path, const diagnosis *d, const firmware_map *map, error *e)
{
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    fputs("/*\n * Written by iqfoc diagnose from ", out);
    text_out_comment(out, d->recording_path);
    fputs(" with ", out);
    text_out_comment(out, d->motor_path);
    fputs(".\n * ", out);
    text_out_comment(out, d->sentence);
    fputs("\n *\n *     static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;\n"
          " *     static const ",
          out);
    fputs(map->there ? "iqfoc_flux_map_t predictor = IQFOC_DIAGNOSED_FLUX_MAP;\n"
                     : "iqfoc_flux_predictor_t predictor = IQFOC_DIAGNOSED_FLUX_PREDICTOR;\n",
          out);
    fputs(" *\n * How they are used: iqfoc/extension.h, iqfoc/flux_predictor.h, iqfoc/flux_map.h. "
          "A value outside the library's range does not compile.\n"
          " */\n#ifndef IQFOC_DIAGNOSED_EXTENSION_H\n#define IQFOC_DIAGNOSED_EXTENSION_H\n\n"
          "#include \"iqfoc/current_control.h\"\n#include \"iqfoc/extension_params.h\"\n#include "
          "\"iqfoc/flux_map.h\"\n#include \"iqfoc/flux_predictor.h\"\n\n",
          out);
    define_machine(out, d);
    define_corrections(out, d);
    put_initialisers(out, d->extended_motor.ext.has[CAUSE_SATURATION], map->there);
    if (map->there) {
        define_map(out, d, map);
    }
    put_rest(out, d, map);
    fputs("#endif\n", out);
    return out_file_commit(&f, e);
}
