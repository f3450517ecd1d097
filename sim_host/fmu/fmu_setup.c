/* The files in an FMU's folder `resources`, read (fmu_setup.h). */
#include "fmu_setup.h"

#include "fmu_guarded.h"

#include "data/toml_table.h"
#include "drive/drive_scenario.h"

#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = 4096 };

bool fmu_setup_read_files(fmu_setup *s, const char *motor_path, const char *scenario_path, error *e)
{
    s->has_scenario = scenario_path != NULL;
    s->scenario = (scenario){.runs = 0};
    const bool good = motor_read(motor_path, &s->motor, e) &&
                      (!s->has_scenario || (scenario_read(scenario_path, &s->scenario, e) &&
                                            drive_scenario_plain(&s->scenario, scenario_path, e)));
    /* The name is the caller's; a message about a value names the key. */
    s->motor.path = NULL;
    if (!good) {
        scenario_free(&s->scenario);
    }
    return good;
}

static bool path_of(const char *folder, const char *name, char path[PATH_SIZE], error *e)
{
    const size_t length = strlen(folder);
    const bool ends = length > 0 && (folder[length - 1] == '/' || folder[length - 1] == '\\');
    const int wrote = snprintf(path, PATH_SIZE, "%s%s%s", folder, ends ? "" : "/", name);
    return (wrote > 0 && wrote < PATH_SIZE) ||
           error_failure(e, 0, "the path of the FMU's resources is too long");
}

/* setup.toml; *with_scenario: whether scenario.toml is there. */
static bool read_setup(fmu_setup *s, const char *path, bool *with_scenario, error *e)
{
    toml_file *file = toml_file_open(path, e);
    if (file == NULL) {
        return false;
    }
    toml_table *root = toml_file_root(file);
    s->kind = (fmu_kind)toml_choice_or(root, "kind", fmu_kind_words, 2, FMU_KIND_DRIVE);
    s->seed = toml_integer(root, "seed", 0, 2147483647);
    s->run = (size_t)toml_integer_or(root, "run", 1, 100000000, 1) - 1;
    *with_scenario = toml_flag_or(root, "scenario", false);
    toml_text_or_keep(root, "token", s->token, sizeof s->token);
    const size_t effects = toml_table_count(root, "effect");
    s->effects = effects < FMU_EFFECTS_MAX ? (int)effects : FMU_EFFECTS_MAX;
    for (int k = 0; k < s->effects; k++) {
        toml_text_or_keep(toml_table_at(root, "effect", (size_t)k), "is", s->effect[k], sizeof s->effect[k]);
    }
    return toml_file_close(file);
}

typedef struct reading {
    fmu_setup *setup;
    const char *folder;
} reading;

static bool read_folder(void *context, error *e)
{
    fmu_setup *s = ((const reading *)context)->setup;
    const char *folder = ((const reading *)context)->folder;
    char setup_path[PATH_SIZE];
    char motor_path[PATH_SIZE];
    char scenario_path[PATH_SIZE];
    bool with_scenario = false;
    memset(s, 0, sizeof *s);
    if (!path_of(folder, "setup.toml", setup_path, e) || !path_of(folder, "motor.toml", motor_path, e) ||
        !path_of(folder, "scenario.toml", scenario_path, e) ||
        !read_setup(s, setup_path, &with_scenario, e) ||
        !fmu_setup_read_files(s, motor_path, with_scenario ? scenario_path : NULL, e)) {
        return false;
    }
    if (with_scenario && s->run >= s->scenario.runs) {
        fmu_setup_free(s);
        return error_input(e, scenario_path, 0, 0, "setup.toml asks for run %zu, which is not there",
                           s->run + 1);
    }
    return true;
}

bool fmu_setup_read(fmu_setup *s, const char *folder, error *e)
{
    reading r = {s, folder};
    return fmu_guarded(read_folder, &r, e);
}

void fmu_setup_free(fmu_setup *s)
{
    scenario_free(&s->scenario);
}
