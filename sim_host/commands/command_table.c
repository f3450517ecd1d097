/* The commands by name (command_table.h). */
#include "command_table.h"

#include "base/confine.h"
#include "base/suggest.h"

#include <string.h>

const command command_table[COMMANDS] = {
    {&about_reproduce, "compare the tables and figures of both papers with this project's values",
     cmd_reproduce, CONFINE_MAY_START},
    {&about_simulate, "run the firmware code with a simulated drive and write a recording", cmd_simulate,
     CONFINE_MAY_START | CONFINE_MAY_CONNECT},
#ifdef IQFOC_FMU
    {&about_export_fmu, "export the drive, or its plant, for another simulator (FMI 3.0)", cmd_export_fmu,
     CONFINE_TO_FILES},
#endif
    {&about_record, "write the stream of the firmware's recorder as a recording", cmd_record,
     CONFINE_MAY_CONNECT},
    {&about_sweep, "compute the error of each method over the switching-to-fundamental frequency ratio",
     cmd_sweep, CONFINE_MAY_START},
    {&about_loops, "compare controllers with better feedback and better prediction in closed loop", cmd_loops,
     CONFINE_TO_FILES},
    {&about_motor, "write a first motor file from the values of a data sheet", cmd_motor, CONFINE_TO_FILES},
    {&about_import, "convert the log of another program to a recording", cmd_import, CONFINE_TO_FILES},
    {&about_info, "print what a recording holds", cmd_info, CONFINE_TO_FILES},
    {&about_plot, "draw a recording as a page of charts", cmd_plot, CONFINE_TO_FILES},
    {&about_diagnose, "find the causes of the model error in a recording, and the extended model",
     cmd_diagnose, CONFINE_TO_FILES},
    {&about_plan, "design a test recording that separates the possible causes", cmd_plan, CONFINE_TO_FILES},
    {&about_tune, "design a current controller with margins at every speed, from a diagnosis", cmd_tune,
     CONFINE_TO_FILES},
    {&about_observe, "compare the firmware's observer without a sensor with the angle of a recording",
     cmd_observe, CONFINE_TO_FILES},
    {&about_patterns, "find pulse patterns of least current distortion, for few pulses a turn", cmd_patterns,
     CONFINE_TO_FILES},
    {&about_watch, "test the firmware's change detector on simulated drives", cmd_watch,
     CONFINE_MAY_START | CONFINE_MAY_CONNECT},
    {&about_golden, "check that this build of the library gives the expected bits", cmd_golden,
     CONFINE_TO_FILES},
    {&about_version, "print the version and the commit", cmd_version, CONFINE_TO_FILES},
    {&about_help, "list the commands, explain one, print manual pages and shell completions", cmd_help,
     CONFINE_TO_FILES},
};

const command *command_find(const char *given, error *e)
{
    const char *names[COMMANDS];
    for (int n = 0; n < COMMANDS; n++) {
        names[n] = command_table[n].about->name;
        if (given != NULL && strcmp(given, names[n]) == 0) {
            return &command_table[n];
        }
    }
    const char *meant = given != NULL ? suggest(given, names, COMMANDS) : NULL;
    if (given == NULL) {
        error_input(e, NULL, 0, 0, "expected a command; `iqfoc help` lists them");
    } else if (meant != NULL) {
        error_input(e, NULL, 0, 0, "unknown command \"%s\"; did you mean %s?", given, meant);
    } else {
        error_input(e, NULL, 0, 0, "unknown command \"%s\"; `iqfoc help` lists them", given);
    }
    return NULL;
}
