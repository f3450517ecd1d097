/* iqfoc version: the version and the commit of this program. */
#include "command.h"
#include "help.h"

static const option_spec specs[] = {{.name = NULL}};

const command_about about_version = {"version", "", "Prints the version and the commit, as --version does.",
                                     specs};

int cmd_version(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_version, argc, argv);
    if (!options_read(&o, &e) || (!o.helped && !options_complete(&o, &e))) {
        return error_print(&e);
    }
    if (!o.helped) {
        help_version();
    }
    return STATUS_DONE;
}
