/* The parts of TOML's keys, counted without a parser (toml_depth.h). */
#include "toml_depth.h"

#include <string.h>

/* The end of a comment: its line's end, or the text's. */
static size_t comment_end(const char *text, size_t length, size_t at)
{
    while (at < length && text[at] != '\n') {
        at++;
    }
    return at;
}

/* Whether a quote is tripled: a string that may hold line breaks. */
static bool is_tripled(const char *text, size_t length, size_t at)
{
    return length - at >= 3 && text[at + 1] == text[at] && text[at + 2] == text[at];
}

/* The place after a string that begins at `at`; a string without an end ends with its line, or with the text. */
static size_t string_end(const char *text, size_t length, size_t at)
{
    const char quote = text[at];
    const bool tripled = is_tripled(text, length, at);
    at += tripled ? 3 : 1;
    while (at < length) {
        if (text[at] == '\\' && quote == '"') {
            at += 2;
        } else if (text[at] == quote && (!tripled || is_tripled(text, length, at))) {
            return at + (tripled ? 3 : 1);
        } else if (text[at] == '\n' && !tripled) {
            return at;
        } else {
            at++;
        }
    }
    return length;
}

static void position_of(const char *text, size_t at, long *line, long *column)
{
    *line = 1;
    *column = 1;
    for (size_t k = 0; k < at; k++) {
        if (text[k] == '\n') {
            *line += 1;
            *column = 1;
        } else if (((unsigned char)text[k] & 0xC0) != 0x80) {
            *column += 1; /* a character, not a byte */
        }
    }
}

bool toml_depth_check(const char *text, size_t length, long *line, long *column)
{
    int parts = 1;
    size_t at = 0;
    while (at < length) {
        const char c = text[at];
        if (c == '#') {
            at = comment_end(text, length, at);
            continue;
        }
        if (c == '"' || c == '\'') {
            at = string_end(text, length, at);
            continue;
        }
        if (c == '.' && ++parts > TOML_KEY_PARTS_MAX) {
            position_of(text, at, line, column);
            return false;
        }
        if (c != '.' &&
            strchr("=,[]{}\n", c) != NULL) { /* a key ends here, or a value in which dots are decimal marks */
            parts = 1;
        }
        at++;
    }
    return true;
}
