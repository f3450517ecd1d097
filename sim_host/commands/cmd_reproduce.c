/* iqfoc reproduce: both papers' tables with this project's values, and their figures. */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "options.h"
#include "reproduce/figures.h"
#include "reproduce/paper_2016.h"
#include "reproduce/paper_2019.h"

#include <stdio.h>
#include <string.h>

typedef struct request {
    bool with_2016, with_2019;
    const char *json_path, *directory;
} request;

static request asked = {.with_2016 = true, .with_2019 = true};

static bool take_paper(const options *o, error *e)
{
    request *r = &asked;
    r->with_2016 = strcmp(o->argument, "2016") == 0;
    r->with_2019 = strcmp(o->argument, "2019") == 0;
    return r->with_2016 || r->with_2019 ||
           error_input(e, NULL, 0, 0, "reproduce: --paper %s: expected 2016 or 2019", o->argument);
}

static const option_spec specs[] = {
    {"paper", 0, "2016|2019", "only this paper; default: both", .take = take_paper},
    {"json", 0, "F", "write the rows to file F; - is stdout, without the tables", .text = &asked.json_path,
     .written = true},
    {"output", 'o', "DIR",
     "folder of the report page; default: report-reproduce,\nor no page if --json is given without -o",
     .text = &asked.directory},
    {.name = NULL}};

const command_about about_reproduce = {
    "reproduce", "[--paper 2016|2019] [--json F] [-o DIR]",
    "Computes the tables and figures of two papers:\n"
    "  2016: L. Jarzebowicz, Applied Mathematical Modelling 42, pp. 576-590\n"
    "  2019: L. Jarzebowicz, IET Power Electronics 12(12), pp. 3280-3285\n"
    "and compares each of their figures with the formula in double precision, evaluated on the\n"
    "simulated drive, and with the firmware's IQ24 functions. DIR/index.html has the plots.",
    specs};

/* Files first, text last: printed results have been written. */
static bool reproduce(const request *r, comparison *c, error *e)
{
    const char *directory = r->directory != NULL || r->json_path != NULL ? r->directory : "report-reproduce";
    out_folder f = {0};
    bool ok = out_folder_open(&f, directory, e) && (!r->with_2016 || paper_2016_compare(c, e)) &&
              (!r->with_2019 || paper_2019_compare(c, e)) &&
              (f.stage == NULL || reproduce_page(f.stage, c, r->with_2016, r->with_2019, e)) &&
              json_file_place(&f, r->json_path, comparison_json(c), e);
    ok = out_folder_close(&f, ok, e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        comparison_print(c, stdout);
        if (directory != NULL) {
            printf("\nPlots: %s/index.html\n", directory);
        }
    }
    return ok;
}

int cmd_reproduce(int argc, char **argv)
{
    comparison c = {0};
    error e = {0};
    options o = options_begin(&about_reproduce, argc, argv);
    const bool ok =
        options_read(&o, &e) && (o.helped || (options_complete(&o, &e) && reproduce(&asked, &c, &e)));
    comparison_free(&c);
    return ok ? STATUS_DONE : error_print(&e);
}
