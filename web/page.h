/*
 * What the page in the browser calls (page.c, page_files.c, page_live.c). The same C as the program's; each call prints its JSON on
 * stdout, what is to be said on stderr, and returns the program's exit status. Files are those that the page put into memory; what a
 * call writes the page finds there.
 */
#ifndef WEB_PAGE_H
#define WEB_PAGE_H

#include "base/json.h"

#define PAGE_CALL(name) __attribute__((export_name(#name))) int name

/* The files that the page may name ahead of a call, as JSON and messages shall show them. The numbers are worker.js's, too. */
typedef enum page_name {
    PAGE_RECORDING,
    PAGE_MOTOR,
    PAGE_LOG,
    PAGE_MAP,
    PAGE_DIAGNOSIS,
    PAGE_OCTETS,
    PAGE_NAMES
} page_name;

const char *page_name_of(page_name which);

/* Prints the JSON if all went well, else the message, and frees the JSON; the status. */
int page_answer(bool ok, json_t *json, const error *e);

#endif
