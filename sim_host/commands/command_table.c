/* The commands by name (command_table.h). */
#include "command_table.h"

#include "base/confine.h"
#include "base/suggest.h"

#include <string.h>

const command command_table[COMMANDS] = {
    {&about_reproduce, "the papers' tables beside this project's values, with the figures as plots",
     cmd_reproduce, CONFINE_MAY_START},
    {&about_simulate, "run the firmware code against the switching-level drive, write a recording",
     cmd_simulate, CONFINE_MAY_START | CONFINE_MAY_CONNECT},
#ifdef IQFOC_FMU
    {&about_export_fmu, "the drive, or its plant alone, as a model for another simulator (FMI 3.0)",
     cmd_export_fmu, CONFINE_TO_FILES},
#endif
    {&about_record, "what the firmware's recorder sends over a serial line, as a recording", cmd_record,
     CONFINE_MAY_CONNECT},
    {&about_sweep, "errors of each method over the switching-to-fundamental frequency ratio", cmd_sweep,
     CONFINE_MAY_START},
    {&about_loops, "what better feedback and better prediction do to a closed loop", cmd_loops,
     CONFINE_TO_FILES},
    {&about_import, "a recording from the log of another program", cmd_import, CONFINE_TO_FILES},
    {&about_diagnose, "what the model gets wrong about a recording, why, and what mending it gains",
     cmd_diagnose, CONFINE_TO_FILES},
    {&about_plan, "the recording to make, by how well it lets the causes be told apart", cmd_plan,
     CONFINE_TO_FILES},
    {&about_tune, "a current controller with its margins at every speed, from what a diagnosis knows",
     cmd_tune, CONFINE_TO_FILES},
    {&about_watch, "trials of the firmware's watch on its model", cmd_watch,
     CONFINE_MAY_START | CONFINE_MAY_CONNECT},
    {&about_golden, "one hash that shows this build to compute what every other does", cmd_golden,
     CONFINE_TO_FILES},
    {&about_help, "this list, a command's help, man pages, completion for shells", cmd_help,
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
