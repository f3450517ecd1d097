/* The nearest word by the distance of Levenshtein (suggest.h). */
#include "suggest.h"

#include <ctype.h>
#include <string.h>

enum {
    LONGEST = 64 /* longer words get no suggestion; no key or option of ours is nearly as long */
};

static size_t smallest(size_t a, size_t b, size_t c)
{
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Levenshtein's distance, one row of its table at a time. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[LONGEST + 1];
    const size_t length_b = strlen(b);
    for (size_t j = 0; j <= length_b; j++) {
        row[j] = j;
    }
    for (size_t i = 0; a[i] != '\0'; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length_b; j++) {
            const size_t differs = tolower((unsigned char)a[i]) != tolower((unsigned char)b[j]) ? 1 : 0;
            const size_t replaced = diagonal + differs;
            diagonal = row[j + 1];
            row[j + 1] = smallest(replaced, row[j + 1] + 1, row[j] + 1);
        }
    }
    return row[length_b];
}

const char *suggest(const char *word, const char *const *known, size_t count)
{
    const char *best = NULL;
    size_t within = 1 + strlen(word) / 3;
    for (size_t i = 0; i < count; i++) {
        if (strlen(known[i]) > LONGEST) {
            continue;
        }
        const size_t distance = edit_distance(word, known[i]);
        if (distance <= within && (best == NULL || distance < within)) {
            best = known[i];
            within = distance;
        }
    }
    return best;
}
