/* The page of both papers (figures.h). */
#include "figures.h"

bool reproduce_page(const char *directory, const comparison *c, bool with_2016, bool with_2019, error *e)
{
    page p;
    if (!page_begin(&p, directory, "Both papers, reproduced",
                    "The tables and figures of L. Jarzebowicz 2016 and 2019 with this project's values: the "
                    "formula in double precision on the simulated drive, and the firmware's "
                    "IQ24 functions.",
                    e)) {
        return false;
    }
    const bool ok = (!with_2016 || figures_2016(&p, c, e)) && (!with_2019 || figures_2019(&p, c, e));
    return page_finish(&p, ok, e);
}
