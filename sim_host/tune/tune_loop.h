/*
 * The closed current loop of a tuned controller (iqfoc/tuned_control.h) and a machine, as one linear system
 * from valley to valley at constant speed, in the rotor's frame: exact in machine, sampling, hold and delay.
 *
 * The machine is exact_map.h's, its voltage seen at the start of the cycle in which it acts. The controller uses the
 * design's machine, the loop has another. The matrix contains that difference, and any error of the voltage's gain,
 * angle or delay. It is for deviations only: the magnet and the reference's constant part drop out.
 */
#ifndef SIM_HOST_TUNE_TUNE_LOOP_H
#define SIM_HOST_TUNE_TUNE_LOOP_H

#include <stdbool.h>

typedef struct tune_machine {
    double R_ohm, L_d_H, L_q_H, psi_f_Wb;
} tune_machine;

/* The controller: shares per cycle, as iqfoc_tuned_law_t has them. */
typedef struct tune_design {
    tune_machine machine; /* the controller's model */
    double T_s;
    double keep, follow, learn, learn_offset;
} tune_design;

/* What happens to the voltage between controller and machine. */
typedef struct tune_fault {
    double gain;      /* 1: nothing */
    double angle_rad; /* turned ahead by so much; 0: nothing */
    double delay;     /* cycles, 0 ... 1, in addition to the controller's own one */
} tune_fault;

extern const tune_fault tune_no_fault;

enum {
    TUNE_ORDER = 14,
    /*
     * Index of each pair of states: current, voltage of the beginning cycle, predicted current, disturbance estimate,
     * valley's offset (estimated, and last measured), voltage of the cycle before.
     */
    TUNE_I = 0,
    TUNE_V = 2,
    TUNE_P = 4,
    TUNE_D = 6,
    TUNE_O = 8,
    TUNE_Z = 10,
    TUNE_LAST = 12
};

typedef struct tune_loop {
    int order; /* TUNE_LAST without a delay, else TUNE_ORDER */
    double a[TUNE_ORDER][TUNE_ORDER];
    double push[TUNE_ORDER][2]; /* of a voltage added behind the controller */
    double aim[TUNE_ORDER][2];  /* of set-point - keep e^(-j phi) predicted current, both at the valleys */
    double mean[2][TUNE_ORDER]; /* the current's mean over the cycle that begins; without a fault only */
    double voltage_of_mean;     /* 1/s1^2: valley over mean */
    double keep_re, keep_im;    /* of keep e^(-j phi) */
    double follow;
} tune_loop;

/* phi: electrical angle of a cycle, |phi| <= 2 pi/3. */
void tune_loop_make(const tune_design *design, const tune_machine *truth, double phi_rad,
                    const tune_fault *fault, tune_loop *loop);

/* Mean of i_d, i_q over each cycle after the reference of i_q has stepped from 0 to 1 at cycle 0. */
void tune_loop_step(const tune_loop *loop, int cycles, double (*mean)[2]);

#endif
