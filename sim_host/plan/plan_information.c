/* The information of a recording (plan_information.h). */
#include "plan_information.h"

#include "diagnose/identify/fit.h"
#include "drive/drive_scenario.h"
#include "drive/firmware_host.h"

#include <stdlib.h>
#include <string.h>

const plan_asked plan_asked_list[PLAN_ASKED] = {
    {"R", "ohm", P_R, H_RESISTANCE},
    {"L_d", "H", P_L_D, H_SALIENCY},
    {"L_q", "H", P_L_Q, H_SALIENCY},
    {"saturation", "share of L at rated current", P_SATURATION, H_SATURATION},
    {"psi_f", "Wb", P_PSI, H_FLUX},
    {"v_dead", "V", P_V_DEAD, H_DEAD_TIME},
    {"theta_0", "rad", P_THETA_0, H_ANGLE_OFFSET},
    {"t_delay", "s", P_T_DELAY, H_ANGLE_DELAY},
    {"voltage delay", "cycles", P_U_DELAY_1, H_VOLTAGE_DELAY_PART},
    {"g_a against b, c", "1", COLUMN_GAIN_A, H_GAIN_MISMATCH},
    {"g_b against c", "1", COLUMN_GAIN_BC, H_GAIN_MISMATCH},
    {"o_alpha", "A", P_OFFSET_A, H_CURRENT_OFFSET},
    {"o_beta", "A", P_OFFSET_B, H_CURRENT_OFFSET},
    {"dR_a", "ohm", P_DR_A, H_ASYMMETRY_A},
    {"dR_b", "ohm", P_DR_B, H_ASYMMETRY_B},
    {"dL_a", "H", P_DL_A, H_INDUCTANCE_A},
    {"dL_b", "H", P_DL_B, H_INDUCTANCE_B},
    {"psi_5", "Wb", P_PSI_5, H_EMF_HARMONICS},
    {"psi_7", "Wb", P_PSI_7, H_EMF_HARMONICS},
};

double plan_cycles_of(const motor *m, const scenario *s)
{
    double cycles = 0.0;
    for (size_t k = 0; k < s->runs; k++) {
        cycles += (double)(scenario_run_cycles(&s->run[k], 1.0 / m->f_pwm_Hz) + s->run[k].settle_cycles);
    }
    return cycles;
}

/* The size of a step of 1 in z; of a logarithmic coordinate that share of the nominal value. */
static double unit_of(const coordinate_frame *f, int column)
{
    if (column >= P_COUNT) {
        return 1.0;
    }
    const coordinate *c = &coordinate_table[column];
    double nominal;
    memcpy(&nominal, (const unsigned char *)&f->nominal + c->offset, sizeof nominal);
    /* 1/I_sat^2 is reported as the share of L lost at the rated current. */
    return c->logarithmic ? nominal : c->scale == SCALE_PER_SQUARE ? 1.0 : f->scale[c->scale];
}

static bool look(const motor *m, const recording *rec, plan_information *info, error *e)
{
    diagnose_rows rows;
    fit_data fitted;
    if (!rows_prepare(&rows, rec, m, e)) {
        return false;
    }
    const coordinate_frame frame = coordinates_of(m, &rows);
    bool ok = fit_data_make(&fitted, &rows, &frame, rec->rows, e);
    info->view.stands = false; /* evidence of another recording is none of this one's */
    if (ok) {
        fit_state nominal;
        info->possible = hypotheses_possible(&rows, &frame);
        ok = (fit_of_nominal(&fitted, &nominal) &&
              evidence_look(&fitted, &nominal, info->possible, &info->view)) ||
             error_failure(e, 0, "out of memory for a recording's information");
        fit_data_free(&fitted);
    }
    for (size_t i = 0; i < PLAN_ASKED && ok; i++) {
        info->unit[i] = unit_of(&frame, plan_asked_list[i].column);
        for (size_t j = 0; j < PLAN_ASKED; j++) {
            info->h[i][j] = info->view.sums.h[plan_asked_list[i].column][plan_asked_list[j].column];
        }
    }
    info->rows = (diagnose_rows){.sensors = rows.sensors};
    info->view.rows = &info->rows;
    rows_free(&rows);
    return ok;
}

static void note(void *context, size_t run, uint32_t status)
{
    uint32_t *all = context;
    (void)run;
    *all |= status;
}

bool plan_information_of(const motor *m, const scenario *s, long seed, plan_information *info, error *e)
{
    static drive_host host;
    uint32_t status = 0;
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    const plant_config true_drive = drive_scenario_plant(m, s);
    const drive_scenario all = {m, s, &true_drive, seed, &firmware, note, &status};
    drive_recording out;
    bool ok = drive_scenario_run(&all, &out, e);
    if (ok && status != 0) {
        char text[160];
        ok = error_input(e, NULL, 0, 0, "%s: %s", s->name, drive_status_text(status, text, sizeof text));
    }
    ok = ok && (recording_find_stretches(&out.recording) ||
                error_failure(e, 0, "out of memory for a recording's stretches"));
    ok = ok && look(m, &out.recording, info, e);
    recording_free(&out.recording);
    return ok;
}
