/*
 * The watch (iqfoc/watch.h) tried: drives under the tuned controller run varied duty (speeds through both
 * directions, steps of both currents); after half a second something about the drive changes.
 *
 * The drive is the motor file's, the firmware's model the centre of the design's region. Where a diagnosis made that, the
 * watch has its noise and confidence; else it takes the model for exact, and knows the trials' own noise.
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
    WATCH_CHANGES
} watch_change;

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
    double median_s; /* from the change to the alarm; NAN if none was noted */
    double latest_s;
    double amount;    /* mean of those with the right group, in the sizes of iqfoc/watch.h */
    int since_within; /* of those noted: the change's time is told to 0.1 s */
    int named[IQFOC_WATCH_GROUPS + 1];
} watch_trial;

/* The design's motor runs at its f_pwm_Hz. */
bool watch_trial_run(const tune_result *r, watch_change change, int trials, uint64_t seed, watch_trial *out,
                     error *e);

/*
 * What a recorder holds that the alarm triggers: the rows of the seconds after it as sensors and firmware had
 * them, and the motor as the firmware knows it. The change of a current sensor is phase A's.
 */
typedef struct watch_dump {
    bool noted;     /* within WATCH_CHANGED_S; else there are no rows */
    double alarm_s; /* from the change to the alarm */
    iqfoc_watch_group_t group;
    drive_recording rows; /* freed with recording_free(&rows.recording), also after a failure */
    motor told;
} watch_dump;

/* A firmware that runs elsewhere than in this program. */
typedef struct watch_target {
    void *context;
    /* *calls: its valley and peak. told: whose bases its recorder speaks in. */
    bool (*start)(void *context, const tuned_firmware_config_t *config, const motor *told,
                  drive_firmware *calls, error *e);
    bool (*group)(void *context, iqfoc_watch_group_t *group, error *e);
} watch_target;

/* target: NULL for the firmware of this program. */
bool watch_trial_dump(const tune_result *r, watch_change change, uint64_t seed, double seconds,
                      const watch_target *target, watch_dump *dump, error *e);

/*
 * Cycles without a change, in runs of `cycles`/32 blocks each with a seed of its own: how often the highest
 * detector has passed 1, 2, ... WATCH_LEVELS - 1 in each block of those runs, and the alarms.
 */
enum { WATCH_LEVELS = 24 };

typedef struct watch_clean {
    double cycles;
    long passed[WATCH_LEVELS]; /* upcrossings of level n */
    long alarms;
    double highest;
} watch_clean;

bool watch_clean_run(const tune_result *r, double cycles, uint64_t seed, watch_clean *out, error *e);

#endif
