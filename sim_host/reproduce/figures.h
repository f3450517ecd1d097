/*
 * The papers' figures, drawn from this project's computation, and the page with them and the rows.
 */
#ifndef SIM_HOST_REPRODUCE_FIGURES_H
#define SIM_HOST_REPRODUCE_FIGURES_H

#include "../report/page.h"
#include "rows.h"

/* Each appends its section to the page. */
bool figures_2016(page *p, const comparison *c, error *e);
bool figures_2019(page *p, const comparison *c, error *e);

/* The whole page, DIRECTORY/index.html. */
bool reproduce_page(const char *directory, const comparison *c, bool with_2016, bool with_2019, error *e);

#endif
