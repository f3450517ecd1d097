/*
 * Limits the depth of dotted TOML keys before parsing: toml++ recurses once for each part, so a key of 50,000 parts would overflow the stack.
 */
#ifndef SIM_HOST_DATA_TOML_DEPTH_H
#define SIM_HOST_DATA_TOML_DEPTH_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    TOML_KEY_PARTS_MAX = 16 /* no file of this program has a key of more than three parts */
};

/*
 * False where a key, of a value, a table or an inline table, has more parts: at which line and character column (from 1) the first
 * one too many follows. What is no TOML is left to the parser.
 */
bool toml_depth_check(const char *text, size_t length, long *line, long *column);

#ifdef __cplusplus
}
#endif

#endif
