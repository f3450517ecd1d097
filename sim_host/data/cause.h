/*
 * The causes of interfaces.md, and the effects without a name that compete with them: what every room of the host
 * may know of one. The rows stand in causes.def.
 */
#ifndef SIM_HOST_DATA_CAUSE_H
#define SIM_HOST_DATA_CAUSE_H

#include <stdbool.h>

typedef enum cause_id {
#define CAUSE(ID, ...)   CAUSE_##ID,
#define UNNAMED(ID, ...) CAUSE_##ID,
#include "causes.def"
    CAUSE_COUNT
} cause_id;

/* What the library has against a cause. */
typedef enum cause_firmware {
    FIRMWARE_HOLDS,          /* parameters or corrections that hold its values */
    FIRMWARE_KEEPS_COMMANDS, /* nothing, but a firmware that keeps its last commands predicts right */
    FIRMWARE_LACKS
} cause_firmware;

typedef struct cause_row {
    const char *id; /* of interfaces.md, or a description of an effect that is not named */
    bool named;
    cause_firmware firmware;
    const char *words; /* for people */
    const char *law;   /* for the list of the plant's effects */
    const char *noun;  /* what a plant with it has: "a dead time" */
} cause_row;

extern const cause_row cause_table[CAUSE_COUNT];

/* The row of that id, NULL if there is none. */
const cause_row *cause_find(const char *id);

/* Some sentences on each, for a glossary; NULL where it has no name. */
extern const char *const cause_meaning[CAUSE_COUNT];

#endif
