/* The studies of closed loops, run and printed (loops_study.h). */
#include "loops_study.h"

#include "run_up_show.h"

#include <math.h>

const char *const six_step_loop_text[SIX_STEP_LOOPS] = {"discrete angle", "corrected, 2016 (10)"};

bool loops_study_run(loops_study *s, error *e)
{
    return six_step_loop_run(false, &s->six_step[SIX_STEP_DISCRETE], e) &&
           six_step_loop_run(true, &s->six_step[SIX_STEP_CORRECTED], e) &&
           current_loops_run(&s->current, e) && finite_set_loops_run(&s->finite_set, e) &&
           run_ups_run(s->run_ups, e) && update_loops_run(&s->updates, e) &&
           corrected_loops_run(&s->corrected, e) && sensorless_loops_run(&s->sensorless, e);
}

static void print_six_step(const loops_study *s, FILE *f)
{
    fprintf(f, "Six-step torque control at %g rpm, %g V, i_q asked for %.4g A\n  %-24s%12s%12s%12s%12s%14s\n",
            SIX_STEP_RPM, SIX_STEP_U_DC, s->six_step[0].reference_A, "feedback", "fed back, A", "true i_q, A",
            "excess, %", "torque, Nm", "asked for, Nm");
    for (int n = 0; n < SIX_STEP_LOOPS; n++) {
        const six_step_loop *l = &s->six_step[n];
        fprintf(f, "  %-24s%12.4f%12.4f%12.3f%12.4f%14.4f\n", six_step_loop_text[n], l->i_q_fed_back_A,
                l->i_q_A, six_step_excess_percent(l), l->torque_Nm, l->torque_reference_Nm);
    }
}

static const char *settling(const loop_result *r, char text[16])
{
    if (r->settling_cycles < 0) {
        return "-";
    }
    (void)snprintf(text, 16, "%d", r->settling_cycles);
    return text;
}

static void print_current(const loops_study *s, FILE *f)
{
    fprintf(
        f,
        "\nCurrent loops at %g rpm, step of i_q from 30 %% to 70 %% of rated, right parameters; percent of "
        "the rated peak\n  %5s  %-26s%-10s%10s%10s%10s%10s%10s%10s%10s\n",
        LOOP_RPM, "SFFR", "loop", "outcome", "rms", "rest", "start", "overshoot", "settling", "THD",
        "L up to");
    for (int k = 0; k < LOOP_RATIOS; k++) {
        for (int n = 0; n < LOOP_METHODS; n++) {
            const loop_result *r = &s->current.at[k][LOOP_NOMINAL][n];
            char text[16];
            fprintf(f, "  %5g  %-26s%-10s%10.3f%10.3f%10.1f%10.1f%10s%10.2f%10.2f\n", loop_ratios[k],
                    loop_method_text[n], loop_outcome_text(r->outcome), r->rms_percent, r->wander_percent,
                    r->start_percent, r->overshoot_percent, settling(r, text), r->thd_percent,
                    s->current.L_most[k][n]);
        }
    }
    fprintf(f, "\nThe same with wrong parameters: rms error, percent of the rated peak\n  %5s  %-26s", "SFFR",
            "loop");
    for (int b = 0; b < LOOP_BELIEFS; b++) {
        fprintf(f, "%10s", loop_beliefs[b].key);
    }
    fprintf(f, "%10s\n", "noise");
    for (int k = 0; k < LOOP_RATIOS; k++) {
        for (int n = 0; n < LOOP_METHODS; n++) {
            fprintf(f, "  %5g  %-26s", loop_ratios[k], loop_method_text[n]);
            for (int b = 0; b < LOOP_BELIEFS; b++) {
                const loop_result *r = &s->current.at[k][b][n];
                if (r->outcome == LOOP_TRIPS) {
                    fprintf(f, "%10s", "trips");
                } else {
                    fprintf(f, "%9.2f%c", r->rms_percent, r->outcome == LOOP_UNSTABLE ? '*' : ' ');
                }
            }
            fprintf(f, "%9.2f \n", s->current.noisy[k][n].rms_percent);
        }
    }
    fprintf(f, "  *: unstable, varies by more than %g %%. trips: beyond %g times rated.\n",
            100.0 * LOOP_WANDER_LIMIT, LOOP_TRIP_LIMIT);
}

static void print_point(FILE *f, const char *what, double share, int horizon, const finite_set_point *p)
{
    fprintf(f, "  %8g  %-16s%8d%10.2f%10.2f%10.2f%10.0f%10.1f\n", share, what, horizon, p->loop.rms_percent,
            p->loop.offset_percent, p->loop.thd_percent, p->loop.switching_Hz, p->nodes);
}

static void print_finite_set(const loops_study *s, FILE *f)
{
    const finite_set_loops *all = &s->finite_set;
    fprintf(f,
            "\nFinite control set, no weight on switching; percent of the rated peak\n"
            "  intervals\n  a period  predictor        horizon       rms    offset       THD  pulses/s     "
            "nodes\n");
    for (int k = 0; k < FINITE_SET_RATIOS; k++) {
        for (int p = 0; p < FINITE_SET_PREDICTORS; p++) {
            for (int h = 0; h < IQFOC_FINITE_SET_HORIZON; h++) {
                print_point(f, loop_model_text[p], finite_set_ratios[k], h + 1, &all->at[k][p][h]);
            }
        }
    }
    fprintf(f, "\nThe same at %g intervals a period, exact predictor, over the weight of a leg's switching\n",
            FINITE_SET_TRADE_RATIO);
    for (int w = 0; w < FINITE_SET_WEIGHTS; w++) {
        for (int h = 0; h < IQFOC_FINITE_SET_HORIZON; h++) {
            print_point(f, "exact", finite_set_weights[w], h + 1, &all->trade[h][w]);
        }
        if (all->pwm_ratio[w] > 0.0) {
            fprintf(f, "  %8s  %-16s%8s%10.2f%10.2f%10.2f%10.0f\n", "", "deadbeat, PWM", "",
                    all->pwm[w].rms_percent, all->pwm[w].offset_percent, all->pwm[w].thd_percent,
                    all->pwm[w].switching_Hz);
        }
    }
}

void loops_study_print(const loops_study *s, FILE *stream)
{
    print_six_step(s, stream);
    print_current(s, stream);
    print_finite_set(s, stream);
    corrected_loops_print(&s->corrected, stream);
    update_loops_print(&s->updates, stream);
    sensorless_loops_print(&s->sensorless, stream);
    run_ups_print(s->run_ups, stream);
    fprintf(stream, "Seed of the noise: %llu.\n", (unsigned long long)LOOP_SEED);
}
