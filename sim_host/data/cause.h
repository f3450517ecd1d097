/*
 * The causes of docs/interfaces.md and the unnamed effects that compete with them: id, words, firmware correction. causes.def has the rows.
 */
#ifndef SIM_HOST_DATA_CAUSE_H
#define SIM_HOST_DATA_CAUSE_H

#include <stdbool.h>

typedef enum cause_id {
#define CAUSE(ID, ...)      CAUSE_##ID,
#define CAUSE_MORE(ID, ...) CAUSE_##ID,
#define UNNAMED(ID, ...)    CAUSE_##ID,
#include "causes.def"
    CAUSE_COUNT
} cause_id;

/* The correction that the library has for a cause. */
typedef enum cause_firmware {
    FIRMWARE_HOLDS,          /* parameters or corrections that hold its values */
    FIRMWARE_KEEPS_COMMANDS, /* none; a firmware that stores its last commands predicts correctly */
    FIRMWARE_LACKS
} cause_firmware;

typedef struct cause_row {
    const char *id; /* of interfaces.md, or a description of an effect that is not named */
    bool named;
    cause_firmware firmware;
    const char *words; /* for people */
    const char *law;   /* for the list of the plant's effects */
    const char *noun;  /* the effect as a noun: "a dead time" */
    cause_id of;       /* itself, or the cause of the same id that it is a further entry of */
} cause_row;

extern const cause_row cause_table[CAUSE_COUNT];

/* The row of that id, NULL if there is none. */
const cause_row *cause_find(const char *id);

/* A few sentences on each, for the glossary; NULL for an unnamed effect. */
extern const char *const cause_meaning[CAUSE_COUNT];

#endif
