/* The report page and the files around it (report.h). */
#include "report.h"

#include "base/json_file.h"
#include "extension_header.h"
#include "figures.h"
#include "firmware_gain.h"
#include "report_first.h"
#include "report_hypotheses.h"
#include "report_tables.h"
#include "report_words.h"

#include "model/flux_map.h"

#include <string.h>

static firmware_gain firmware_of(const report_input *in)
{
    return firmware_gain_measure(in->rec, in->d->held_out, in->nominal, &in->d->extended_motor);
}

void report_firmware(const report_input *in, json_t *json)
{
    const firmware_gain firmware = firmware_of(in);
    firmware_gain_tell(&firmware, json);
}

static json_t *plant_json(const diagnosis *d, const forward_validation *w)
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
        const diagnosis_run *run = forward_validation_run(w, d, k);
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

/* Draws a figure unless the first screen has it. */
static bool draw(page *p, const report_context *c, figure f, error *e)
{
    return f == report_first_figure(c) || f(p, c, e);
}

/* Two figures, next to one another in a wide window; one alone if the first screen has the other. */
static bool pair(page *p, const report_context *c, figure first, figure second, error *e)
{
    const figure shown = report_first_figure(c);
    if (first == shown || second == shown) {
        return draw(p, c, first, e) && draw(p, c, second, e);
    }
    page_twins_begin(p);
    if (!first(p, c, e)) {
        return false;
    }
    page_pair_beside(p);
    if (!second(p, c, e)) {
        return false;
    }
    page_pair_end(p);
    return true;
}

static bool write_plant(page *p, const report_context *c, error *e)
{
    page_heading(p, 2, "Forward validation: does a simulated drive with these causes show the same error?");
    report_plant(p, c->d, c->validation);
    return !c->validation->simulated || pair(p, c, figure_plant_runs, figure_plant_current, e);
}

static bool write_residuals(page *p, const report_context *c, error *e)
{
    page_heading(p, 2, "Residuals: where the model and the recording differ");
    if (!figure_time(p, c, e) || !pair(p, c, figure_current, figure_voltage, e)) {
        return false;
    }
    if (c->turns) {
        return pair(p, c, figure_speed, figure_angle, e) && pair(p, c, figure_orders, figure_methods, e);
    }
    page_note(p, "The rotor does not turn in this recording: there are no plots over speed, angle or order.");
    return figure_methods(p, c, e);
}

static bool write_learned(page *p, const report_context *c, error *e)
{
    if (c->d->learned.terms == 0) {
        return true;
    }
    page_heading(p, 2, "The residual depends on");
    report_learned(p, c->d);
    return c->d->learned.points <= 1 || draw(p, c, figure_learned, e);
}

/* Of iron that saturates. */
static bool write_flux(page *p, const report_context *c, error *e)
{
    if (!c->extended || !flux_map_bends(&c->d->extended_drive)) {
        return true;
    }
    page_heading(p, 2, "Flux linkage: how the machine saturates");
    return pair(p, c, figure_flux_d, figure_flux_q, e);
}

static bool write_body(page *p, const report_input *in, const report_context *c, error *e)
{
    const diagnosis *d = in->d;
    if (!report_first(p, c, e)) {
        return false;
    }
    page_heading(p, 2, d->causes > 0 ? "Causes and errors" : "Errors");
    if (d->causes > 0) {
        report_causes(p, d);
    }
    report_errors(p, d, c->firmware);
    report_experiment(p, d);
    if (!write_flux(p, c, e) || !write_residuals(p, c, e) || !write_learned(p, c, e)) {
        return false;
    }
    page_heading(p, 2, "Run by run");
    if (!pair(p, c, figure_runs, figure_free_runs, e)) {
        return false;
    }
    report_runs(p, d, c->validation);
    if (d->causes > 0 && !write_plant(p, c, e)) {
        return false;
    }
    page_heading(p, 2, "Other hypotheses");
    report_hypotheses(p, d);
    page_heading(p, 2, "Motor parameters");
    report_estimates(p, d);
    report_motor(p, in->nominal, d);
    page_heading(p, 2, "Glossary");
    report_glossary(p);
    provenance_tell(p, in->from);
    page_heading(p, 2, "Files in this folder");
    page_text(p,
              "motor_extended.toml: the motor file with the causes found; every command reads it. "
              "iqfoc_extension.h: the same values as constants for the firmware. diagnosis.json: the numbers "
              "of this page.");
    return true;
}

static bool write_page(const report_input *in, const report_context *c, const char *directory, error *e)
{
    page p;
    char subtitle[900];
    const char *slash = strrchr(in->d->recording_path, '/');
    snprintf(subtitle, sizeof subtitle, "Recording %s, motor file %s (%s)", in->d->recording_path,
             in->d->motor_path, in->nominal->name);
    char title[300];
    snprintf(title, sizeof title, "Diagnosis of %s", slash != NULL ? slash + 1 : in->d->recording_path);
    if (!page_begin_as(&p, directory, "report.html", title, subtitle, e)) {
        return false;
    }
    if (!write_body(&p, in, c, e)) {
        page_abandon(&p);
        return false;
    }
    return page_end(&p, e);
}

static bool write_all(const report_input *in, const forward_validation *validation, const char *directory,
                      json_t *json, error *e)
{
    const firmware_gain firmware = firmware_of(in);
    const report_context c = report_context_of(in->rec, in->nominal, in->d, validation, &firmware);
    char path[4096];
    snprintf(path, sizeof path, "%s/motor_extended.toml", directory);
    if (!motor_write(path, &in->d->extended_motor,
                     "Written by iqfoc diagnose: the motor file with the causes that the recording showed.",
                     e)) {
        return false;
    }
    snprintf(path, sizeof path, "%s/iqfoc_extension.h", directory);
    if (!extension_header_write(path, in->d, &firmware.map, e) || !write_page(in, &c, directory, e)) {
        return false;
    }
    snprintf(path, sizeof path, "%s/diagnosis.json", directory);
    return json_file_write(path, json, e);
}

bool report_write(const report_input *in, const char *directory, json_t *json, error *e)
{
    forward_validation validation;
    forward_validation_call(&validation, in->rec, in->nominal, in->d);
    json_object_set_new(json, "plant", plant_json(in->d, &validation));
    const bool good = write_all(in, &validation, directory, json, e);
    forward_validation_free(&validation);
    return good;
}
