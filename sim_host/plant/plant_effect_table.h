/*
 * The effects as data: ids, keys with units, their members in the configuration, and typical sizes. Only plant_effect.c includes it;
 * other files use plant_effect.h.
 */
#ifndef SIM_HOST_PLANT_PLANT_EFFECT_TABLE_H
#define SIM_HOST_PLANT_PLANT_EFFECT_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#define EFFECT_KEYS_MAX 16

/* The quantity that a typical value is a multiple of. */
typedef enum relative_to {
    ABSOLUTE,
    OF_ITSELF, /* of the present value */
    OF_RATED,  /* rated peak current */
    OF_CYCLE,
    OF_LINK,
    OF_MAGNET,
    OF_RESISTANCE,
    OF_INDUCTANCE,
    OF_MAP_THIRD, /* mean inductance over the rated peak current, */
    OF_MAP_FOURTH /* and over its square */
} relative_to;

typedef enum key_kind { KEY_REAL, KEY_WHOLE, KEY_FLAG, KEY_BOTH_INDUCTANCES, KEY_MEAN_INDUCTANCE } key_kind;

typedef struct effect_key {
    const char *name;
    const char *unit;
    key_kind kind;
    size_t offset; /* into plant_config */
    double typical;
    relative_to of;
    bool needed; /* there is no such effect while this is 0: the typical value unless given */
} effect_key;

typedef struct effect {
    const char *id;
    const char *does;
    effect_key key[EFFECT_KEYS_MAX]; /* the first without a name ends them */
} effect;

extern const effect effect_table[];
extern const int effect_table_length;

#endif
