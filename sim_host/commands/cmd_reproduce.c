/*
 * iqfoc reproduce: both papers' tables beside this project's values, and their figures.
 */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "options.h"
#include "reproduce/figures.h"
#include "reproduce/paper_2016.h"
#include "reproduce/paper_2019.h"

#include <stdio.h>
#include <string.h>

enum { OPT_PAPER, OPT_JSON, OPT_OUTPUT };

static const option_spec specs[] = {
    {"paper", 0, "2016|2019", "only this paper; default: both"},
    {"json", 0, "F", "write the rows to file F; - is stdout, without the tables"},
    {"output", 'o', "DIR",
     "where the report page goes; default: report-reproduce,\nor no page if --json is given without -o"},
    {NULL, 0, NULL, NULL}};

static const command_about about = {
    "reproduce", "[--paper 2016|2019] [--json F] [-o DIR]",
    "Computes the tables and figures of\n"
    "  2016: L. Jarzebowicz, Applied Mathematical Modelling 42, pp. 576-590\n"
    "  2019: L. Jarzebowicz, IET Power Electronics 12(12), pp. 3280-3285\n"
    "and puts each of their figures beside the formula in double precision, evaluated on the\n"
    "simulated drive, and beside the firmware's IQ24 functions. DIR/index.html has the plots.",
    specs};

typedef struct request {
    bool with_2016, with_2019, helped;
    const char *json_path, *directory;
} request;

static bool take_option(const options *o, int which, request *r, error *e)
{
    switch (which) {
    case OPT_PAPER:
        r->with_2016 = strcmp(o->argument, "2016") == 0;
        r->with_2019 = strcmp(o->argument, "2019") == 0;
        return r->with_2016 || r->with_2019 ||
               error_input(e, NULL, 0, 0, "reproduce: --paper %s: expected 2016 or 2019", o->argument);
    case OPT_JSON:
        r->json_path = o->argument;
        return true;
    case OPT_OUTPUT:
        r->directory = o->argument;
        return true;
    default:
        return false;
    }
}

static bool parse(int argc, char **argv, request *r, error *e)
{
    options o = options_begin(&about, argc, argv);
    int which;
    while ((which = options_next(&o, e)) >= 0) {
        if (!take_option(&o, which, r, e)) {
            return false;
        }
    }
    r->helped = o.helped;
    return which != OPTIONS_ERROR && (o.helped || options_at_most(&o, 0, e));
}

static bool write_json(const char *path, const comparison *c, error *e)
{
    json_t *rows = comparison_json(c);
    const bool ok = path != NULL && json_file_write(path, rows, e);
    json_decref(rows);
    return ok;
}

/* directory: NULL for no page. */
static bool compare(const request *r, const char *directory, comparison *c, error *e)
{
    out_folder f = {0};
    const bool ok = out_folder_open(&f, directory, e) && (!r->with_2016 || paper_2016_compare(c, e)) &&
                    (!r->with_2019 || paper_2019_compare(c, e)) &&
                    (f.stage == NULL || reproduce_page(f.stage, c, r->with_2016, r->with_2019, e)) &&
                    (r->json_path == NULL || write_json(out_folder_place(&f, r->json_path, e), c, e));
    return out_folder_close(&f, ok, e);
}

/* Files first, words last: what is printed has been written. */
static bool reproduce(const request *r, comparison *c, error *e)
{
    const bool quiet = r->json_path != NULL && strcmp(r->json_path, "-") == 0;
    const char *directory = r->directory != NULL || r->json_path != NULL ? r->directory : "report-reproduce";
    if (!compare(r, directory, c, e)) {
        return false;
    }
    if (!quiet) {
        comparison_print(c, stdout);
        if (directory != NULL) {
            printf("\nThe figures: %s/index.html\n", directory);
        }
    }
    return true;
}

int cmd_reproduce(int argc, char **argv)
{
    request r = {.with_2016 = true, .with_2019 = true};
    comparison c = {0};
    error e = {0};
    const bool ok = parse(argc, argv, &r, &e) && (r.helped || reproduce(&r, &c, &e));
    comparison_free(&c);
    return ok ? STATUS_DONE : error_print(&e);
}
