/* iqfoc simulate: run the firmware code in closed loop with the switching-level drive and write a recording. */
#include "base/confine.h"
#include "command.h"
#include "options.h"

#include "drive/drive_scenario.h"
#include "drive/firmware_host.h"
#include "drive_emulated.h"
#include "patterns/pattern_drive.h"
#include "plant/plant_effect.h"

#include <stdio.h>
#include <string.h>

typedef struct request {
    const char *motor_path, *scenario_path, *out_path;
    drive_emulated_choice emulated; /* no target: the firmware in this program */
    option_texts effects;
    long seed;
    bool list;
} request;

static request asked = {.seed = 1};

static const option_spec specs[] = {
    {"motor", 0, "M.toml", "the motor file: machine, inverter, and the firmware's parameters",
     .text = &asked.motor_path, .needed = true},
    {"scenario", 0, "S.toml", "speeds, currents and sensors over time (docs/scenario.md)",
     .text = &asked.scenario_path, .needed = true},
    {"output", 'o', "REC.csv", "the recording; - is standard output", .text = &asked.out_path, .needed = true,
     .written = true},
    {"effect", 0, "id[:key=value,...]", "effect that the true drive has and its file has not; repeatable",
     .texts = &asked.effects},
    {"seed", 0, "N", "seed of sensor noise and random effects (default 1)", .integer = &asked.seed,
     .high = 2147483647},
    {"target", 0, "T", "run the firmware in QEMU: cortex-m4 or rv32; the recording is the same",
     .text = &asked.emulated.target},
    {"image", 0, "F.elf", "image for --target (default: the one built with this program)",
     .text = &asked.emulated.image},
    {"uart", 0, "F",
     "with --target: the image sends every cycle over its UART into file or terminal F (iqfoc record)",
     .text = &asked.emulated.uart},
    {"list-effects", 0, NULL, "print the effects with their keys and default sizes", .flag = &asked.list},
    {.name = NULL}};

const command_about about_simulate = {
    "simulate",
    "--motor M.toml --scenario S.toml -o REC.csv [--effect id[:key=value,...]]... [--seed N] "
    "[--target T]",
    "Runs the firmware code in closed loop with the switching-level drive. Writes the sensor values and the\n"
    "commands of the controller as a recording. The firmware uses the motor file; the drive differs from it\n"
    "by the given effects.",
    specs,
};

static void note(void *context, size_t run, uint32_t status)
{
    char text[160];
    (void)context;
    fprintf(stderr, "iqfoc: simulate: note: run %zu, settling included: %s\n", run,
            drive_status_text(status, text, sizeof text));
}

static bool run_all(const request *r, const motor *m, const scenario *s, const plant_config *drive,
                    const drive_firmware *firmware, drive_recording *out, error *e)
{
    const drive_scenario all = {m, s, drive, r->seed, firmware, note, NULL};
    return drive_scenario_run(&all, out, e);
}

/* The firmware compiled into this program, or a target's image in its emulator. */
static bool run_firmware(const request *r, const motor *m, const scenario *s, const plant_config *drive,
                         drive_recording *out, error *e)
{
    static drive_host host;
    static drive_emulated emulated;
    static pattern_drive pattern;
    if (s->control.modulation == MODULATION_PATTERN) {
        drive_firmware firmware;
        return pattern_drive_begin(&pattern, m, s, r->scenario_path, &firmware, e) &&
               run_all(r, m, s, drive, &firmware, out, e);
    }
    if (r->emulated.target == NULL) {
        const drive_firmware firmware = drive_firmware_host(&host, NULL);
        return (s->control.angle == ANGLE_MEASURED || drive_host_observe(&host, m, e)) &&
               run_all(r, m, s, drive, &firmware, out, e);
    }
    const drive_firmware firmware = drive_firmware_emulated(&emulated);
    const bool good = drive_emulated_start(&emulated, &r->emulated, m, e) &&
                      run_all(r, m, s, drive, &firmware, out, e) && drive_emulated_finish(&emulated, e);
    drive_emulated_stop(&emulated);
    return good;
}

static bool simulate(const request *r, const motor *known, const motor *m, const scenario *s, error *e)
{
    plant_config drive = drive_scenario_plant(m, s);
    for (int k = 0; k < r->effects.count; k++) {
        if (!plant_effect_apply(&drive, r->effects.of[k], e)) {
            return false;
        }
    }
    const plant_inverter *v = &drive.inverter;
    if (s->control.modulation == MODULATION_PATTERN &&
        (v->delay_cycles != 0.0 || v->glitch_probability != 0.0 || v->compensation_V != 0.0)) {
        return error_input(
            e, r->scenario_path, 0, 0,
            "modulation = \"pattern\" has no duties: an effect that delays, loses or corrects them "
            "needs modulation = \"pwm\"");
    }
    drive_recording out = {.run = 0};
    char comment[512];
    (void)snprintf(comment, sizeof comment, "iqfoc simulate: %s, %s, seed %ld%s%s", m->name, s->name, r->seed,
                   r->effects.count > 0 ? ", with effects: " : "",
                   r->effects.count > 0 ? r->effects.of[0] : "");
    for (int k = 1; k < r->effects.count; k++) {
        const size_t used = strlen(comment);
        (void)snprintf(comment + used, sizeof comment - used, " %s", r->effects.of[k]);
    }
    bool good = run_firmware(r, known, s, &drive, &out, e) &&
                recording_write(r->out_path, &out.recording, comment, e);
    recording_free(&out.recording);
    return good;
}

int cmd_simulate(int argc, char **argv)
{
    error e = {0, ""};
    options o = options_begin(&about_simulate, argc, argv);
    if (!options_read(&o, &e) || o.helped) {
        return error_print(&e);
    }
    if (asked.list) {
        plant_effect_list(stdout);
        return STATUS_DONE;
    }
    if (asked.emulated.target == NULL) {
        confine(CONFINE_TO_FILES);
    }
    motor m;
    scenario s;
    if (!options_complete(&o, &e) || !motor_read(asked.motor_path, &m, &e) ||
        !scenario_read(asked.scenario_path, &s, &e)) {
        return error_print(&e);
    }
    const motor known = drive_scenario_motor(&m, &s);
    const bool good = (asked.emulated.target == NULL || drive_scenario_plain(&s, asked.scenario_path, &e)) &&
                      simulate(&asked, &known, &m, &s, &e);
    scenario_free(&s);
    return good ? STATUS_DONE : error_print(&e);
}
