/* The known word closest to a mistyped one, for "did you mean". */
#ifndef SIM_HOST_BASE_SUGGEST_H
#define SIM_HOST_BASE_SUGGEST_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The known word nearest to `word`: fewest letters inserted, removed or replaced, case ignored. NULL if every
 * one is further than a third of the word's letters (plus one), since that is another word, not a slip.
 */
const char *suggest(const char *word, const char *const *known, size_t count);

#ifdef __cplusplus
}
#endif

#endif
