#include "extension_header.h"

#include "../base/number.h"
#include "../base/out_file.h"

#include <math.h>
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

/* Text inside a comment: nothing in it may end the comment or the line. */
static void put_comment_text(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        fputc(c < 0x20 || c == '*' || c == 0x5c ? '_' : c, out);
    }
}

static const diagnosis_parameter *found(const diagnosis *d, const char *name)
{
    for (size_t k = 0; k < d->causes; k++) {
        for (size_t n = 0; n < d->cause[k].parameters; n++) {
            if (strcmp(d->cause[k].parameter[n].name, name) == 0) {
                return &d->cause[k].parameter[n];
            }
        }
    }
    return NULL;
}

/* One macro; behind it what the diagnosis knows of the parameter `name` of interfaces.md. */
static void define(FILE *out, const diagnosis *d, const char *macro, double value, const char *unit,
                   const char *name, const char *otherwise)
{
    const diagnosis_parameter *p = name != NULL ? found(d, name) : NULL;
    fprintf(out, "#define %s ", macro);
    put_value(out, value);
    fprintf(out, " /* %s", unit);
    if (p != NULL && p->high > p->low) {
        fprintf(out, "; diagnosed, 95 %%: %.6g to %.6g; the file says %.6g", p->low, p->high, p->nominal);
    } else if (p != NULL) {
        fprintf(out, "; diagnosed; the file says %.6g", p->nominal);
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
    const bool zero = found(d, "L_0") != NULL;
    fputs("/* ---- Bases and machine: what iqfoc/params.h takes ---- */\n", out);
    define(out, d, "IQFOC_DIAGNOSED_T_S", 1.0 / m->f_pwm_Hz, "s, control cycle", NULL, same);
    define(out, d, "IQFOC_DIAGNOSED_I_RATED_A", m->I_rated_A_rms, "A rms", NULL, same);
    define(out, d, "IQFOC_DIAGNOSED_U_DC_V", m->u_dc_V, "V", NULL, same);
    define(out, d, "IQFOC_DIAGNOSED_R_OHM", m->R_ohm, "ohm", "R", same);
    define(out, d, "IQFOC_DIAGNOSED_L_D_H", m->L_d_H, zero ? "H, at zero current" : "H",
           both ? "L" : (zero ? "L_0" : "L_d"), same);
    define(out, d, "IQFOC_DIAGNOSED_L_Q_H", m->L_q_H, zero ? "H, at zero current" : "H",
           both ? "L" : (zero ? "L_0" : "L_q"), same);
    define(out, d, "IQFOC_DIAGNOSED_PSI_WB", m->psi_f_Wb, "Wb", "psi_f", same);
    fputs("#define IQFOC_DIAGNOSED_I_BASE_A IQFOC_I_BASE(IQFOC_DIAGNOSED_I_RATED_A)\n\n", out);
}

static void define_sensors(FILE *out, const diagnosis *d)
{
    static const char phase[] = "ABC";
    const motor_extension *x = &d->extended_motor.ext;
    fputs("/* ---- Sensors: measured = g * true + o, recorded angle = true + theta_0, and true at t + "
          "t_delay ---- */\n",
          out);
    for (int n = 0; n < 3; n++) {
        char macro[40];
        char name[8];
        snprintf(macro, sizeof macro, "IQFOC_DIAGNOSED_O_%c_A", phase[n]);
        snprintf(name, sizeof name, "o_%c", "abc"[n]);
        define(out, d, macro, x->has[EXT_CURRENT_OFFSET] ? x->o_A[n] : 0.0, "A", name,
               x->has[EXT_CURRENT_OFFSET] ? "as in the motor file" : "none seen");
    }
    for (int n = 0; n < 3; n++) {
        char macro[40];
        char name[8];
        snprintf(macro, sizeof macro, "IQFOC_DIAGNOSED_G_%c", phase[n]);
        snprintf(name, sizeof name, "g_%c", "abc"[n]);
        define(out, d, macro, x->has[EXT_CURRENT_GAIN] ? x->g[n] : 1.0, "1", name,
               x->has[EXT_CURRENT_GAIN] ? "as in the motor file" : "none seen");
    }
    define(out, d, "IQFOC_DIAGNOSED_THETA_0_RAD", x->has[EXT_ANGLE_OFFSET] ? x->theta_0_rad : 0.0,
           "rad, electrical", "theta_0", x->has[EXT_ANGLE_OFFSET] ? "as in the motor file" : "none seen");
    define(out, d, "IQFOC_DIAGNOSED_T_DELAY_S", x->has[EXT_ANGLE_DELAY] ? x->t_delay_s : 0.0, "s", "t_delay",
           x->has[EXT_ANGLE_DELAY] ? "as in the motor file" : "none seen");
    fputc('\n', out);
}

static void define_voltage(FILE *out, const diagnosis *d)
{
    const motor_extension *x = &d->extended_motor.ext;
    const bool dead = x->has[EXT_DEAD_TIME];
    const bool saturates = x->has[EXT_SATURATION];
    fputs("/* ---- Voltage: applied = k_u * recorded, less v_dead * sat(i / i_knee) of each leg; L = L_0 / "
          "(1 + (i/I_sat)^2) ---- */\n",
          out);
    define(out, d, "IQFOC_DIAGNOSED_K_U", x->has[EXT_VOLTAGE_GAIN] ? x->k_u : 1.0, "1", "k_u",
           x->has[EXT_VOLTAGE_GAIN] ? "as in the motor file" : "none seen");
    define(out, d, "IQFOC_DIAGNOSED_V_DEAD_V", dead ? x->v_dead_V : 0.0, "V", "v_dead",
           dead ? "as in the motor file" : "none seen");
    define(out, d, "IQFOC_DIAGNOSED_I_KNEE_A", dead ? x->i_knee_A : 0.0, "A", "i_knee",
           dead ? "as in the motor file" : "none seen");
    if (saturates) {
        define(out, d, "IQFOC_DIAGNOSED_I_SAT_A", x->I_sat_A, "A", "I_sat", "as in the motor file");
    }
    fputc('\n', out);
}

static void put_initialisers(FILE *out, bool saturates)
{
    fprintf(out,
            "/* iqfoc_extension_t: the corrections of samples, duties and acting voltage. */\n"
            "#define IQFOC_DIAGNOSED_EXTENSION \\\n"
            "    {.i_offset = {IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_A_A, IQFOC_DIAGNOSED_I_BASE_A), \\\n"
            "                  IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_B_A, IQFOC_DIAGNOSED_I_BASE_A), \\\n"
            "                  IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_C_A, IQFOC_DIAGNOSED_I_BASE_A)}, \\\n"
            "     .i_gain_inverse = {IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_A), \\\n"
            "                        IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_B), \\\n"
            "                        IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_C)}, \\\n"
            "     .theta_0 = IQFOC_EXT_ANGLE(IQFOC_DIAGNOSED_THETA_0_RAD), \\\n"
            "     .theta_delay = IQFOC_EXT_DELAY(IQFOC_DIAGNOSED_T_DELAY_S, IQFOC_DIAGNOSED_T_S), \\\n"
            "     .k_u = IQFOC_EXT_K_U(IQFOC_DIAGNOSED_K_U), \\\n"
            "     .v_dead = IQFOC_EXT_VOLTAGE(IQFOC_DIAGNOSED_V_DEAD_V, IQFOC_DIAGNOSED_U_DC_V), \\\n"
            "     .knee_inverse = IQFOC_EXT_KNEE_INVERSE(IQFOC_DIAGNOSED_I_KNEE_A, "
            "IQFOC_DIAGNOSED_I_BASE_A), \\\n"
            "     .saturation = %s}\n\n",
            saturates ? "IQFOC_EXT_SATURATION(IQFOC_DIAGNOSED_I_SAT_A, IQFOC_DIAGNOSED_I_BASE_A)" : "0");
    fputs(
        "/* iqfoc_predictor_t, for a machine with L_d = L_q: their mean stands for both. */\n"
        "#define IQFOC_DIAGNOSED_PREDICTOR \\\n"
        "    IQFOC_PREDICTOR(IQFOC_DIAGNOSED_R_OHM, 0.5 * (IQFOC_DIAGNOSED_L_D_H + IQFOC_DIAGNOSED_L_Q_H), "
        "\\\n"
        "                    IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A, \\\n"
        "                    IQFOC_DIAGNOSED_U_DC_V)\n\n"
        "/* iqfoc_flux_predictor_t, for any machine. */\n"
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

/* Named effects that the firmware has no constant for. */
static void put_rest(FILE *out, const diagnosis *d)
{
    static const extension_id without[] = {EXT_ANGLE_HARMONIC, EXT_VOLTAGE_DELAY, EXT_EMF_HARMONICS,
                                           EXT_PHASE_ASYMMETRY};
    for (size_t k = 0; k < sizeof without / sizeof without[0]; k++) {
        if (d->extended_motor.ext.has[without[k]]) {
            fprintf(out,
                    "/* Not here, because the library has no correction for it: %s. See motor_extended.toml. "
                    "*/\n",
                    motor_extension_id(without[k]));
        }
    }
}

bool extension_header_write(const char *path, const diagnosis *d, const char *recording_path,
                            const char *motor_path, error *e)
{
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    fputs("/*\n * Written by iqfoc diagnose from ", out);
    put_comment_text(out, recording_path);
    fputs(" with ", out);
    put_comment_text(out, motor_path);
    fputs(".\n * ", out);
    put_comment_text(out, d->sentence);
    fputs("\n *\n *     static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;\n"
          " *     static const iqfoc_flux_predictor_t predictor = IQFOC_DIAGNOSED_FLUX_PREDICTOR;\n"
          " *\n * How they are used: iqfoc/extension.h, iqfoc/flux_predictor.h. A value that the library "
          "cannot hold does not compile.\n"
          " */\n#ifndef IQFOC_DIAGNOSED_EXTENSION_H\n#define IQFOC_DIAGNOSED_EXTENSION_H\n\n"
          "#include \"iqfoc/extension_params.h\"\n#include \"iqfoc/flux_predictor.h\"\n\n",
          out);
    define_machine(out, d);
    define_sensors(out, d);
    define_voltage(out, d);
    put_initialisers(out, d->extended_motor.ext.has[EXT_SATURATION]);
    put_rest(out, d);
    fputs("#endif\n", out);
    return out_file_commit(&f, e);
}
