/* The section on where a page comes from (provenance.h). */
/* POSIX: gmtime_r. */
#define _POSIX_C_SOURCE 200809L

#include "provenance.h"

#include "../base/build.h"
#include "../base/memory.h"
#include "../base/sha256.h"
#include "../base/text_out.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* reproducible-builds.org: SOURCE_DATE_EPOCH is whole seconds since 1970; anything else is as if it were not set. */
static time_t now(void)
{
    const char *fixed = getenv("SOURCE_DATE_EPOCH");
    if (fixed != NULL && fixed[0] != '\0' && fixed[strspn(fixed, "0123456789")] == '\0' &&
        strlen(fixed) < 12) {
        return (time_t)strtoll(fixed, NULL, 10);
    }
    return time(NULL);
}

static void tell_date(page *p)
{
    const time_t at = now();
    struct tm utc;
    char text[64] = "";
    if (gmtime_r(&at, &utc) != NULL) {
        strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &utc);
    }
    page_term(p, "date", "%s", text);
}

/* As a shell takes it: quoted where it has to be. */
static void put_word(FILE *out, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
    if (word[0] != '\0' && word[strspn(word, plain)] == '\0') {
        fputs(word, out);
        return;
    }
    fputc('\'', out);
    for (; *word != '\0'; word++) {
        if (*word == '\'') {
            fputs("'\\''", out);
        } else {
            fputc(*word, out);
        }
    }
    fputc('\'', out);
}

static void tell_command(page *p, const provenance *from)
{
    text_out text;
    if (text_out_open(&text)) {
        fputs("iqfoc", text.stream);
        for (int n = 0; n < from->argc; n++) {
            fputc(' ', text.stream);
            put_word(text.stream, from->argv[n]);
        }
    }
    if (!text_out_close(&text)) {
        memory_out();
    }
    page_term(p, "command", "%s", text.bytes);
    free(text.bytes);
}

void provenance_tell(page *p, const provenance *from)
{
    page_heading(p, 2, "Where this page comes from");
    page_terms_begin(p);
    page_term(p, "program", "iqfoc %s%s%s", build_version, build_commit[0] != '\0' ? ", commit " : "",
              build_commit);
    tell_date(p);
    if (from->argc > 0) {
        tell_command(p, from);
    }
    for (size_t n = 0; n < PROVENANCE_FILES && from->file[n].what != NULL; n++) {
        char hash[SHA256_TEXT];
        errno = 0;
        if (from->file[n].path == NULL) {
            page_term(p, from->file[n].what, "no file: given by the program that called");
        } else if (sha256_of_file(from->file[n].path, hash)) {
            page_term(p, from->file[n].what, "%s, sha256 %s", from->file[n].path, hash);
        } else if (errno == ENOMEM) {
            memory_out();
        } else {
            page_term(p, from->file[n].what, "%s, which cannot be read twice", from->file[n].path);
        }
    }
    page_terms_end(p);
}
