/* The scenario file, read and checked (scenario.h). */
#include "scenario.h"

#include "toml_table.h"

#include <math.h>
#include <stdlib.h>

enum {
    ADC_BITS_MAX = 24,
    SETTLE_CYCLES = 200, /* at the default bandwidth the current settles within 20 cycles */
    CYCLES_MAX = 100000000,
};

static const toml_range duration_range = {.min = 0.0, .max = 36000.0, .min_open = true};

static void read_control(toml_table *t, scenario_control *control)
{
    static const char *const feedbacks[] = {"midpoint", "corrected_mean", "quasi_discrete_mean"};
    static const char *const modulations[] = {"pwm", "six_step", "pattern"};
    static const char *const angles[] = {"measured", "observed"};

    control->angle = (scenario_angle)toml_choice_or(t, "angle", angles, 2, ANGLE_MEASURED);
    control->feedback = (scenario_feedback)toml_choice_or(t, "feedback", feedbacks, 3, FEEDBACK_MIDPOINT);
    control->modulation =
        (scenario_modulation)toml_choice_or(t, "modulation", modulations, 3, MODULATION_PWM);
    control->bandwidth_Hz = toml_number_or(t, "bandwidth_Hz", TOML_POSITIVE, 0.0);
    control->updates = (int)toml_integer_or(t, "updates", 1, 2, 1);
    if (control->updates == 2 &&
        (control->feedback != FEEDBACK_QUASI_DISCRETE_MEAN || control->modulation != MODULATION_PWM)) {
        toml_refuse(
            t, "updates",
            "updates = 2 needs feedback = \"quasi_discrete_mean\" and modulation = \"pwm\": half a carrier "
            "period has no sample in its middle");
    }
    if (control->angle == ANGLE_OBSERVED &&
        (control->updates == 2 || control->modulation != MODULATION_PWM)) {
        toml_refuse(t, "angle", "angle = \"observed\" needs updates = 1 and modulation = \"pwm\"");
    }
}

/* Pulses of a pattern in a turn; 0 with another modulation. The pattern's control has no other feedback than the flux. */
static int read_pulses(toml_table *t, scenario_modulation modulation)
{
    static const char *const of_duties[] = {"feedback", "bandwidth_Hz"};
    const bool pattern = modulation == MODULATION_PATTERN;
    const long pulses =
        toml_integer_or(t, "pulses", PATTERN_PULSES_LEAST, PATTERN_PULSES_MOST, PATTERN_PULSES_LEAST);
    if (pattern != toml_has(t, "pulses")) {
        toml_refuse(t, "pulses", "expected pulses and modulation = \"pattern\" together, or none of them");
    } else if (pulses % 2 == 0) {
        toml_refuse(t, "pulses", "pulses = %ld, expected an odd number from %d to %d", pulses,
                    PATTERN_PULSES_LEAST, PATTERN_PULSES_MOST);
    }
    for (int k = 0; pattern && k < 2; k++) {
        if (toml_has(t, of_duties[k])) {
            toml_refuse(t, of_duties[k], "%s needs duties; modulation = \"pattern\" controls the flux",
                        of_duties[k]);
        }
    }
    return pattern ? (int)pulses : 0;
}

static void read_sensors(toml_table *t, scenario_sensors *sensors)
{
    sensors->current_bits = (int)toml_integer_or(t, "current_bits", 0, ADC_BITS_MAX, 0);
    sensors->current_full_scale_A = toml_number_or(t, "current_full_scale_A", TOML_POSITIVE, 0.0);
    sensors->current_noise_A = toml_number_or(t, "current_noise_A", TOML_NOT_NEGATIVE, 0.0);
    const size_t offsets = toml_numbers(t, "current_offset_A", TOML_ANY, sensors->current_offset_A, 3);
    sensors->current_bandwidth_Hz = toml_number_or(t, "current_bandwidth_Hz", TOML_POSITIVE, 0.0);
    sensors->angle_noise_rad = toml_number_or(t, "angle_noise_rad", TOML_NOT_NEGATIVE, 0.0);
    sensors->speed_noise_rad_s = toml_number_or(t, "speed_noise_rad_s", TOML_NOT_NEGATIVE, 0.0);
    sensors->u_dc_noise_V = toml_number_or(t, "u_dc_noise_V", TOML_NOT_NEGATIVE, 0.0);

    if (offsets != 0 && offsets != 3) {
        toml_refuse(t, "current_offset_A",
                    "current_offset_A must hold one number for each of the three phases");
    }
    if (sensors->current_bits > 0 && sensors->current_full_scale_A == 0.0) {
        toml_refuse(t, "current_bits",
                    "current_bits needs current_full_scale_A, the current at the end of the ADC's range");
    }
}

/* The plant puts a command out at the start of a PWM period. */
static pwm_updates read_pwm(toml_table *root, const scenario_control *control)
{
    toml_table *t = toml_table_inner_or_null(root, "pwm");
    const pwm_updates p = pwm_updates_read(t, toml_table_inner_or_null(root, "sensors"));
    const double periods_late = p.delay_cycles * (double)p.periods;
    if (!pwm_updates_is_plain(&p) && (control->updates == 2 || control->modulation != MODULATION_PWM)) {
        toml_refuse(root, "pwm", "[pwm] and shunts need updates = 1 and modulation = \"pwm\"");
    } else if (fabs(periods_late - round(periods_late)) > 1e-9) {
        toml_refuse(t, "delay_cycles",
                    "delay_cycles = %g, expected a whole number of PWM periods in a simulation: n / %d",
                    p.delay_cycles, p.periods);
    }
    return p;
}

static void read_log(toml_table *t, const scenario_control *control, scenario_log *log)
{
    log->voltages = toml_flag_or(t, "voltages", true);
    log->duties = toml_flag_or(t, "duties", false);
    log->u_dc = toml_flag_or(t, "u_dc", log->duties);
    log->third_current = toml_flag_or(t, "third_current", true);
    log->mid_currents = toml_flag_or(t, "mid_currents", control->updates != 2);
    log->mechanical_angle = toml_flag_or(t, "mechanical_angle", false);

    if (!log->voltages && !log->duties) {
        toml_refuse(t, "voltages", "a recording needs voltages or duties");
    }
    if (log->mid_currents && control->updates == 2) {
        toml_refuse(t, "mid_currents",
                    "updates = 2 has no mid_currents: half a carrier period has no sample in its middle");
    }
    if (log->duties && !log->u_dc) {
        toml_refuse(t, "u_dc", "duties need u_dc");
    }
}

static void read_duration(toml_table *t, scenario_run *run)
{
    run->cycles = toml_integer_or(t, "cycles", 1, CYCLES_MAX, 0);
    run->duration_s = toml_number_or(t, "duration_s", duration_range, 0.0);
    if (toml_has(t, "cycles") && toml_has(t, "duration_s")) {
        toml_refuse(t, "duration_s", "a run has cycles or duration_s, not both");
    } else if (!toml_has(t, "cycles") && !toml_has(t, "duration_s")) {
        toml_refuse(t, "duration_s", "cycles or duration_s is missing in this [[run]]");
    }
}

static void read_shaft(toml_table *run_table, scenario_run *run)
{
    if (toml_has(run_table, "shaft") && toml_has(run_table, "speed_rpm")) {
        toml_refuse(run_table, "speed_rpm",
                    "a run has speed_rpm (a given speed) or a shaft (inertia and load), not both");
    }
    run->speed_rpm = profile_read(run_table, "speed_rpm", TOML_ANY, 0.0);
    run->load_Nm = profile_constant(0.0);
    toml_table *t = toml_table_inner_or_null(run_table, "shaft");
    if (t == NULL) {
        return;
    }
    run->shaft = SHAFT_INERTIA;
    run->speed_rpm = profile_constant(toml_number_or(t, "start_rpm", TOML_ANY, 0.0));
    run->J_kgm2 = toml_number(t, "J_kgm2", TOML_POSITIVE);
    run->friction_Nms = toml_number_or(t, "friction_Nms", TOML_NOT_NEGATIVE, 0.0);
    run->load_Nm = profile_read(t, "load_Nm", TOML_ANY, 0.0);
}

static scenario_run read_run(toml_table *t)
{
    scenario_run run = {0};
    read_duration(t, &run);
    run.settle_cycles = toml_integer_or(t, "settle_cycles", 0, CYCLES_MAX, SETTLE_CYCLES);
    read_shaft(t, &run);
    (void)toml_position(t, run.shaft == SHAFT_INERTIA ? "shaft" : "speed_rpm", &run.line, &run.column);
    run.i_d_A = profile_read(t, "i_d_A", TOML_ANY, 0.0);
    run.i_q_A = profile_read(t, "i_q_A", TOML_ANY, 0.0);
    run.u_dc_V = toml_number_or(t, "u_dc_V", TOML_POSITIVE, 0.0);
    run.theta_mech_start_rad = toml_number_or(t, "theta_mech_start_rad", TOML_ANY, 0.0);
    return run;
}

bool scenario_read(const char *path, scenario *s, error *e)
{
    *s = (scenario){0};
    toml_file *file = toml_file_open(path, e);
    if (file == NULL) {
        return false;
    }
    toml_table *root = toml_file_root(file);
    toml_text_or_keep(root, "name", s->name, sizeof s->name);
    read_control(toml_table_inner_or_null(root, "control"), &s->control);
    read_sensors(toml_table_inner_or_null(root, "sensors"), &s->sensors);
    read_log(toml_table_inner_or_null(root, "log"), &s->control, &s->log);
    s->pwm = read_pwm(root, &s->control);

    const size_t runs = toml_table_count(root, "run");
    if (runs == 0) {
        toml_refuse(root, "run", "no [[run]]; expected at least one");
    } else if ((s->run = calloc(runs, sizeof *s->run)) == NULL) {
        error_failure(e, 0, "%s: out of memory", path);
    }
    for (size_t i = 0; s->run != NULL && i < runs; i++) {
        s->run[i] = read_run(toml_table_at(root, "run", i));
        s->run[i].halves = s->control.updates == 2;
        s->run[i].pwm = s->pwm;
        s->runs = i + 1;
    }
    s->pwm.pulses = read_pulses(toml_table_inner_or_null(root, "control"), s->control.modulation);
    if (!toml_file_close(file)) {
        scenario_free(s);
        return false;
    }
    return true;
}

void scenario_free(scenario *s)
{
    free(s->run);
    *s = (scenario){0};
}

long scenario_run_cycles(const scenario_run *run, double T_s)
{
    if (run->cycles > 0) {
        return run->cycles;
    }
    const double cycles = round(run->duration_s / T_s);
    return cycles < 1.0 ? 1 : cycles > CYCLES_MAX ? CYCLES_MAX : (long)cycles;
}
