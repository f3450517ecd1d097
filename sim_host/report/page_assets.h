/*
 * What every page carries that is not its own text: the style sheets, the program that draws its charts (uPlot,
 * numbers.js, page.js), and a policy that lets these run, and nothing else: no other script, no network.
 */
#ifndef SIM_HOST_REPORT_PAGE_ASSETS_H
#define SIM_HOST_REPORT_PAGE_ASSETS_H

#include <stdio.h>

/* For the <head>. */
void page_assets_head(FILE *out);
/* Before </body>. */
void page_assets_end(FILE *out);

#endif
