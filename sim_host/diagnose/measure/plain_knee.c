/* The knee closest to the fitted model (plain_knee.h). */
#include "plain_knee.h"

#include <math.h>

double plain_knee_A(const averaged_drive *drive, const diagnose_rows *r, double i_peak_A)
{
    /* Typical ripple at an edge. */
    double square = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        vec_ab flux = r->row[k].edge_ripple_Wb[0];
        square += (flux.alpha * flux.alpha + flux.beta * flux.beta) / (double)r->rows;
    }
    double apart = drive->edge_ripple * drive->k_u * sqrt(square) * 2.0 / (drive->L_d_H + drive->L_q_H);
    double best = drive->i_knee_A;
    double least = INFINITY;
    for (double knee = 0.002 * i_peak_A; knee < 0.3 * i_peak_A; knee *= 1.05) {
        double sum = 0.0;
        for (int k = 1; k <= 400; k++) {
            double i = i_peak_A * k / 400.0;
            double x = (i + apart) / drive->i_knee_A;
            double y = (i - apart) / drive->i_knee_A;
            double is = 0.5 * (averaged_drive_edge(drive->edge, x) + averaged_drive_edge(drive->edge, y));
            /* What devices take follows the mean sign of a current that swings by the ripple. */
            is += drive->conduction * ((apart > i ? i / apart : 1.0) - is);
            double wrong = fmin(i / knee, 1.0) - is;
            sum += wrong * wrong;
        }
        if (sum < least) {
            least = sum;
            best = knee;
        }
    }
    return best;
}

bool plain_knee_holds_sign(const averaged_drive *drive, const diagnose_rows *r, double i_peak_A)
{
    if (drive->compensation_V == 0.0) {
        return false;
    }
    const double share = drive->compensation_knee_A / plain_knee_A(drive, r, i_peak_A);
    return (drive->v_dead_V + drive->compensation_V) * fmin(share, 1.0) < drive->compensation_V;
}
