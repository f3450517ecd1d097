/*
 * Writes the files of a diagnosis: report page, firmware header, extended motor file, JSON with forward validation and firmware error.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_H

#include "base/json.h"
#include "diagnose/result.h"
#include "report/provenance.h"

typedef struct report_input {
    const recording *rec;
    const motor *nominal;
    const diagnosis *d;     /* with its series */
    const provenance *from; /* for the page */
} report_input;

/* Sets the JSON's "firmware" (firmware_gain.h). */
void report_firmware(const report_input *in, json_t *json);

/*
 * Writes motor_extended.toml, iqfoc_extension.h, report.html and diagnosis.json
 * into a directory that exists, the stage of an out_folder (base/out_folder.h); the JSON gets "plant" as
 * well.
 */
bool report_write(const report_input *in, const char *directory, json_t *json, error *e);

#endif
