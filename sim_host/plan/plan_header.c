/* A plan as a firmware's header (plan_tell.h). */
#include "plan_tell.h"

#include "base/out_file.h"
#include "base/vector.h"

#include <inttypes.h>
#include <math.h>

static int64_t q48(double x)
{
    return (int64_t)llround(ldexp(x, 48));
}

/* Runs without a ramp have one point, ramps the second at the end of the logged cycles. */
static void put_course(FILE *out, const profile *p, double base_A, double T_s)
{
    const long ramp = p->points > 1 ? lround(p->t_s[1] / T_s) : 0;
    const double per_cycle = ramp > 0 ? (p->value[1] - p->value[0]) / (double)ramp : 0.0;
    const bool squares = p->excitation == EXCITATION_SQUARE;
    fprintf(out, "{INT64_C(%" PRId64 "), INT64_C(%" PRId64 "), INT64_C(%" PRId64 "), %ld, %ld}",
            q48(p->value[0] / base_A), q48(per_cycle / base_A), squares ? q48(p->amplitude / base_A) : 0,
            ramp, squares ? lround(0.5 * p->period_s / T_s) : 0L);
}

static void put_run(FILE *out, const motor *m, const plan_piece *piece, const scenario_run *run, bool last)
{
    const double T_s = 1.0 / m->f_pwm_Hz;
    const double to_turns = T_s / VEC_TWO_PI;
    const double end_s = (double)scenario_run_cycles(run, T_s) * T_s;
    const double theta = run->theta_mech_start_rad * m->pole_pairs / VEC_TWO_PI;
    fprintf(out, "    /* %s */ \\\n    {%ld, %ld, IQ24(%.9f), IQ24(%.9f), IQ24(%.9f), \\\n     ",
            piece->words, run->settle_cycles, scenario_run_cycles(run, T_s),
            motor_speed_rad_s(m, profile_at(&run->speed_rpm, 0.0)) * to_turns,
            motor_speed_rad_s(m, profile_at(&run->speed_rpm, end_s)) * to_turns, theta - floor(theta));
    put_course(out, &run->i_d_A, motor_rated_peak_A(m), T_s);
    fputs(", \\\n     ", out);
    put_course(out, &run->i_q_A, motor_rated_peak_A(m), T_s);
    fputs(last ? "}, \\\n}\n" : "}, \\\n", out);
}

bool plan_write_header(const plan_report *r, const char *path, error *e)
{
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    const size_t count = r->plan.pieces;
    fprintf(
        out,
        "/*\n * Written by iqfoc plan: up to %.6g A and %.6g rpm, %.6g s at %.6g Hz, settling included. For\n"
        " * examples/planned_recording/planned.h: planned_run_t, currents over the rated peak of %.6g A.\n "
        "*/\n"
        "/* clang-format off */\n#ifndef IQFOC_PLAN_H\n#define IQFOC_PLAN_H\n\n#include "
        "\"planned.h\"\n\n#define IQFOC_PLAN_RUNS "
        "%zu\n"
        "#define IQFOC_PLAN \\\n{ \\\n",
        r->limits.current_A, r->limits.speed_rpm, r->plan.seconds, r->motor->f_pwm_Hz,
        motor_rated_peak_A(r->motor), count);
    for (size_t k = 0; k < count; k++) {
        put_run(out, r->motor, &r->plan.piece[k], &r->plan.run[k], k + 1 == count);
    }
    fputs("\n#endif\n", out);
    return out_file_commit(&f, e);
}
