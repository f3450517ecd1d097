/* Dead time in microseconds (dead_time.h). */
#include "dead_time.h"

#include <stdio.h>
#include <string.h>

const diagnosis_parameter *dead_time_of(const diagnosis_cause *cause)
{
    for (size_t k = 0; strcmp(cause->id, cause_table[CAUSE_DEAD_TIME].id) == 0 && k < cause->parameters;
         k++) {
        if (strcmp(cause->parameter[k].name, "v_dead") == 0) {
            return &cause->parameter[k];
        }
    }
    return NULL;
}

void dead_time_words(const motor *m, double v_dead_V, char *text, size_t size)
{
    snprintf(text, size, "%.3g us at %.4g kHz and %.4g V", 1e6 * v_dead_V / (m->u_dc_V * m->f_pwm_Hz),
             1e-3 * m->f_pwm_Hz, m->u_dc_V);
}
