/* Maps of foreign logs: an accepted map that is printed and read again prints the same. */
#include "fuzz.h"
#include "import/map.h"

#include <stdlib.h>
#include <string.h>

static char *printed(const import_map *m, size_t *length)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, length);
    fuzz_expect(out != NULL, "the fuzzer itself: a stream into memory");
    map_print(out, m);
    fclose(out);
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    error e = {0};
    import_map m;
    if (!map_read(fuzz_file(data, size), &m, &e)) {
        fuzz_expect_refusal(&e);
        return 0;
    }
    size_t length;
    size_t length_again;
    char *text = printed(&m, &length);
    fuzz_expect(map_read(fuzz_file((const uint8_t *)text, length), &m, &e),
                "a map that was printed can be read");
    char *again = printed(&m, &length_again);
    fuzz_expect(strcmp(text, again) == 0, "a map that was printed reads as it was");
    free(again);
    free(text);
    return 0;
}
