/* The firmware's header of a design, and the design as text (tune_report.h). */
#include "tune_report.h"

#include "drive/firmware.h"
#include "tune_watch.h"

#include "base/number.h"
#include "base/out_file.h"
#include "base/text_out.h"

#include <math.h>
#include <string.h>

/* A double as a C constant: with a point or an exponent, so that it is no integer. */
static void define(FILE *out, const char *macro, double value, const char *comment)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(value, text);
    fprintf(out, "#define %s %s%s /* %s */\n", macro, text, strpbrk(text, ".eE") == NULL ? ".0" : "",
            comment);
}

/* The change detector's constants, or the reason why there are none. */
static void put_watch(FILE *out, const tune_result *r)
{
    const tune_watch w = tune_watch_of(r);
    if (w.none != NULL) {
        fprintf(out, "\n/* No change detector (iqfoc/watch.h): %s. */\n", w.none);
        return;
    }
    const tune_noted from = tune_noted_from(&w);
    fprintf(out,
            "\n/*\n * The change detector of iqfoc/watch.h: iqfoc_watch_config_t. Its bound on false alarms "
            "holds for every machine\n * of the uncertainty set. Smallest detected changes: R %.2g %%, L "
            "%.2g %%, psi_f %.2g %%.\n */\n",
            100.0 * from.R, 100.0 * from.L, 100.0 * from.psi);
    fprintf(out, "#define IQFOC_TUNED_POLE_PAIRS %d\n", r->motor.pole_pairs);
    define(out, "IQFOC_TUNED_NOISE_PU", w.noise_pu, "of a current sample, per unit");
    define(out, "IQFOC_TUNED_UNSURE_R", w.R, "uncertainty of R, share");
    define(out, "IQFOC_TUNED_UNSURE_L", w.L,
           w.fall >= w.L && w.fall > 0.0
               ? "L_d and L_q: fall by the motor file's saturation, up to the rated peak"
               : "L_d and L_q");
    define(out, "IQFOC_TUNED_UNSURE_PSI", w.psi, "psi_f");
    fputs("#define IQFOC_TUNED_WATCH \\\n"
          "    IQFOC_WATCH_CONFIG_KNOWN(IQFOC_TUNED_R_OHM, IQFOC_TUNED_L_D_H, IQFOC_TUNED_L_Q_H, "
          "IQFOC_TUNED_PSI_WB, \\\n"
          "                             IQFOC_TUNED_POLE_PAIRS, IQFOC_TUNED_T_S, "
          "IQFOC_I_BASE(IQFOC_TUNED_I_RATED_A), \\\n"
          "                             IQFOC_TUNED_U_DC_V, IQFOC_TUNED_NOISE_PU, IQFOC_TUNED_UNSURE_R, \\\n"
          "                             IQFOC_TUNED_UNSURE_L, IQFOC_TUNED_UNSURE_PSI)\n",
          out);
}

/* The observer's constants, or the reason why there are none. */
static void put_observer(FILE *out, const tune_report *t)
{
    const tune_observer *o = &t->observer;
    if (o->none != NULL) {
        fprintf(out, "\n/* No observer (iqfoc/observer.h): %s. */\n", o->none);
        return;
    }
    const tune_observer_speed *worst = &o->at[o->disk_worst];
    fprintf(out,
            "\n/*\n * The observer of iqfoc/observer.h, for a drive without an angle sensor: "
            "iqfoc_observer_config_t.\n * Worst disk margin %.2f at %.0f rpm with %s.\n"
            " * Largest steady angle error %.1f degrees, at %.0f rpm.\n */\n",
            worst->disk, worst->rpm, worst->disk_worst, o->at[o->angle_worst].angle_deg,
            o->at[o->angle_worst].rpm);
    define(out, "IQFOC_TUNED_OBSERVER_W", o->bandwidth_rad_s, "rad/s, bandwidth of the phase-locked loop");
    define(out, "IQFOC_TUNED_OBSERVER_GAIN", o->gain_max, "largest gain of the radial correction");
    define(out, "IQFOC_TUNED_OBSERVER_TURNS", o->speed_min, "turns per cycle: least speed");
    define(out, "IQFOC_TUNED_OBSERVER_FLUX", o->flux_max, "limit of the flux' error, share of psi_f");
    define(out, "IQFOC_TUNED_OBSERVER_SATURATION", iq24_to_double(o->config.saturation), "(I_b/I_sat)^2");
    fputs("#define IQFOC_TUNED_OBSERVER \\\n"
          "    {IQFOC_FLUX_PREDICTOR(IQFOC_TUNED_R_OHM, IQFOC_TUNED_L_D_H, IQFOC_TUNED_L_Q_H, "
          "IQFOC_TUNED_PSI_WB, \\\n"
          "                          IQFOC_TUNED_T_S, IQFOC_I_BASE(IQFOC_TUNED_I_RATED_A), "
          "IQFOC_TUNED_U_DC_V), \\\n"
          "     IQ24(IQFOC_TUNED_OBSERVER_SATURATION), IQFOC_CHECKED(IQFOC_TUNED_OBSERVER_GAIN, 0.125, 1.0), "
          "\\\n"
          "     IQ24(IQFOC_RAW_TRACKER_K1_2(IQFOC_RAW_TRACKER_POLE(IQFOC_TUNED_OBSERVER_W, "
          "IQFOC_TUNED_T_S))), \\\n"
          "     IQ24(IQFOC_RAW_TRACKER_K2_2(IQFOC_RAW_TRACKER_POLE(IQFOC_TUNED_OBSERVER_W, "
          "IQFOC_TUNED_T_S))), \\\n"
          "     IQ24(IQFOC_TUNED_OBSERVER_TURNS), IQ24(0.02), \\\n"
          "     IQFOC_FLUX_PSI(IQFOC_TUNED_OBSERVER_FLUX * IQFOC_TUNED_PSI_WB, IQFOC_TUNED_T_S, "
          "IQFOC_TUNED_U_DC_V), \\\n"
          "     8, 50, 2000}\n",
          out);
}

/* The speed control's constants, if an inertia was stated. */
static void put_speed(FILE *out, const tune_report *t)
{
    const tune_speed *s = &t->speed;
    if (s->J_kgm2 == 0.0) {
        return;
    }
    fprintf(out,
            "\n/*\n * The speed control of iqfoc/speed_control.h, and the tracker of iqfoc/tracker.h that it "
            "needs. "
            "Worst disk margin %.2f,\n * with an inertia %.0f %% lower or higher.\n */\n",
            s->disk, 100.0 * TUNE_INERTIA_OFF);
    fprintf(out, "#define IQFOC_TUNED_SPEED_CYCLES %d\n", s->cycles);
    define(out, "IQFOC_TUNED_SPEED_W", s->bandwidth_rad_s, "rad/s, bandwidth");
    define(out, "IQFOC_TUNED_INERTIA_KGM2", s->J_kgm2, "kg m2, rotor and load");
    define(out, "IQFOC_TUNED_RAMP_RPM_S", s->ramp_rpm_s, "rpm per second");
    define(out, "IQFOC_TUNED_TRACKER_W", s->tracker_rad_s, "rad/s, bandwidth of the tracker");
    fprintf(out,
            "#define IQFOC_TUNED_SPEED \\\n"
            "    IQFOC_SPEED_CONTROL(IQFOC_TUNED_SPEED_W, IQFOC_TUNED_INERTIA_KGM2, %d, IQFOC_TUNED_PSI_WB, "
            "IQFOC_TUNED_T_S, \\\n"
            "                        IQFOC_I_BASE(IQFOC_TUNED_I_RATED_A), IQFOC_TUNED_RAMP_RPM_S, \\\n"
            "                        IQFOC_I_BASE(IQFOC_TUNED_I_RATED_A), IQFOC_TUNED_SPEED_CYCLES)\n"
            "#define IQFOC_TUNED_TRACKER IQFOC_TRACKER_GAINS(IQFOC_TUNED_TRACKER_W, IQFOC_TUNED_T_S, "
            "IQ24(0.1), 50)\n",
            t->result.motor.pole_pairs);
}

bool tune_report_header(const tune_report *t, const char *directory, error *e)
{
    const tune_result *r = &t->result;
    const tune_design *d = &r->design;
    char path[1100];
    out_file f;
    (void)snprintf(path, sizeof path, "%s/iqfoc_tuned.h", directory);
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    FILE *out = f.stream;
    fputs("/*\n * Written by iqfoc tune for ", out);
    text_out_comment(out, r->motor.name);
    fprintf(out, ": method %s, bandwidth %.0f rad/s.\n * Limited by ", tune_method_text[r->method],
            r->bandwidth_rad_s);
    text_out_comment(out, r->limited_by);
    fputs(".\n * Uncertainty set:  ", out);
    text_out_comment(out, r->region.source);
    if (r->halves) {
        fputs(".\n *\n * Two updates a carrier period: call iqfoc_tuned_step at each valley and at each "
              "peak, and neither "
              "iqfoc_tuned_peak\n * nor iqfoc_tuned_ripple. A control cycle is half a carrier period",
              out);
    }
    fputs(".\n *\n *     static const iqfoc_tuned_law_t law = IQFOC_TUNED_LAW;\n *\n * Use: "
          "iqfoc/tuned_control.h. A value outside the library's range does not compile.\n */\n"
          "#ifndef IQFOC_TUNED_LAW_H\n#define IQFOC_TUNED_LAW_H\n\n#include "
          "\"iqfoc/tuned_control.h\"\n#include "
          "\"iqfoc/observer.h\"\n#include \"iqfoc/speed_control.h\"\n#include \"iqfoc/tracker.h\"\n#include "
          "\"iqfoc/watch.h\"\n\n",
          out);
    define(out, "IQFOC_TUNED_T_S", d->T_s, "s, control cycle");
    define(out, "IQFOC_TUNED_I_RATED_A", r->motor.I_rated_A_rms, "A rms");
    define(out, "IQFOC_TUNED_U_DC_V", r->motor.u_dc_V, "V");
    define(out, "IQFOC_TUNED_R_OHM", d->machine.R_ohm, "ohm");
    define(out, "IQFOC_TUNED_L_D_H", d->machine.L_d_H, "H");
    define(out, "IQFOC_TUNED_L_Q_H", d->machine.L_q_H, "H");
    define(out, "IQFOC_TUNED_PSI_WB", d->machine.psi_f_Wb, "Wb");
    define(out, "IQFOC_TUNED_KEEP", d->keep, "pole radius: share of an error after one cycle");
    define(out, "IQFOC_TUNED_FOLLOW", d->follow, "reference-filter pole");
    define(out, "IQFOC_TUNED_LEARN", d->learn, "observer gain");
    define(out, "IQFOC_TUNED_LEARN_OFFSET", d->learn_offset, "gain of the valley offset's estimate");
    fputs("\n/* iqfoc_tuned_law_t: machine, keep, follow, learn, learn_offset. */\n"
          "#define IQFOC_TUNED_LAW \\\n"
          "    {IQFOC_SALIENT_MACHINE(IQFOC_TUNED_R_OHM, IQFOC_TUNED_L_D_H, IQFOC_TUNED_L_Q_H, "
          "IQFOC_TUNED_PSI_WB, \\\n"
          "                           IQFOC_TUNED_T_S, IQFOC_I_BASE(IQFOC_TUNED_I_RATED_A), "
          "IQFOC_TUNED_U_DC_V), \\\n"
          "     IQFOC_CHECKED(IQFOC_TUNED_KEEP, 0.0, 1.0), IQFOC_CHECKED(IQFOC_TUNED_FOLLOW, 0.0, 1.0), \\\n"
          "     IQFOC_CHECKED(IQFOC_TUNED_LEARN, 0.0, 1.0), IQFOC_CHECKED(IQFOC_TUNED_LEARN_OFFSET, 0.0, "
          "1.0)}\n",
          out);
    put_watch(out, r);
    put_observer(out, t);
    put_speed(out, t);
    fputs("\n#endif\n", out);
    return out_file_commit(&f, e);
}

static void print_margins(const tune_result *r, FILE *stream)
{
    fprintf(stream, "  %8s%8s%13s%15s%15s%15s   %s\n", "rpm", "SFFR", "disk margin", "gain, dB", "phase, deg",
            "delay, cycles", "worst disk margin with");
    for (int s = 0; s < TUNE_SPEEDS; s += 4) {
        const tune_at_speed *at = &r->at[s];
        char sffr[NUMBER_TEXT_SIZE];
        fprintf(stream, "  %8.0f%8s%13.3f%15.2f%15.1f%15.2f   %s\n", at->rpm,
                number_or_dash(at->sffr, 3, sffr), at->worst.disk, at->worst.gain_dB, at->worst.phase_deg,
                at->worst.delay_cycles, r->region.point[at->disk_worst].text);
    }
}

static void print_fall(const tune_region *region, FILE *stream)
{
    if (region->fall_source != NULL) {
        fprintf(stream, "  L_d down to %.3g %%, L_q to %.3g %% at least: %s\n", -100.0 * region->fall_d,
                -100.0 * region->fall_q, region->fall_source);
    }
    fputc('\n', stream);
}

static void print_observer(const tune_report *t, FILE *stream)
{
    const tune_observer *o = &t->observer;
    if (o->none != NULL) {
        fprintf(stream, "\nWithout an angle sensor: no observer, as %s\n", o->none);
        return;
    }
    const tune_observer_speed *disk = &o->at[o->disk_worst];
    const tune_observer_speed *angle = &o->at[o->angle_worst];
    const tune_observer_trial *trial = &t->observer_trial;
    fprintf(stream,
            "\nWithout an angle sensor: bandwidth of the observer's loop %.0f rad/s%s, largest gain %g\n"
            "  run-up in %g s; noise of a current sensor %.3g A (%s)\n"
            "  worst disk margin %.3f at %.0f rpm with %s\n"
            "  largest steady angle error %.1f degrees at %.0f rpm with %s\n"
            "  %8s%8s%13s%13s%15s%15s\n",
            o->bandwidth_rad_s, o->fastest ? ", the highest" : "", o->gain_max, o->run_up_s, o->noise_A,
            o->noise_measured ? "by the diagnosis" : "assumed", disk->disk, disk->rpm, disk->disk_worst,
            angle->angle_deg, angle->rpm, angle->angle_worst, "rpm", "SFFR", "disk margin", "nominal",
            "angle, deg", "noise, deg");
    for (int s = 1; s < TUNE_OBSERVER_SPEEDS; s += 2) {
        const tune_observer_speed *at = &o->at[s];
        fprintf(stream, "  %8.0f%8.3g%13.3f%13.3f%15.1f%15.3f\n", at->rpm, at->sffr, at->disk,
                at->disk_nominal, at->angle_deg, at->noise_deg);
    }
    fprintf(
        stream,
        "  simulated: %d drives; unstable %d, lost lock %d; largest angle error predicted %.1f, simulated "
        "%.1f degrees, largest difference %.2f\n",
        trial->drives, trial->unstable, trial->lost, trial->predicted_deg, trial->simulated_deg,
        trial->off_deg);
}

static void print_speed(const tune_speed *s, FILE *stream)
{
    static const char *const shaft[TUNE_SHAFTS] = {"inertia high", "as stated", "inertia low"};
    fprintf(stream,
            "\nSpeed control for %g kg m2: bandwidth %.3g rad/s, a step every %d cycles, tracker %.3g rad/s\n"
            "  worst disk margin %.3f with an inertia %.0f %% lower or higher; as stated %.3f\n"
            "  ramp %.4g rpm/s%s; load of %.3g %% of the rated torque: predicted dip %.3g rpm\n"
            "  simulated up to %.0f rpm   overshoot, rpm   dip, rpm   back within a tenth of the dip, ms\n",
            s->J_kgm2, s->bandwidth_rad_s, s->cycles, s->tracker_rad_s, s->disk, 100.0 * TUNE_INERTIA_OFF,
            s->disk_nominal, s->ramp_rpm_s, s->ramp_limited ? ", limited by the rated current" : "",
            100.0 * s->load, s->dip_rpm, s->rpm);
    for (int n = 0; n < TUNE_SHAFTS; n++) {
        char text[200];
        fprintf(stream, "  %-26s %14.3g %10.3g %35.3g", shaft[n], s->overshoot_rpm[n], s->found_dip_rpm[n],
                1e3 * s->settled_s[n]);
        if (s->lost[n]) {
            fputs("   lost: the speed ran away", stream);
        } else if (s->status[n] != 0) {
            fprintf(stream, "   status: %s", drive_status_text(s->status[n], text, sizeof text));
        }
        fputc('\n', stream);
    }
}

void tune_report_print(const tune_report *t, FILE *stream)
{
    const tune_result *r = &t->result;
    const tune_trial *trial = &t->trial;
    fprintf(stream,
            "%s, %g Hz%s: %s, bandwidth %.0f rad/s\n  limited by %s\n  uncertainty set: %s (%d machines)\n",
            r->motor.name, r->motor.f_pwm_Hz, r->halves ? " control, two updates a carrier period" : "",
            tune_method_text[r->method], r->bandwidth_rad_s, r->limited_by, r->region.source,
            r->region.points);
    print_fall(&r->region, stream);
    fprintf(stream, "Smallest margins over the uncertainty set\n");
    print_margins(r, stream);
    fprintf(stream,
            "\nStep of i_q in the plant: %d drives of the uncertainty set, each at its own speed up to %.0f "
            "rpm\n  unstable drives: %d\n  largest overshoot: predicted %.1f %%, simulated %.1f %%\n  "
            "longest settling: predicted %.0f cycles, simulated %.0f cycles\n  drives that settle later than "
            "predicted, by more than a tenth and a cycle: %d\n  drives that overshoot by a tenth of the step "
            "more than predicted: %d\n",
            trial->drives, trial->rpm_most, trial->unstable, trial->promised.overshoot_percent,
            trial->found.overshoot_percent, trial->promised.settling_cycles, trial->found.settling_cycles,
            trial->late, trial->high);
    print_observer(t, stream);
    if (t->speed.J_kgm2 > 0.0) {
        print_speed(&t->speed, stream);
    }
}
