/*
 * A foreign log as lines of UTF-8, whatever bytes it is made of: UTF-8 with or without a byte order mark,
 * UTF-16 of either order, Latin-1; lines that end in LF, CRLF or CR; plain or gzip; "-" is stdin.
 *
 * A byte order mark decides. Without one and without a word from the map, a line that is no UTF-8 is Latin-1.
 */
#ifndef SIM_HOST_IMPORT_LOG_TEXT_H
#define SIM_HOST_IMPORT_LOG_TEXT_H

#include "data/line_source.h"

typedef enum log_encoding {
    ENCODING_AUTO,
    ENCODING_UTF8,
    ENCODING_UTF16LE,
    ENCODING_UTF16BE,
    ENCODING_LATIN1,
    ENCODING_COUNT
} log_encoding;

/* "auto", "utf-8" ... as a map spells them. */
extern const char *const log_encoding_words[ENCODING_COUNT];

typedef struct log_text {
    line_source bytes;
    log_encoding encoding;
    void *utf16;  /* iconv_t, NULL if not UTF-16 */
    char rest[4]; /* bytes of a UTF-16 character that the block cut */
    size_t rest_count;
    char *text; /* what has been read and not handed out: [at, end), UTF-8, or bytes if not UTF-16 */
    size_t offset, end, size;
    bool is_end;
    char *latin1; /* a line that had to be converted */
    size_t latin1_size;
    const char *line; /* the current line without its end; not 0-terminated */
    size_t length;
    long number;
} log_text;

/* `path` must outlive the struct. */
bool log_text_open(log_text *t, const char *path, log_encoding said, error *e);

/* The next line. False at the end, or with *e set. */
bool log_text_next(log_text *t, error *e);

/* Safe on a zeroed struct. */
void log_text_close(log_text *t);

#endif
