/* iqfoc motor: a first motor file from the values of a data sheet, by options or by questions. */
#define _XOPEN_SOURCE 700 /* isatty */

#include "base/vector.h"
#include "command.h"
#include "data/motor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct request {
    const char *path, *name;
    double pole_pairs, resistance, inductance[2], flux, kv, current, u_dc, f_pwm, speed;
    size_t inductances;
    bool line_to_line, ask;
} request;

static request asked = {.name = "motor"};

static const option_spec specs[] = {
    {"output", 'o', "M.toml", "the motor file to write", .text = &asked.path},
    {"pole-pairs", 0, "N", "pole pairs", .number = &asked.pole_pairs, .low = 1.0, .high = 1000.0},
    {"resistance", 0, "OHM", "resistance of a phase", .number = &asked.resistance, .low = 1e-6, .high = 1e4},
    {"inductance", 0, "H[,H]", "inductance of a phase; two numbers: L_d and L_q", .number = asked.inductance,
     .count = &asked.inductances, .most = 2, .low = 1e-9, .high = 10.0},
    {"flux", 0, "WB", "flux linkage psi_f, peak; or --kv", .number = &asked.flux, .low = 1e-6, .high = 100.0},
    {"kv", 0, "RPM/V", "no-load speed over the peak of the line-to-line voltage", .number = &asked.kv,
     .low = 1e-3, .high = 1e5},
    {"current", 0, "A", "rated current, rms", .number = &asked.current, .low = 1e-3, .high = 1e5},
    {"u-dc", 0, "V", "nominal DC link", .number = &asked.u_dc, .low = 1.0, .high = 1e5},
    {"f-pwm", 0, "HZ", "switching frequency", .number = &asked.f_pwm, .low = 10.0, .high = 1e6},
    {"speed", 0, "RPM", "highest speed; default: where the EMF reaches the DC link", .number = &asked.speed,
     .low = 1e-3, .high = 1e6},
    {"name", 0, "TEXT", "name of the motor; default: motor", .text = &asked.name},
    {"line-to-line", 0, NULL, "resistance and inductance are between two terminals: twice a phase's",
     .flag = &asked.line_to_line},
    {"ask", 0, NULL, "ask for missing values, also if stdin is no terminal", .flag = &asked.ask},
    {.name = NULL}};

const command_about about_motor = {
    "motor",
    "-o M.toml [--pole-pairs N --resistance OHM --inductance H[,H] --flux WB|--kv RPM/V --current A "
    "--u-dc V --f-pwm HZ]",
    "Writes a motor file from the values of a data sheet. On a terminal it asks for those that no option\n"
    "gives. iqfoc diagnose then corrects the values by a recording.",
    specs};

typedef struct question {
    const char *option, *text;
    double *value;
} question;

enum { QUESTIONS = 7 };

/* A positive number on a line of stdin. */
static bool answer(const question *q, error *e)
{
    char line[200];
    char *end = NULL;
    fprintf(stderr, "%s: ", q->text);
    if (fgets(line, sizeof line, stdin) == NULL) {
        return error_input(e, NULL, 0, 0, "motor: %s: no answer; or give --%s", q->text, q->option);
    }
    line[strcspn(line, "\r\n")] = '\0';
    const double value = strtod(line, &end);
    if (end == line || end[strspn(end, " ")] != '\0' || !isfinite(value) || !(value > 0.0)) {
        return error_input(e, NULL, 0, 0, "motor: %s: \"%s\" is no number above 0", q->text, line);
    }
    *q->value = value;
    return true;
}

static bool complete(const options *o, request *r, error *e)
{
    const question questions[QUESTIONS] = {
        {"pole-pairs", "pole pairs", &r->pole_pairs},
        {"resistance",
         r->line_to_line ? "resistance between two terminals, ohm" : "resistance of a phase, ohm",
         &r->resistance},
        {"inductance", r->line_to_line ? "inductance between two terminals, H" : "inductance of a phase, H",
         &r->inductance[0]},
        {"kv", "no-load speed over line-to-line voltage (Kv), rpm/V", &r->kv},
        {"current", "rated current, A rms", &r->current},
        {"u-dc", "DC link, V", &r->u_dc},
        {"f-pwm", "switching frequency, Hz", &r->f_pwm}};
    if (r->path == NULL) {
        return options_missing(o, "output", e);
    }
    if (r->flux > 0.0 && r->kv > 0.0) {
        return error_input(e, NULL, 0, 0, "motor: --flux and --kv are the same quantity; give one of them");
    }
    const bool asks = r->ask || isatty(STDIN_FILENO) == 1;
    for (size_t n = 0; n < QUESTIONS; n++) {
        const question *q = &questions[n];
        if (*q->value > 0.0 || (q->value == &r->kv && r->flux > 0.0)) {
            continue;
        }
        if (!asks) {
            return error_input(e, NULL, 0, 0, "motor: --%s %s%s is missing: %s", q->option,
                               options_find(&about_motor, q->option)->argument,
                               q->value == &r->kv ? " or --flux WB" : "", q->text);
        }
        if (!answer(q, e)) {
            return false;
        }
    }
    return fmod(r->pole_pairs, 1.0) == 0.0 ||
           error_input(e, NULL, 0, 0, "motor: pole pairs: %g is no whole number", r->pole_pairs);
}

static motor motor_of(const request *r)
{
    motor m = motor_blank();
    const double phase = r->line_to_line ? 0.5 : 1.0;
    (void)snprintf(m.name, sizeof m.name, "%s", r->name);
    m.pole_pairs = (int)r->pole_pairs;
    m.R_ohm = phase * r->resistance;
    m.L_d_H = phase * r->inductance[0];
    m.L_q_H = phase * (r->inductances == 2 ? r->inductance[1] : r->inductance[0]);
    /* The line-to-line EMF has the peak sqrt(3) psi_f omega_e. */
    m.psi_f_Wb = r->flux > 0.0
                     ? r->flux
                     : 1.0 / (sqrt(3.0) * motor_speed_rad_s(&(motor){.pole_pairs = m.pole_pairs}, r->kv));
    m.I_rated_A_rms = r->current;
    m.u_dc_V = r->u_dc;
    m.f_pwm_Hz = r->f_pwm;
    m.n_max_rpm = r->speed > 0.0 ? r->speed : r->u_dc / (sqrt(3.0) * m.psi_f_Wb * motor_speed_rad_s(&m, 1.0));
    return m;
}

static bool write_motor(const request *r, error *e)
{
    const motor m = motor_of(r);
    if (!motor_write(r->path, &m, "a first motor file of `iqfoc motor`, from a data sheet", e)) {
        return false;
    }
    const double hertz = motor_speed_rad_s(&m, m.n_max_rpm) / VEC_TWO_PI;
    printf("%s: psi_f = %.4g Wb, n_max = %.4g rpm, SFFR %.3g there (PWM periods per electrical period)\n",
           r->path, m.psi_f_Wb, m.n_max_rpm, m.f_pwm_Hz / hertz);
    if (m.f_pwm_Hz < 3.0 * hertz) {
        printf("note: the library needs SFFR 3 at n_max: --f-pwm %.4g, or --speed %.4g\n", 3.0 * hertz,
               m.n_max_rpm * m.f_pwm_Hz / (3.0 * hertz));
    }
    return true;
}

int cmd_motor(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_motor, argc, argv);
    bool ok = options_read(&o, &e);
    if (ok && !o.helped) {
        ok = options_complete(&o, &e) && complete(&o, &asked, &e) && write_motor(&asked, &e);
    }
    return ok ? STATUS_DONE : error_print(&e);
}
