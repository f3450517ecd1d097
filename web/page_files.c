/*
 * The calls that files are dropped for: a diagnosis and its report, a foreign log and its map, the recorder's octets, a tuned
 * controller.
 */
#include "page.h"

#include "base/text_out.h"
#include "data/recording.h"
#include "diagnose/diagnose.h"
#include "diagnose/show/report.h"
#include "diagnose/tell/json.h"
#include "diagnose/tell/text.h"
#include "import/arrange_map.h"
#include "import/convert.h"
#include "import/propose.h"
#include "record/record_rows.h"
#include "tune/tune_report.h"

#include <stdlib.h>
#include <string.h>

/* What calls write: the names that `iqfoc diagnose -o` and `iqfoc tune -o` give, in the only folder; and the recording. */
static const char folder[] = ".";
static const char recording_made[] = "recording.csv";

/* ---- Diagnosis ---- */

static int diagnose_recording(bool with_report)
{
    error e = {0};
    motor m;
    recording rec;
    diagnosis d;
    if (!motor_read(page_name_of(PAGE_MOTOR), &m, &e) ||
        !recording_read(page_name_of(PAGE_RECORDING), &rec, &e)) {
        return error_print(&e);
    }
    const diagnose_options how = {.series = true};
    json_t *json = NULL;
    bool ok = diagnose(&d, &rec, &m, &how, &e);
    if (ok) {
        const provenance from = {
            .file = {{"recording", page_name_of(PAGE_RECORDING)}, {"motor file", page_name_of(PAGE_MOTOR)}}};
        const report_input in = {&rec, &m, &d, &from};
        json = json_of_diagnosis(&d);
        report_firmware(&in, json);
        ok = !with_report || report_write(&in, folder, json, &e);
        text_print(stderr, &d);
        diagnosis_free(&d);
    }
    recording_free(&rec);
    return page_answer(ok, json, &e);
}

/* As `iqfoc diagnose --json` does. */
PAGE_CALL(page_diagnose)(void)
{
    return diagnose_recording(false);
}

/* As `iqfoc diagnose -o` does: writes its four files. */
PAGE_CALL(page_report)(void)
{
    return diagnose_recording(true);
}

/* ---- A foreign log ---- */

enum { ROWS_SHOWN = 8 };

/* A line of the log's head as its fields. */
static json_t *fields_of(const log_table *t, size_t line)
{
    json_t *texts = json_array();
    log_field *fields = malloc(LOG_FIELDS_MOST * sizeof *fields);
    char *copy = malloc(t->head.length[line] + 1);
    if (fields != NULL && copy != NULL) {
        memcpy(copy, t->head.line[line], t->head.length[line]);
        const int count = log_line_split(copy, t->head.length[line], t->format.delimiter, fields);
        for (int n = 0; n < count; n++) {
            char text[64];
            (void)snprintf(text, sizeof text, "%.*s", (int)fields[n].length, fields[n].text);
            json_array_append_new(texts, json_string(text));
        }
    }
    free(copy);
    free(fields);
    return texts;
}

static json_t *head_json(const log_table *t, const char *map)
{
    json_t *names = json_array();
    json_t *units = json_array();
    json_t *rows = json_array();
    for (size_t n = 0; n < t->columns; n++) {
        json_array_append_new(names, json_string(t->name[n]));
        json_array_append_new(units, json_string(t->unit[n]));
    }
    for (size_t k = t->head.first_row; k < t->head.lines && k < t->head.first_row + ROWS_SHOWN; k++) {
        json_array_append_new(rows, fields_of(t, k));
    }
    return json_pack("{s:s, s:o, s:o, s:o}", "map", map, "names", names, "units", units, "rows", rows);
}

/* As `iqfoc import LOG` does: {"map": the text, "names", "units", "rows": the first ones' fields}. */
PAGE_CALL(page_propose)(void)
{
    error e = {0};
    const log_format unknown = LOG_FORMAT_UNKNOWN;
    log_table t;
    proposal p;
    text_out map;
    json_t *json = NULL;
    bool ok = log_table_open(&t, page_name_of(PAGE_LOG), &unknown, &e);
    if (ok) {
        propose_map(&t, &p);
        if (text_out_open(&map)) {
            propose_print(map.stream, &t, &p);
        }
        ok = text_out_close(&map) || error_failure(&e, 0, "out of memory");
        json = ok ? head_json(&t, map.bytes) : NULL;
        free(map.bytes);
    }
    log_table_close(&t);
    return page_answer(ok, json, &e);
}

/* As `iqfoc import LOG --map MAP --motor M` does: with --check what fits best is said, else the recording is written. */
static int import(bool check)
{
    error e = {0};
    motor m;
    import_map map;
    log_table t = {0};
    recording rec;
    bool ok = motor_read(page_name_of(PAGE_MOTOR), &m, &e) && map_read(page_name_of(PAGE_MAP), &map, &e) &&
              map_open_log(&map, &t, page_name_of(PAGE_LOG), &e) && convert_log(&t, &map, &m, &rec, &e);
    if (ok && check) {
        const arrange_freedom freedom = arrange_freedom_of(&map, &m);
        const arrange_result found = arrange_find(&rec, &freedom);
        arrange_print(stderr, &map, &m, &found);
    } else if (ok) {
        char comment[CONVERT_COMMENT];
        convert_comment(&t, &map, comment, sizeof comment);
        ok = recording_write(recording_made, &rec, comment, &e);
    }
    if (ok) {
        recording_free(&rec);
    }
    log_table_close(&t);
    return page_answer(ok, json_object(), &e);
}

PAGE_CALL(page_import)(void)
{
    return import(false);
}

PAGE_CALL(page_check)(void)
{
    return import(true);
}

/* ---- The recorder's octets ---- */

/* As `iqfoc record --port FILE` does: writes the recording. */
PAGE_CALL(page_record)(void)
{
    static wire_reader reader;
    static record_rows rows;
    static uint8_t octets[4096];
    error e = {0};
    FILE *in = fopen(page_name_of(PAGE_OCTETS), "rb");
    bool ok = in != NULL || error_failure(&e, 0, "no octets were given");
    for (size_t count = 1; ok && count > 0;) {
        count = fread(octets, 1, sizeof octets, in);
        ok = wire_read(&reader, octets, count, record_rows_take, &rows);
        e = ok ? e : rows.e;
    }
    if (in != NULL) {
        fclose(in);
    }
    wire_close(&reader);
    ok = ok && (rows.recording.rows > 0 ||
                error_input(&e, page_name_of(PAGE_OCTETS), 0, 0,
                            "no row received: %lu frames, %lu damaged, %lu lost", reader.counts.frames,
                            reader.counts.damaged, reader.counts.lost_frames));
    if (ok) {
        char comment[RECORD_COMMENT];
        record_comment(&reader.counts, comment, sizeof comment);
        ok = recording_write(recording_made, &rows.recording, comment, &e);
        fprintf(stderr, "%s\n", comment);
    }
    record_rows_free(&rows);
    return page_answer(ok, json_object(), &e);
}

/* ---- Tune ---- */

/* As `iqfoc tune --motor M [--diagnosis D] -o DIR --json F` does: writes the page and the firmware's header. */
PAGE_CALL(page_tune)(void)
{
    static tune_report t;
    error e = {0};
    motor m;
    const char *diagnosis = page_name_of(PAGE_DIAGNOSIS);
    tune_choice choice = tune_choice_usual();
    choice.diagnosis_path = diagnosis[0] != '\0' ? diagnosis : NULL;
    choice.compares = true;
    const bool ok = motor_read(page_name_of(PAGE_MOTOR), &m, &e) && tune_report_make(&t, &m, &choice, &e) &&
                    tune_report_page(&t, folder, &e) && tune_report_header(&t, folder, &e);
    if (ok) {
        tune_report_print(&t, stderr);
    }
    return page_answer(ok, ok ? tune_report_json(&t) : NULL, &e);
}
