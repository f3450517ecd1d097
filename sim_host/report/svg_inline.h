/*
 * Fits gnuplot's SVG into a page: the fixed colours become the page's variables, so that light and dark have
 * their own, and ids get a prefix, so that two figures do not share one.
 */
#ifndef SIM_HOST_REPORT_SVG_INLINE_H
#define SIM_HOST_REPORT_SVG_INLINE_H

#include <stdio.h>

/* Writes the <svg> element. prefix: letters and digits. label: for those who cannot see it; plain text. */
void svg_inline(FILE *out, const char *svg, const char *prefix, const char *label);

/* Text as HTML: <, >, & and quotes escaped. */
void html_text(FILE *out, const char *text);

#endif
