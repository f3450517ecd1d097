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

void recording_missing_add(recording_missing *m, const char *what)
{
    const size_t used = strlen(m->list);
    snprintf(m->list + used, sizeof m->list - used, "%s%s", used > 0 ? ", " : "", what);
}

void recording_missing_refuse(const recording_missing *m, csv_file *csv)
{
    const bool has_hint = m->hint[0] != '\0';
    const int most = has_hint ? HEADER_SHOWN_BESIDE_HINT : HEADER_SHOWN;
    int shown = 0;
    while (shown < most && (size_t)shown < csv->text_length && strchr("\r\n", csv->text[shown]) == NULL) {
        shown++;
    }
    csv_file_refuse(csv, 0,
                    "missing column%s: %s; found %.*s; `iqfoc import` makes a recording of other logs%s%s%s",
                    strchr(m->list, ',') != NULL ? "s" : "", m->list, shown, csv->text,
                    has_hint ? " (map: " : "", m->hint, has_hint ? ")" : "");
}
