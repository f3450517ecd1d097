/* iqfoc export-fmu: the plant, or controller and plant, as an FMU for another simulator. */
#include "command.h"
#include "options.h"

#include "fmu/fmu_export.h"

#include <stdio.h>
#include <string.h>

enum { OPT_MOTOR, OPT_OUT, OPT_KIND, OPT_SCENARIO, OPT_RUN, OPT_EFFECT, OPT_SEED };

static const option_spec specs[] = {
    [OPT_MOTOR] = {"motor", 0, "M.toml", "the motor file: machine, inverter, and the firmware's parameters"},
    [OPT_OUT] = {"output", 'o', "F.fmu", "the FMU"},
    [OPT_KIND] =
        {"kind", 0, "plant|drive",
         "plant: inverter, machine, shaft and sensors; the inputs are duties;\n"
         "drive (default): the same with the firmware's control cycle; the inputs are current references"},
    [OPT_SCENARIO] = {"scenario", 0, "S.toml",
                      "sensors and control from this scenario; the drive follows one of its runs"},
    [OPT_RUN] = {"run", 0, "N", "run of the scenario (default 1)"},
    [OPT_EFFECT] = {"effect", 0, "id[:key=value,...]",
                    "effect that the true drive has and its file has not; repeatable"},
    [OPT_SEED] = {"seed", 0, "N", "seed of sensor noise and random effects (default 1)"},
    {NULL, 0, NULL, NULL},
};

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

static bool take_kind(const options *o, void *context, error *e)
{
    fmu_kind *kind = context;
    for (int k = 0; k < 2; k++) {
        if (strcmp(o->argument, fmu_kind_words[k]) == 0) {
            *kind = (fmu_kind)k;
            return true;
        }
    }
    return error_input(e, NULL, 0, 0, "export-fmu: --kind expects plant or drive, not \"%s\"", o->argument);
}

int cmd_export_fmu(int argc, char **argv)
{
    error e = {0, ""};
    fmu_request r = {.kind = FMU_KIND_DRIVE, .seed = 1};
    option_texts effects = {.count = 0};
    long run = 1;
    const option_place places[] = {[OPT_MOTOR] = {.text = &r.motor_path, .needed = true},
                                   [OPT_OUT] = {.text = &r.out_path, .needed = true, .written = true},
                                   [OPT_KIND] = {.take = take_kind, .context = &r.kind},
                                   [OPT_SCENARIO] = {.text = &r.scenario_path},
                                   [OPT_RUN] = {.integer = &run, .low = 1, .high = 100000000},
                                   [OPT_EFFECT] = {.texts = &effects},
                                   [OPT_SEED] = {.integer = &r.seed, .high = 2147483647}};
    options o = options_begin(&about_export_fmu, argc, argv);
    if (!options_read(&o, places, &e) || o.helped || !options_complete(&o, places, &e)) {
        return error_print(&e);
    }
    r.run = (size_t)run - 1;
    r.effect = effects.of;
    r.effects = effects.count;
    if (run > 1 && r.scenario_path == NULL) {
        error_input(&e, NULL, 0, 0,
                    "export-fmu: --run %ld selects a run of a scenario; add --scenario S.toml", run);
        return error_print(&e);
    }
    return fmu_export(&r, &e) ? STATUS_DONE : error_print(&e);
}
