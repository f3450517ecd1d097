/* The parts of TOML's keys, counted without a parser (toml_depth.h). */
#include "toml_depth.h"

#include <string.h>

/* The end of a comment: its line's end, or the text's. */
static size_t comment_end(const char *text, size_t length, size_t offset)
{
    while (offset < length && text[offset] != '\n') {
        offset++;
    }
    return offset;
}

/* Whether a quote is tripled: a string that may hold line breaks. */
static bool is_tripled(const char *text, size_t length, size_t offset)
{
    return length - offset >= 3 && text[offset + 1] == text[offset] && text[offset + 2] == text[offset];
}

/* The place after a string that begins at `offset`; a string without an end ends with its line, or with the text. */
static size_t string_end(const char *text, size_t length, size_t offset)
{
    const char quote = text[offset];
    const bool tripled = is_tripled(text, length, offset);
    offset += tripled ? 3 : 1;
    while (offset < length) {
        if (text[offset] == '\\' && quote == '"') {
            offset += 2;
        } else if (text[offset] == quote && (!tripled || is_tripled(text, length, offset))) {
            return offset + (tripled ? 3 : 1);
        } else if (text[offset] == '\n' && !tripled) {
            return offset;
        } else {
            offset++;
        }
    }
    return length;
}

static void position_of(const char *text, size_t offset, long *line, long *column)
{
    *line = 1;
    *column = 1;
    for (size_t k = 0; k < offset; k++) {
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
    size_t offset = 0;
    while (offset < length) {
        const char c = text[offset];
        if (c == '#') {
            offset = comment_end(text, length, offset);
            continue;
        }
        if (c == '"' || c == '\'') {
            offset = string_end(text, length, offset);
            continue;
        }
        if (c == '.' && ++parts > TOML_KEY_PARTS_MAX) {
            position_of(text, offset, line, column);
            return false;
        }
        if (c != '.' &&
            strchr("=,[]{}\n", c) != NULL) { /* a key ends here, or a value in which dots are decimal marks */
            parts = 1;
        }
        offset++;
    }
    return true;
}
