/* Rows of the comparison as a table of the report page. */
#ifndef SIM_HOST_REPRODUCE_ROWS_PAGE_H
#define SIM_HOST_REPRODUCE_ROWS_PAGE_H

#include "../report/page.h"
#include "rows.h"

/* A figure, and next to it the rows of one item. */
bool rows_page_figure(page *p, plot *drawing, const char *id, const char *caption, const comparison *c,
                      const char *paper, const char *item, const char *part, error *e);

/* The same of charts. */
bool rows_page_charts(page *p, const chart *charts, size_t count, const char *id, const char *caption,
                      const comparison *c, const char *paper, const char *item, const char *part, error *e);

/* The rows of one item; with a `part`, those whose condition or quantity contains it. Notes are below the table. */
void rows_page_table(page *p, const comparison *c, const char *paper, const char *item, const char *part);

#endif
