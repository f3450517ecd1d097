/* iqfoc golden: check that this build of the library gives the same bits as every other build. */
#include "command.h"
#include "golden_hash.h"
#include "options.h"

#include <inttypes.h>
#include <stdio.h>

static bool listed;

static const option_spec specs[] = {
    {"list", 0, NULL, "also print the hash of each function", .flag = &listed}, {.name = NULL}};

const command_about about_golden = {
    "golden", "[--list]",
    "Runs every function of the library and every configuration of its control "
    "cycle on 100,000 inputs each.\n"
    "Prints one hash of all outputs. The hash is the same for every processor and "
    "compiler. Exit status 1: it\n"
    "differs from the expected hash of this version.",
    specs};

static void print_one(const char *name, uint64_t digest)
{
    printf("%s %016" PRIx64 "\n", name, digest);
}

int cmd_golden(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_golden, argc, argv);
    if (!options_read(&o, &e) || (!o.helped && !options_complete(&o, &e))) {
        return error_print(&e);
    }
    if (o.helped) {
        return STATUS_DONE;
    }
    const uint64_t hash = golden_hash(listed ? print_one : NULL);
    print_one("golden", hash);
    if (hash != GOLDEN_HASH) {
        error_failure(&e, 0, "golden: expected %016" PRIx64 ": this build of the library gives other results",
                      GOLDEN_HASH);
    }
    return e.status == STATUS_DONE ? STATUS_DONE : error_print(&e);
}
