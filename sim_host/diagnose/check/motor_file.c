/* Fitted values against the motor file's (motor_file.h). */
#include "motor_file.h"

#include <math.h>

bool check_motor_file(const averaged_drive *fitted, const averaged_drive *file, const recording *rec,
                      error *e)
{
    /* All scaled alike is a voltage gain: what counts is what the motor would be with the recorded voltages.
     * Hot windings, saturation and weak magnets stay within these factors; two beyond them are another
     * machine. */
    double k = fitted->k_u;
    double ki = k * (fitted->g[0] + fitted->g[1]) / 2.0; /* and with the recorded currents */
    double psi = file->psi_f_Wb > 0.0 ? fitted->psi_f_Wb / (k * file->psi_f_Wb) : 1.0;
    double L = sqrt(fitted->L_d_H * fitted->L_q_H / (file->L_d_H * file->L_q_H)) / ki;
    double R = file->R_ohm > 0.0 ? fitted->R_ohm / (ki * file->R_ohm) : 1.0;
    int far = (psi > 1.45 || psi < 0.7) + (L > 1.7 || L < 0.6) + (R > 2.5 || R < 0.4);
    if (far < 2) {
        return true;
    }
    return error_input(
        e, rec->path, 0, 0,
        "the recording is of another motor: it fits R = %.3g ohm, L_d = %.3g H, L_q = %.3g H, "
        "psi_f = %.3g Wb, the motor file has %.3g ohm, %.3g H, %.3g H, %.3g Wb; give the file of this motor",
        fitted->R_ohm / ki, fitted->L_d_H / ki, fitted->L_q_H / ki, fitted->psi_f_Wb / k, file->R_ohm,
        file->L_d_H, file->L_q_H, file->psi_f_Wb);
}
