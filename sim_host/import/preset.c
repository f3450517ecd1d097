#include "preset.h"

#include "base/suggest.h"

#include <string.h>

enum { ENTRIES_MOST = 10 };

typedef struct preset_entry {
    quantity q;
    const char *from, *unit; /* from NULL: no more */
    bool mechanical;
    double scale; /* 0: 1 */
} preset_entry;

struct preset {
    const char *name;
    const char *note; /* comment lines of the map */
    char delimiter;
    preset_entry entry[ENTRIES_MOST];
};

static const preset presets[] = {
    {"vesc",
     "# VESC Tool's real-time log (CSV, semicolons), as its files are read by public log viewers.\n"
     "# It holds some ten to hundred rows a second, not every cycle: import refuses such a log, since the\n"
     "# commands between two rows are not in it. The map is for firmware that logs these names every "
     "cycle.\n",
     ';',
     {{QUANTITY_T, "ms_today", "ms", false, 0.0},
      {QUANTITY_I_D, "d_axis_current", "A", false, 0.0},
      {QUANTITY_I_Q, "q_axis_current", "A", false, 0.0},
      {QUANTITY_U_D, "d_axis_voltage", "V", false, 0.0},
      {QUANTITY_U_Q, "q_axis_voltage", "V", false, 0.0},
      {QUANTITY_U_DC, "input_voltage", "V", false, 0.0},
      {QUANTITY_OMEGA, "erpm", "rpm", false, 0.0},
      {QUANTITY_THETA, "encoder_position", "deg", true, 0.0}}},
    {"odrive",
     "# ODrive's properties of axis0.motor.current_control, firmware 0.5, under their own names. ODrive "
     "writes no\n"
     "# file: name the columns so where you capture them. A capture over USB is not every cycle.\n",
     ',',
     {{QUANTITY_T, "time", "s", false, 0.0},
      {QUANTITY_I_ALPHA, "Ialpha_measured", "A", false, 0.0},
      {QUANTITY_I_BETA, "Ibeta_measured", "A", false, 0.0},
      {QUANTITY_U_ALPHA, "final_v_alpha", "V", false, 0.0},
      {QUANTITY_U_BETA, "final_v_beta", "V", false, 0.0},
      {QUANTITY_U_DC, "vbus_voltage", "V", false, 0.0},
      {QUANTITY_THETA, "phase", "rad", false, 0.0},
      {QUANTITY_OMEGA, "phase_vel", "rad/s", false, 0.0}}},
    {"moteus",
     "# moteus' telemetry channels servo_stats and servo_cmd (d_V, q_V), field names as in its sources. "
     "Written\n"
     "# by tview as rows of their own rate: only a log of every cycle can be used.\n",
     ',',
     {{QUANTITY_T, "time", "s", false, 0.0},
      {QUANTITY_I_A, "cur1_A", "A", false, 0.0},
      {QUANTITY_I_B, "cur2_A", "A", false, 0.0},
      {QUANTITY_I_C, "cur3_A", "A", false, 0.0},
      {QUANTITY_U_D, "d_V", "V", false, 0.0},
      {QUANTITY_U_Q, "q_V", "V", false, 0.0},
      {QUANTITY_U_DC, "bus_V", "V", false, 0.0},
      {QUANTITY_THETA, "electrical_theta", "rad", false, 0.0}}},
    {"simplefoc",
     "# SimpleFOC's motor.monitor() with all seven variables: no header, tabs, in the documented order "
     "target,\n"
     "# voltage q and d [V], current q and d [mA], velocity, angle [rad, of the shaft]. It has no time: say\n"
     "# rate_Hz, and take care that no row is left out (monitor_downsample, and a serial line that is fast "
     "enough).\n"
     "# The shaft's angle must be zero where theta_e is zero: zero = sensor's zero_electric_angle / pole "
     "pairs.\n",
     '\t',
     {{QUANTITY_U_Q, "2", "V", false, 0.0},
      {QUANTITY_U_D, "3", "V", false, 0.0},
      {QUANTITY_I_Q, "4", "mA", false, 0.0},
      {QUANTITY_I_D, "5", "mA", false, 0.0},
      {QUANTITY_OMEGA, "6", "rad/s", true, 0.0},
      {QUANTITY_THETA, "7", "rad", true, 0.0}}},
    {"ti-datalog",
     "# TI's datalog buffers, the names as documented. What each holds, the firmware chooses: this map is "
     "for\n"
     "# angle, i_alpha, i_beta, u_alpha, u_beta in physical units, in that order. Say rate_Hz; a prescaler\n"
     "# above 1 leaves cycles out.\n",
     ',',
     {{QUANTITY_THETA, "datalogBuff[0]", "rad", false, 0.0},
      {QUANTITY_I_ALPHA, "datalogBuff[1]", "A", false, 0.0},
      {QUANTITY_I_BETA, "datalogBuff[2]", "A", false, 0.0},
      {QUANTITY_U_ALPHA, "datalogBuff[3]", "V", false, 0.0},
      {QUANTITY_U_BETA, "datalogBuff[4]", "V", false, 0.0}}},
    {"freemaster",
     "# A FreeMASTER recorder with the variables of NXP's PMSM examples (g_sM1Drive), names as in their "
     "sources.\n"
     "# How the recorder's export writes its header was not at hand: names and delimiter may have to be "
     "changed.\n"
     "# Duties are fractions; the position is a fraction of half a turn, so that its unit is half turns.\n",
     '\t',
     {{QUANTITY_I_A, "g_sM1Drive.sFocPMSM.sIABC.fltA", "A", false, 0.0},
      {QUANTITY_I_B, "g_sM1Drive.sFocPMSM.sIABC.fltB", "A", false, 0.0},
      {QUANTITY_I_C, "g_sM1Drive.sFocPMSM.sIABC.fltC", "A", false, 0.0},
      {QUANTITY_D_A, "g_sM1Drive.sFocPMSM.sDutyABC.f16A", "1", false, 0.0},
      {QUANTITY_D_B, "g_sM1Drive.sFocPMSM.sDutyABC.f16B", "1", false, 0.0},
      {QUANTITY_D_C, "g_sM1Drive.sFocPMSM.sDutyABC.f16C", "1", false, 0.0},
      {QUANTITY_U_DC, "g_sM1Drive.sFocPMSM.fltUDcBusFilt", "V", false, 0.0},
      {QUANTITY_THETA, "g_sM1Drive.sFocPMSM.f16PosEl", "turn", false, 0.5}}},
    {"motulator",
     "# motulator writes no file: this is for its signals under their own symbols (i_s, u_s in stator "
     "coordinates,\n"
     "# theta_m and w_m of its two-pole equivalent, so electrical), sampled once a cycle and saved as CSV.\n",
     ',',
     {{QUANTITY_T, "t", "s", false, 0.0},
      {QUANTITY_I_A, "i_s_a", "A", false, 0.0},
      {QUANTITY_I_B, "i_s_b", "A", false, 0.0},
      {QUANTITY_I_C, "i_s_c", "A", false, 0.0},
      {QUANTITY_D_A, "d_a", "1", false, 0.0},
      {QUANTITY_D_B, "d_b", "1", false, 0.0},
      {QUANTITY_D_C, "d_c", "1", false, 0.0},
      {QUANTITY_U_DC, "u_dc", "V", false, 0.0},
      {QUANTITY_THETA, "theta_m", "rad", false, 0.0},
      {QUANTITY_OMEGA, "w_m", "rad/s", false, 0.0}}},
};

enum { PRESETS = sizeof presets / sizeof *presets };

const preset *preset_find(const char *name, error *e)
{
    const char *names[PRESETS];
    char all[200] = "";
    for (size_t n = 0; n < PRESETS; n++) {
        names[n] = presets[n].name;
        if (strcmp(name, presets[n].name) == 0) {
            return &presets[n];
        }
        strcat(all, n == 0 ? "" : ", ");
        strcat(all, presets[n].name);
    }
    const char *meant = suggest(name, names, PRESETS);
    if (meant != NULL) {
        error_input(e, NULL, 0, 0, "import: no preset \"%s\"; did you mean %s?", name, meant);
    } else {
        error_input(e, NULL, 0, 0, "import: no preset \"%s\"; there are %s", name, all);
    }
    return NULL;
}

import_map preset_map(const preset *p)
{
    import_map m = map_blank();
    m.path = p->name;
    m.format.delimiter = p->delimiter;
    for (size_t n = 0; n < ENTRIES_MOST && p->entry[n].from != NULL; n++) {
        const preset_entry *entry = &p->entry[n];
        map_column *c = &m.column[entry->q];
        map_put(&m, entry->q, entry->from, entry->unit);
        c->mechanical = entry->mechanical;
        c->scale = entry->scale != 0.0 ? entry->scale : 1.0;
    }
    return m;
}

void preset_print(FILE *out, const preset *p)
{
    const import_map m = preset_map(p);
    fprintf(out, "%s\n", p->note);
    map_print(out, &m);
    if (!m.column[QUANTITY_T].there) {
        fprintf(out,
                "\n# The log has no time: say the rate of control cycles.\n# [timing]\n# rate_Hz = 10000\n");
    }
}
