/* Rows of the comparison as a table of the report page. */
#ifndef SIM_HOST_REPRODUCE_ROWS_PAGE_H
#define SIM_HOST_REPRODUCE_ROWS_PAGE_H

#include "../report/page.h"
#include "rows.h"

/* The rows of one item; with a `part`, those whose condition or quantity contains it. Notes stand below. */
void rows_page_table(page *p, const comparison *c, const char *paper, const char *item, const char *part);

#endif
