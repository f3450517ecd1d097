/* The exact solution under a constant voltage and speed (edge_machine.h). */
#include "edge_machine.h"

#include "base/vector.h"

#include <math.h>

double edge_machine_link_V(const edge_machine *m, double time_s)
{
    return m->u_dc_V * (1.0 + m->ripple * sin(VEC_TWO_PI * EDGE_MACHINE_RIPPLE_HZ * time_s));
}

void edge_machine_flow(edge_machine *m, double to_s)
{
    const double dt = to_s - m->time_s;
    if (dt > 0.0) {
        double complex u = 0.0;
        for (int k = 0; k < 3; k++) {
            u += m->level[k] / 3.0 * cexp(I * VEC_TWO_PI / 3.0 * k);
        }
        u *= edge_machine_link_V(m, m->time_s + 0.5 * dt);
        const double complex emf = -I * m->w * m->psi_f_Wb / (m->R_ohm + I * m->w * m->L_s_H);
        const double complex before = u / m->R_ohm + emf * cexp(I * m->theta);
        m->theta += m->w * dt;
        m->i = u / m->R_ohm + emf * cexp(I * m->theta) + (m->i - before) * exp(-m->R_ohm * dt / m->L_s_H);
        m->time_s = to_s;
    }
}
