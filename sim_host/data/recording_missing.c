#include "recording_missing.h"

#include "foreign_names.h"

#include <stdio.h>
#include <string.h>

enum { HEADER_SHOWN = 130, HEADER_SHOWN_BESIDE_HINT = 60 };

void recording_missing_note(recording_missing *m, const char *name, size_t length)
{
    const foreign_name known = foreign_name_find(name, length);
    const size_t used = strlen(m->hint);
    if (known.key != NULL && used + length + strlen(known.key) + 8 < sizeof m->hint) {
        snprintf(m->hint + used, sizeof m->hint - used, "%s%s = \"%.*s\"", used > 0 ? ", " : "", known.key,
                 (int)length, name);
    }
}

static void add(recording_missing *m, const char *what)
{
    const size_t used = strlen(m->list);
    snprintf(m->list + used, sizeof m->list - used, "%s%s", used > 0 ? ", " : "", what);
}

void recording_missing_find(recording_missing *m, const bool have[COL_COUNT])
{
    /* The speed is not among them: it can be had from the angle. */
    static const column_id required[] = {COL_T, COL_I_A, COL_I_B, COL_THETA};
    for (size_t i = 0; i < sizeof required / sizeof required[0]; i++) {
        if (!have[required[i]]) {
            add(m, recording_column_name(required[i]));
        }
    }
    const bool has_u = have[COL_U_A] && have[COL_U_B] && have[COL_U_C];
    const bool has_duty = have[COL_D_A] && have[COL_D_B] && have[COL_D_C];
    if (!has_u && has_duty && !have[COL_U_DC]) {
        add(m, "u_dc_V (for the duties)");
    }
    if (!has_u && !has_duty) {
        add(m, "u_a_V, u_b_V, u_c_V (or d_a, d_b, d_c and u_dc_V)");
    }
}

void recording_missing_words(const recording_missing *m, const char *found, size_t length, char *text,
                             size_t size)
{
    const bool has_hint = m->hint[0] != '\0';
    const size_t most = has_hint ? HEADER_SHOWN_BESIDE_HINT : HEADER_SHOWN;
    size_t shown = 0;
    while (shown < most && shown < length && strchr("\r\n", found[shown]) == NULL) {
        shown++;
    }
    snprintf(text, size,
             "missing column%s: %s; found %.*s; `iqfoc import` makes a recording of other logs%s%s%s",
             strchr(m->list, ',') != NULL ? "s" : "", m->list, (int)shown, found, has_hint ? " (map: " : "",
             m->hint, has_hint ? ")" : "");
}

void recording_missing_refuse(const recording_missing *m, csv_file *csv)
{
    char words[512];
    recording_missing_words(m, csv->text, csv->text_length, words, sizeof words);
    csv_file_refuse(csv, 0, "%s", words);
}
