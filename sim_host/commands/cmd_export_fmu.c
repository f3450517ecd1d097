/* iqfoc export-fmu: the plant, or controller and plant, as an FMU for another simulator. */
#include "command.h"
#include "options.h"

#include "fmu/fmu_export.h"

#include <stdio.h>
#include <string.h>

typedef struct request {
    fmu_request fmu;
    option_texts effects;
    long run;
} request;

static request asked = {.fmu = {.kind = FMU_KIND_DRIVE, .seed = 1}, .run = 1};

static bool take_kind(const options *o, error *e)
{
    for (int k = 0; k < 2; k++) {
        if (strcmp(o->argument, fmu_kind_words[k]) == 0) {
            asked.fmu.kind = (fmu_kind)k;
            return true;
        }
    }
    return error_input(e, NULL, 0, 0, "export-fmu: --kind expects plant or drive, not \"%s\"", o->argument);
}

static const option_spec specs[] = {
    {"motor", 0, "M.toml", "the motor file: machine, inverter, and the firmware's parameters",
     .text = &asked.fmu.motor_path, .needed = true},
    {"output", 'o', "F.fmu", "the FMU", .text = &asked.fmu.out_path, .needed = true, .written = true},
    {"kind", 0, "plant|drive",
     "plant: inverter, machine, shaft and sensors; the inputs are duties;\n"
     "drive (default): the same with the firmware's control cycle; the inputs are current references",
     .take = take_kind},
    {"scenario", 0, "S.toml", "sensors and control from this scenario; the drive follows one of its runs",
     .text = &asked.fmu.scenario_path},
    {"run", 0, "N", "run of the scenario (default 1)", .integer = &asked.run, .low = 1, .high = 100000000},
    {"effect", 0, "id[:key=value,...]", "effect that the true drive has and its file has not; repeatable",
     .texts = &asked.effects},
    {"seed", 0, "N", "seed of sensor noise and random effects (default 1)", .integer = &asked.fmu.seed,
     .high = 2147483647},
    {.name = NULL}};

const command_about about_export_fmu = {
    "export-fmu",
    "--motor M.toml -o F.fmu [--kind plant|drive] [--scenario S.toml [--run N]] [--effect "
    "id[:key=value,...]]... "
    "[--seed N]",
    "Writes an FMU (Functional Mock-up Unit, FMI 3.0, co-simulation) of the switching-level drive, for this\n"
    "processor and operating system. With steps of one control cycle it gives the currents of\n"
    "`iqfoc simulate` (docs/fmu.md).",
    specs,
};

int cmd_export_fmu(int argc, char **argv)
{
    error e = {0, ""};
    options o = options_begin(&about_export_fmu, argc, argv);
    if (!options_read(&o, &e) || o.helped || !options_complete(&o, &e)) {
        return error_print(&e);
    }
    fmu_request *r = &asked.fmu;
    r->run = (size_t)asked.run - 1;
    r->effect = asked.effects.of;
    r->effects = asked.effects.count;
    if (asked.run > 1 && r->scenario_path == NULL) {
        error_input(&e, NULL, 0, 0,
                    "export-fmu: --run %ld selects a run of a scenario; add --scenario S.toml", asked.run);
        return error_print(&e);
    }
    return fmu_export(r, &e) ? STATUS_DONE : error_print(&e);
}
