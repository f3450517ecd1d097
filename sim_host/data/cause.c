#include "cause.h"

const cause_row cause_table[EXT_COUNT] = {
#define CAUSE(ID, id, firmware, words, law, noun) [EXT_##ID] = {id, true, firmware, words, law, noun},
#define UNNAMED(ID, id, words)                    [EXT_##ID] = {id, false, FIRMWARE_LACKS, words, "", ""},
#include "causes.def"
};
