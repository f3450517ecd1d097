/*
 * Trials of the change detector (iqfoc/watch.h). Drives under the tuned controller run a varied duty (speeds in both
 * directions, steps of both currents). After half a second the drive changes.
 *
 * The drive is the motor file's, the firmware's model the centre of the design's uncertainty set. With a diagnosis
 * the detector has its noise and 95 % uncertainty. Without one it takes the model as exact, with the trials' own
 * noise.
 */
#ifndef SIM_HOST_TUNE_WATCH_TRIAL_H
#define SIM_HOST_TUNE_WATCH_TRIAL_H

#include "tune_design.h"

#include "drive/drive_recording.h"

#include "tuned_firmware.h"

typedef enum watch_change {
    WATCH_NOTHING,
    WATCH_MAGNET,  /* psi_f 5 % lower */
    WATCH_WINDING, /* 60 K warmer: R 23.6 % higher */
    WATCH_SENSOR,  /* one phase's current sensor reads 2 % more */
    WATCH_LEGS,    /* dead time doubled */
    WATCH_PHASE,   /* resistance of one phase 50 % higher */
    WATCH_ROTOR,   /* eccentric: the magnet's flux varies by 5 % once per mechanical revolution */
    WATCH_CHANGES
} watch_change;

/* Operating conditions of the runs without a change. */
typedef enum watch_condition {
    WATCH_CONSTANT,      /* link, temperatures and inductances */
    WATCH_RIPPLE_1,      /* of the DC link: +-1 % at 300 Hz */
    WATCH_RIPPLE_3,      /* +-3 % */
    WATCH_TEMPERATURE,   /* the winding swings by WATCH_SWING_K, the magnet by half of that */
    WATCH_SATURATION_3,  /* L is 3 % lower at rated current */
    WATCH_SATURATION_10, /* 10 % */
    WATCH_LOAD_STEPS,    /* torque reversals each 3 to 20 ms, with short ramps of the speed */
    WATCH_CONDITIONS
} watch_condition;

#define WATCH_SWING_K 10.0 /* amplitude */
#define WATCH_SWING_S 20.0 /* period */

extern const char *const watch_condition_text[WATCH_CONDITIONS];
extern const char *const watch_condition_key[WATCH_CONDITIONS];

extern const char *const watch_change_text[WATCH_CHANGES];
extern const char *const watch_change_key[WATCH_CHANGES];
extern const char *const watch_group_text[IQFOC_WATCH_GROUPS + 1];

/* Noise of the current sensors over the rated peak; dead time of the legs. */
#define WATCH_NOISE     0.003
#define WATCH_DEAD_S    0.5e-6
#define WATCH_CLEAN_S   0.5
#define WATCH_CHANGED_S 1.0 /* an alarm must come within this */
#define WATCH_NAMED_S   0.5 /* and the name after it */

typedef struct watch_trial {
    int trials;
    int noted;       /* an alarm within WATCH_CHANGED_S, and a name */
    int right;       /* and the right group */
    int early;       /* an alarm before the change */
    double median_s; /* from the change to the alarm; NAN without an alarm */
    double latest_s;
    double amount;    /* mean of those with the right group, in the sizes of iqfoc/watch.h */
    int since_within; /* of the detected: the change's time is reported to 0.1 s */
    int named[IQFOC_WATCH_GROUPS + 1];
} watch_trial;

/* The design's motor runs at its f_pwm_Hz. */
bool watch_trial_run(const tune_result *r, watch_change change, int trials, uint64_t seed, watch_trial *out,
                     error *e);

/*
 * The recording triggered by the alarm: rows of sensors and firmware after it, and the firmware's motor. A changed
 * current sensor is phase A's.
 */
typedef struct watch_dump {
    bool noted;     /* within WATCH_CHANGED_S; without it there are no rows */
    double alarm_s; /* from the change to the alarm */
    iqfoc_watch_group_t group;
    drive_recording rows; /* freed with recording_free(&rows.recording), also after a failure */
    motor model;
} watch_dump;

/* A firmware outside this program. */
typedef struct watch_target {
    void *context;
    /* *calls: its valley and peak. model: the bases of its recorder's values. */
    bool (*start)(void *context, const tuned_firmware_config_t *config, const motor *model,
                  drive_firmware *calls, error *e);
    bool (*group)(void *context, iqfoc_watch_group_t *group, error *e);
} watch_target;

/* target: NULL for the firmware of this program. */
bool watch_trial_dump(const tune_result *r, watch_change change, uint64_t seed, double seconds,
                      const watch_target *target, watch_dump *dump, error *e);

/*
 * Cycles without a change, in runs of `cycles`/32 blocks with their own seeds. Counts how often the highest detector
 * passes 1, 2, ... WATCH_LEVELS - 1, and the alarms.
 */
enum { WATCH_LEVELS = 24 };

typedef struct watch_clean {
    double cycles;
    long passed[WATCH_LEVELS]; /* upcrossings of level n */
    long alarms;
    double highest;
} watch_clean;

bool watch_clean_run(const tune_result *r, watch_condition condition, double cycles, uint64_t seed,
                     watch_clean *out, error *e);

#endif
