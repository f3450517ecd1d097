/* Corrections of rows as causes (corrected_causes.h). */
#include "corrected_causes.h"

#include "diagnose/measure/errors.h"

#include <stdio.h>
#include <string.h>

static void put(motor *m, const motor_value *v, double value)
{
    memcpy((unsigned char *)m + v->offset, &value, sizeof value);
}

static void tell(const row_correction *found, const motor *file, diagnosis *d, diagnosis_cause *cause)
{
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (v->cause != found->cause || cause->parameters == CORRECTION_VALUES) {
            continue;
        }
        const size_t n = cause->parameters++;
        diagnosis_parameter *p = &cause->parameter[n];
        *p = (diagnosis_parameter){.nominal = file->ext.has[v->cause] ? motor_value_of(file, v) : v->absent,
                                   .value = found->value[n],
                                   .low = found->low[n],
                                   .high = found->high[n]};
        snprintf(p->name, sizeof p->name, "%s", v->name);
        snprintf(p->unit, sizeof p->unit, "%s", v->unit);
        put(&d->extended_motor, v, found->value[n]);
    }
    motor_note_extension(&d->extended_motor, found->cause);
}

void corrected_causes_tell(const diagnose_rows *r, const motor *file, double probability, diagnosis *d)
{
    for (size_t n = 0; n < r->corrections && d->causes < DIAGNOSIS_CAUSES; n++) {
        const cause_id id = r->correction[n].cause;
        diagnosis_cause *cause = &d->cause[d->causes++];
        *cause = (diagnosis_cause){.id = cause_table[id].id,
                                   .words = cause_table[id].words,
                                   .gain = measure_gain_of_correction(r, n, &d->extended_drive),
                                   .probability = probability};
        tell(&r->correction[n], file, d, cause);
    }
}
