/*
 * The commands of `iqfoc`, one cmd_<name>.c each. A command parses its options (options.h), does its work, prints an error
 * with error_print and returns the exit status. argv[0] is the command's name.
 */
#ifndef SIM_HOST_COMMANDS_COMMAND_H
#define SIM_HOST_COMMANDS_COMMAND_H

#include "options.h"

int cmd_reproduce(int argc, char **argv);
int cmd_simulate(int argc, char **argv);
int cmd_export_fmu(int argc, char **argv);
int cmd_record(int argc, char **argv);
int cmd_loops(int argc, char **argv);
int cmd_sweep(int argc, char **argv);
int cmd_plan(int argc, char **argv);
int cmd_tune(int argc, char **argv);
int cmd_observe(int argc, char **argv);
int cmd_patterns(int argc, char **argv);
int cmd_watch(int argc, char **argv);
int cmd_motor(int argc, char **argv);
int cmd_info(int argc, char **argv);
int cmd_plot(int argc, char **argv);
int cmd_import(int argc, char **argv);
int cmd_diagnose(int argc, char **argv);
int cmd_golden(int argc, char **argv);
int cmd_version(int argc, char **argv);
int cmd_help(int argc, char **argv);

/* Options and help text of each command. */
extern const command_about about_reproduce, about_simulate, about_record, about_loops, about_sweep,
    about_tune, about_observe, about_patterns, about_watch, about_import, about_diagnose, about_golden,
    about_plan, about_export_fmu, about_motor, about_info, about_plot, about_version, about_help;

#endif
