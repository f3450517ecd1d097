/* Missed updates as a cause (counted.h). */
#include "counted.h"

#include <stdio.h>

static double of_file(const motor *file)
{
    return file->ext.has[CAUSE_MISSED_UPDATE] ? file->ext.missed_share : 0.0;
}

bool counted_is_news(const missed_updates *found, const motor *file)
{
    const double known = of_file(file);
    return found->missed > 0 && (known < found->low || known > found->high);
}

void counted_tell(const missed_updates *found, const motor *file, double gain, diagnosis *d)
{
    if (d->causes == DIAGNOSIS_CAUSES || !counted_is_news(found, file)) {
        return;
    }
    diagnosis_cause *cause = &d->cause[d->causes++];
    *cause = (diagnosis_cause){.id = cause_table[CAUSE_MISSED_UPDATE].id,
                               .words = cause_table[CAUSE_MISSED_UPDATE].words,
                               .parameters = 1,
                               .gain = gain,
                               .probability = 1.0};
    cause->parameter[0] = (diagnosis_parameter){
        .nominal = of_file(file), .value = found->share, .low = found->low, .high = found->high};
    snprintf(cause->parameter[0].name, sizeof cause->parameter[0].name, "share");
    snprintf(cause->parameter[0].unit, sizeof cause->parameter[0].unit, "1");
    d->extended_motor.ext.missed_share = found->share;
    motor_note_extension(&d->extended_motor, CAUSE_MISSED_UPDATE);
}
