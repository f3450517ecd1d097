/* The report page from its parts (report.h). */
#include "report.h"

#include "base/json_file.h"
#include "extension_header.h"
#include "figures.h"
#include "firmware_gain.h"
#include "report_tables.h"
#include "report_words.h"

#include <math.h>
#include <string.h>

static firmware_gain firmware_of(const report_input *in)
{
    return firmware_gain_measure(in->rec, in->d->held_out, in->nominal, &in->d->extended_motor);
}

void report_firmware(const report_input *in, json_t *json)
{
    firmware_gain_tell(json, in->rec, in->d->held_out, in->nominal, &in->d->extended_motor);
}

static json_t *plant_json(const diagnosis *d, const plant_witness *w)
{
    if (!w->simulated) {
        return json_pack("{s:b, s:s}", "simulated", 0, "reason", w->reason);
    }
    json_t *causes = json_array();
    json_t *runs = json_array();
    for (size_t k = 0; k < w->found.causes; k++) {
        json_array_append_new(causes, json_string(w->found.cause[k].id));
    }
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *run = plant_witness_run(w, d, k);
        if (run != NULL) {
            json_array_append_new(runs, json_pack("{s:I, s:o, s:o}", "run", (json_int_t)run->run,
                                                  "nominal_on_machine", json_number(d->run[k].nominal),
                                                  "nominal_on_plant", json_number(run->nominal)));
        }
    }
    return json_pack("{s:b, s:s, s:o, s:o, s:o, s:o, s:o}", "simulated", 1, "effect", w->effect, "nominal",
                     json_number(w->found.nominal), "extended", json_number(w->found.extended),
                     "beyond_noise_plant_over_machine", json_number(w->size), "causes", causes, "runs", runs);
}

/* Two figures side by side where there is room. */
typedef bool (*figure)(page *p, const evidence *v, error *e);

static bool pair(page *p, const evidence *v, figure first, figure second, error *e)
{
    page_twins_begin(p);
    if (!first(p, v, e)) {
        return false;
    }
    page_pair_beside(p);
    if (!second(p, v, e)) {
        return false;
    }
    page_pair_end(p);
    return true;
}

static bool write_plant(page *p, const evidence *v, error *e)
{
    page_heading(p, 2, "Does a plant with this effect err as the machine did?");
    report_plant(p, v->d, v->witness);
    return !v->witness->simulated || pair(p, v, figure_plant_runs, figure_plant_current, e);
}

static bool write_body(page *p, const report_input *in, const evidence *v, const firmware_gain *firmware,
                       error *e)
{
    const diagnosis *d = in->d;
    report_lead(p, d);
    if (d->causes > 0) {
        report_causes(p, d);
    }
    report_errors(p, d, firmware);
    page_heading(p, 2, "What to do next");
    report_next(p, d);
    report_experiment(p, d);
    page_heading(
        p, 2, d->verdict == VERDICT_CLEAN ? "The model beside the recording" : "What the model gets wrong");
    if (!figure_time(p, v, e) || !pair(p, v, figure_current, figure_voltage, e)) {
        return false;
    }
    if (v->turns) {
        if (!pair(p, v, figure_speed, figure_angle, e) || !pair(p, v, figure_orders, figure_methods, e)) {
            return false;
        }
    } else {
        page_note(
            p, "The rotor does not turn in this recording: nothing is shown against speed, angle or order.");
        if (!figure_methods(p, v, e)) {
            return false;
        }
    }
    if (d->learned.terms > 0) {
        page_heading(p, 2, "What is left depends on");
        report_learned(p, d);
        if (d->learned.points > 1 && !figure_learned(p, v, e)) {
            return false;
        }
    }
    page_heading(p, 2, d->causes > 0 ? "What it gains, run by run" : "Run by run");
    if (!pair(p, v, figure_runs, figure_free_runs, e)) {
        return false;
    }
    report_runs(p, d, v->witness);
    if (d->causes > 0 && !write_plant(p, v, e)) {
        return false;
    }
    page_heading(p, 2, "What else was considered");
    report_hypotheses(p, d);
    page_heading(p, 2, "The machine's values");
    report_estimates(p, d);
    report_motor(p, in->nominal, d);
    page_heading(p, 2, "Glossary");
    report_glossary(p);
    provenance_tell(p, in->from);
    page_heading(p, 2, "Files beside this page");
    page_text(p, "motor_extended.toml: the motor file with what was found; every command takes it. "
                 "iqfoc_extension.h: the "
                 "same as constants of the firmware. diagnosis.json: the figures of this page.");
    return true;
}

static bool write_page(const report_input *in, const evidence *v, const firmware_gain *firmware,
                       const char *directory, error *e)
{
    page p;
    char subtitle[900];
    const char *slash = strrchr(in->d->recording_path, '/');
    snprintf(subtitle, sizeof subtitle, "%s with %s (%s): verdict %s", in->d->recording_path,
             in->d->motor_path, in->nominal->name, diagnosis_verdict_id(in->d->verdict));
    char title[300];
    snprintf(title, sizeof title, "Diagnosis of %s", slash != NULL ? slash + 1 : in->d->recording_path);
    if (!page_begin_as(&p, directory, "report.html", title, subtitle, e)) {
        return false;
    }
    if (!write_body(&p, in, v, firmware, e)) {
        page_abandon(&p);
        return false;
    }
    return page_end(&p, e);
}

static bool write_all(const report_input *in, const plant_witness *witness, const char *directory,
                      json_t *json, error *e)
{
    const firmware_gain firmware = firmware_of(in);
    const evidence v = evidence_of(in->rec, in->nominal, in->d, witness);
    char path[4096];
    snprintf(path, sizeof path, "%s/motor_extended.toml", directory);
    if (!motor_write(path, &in->d->extended_motor,
                     "Written by iqfoc diagnose: the motor file with what the recording showed.", e)) {
        return false;
    }
    snprintf(path, sizeof path, "%s/iqfoc_extension.h", directory);
    if (!extension_header_write(path, in->d, e) || !write_page(in, &v, &firmware, directory, e)) {
        return false;
    }
    snprintf(path, sizeof path, "%s/diagnosis.json", directory);
    return json_file_write(path, json, e);
}

bool report_write(const report_input *in, const char *directory, json_t *json, error *e)
{
    plant_witness witness;
    plant_witness_call(&witness, in->rec, in->nominal, in->d);
    json_object_set_new(json, "plant", plant_json(in->d, &witness));
    const bool good = write_all(in, &witness, directory, json, e);
    plant_witness_free(&witness);
    return good;
}
