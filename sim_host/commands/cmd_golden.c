/* iqfoc golden: whether this build of the library computes what every other does, to the last bit. */
#include "command.h"
#include "golden_hash.h"
#include "options.h"

#include <inttypes.h>
#include <stdio.h>

enum { OPT_LIST };

static const option_spec specs[] = {{"list", 0, NULL, "print each function's digest too"},
                                    {NULL, 0, NULL, NULL}};

const command_about about_golden = {"golden", "[--list]",
                                    "Runs every function of the library, and every configuration of its "
                                    "cycle, over 100,000 inputs each, and\n"
                                    "prints one hash of all that came out. It is the same on every processor "
                                    "and by every compiler; the exit\n"
                                    "status is 1 where it is not the one that this version is meant to have.",
                                    specs};

static void print_one(const char *name, uint64_t digest)
{
    printf("%s %016" PRIx64 "\n", name, digest);
}

int cmd_golden(int argc, char **argv)
{
    error e = {0};
    bool list = false;
    const option_place places[] = {[OPT_LIST] = {.flag = &list}};
    options o = options_begin(&about_golden, argc, argv);
    if (!options_read(&o, places, &e) || (!o.helped && !options_complete(&o, places, &e))) {
        return error_print(&e);
    }
    if (o.helped) {
        return STATUS_DONE;
    }
    const uint64_t hash = golden_hash(list ? print_one : NULL);
    print_one("golden", hash);
    if (hash != GOLDEN_HASH) {
        error_failure(&e, 0,
                      "golden: %016" PRIx64 " is expected: this build of the library computes something else",
                      GOLDEN_HASH);
    }
    return e.status == STATUS_DONE ? STATUS_DONE : error_print(&e);
}
