/*
 * iqfoc import: convert the log of another program to a recording.
 */
#include "command.h"
#include "import/arrange_map.h"
#include "import/convert.h"
#include "import/preset.h"
#include "import/propose.h"
#include "options.h"

#include <stdio.h>
#include <string.h>

typedef struct request {
    const char *log_path, *map_path, *recording_path, *motor_path, *preset_name;
    bool check, skip_bad, helped;
} request;

static request asked;

static const option_spec specs[] = {
    {"map", 0, "MAP.toml", "meaning of each column; without it a map is proposed", .text = &asked.map_path},
    {"output", 'o', "REC.csv", "the recording; - is stdout", .text = &asked.recording_path, .written = true},
    {"motor", 'm', "M.toml", "the motor file; needed for mechanical angles and speeds, and for --check",
     .text = &asked.motor_path},
    {"preset", 0, "NAME",
     "print the map for a tool's log, or with -o use it: vesc, odrive, moteus, simplefoc,\n"
     "ti-datalog, freemaster, motulator",
     .text = &asked.preset_name},
    {"check", 0, NULL,
     "try signs, order, direction, inverted counts, shift and angle zero; print the best\n"
     "combination, its error, and the lines of the map for it; write nothing",
     .flag = &asked.check},
    {"skip-bad", 0, NULL,
     "leave out rows that cannot be read, and print their number; each leaves a gap in time",
     .flag = &asked.skip_bad},
    {.name = NULL}};

const command_about about_import = {
    "import", "LOG [--map MAP.toml | --preset NAME] [--motor M.toml] [-o REC.csv | --check]",
    "Makes a recording for `iqfoc diagnose` from the table of another program. A map gives the quantity,\n"
    "unit, frame and sign of each column. Delimiter, decimal mark, encoding and header are detected.\n"
    "Without a map, prints a map proposed from the header; save it and check it.",
    specs};

static bool parse(int argc, char **argv, request *r, error *e)
{
    options o = options_begin(&about_import, argc, argv);
    if (!options_read(&o, e) || o.helped) {
        r->helped = o.helped;
        return o.helped;
    }
    if (r->map_path != NULL && r->preset_name != NULL) {
        return error_input(e, NULL, 0, 0, "import: --map and --preset exclude each other; give one");
    }
    if (o.first >= argc && r->preset_name == NULL) {
        return error_input(e, NULL, 0, 0, "import: no log is given. Usage: iqfoc import %s",
                           about_import.usage);
    }
    r->log_path = o.first < argc ? argv[o.first] : NULL;
    if (!options_at_most(&o, 1, e)) {
        return false;
    }
    const bool has_map = r->map_path != NULL || r->preset_name != NULL;
    if (r->recording_path != NULL && !has_map) {
        return error_input(e, NULL, 0, 0,
                           "import: --map MAP.toml is missing; `iqfoc import LOG > MAP.toml` proposes one");
    }
    if (r->recording_path != NULL && r->log_path == NULL) {
        return error_input(e, NULL, 0, 0, "import: no log is given. Usage: iqfoc import %s",
                           about_import.usage);
    }
    if (r->check && r->recording_path != NULL) {
        return error_input(e, NULL, 0, 0, "import: --check writes nothing; remove -o");
    }
    if (r->check && !has_map) {
        return options_missing(&o, "map", e);
    }
    if (r->check && r->motor_path == NULL) {
        return options_missing(&o, "motor", e);
    }
    if (r->map_path != NULL && r->recording_path == NULL && !r->check) {
        return options_missing(&o, "output", e);
    }
    return true;
}

static bool propose(const request *r, error *e)
{
    const log_format unknown = LOG_FORMAT_UNKNOWN;
    log_table t;
    proposal p;
    const bool ok = log_table_open(&t, r->log_path, &unknown, e);
    if (ok) {
        propose_map(&t, &p);
        propose_print(stdout, &t, &p);
    }
    log_table_close(&t);
    return ok;
}

static bool convert(const request *r, const import_map *map, error *e)
{
    motor m;
    log_table t;
    recording rec;
    char comment[CONVERT_COMMENT];
    if (r->motor_path != NULL && !motor_read(r->motor_path, &m, e)) {
        return false;
    }
    if (r->skip_bad && !map->column[QUANTITY_T].there) {
        return error_input(e, map->path, 0, 0,
                           "--skip-bad needs t_s: without it a row that is left out shifts all later ones");
    }
    bool ok = map_open_log(map, &t, r->log_path, e);
    t.skip_bad = r->skip_bad;
    ok = ok && convert_log(&t, map, r->motor_path != NULL ? &m : NULL, &rec, e);
    if (ok && t.skipped > 0) {
        fprintf(stderr, "iqfoc: note: %zu row%s left out; the first: %s\n", t.skipped,
                t.skipped == 1 ? "" : "s", t.first_skipped.text);
    }
    if (ok && r->check) {
        const arrange_freedom freedom = arrange_freedom_of(map, &m);
        const arrange_result found = arrange_find(&rec, &freedom);
        arrange_print(stdout, map, &m, &found);
        recording_free(&rec);
    } else if (ok) {
        convert_comment(&t, map, comment, sizeof comment);
        ok = recording_write(r->recording_path, &rec, comment, e);
        recording_free(&rec);
    }
    log_table_close(&t);
    return ok;
}

static bool run(const request *r, error *e)
{
    import_map map;
    if (r->map_path != NULL) {
        return map_read(r->map_path, &map, e) && convert(r, &map, e);
    }
    if (r->preset_name == NULL) {
        return propose(r, e);
    }
    const preset *p = preset_find(r->preset_name, e);
    if (p == NULL) {
        return false;
    }
    if (r->recording_path == NULL && !r->check) {
        preset_print(stdout, p);
        return true;
    }
    map = preset_map(p);
    return convert(r, &map, e);
}

int cmd_import(int argc, char **argv)
{
    error e = {0};
    if (!parse(argc, argv, &asked, &e)) {
        return error_print(&e);
    }
    if (asked.helped) {
        return STATUS_DONE;
    }
    return run(&asked, &e) ? STATUS_DONE : error_print(&e);
}
