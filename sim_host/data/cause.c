/* The catalogue's rows as a table (cause.h). */
#include "cause.h"

#include <string.h>

const cause_row cause_table[CAUSE_COUNT] = {
#define CAUSE(ID, id, firmware, words, law, noun)                                                            \
    [CAUSE_##ID] = {id, true, firmware, words, law, noun, CAUSE_##ID},
#define CAUSE_MORE(ID, OF, id, firmware, words, law, noun)                                                   \
    [CAUSE_##ID] = {id, true, firmware, words, law, noun, CAUSE_##OF},
#define UNNAMED(ID, id, words) [CAUSE_##ID] = {id, false, FIRMWARE_LACKS, words, "", "", CAUSE_##ID},
#include "causes.def"
};

const char *const cause_meaning[CAUSE_COUNT] = {
#define MEANING(ID, text) [CAUSE_##ID] = (text),
#include "causes.def"
};

const cause_row *cause_find(const char *id)
{
    for (int n = 0; n < CAUSE_COUNT; n++) {
        if (strcmp(cause_table[n].id, id) == 0) {
            return &cause_table[n];
        }
    }
    return NULL;
}
