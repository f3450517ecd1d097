/* POSIX: iconv. */
#define _XOPEN_SOURCE 700

#include "log_text.h"

#include <errno.h>
#include <iconv.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_LINE = 1024 * 1024 }; /* as the recording's reader allows */

const char *const log_encoding_words[ENCODING_COUNT] = {"auto", "utf-8", "utf-16le", "utf-16be", "latin-1"};

static bool out_of_memory(const log_text *t, error *e)
{
    return error_failure(e, 0, "%s: out of memory", t->bytes.path);
}

/* Room for so many bytes more behind ->end. */
static bool reserve(log_text *t, size_t more, error *e)
{
    if (t->offset > 0) {
        memmove(t->text, t->text + t->offset, t->end - t->offset);
        t->end -= t->offset;
        t->offset = 0;
    }
    if (t->end + more <= t->size) {
        return true;
    }
    char *grown = realloc(t->text, t->end + more);
    if (grown == NULL) {
        return out_of_memory(t, e);
    }
    t->text = grown;
    t->size = t->end + more;
    return true;
}

/* A block of UTF-16 behind ->end as UTF-8: at most 3 bytes for each 2, and a character that was cut. */
static bool append_utf16(log_text *t, char *bytes, size_t length, error *e)
{
    char *to = t->text + t->end;
    size_t room = t->size - t->end;
    for (size_t taken = 0; t->rest_count > 0 && taken < length;) {
        /* The cut character first, a byte at a time until it is whole. */
        t->rest[t->rest_count++] = bytes[taken++];
        char *from = t->rest;
        size_t left = t->rest_count;
        if (iconv(t->utf16, &from, &left, &to, &room) != (size_t)-1 || left == 0) {
            t->rest_count = 0;
        } else if (errno == EILSEQ || t->rest_count == sizeof t->rest) {
            return error_input(e, t->bytes.path, t->number + 1, 0, "is not UTF-16 text from here on");
        }
        if (t->rest_count == 0 || taken == length) {
            bytes += taken;
            length -= taken;
            break;
        }
    }
    if (t->rest_count == 0 && iconv(t->utf16, &bytes, &length, &to, &room) == (size_t)-1) {
        if (errno != EINVAL || length >= sizeof t->rest) {
            return error_input(e, t->bytes.path, t->number + 1, 0, "is not UTF-16 text from here on");
        }
        memcpy(t->rest, bytes, length);
        t->rest_count = length;
    }
    t->end = (size_t)(to - t->text);
    return true;
}

static bool read_block(log_text *t, error *e)
{
    char *bytes;
    size_t length;
    if (!line_source_block(&t->bytes, &bytes, &length, e)) {
        t->is_end = true;
        if (t->rest_count > 0 && e->status == STATUS_DONE) {
            error_input(e, t->bytes.path, t->number + 1, 0, "the file ends within a UTF-16 character");
        }
        return e->status == STATUS_DONE;
    }
    if (!reserve(t, 2 * length + sizeof t->rest, e)) {
        return false;
    }
    if (t->utf16 != NULL) {
        return append_utf16(t, bytes, length, e);
    }
    memcpy(t->text + t->end, bytes, length);
    t->end += length;
    return true;
}

/* A byte order mark is skipped; it overrides the map, since it cannot be there by chance. */
static void find_mark(log_text *t)
{
    static const struct {
        const char *bytes;
        size_t length;
        log_encoding encoding;
    } marks[] = {{"\xEF\xBB\xBF", 3, ENCODING_UTF8},
                 {"\xFF\xFE", 2, ENCODING_UTF16LE},
                 {"\xFE\xFF", 2, ENCODING_UTF16BE}};
    for (size_t m = 0; m < sizeof marks / sizeof *marks; m++) {
        if (t->end >= marks[m].length && memcmp(t->text, marks[m].bytes, marks[m].length) == 0) {
            t->encoding = marks[m].encoding;
            t->offset = marks[m].length;
            return;
        }
    }
}

/* The first block was read as bytes; if it is UTF-16, it is converted now. */
static bool begin_utf16(log_text *t, error *e)
{
    const iconv_t converter = iconv_open("UTF-8", t->encoding == ENCODING_UTF16LE ? "UTF-16LE" : "UTF-16BE");
    if ((intptr_t)converter == -1) {
        return error_failure(e, errno, "%s: UTF-16 cannot be converted here", t->bytes.path);
    }
    t->utf16 = converter;
    const size_t length = t->end - t->offset;
    char *bytes = malloc(length + 1);
    if (bytes == NULL) {
        return out_of_memory(t, e);
    }
    memcpy(bytes, t->text + t->offset, length);
    t->offset = t->end = 0;
    const bool ok = reserve(t, 2 * length + sizeof t->rest, e) && append_utf16(t, bytes, length, e);
    free(bytes);
    return ok;
}

bool log_text_open(log_text *t, const char *path, log_encoding said, error *e)
{
    *t = (log_text){.encoding = said};
    bool ok = line_source_open(&t->bytes, path, e) && reserve(t, 1, e) && read_block(t, e);
    if (ok) {
        find_mark(t);
        if (t->encoding == ENCODING_UTF16LE || t->encoding == ENCODING_UTF16BE) {
            ok = begin_utf16(t, e);
        }
    }
    if (!ok) {
        log_text_close(t);
    }
    return ok;
}

/* Well-formed UTF-8 as far as lead and continuation bytes say. */
static bool is_utf8(const char *text, size_t length)
{
    for (size_t offset = 0; offset < length;) {
        const unsigned char c = (unsigned char)text[offset++];
        size_t more = c < 0x80             ? 0
                      : (c & 0xE0) == 0xC0 ? 1
                      : (c & 0xF0) == 0xE0 ? 2
                      : (c & 0xF8) == 0xF0 ? 3
                                           : 4;
        if (more == 4) {
            return false;
        }
        for (; more > 0; more--, offset++) {
            if (offset >= length || ((unsigned char)text[offset] & 0xC0) != 0x80) {
                return false;
            }
        }
    }
    return true;
}

/* Latin-1's characters are the first 256 of Unicode, two bytes each from 0x80 on. */
static bool convert_latin1(log_text *t, error *e)
{
    if (2 * t->length + 1 > t->latin1_size) {
        char *grown = realloc(t->latin1, 2 * t->length + 1);
        if (grown == NULL) {
            return out_of_memory(t, e);
        }
        t->latin1 = grown;
        t->latin1_size = 2 * t->length + 1;
    }
    size_t out = 0;
    for (size_t k = 0; k < t->length; k++) {
        const unsigned char c = (unsigned char)t->line[k];
        if (c < 0x80) {
            t->latin1[out++] = (char)c;
        } else {
            t->latin1[out++] = (char)(0xC0 | (c >> 6));
            t->latin1[out++] = (char)(0x80 | (c & 0x3F));
        }
    }
    t->line = t->latin1;
    t->length = out;
    return true;
}

static bool decode_line(log_text *t, error *e)
{
    if (t->utf16 != NULL || (t->encoding != ENCODING_LATIN1 && is_utf8(t->line, t->length))) {
        return true;
    }
    if (t->encoding == ENCODING_UTF8) {
        return error_input(e, t->bytes.path, t->number, 0,
                           "the line is not UTF-8; [format] encoding says what it is");
    }
    return convert_latin1(t, e);
}

/* How far the line goes, from ->offset; false if its end has not been read. */
static bool find_end(const log_text *t, size_t from, size_t *length, size_t *with_end)
{
    const char *start = t->text + t->offset;
    const size_t there = t->end - t->offset;
    for (size_t k = from; k < there; k++) {
        if (start[k] == '\n' || (start[k] == '\r' && (k + 1 < there || t->is_end))) {
            const bool two = start[k] == '\r' && k + 1 < there && start[k + 1] == '\n';
            *length = k;
            *with_end = k + (two ? 2 : 1);
            return true;
        }
    }
    *length = *with_end = there;
    return t->is_end;
}

bool log_text_next(log_text *t, error *e)
{
    size_t length = 0;
    size_t with_end = 0;
    while (!find_end(t, length > 0 ? length - 1 : 0, &length, &with_end)) {
        if (length > LONGEST_LINE) {
            return error_input(e, t->bytes.path, t->number + 1, 0,
                               "the line is longer than 1 MiB; expected a table of numbers");
        }
        if (!read_block(t, e)) {
            return false;
        }
    }
    if (with_end == 0) {
        return false;
    }
    t->line = t->text + t->offset;
    t->length = length;
    t->offset += with_end;
    t->number++;
    return decode_line(t, e);
}

void log_text_close(log_text *t)
{
    line_source_close(&t->bytes);
    if (t->utf16 != NULL) {
        iconv_close(t->utf16);
    }
    free(t->text);
    free(t->latin1);
    *t = (log_text){0};
}
