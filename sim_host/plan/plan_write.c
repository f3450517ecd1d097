/* A plan as a scenario file (plan_tell.h). */
#include "plan_tell.h"

#include "base/number.h"
#include "base/out_file.h"

static void put_number(FILE *out, double value)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(value, text);
    fputs(text, out);
}

static void put_key(FILE *out, const char *key, double value)
{
    fprintf(out, "%s = ", key);
    put_number(out, value);
    fputc('\n', out);
}

/* A course in its shortest form; none without current or speed. */
static void put_course(FILE *out, const char *key, const profile *p)
{
    if (p->points == 1 && p->value[0] == 0.0 && p->excitation == EXCITATION_NONE) {
        return;
    }
    fprintf(out, "%s = ", key);
    if (p->points == 1 && p->excitation == EXCITATION_NONE) {
        put_number(out, p->value[0]);
        fputc('\n', out);
        return;
    }
    if (p->points == 1) {
        fputs("{ value = ", out);
        put_number(out, p->value[0]);
    } else {
        fputs("{ at_s = [0.0, ", out);
        put_number(out, p->t_s[1]);
        fputs("], ramp = [", out);
        put_number(out, p->value[0]);
        fputs(", ", out);
        put_number(out, p->value[1]);
        fputs("]", out);
    }
    if (p->excitation == EXCITATION_SQUARE) {
        fputs(", square = { amplitude = ", out);
        put_number(out, p->amplitude);
        fputs(", period_s = ", out);
        put_number(out, p->period_s);
        fputs(" }", out);
    }
    fputs(" }\n", out);
}

static void put_sensors(FILE *out, const scenario_sensors *s)
{
    fputs("\n[sensors]\n", out);
    if (s->current_bits > 0) {
        fprintf(out, "current_bits = %d\n", s->current_bits);
        put_key(out, "current_full_scale_A", s->current_full_scale_A);
    }
    put_key(out, "current_noise_A", s->current_noise_A);
}

static void put_run(FILE *out, const plan_piece *piece, const scenario_run *run)
{
    fprintf(out, "\n# %s\n[[run]]\ncycles = %ld\nsettle_cycles = %ld\n", piece->words, run->cycles,
            run->settle_cycles);
    put_course(out, "speed_rpm", &run->speed_rpm);
    put_course(out, "i_d_A", &run->i_d_A);
    put_course(out, "i_q_A", &run->i_q_A);
    if (run->u_dc_V > 0.0) {
        put_key(out, "u_dc_V", run->u_dc_V);
    }
    if (run->theta_mech_start_rad != 0.0) {
        put_key(out, "theta_mech_start_rad", run->theta_mech_start_rad);
    }
}

bool plan_write_scenario(const plan_report *r, const char *path, error *e)
{
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    fprintf(out,
            "# Written by iqfoc plan: up to %.6g A and %.6g rpm, %.6g s at %.6g Hz, settling included. At "
            "standstill\n"
            "# the rotor is locked at theta_mech_start_rad; in other runs the test bench holds the speed.\n"
            "name = \"%s\"\n",
            r->limits.current_A, r->limits.speed_rpm, r->plan.seconds, r->motor->f_pwm_Hz,
            r->plan.scenario.name);
    put_sensors(out, &r->plan.scenario.sensors);
    fputs("\n[log]\nduties = true\nmid_currents = false\n", out);
    for (size_t k = 0; k < r->plan.pieces; k++) {
        put_run(out, &r->plan.piece[k], &r->plan.run[k]);
    }
    return out_file_commit(&f, e);
}
