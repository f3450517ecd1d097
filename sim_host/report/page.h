/*
 * A report page: one HTML file that opens from disk and asks for nothing else, with its charts and the program that
 * draws them in it. Readable on a phone, on a wide screen and on paper, in light and dark. Contour lines are drawn by gnuplot and also
 * written as <id>.svg next to the page. Text functions take plain text and escape it for HTML.
 */
#ifndef SIM_HOST_REPORT_PAGE_H
#define SIM_HOST_REPORT_PAGE_H

#include "../base/error.h"
#include "../base/out_file.h"
#include "chart.h"
#include "plot.h"

typedef struct page {
    out_file file;
    char directory[1024];
    int figures;
} page;

/* Opens DIRECTORY/index.html; the directory exists, and may be a stage (base/out_folder.h). */
bool page_begin(page *p, const char *directory, const char *title, const char *subtitle, error *e);
/* The same as DIRECTORY/NAME. */
bool page_begin_as(page *p, const char *directory, const char *name, const char *title, const char *subtitle,
                   error *e);
/* Closes the page and puts it in place. */
bool page_end(page *p, error *e);
/* Ends the page if all went well, else gives it up. */
bool page_finish(page *p, bool ok, error *e);
/* Gives up; an old file at the path stays. */
void page_abandon(page *p);

/* level 2 ... 4. */
void page_heading(page *p, int level, const char *text);

/* A paragraph of a class of the style sheet's, or of none: NULL. */
void page_paragraph(page *p, const char *class_name, const char *format, ...) ERROR_PRINTF(3, 4);
#define page_text(p, ...) page_paragraph(p, NULL, __VA_ARGS__)
/* In larger type: the main statement of the page. */
#define page_lead(p, ...) page_paragraph(p, "lead", __VA_ARGS__)
/* In smaller type: a remark below a table. */
#define page_note(p, ...) page_paragraph(p, "note", __VA_ARGS__)

/* Writes HTML as it is. */
void page_markup(page *p, const char *html);

/*
 * The first screen: what is written after page_first_begin spans its width; then come two blocks, next to one another
 * in a wide window and below one another in a narrow one.
 */
#define page_first_begin(p)  page_markup(p, "<div class=\"first\">\n")
#define page_first_figure(p) page_markup(p, "<div class=\"proof\">\n")
#define page_first_beside(p) page_markup(p, "</div><div class=\"steps\">\n")
#define page_first_end(p)    page_markup(p, "</div></div>\n")

/* The verdict: its word on a coloured badge (page.css has a colour for each verdict), and a sentence. */
void page_verdict(page *p, const char *verdict, const char *sentence);

/* Horizontal bars on one scale from zero. full_scale: the value of a bar of full length. */
void page_meters_begin(page *p, const char *title);
void page_meter(page *p, const char *name, double value, const char *unit, double full_scale,
                chart_colour colour);
#define page_meters_end(p) page_markup(p, "</dl></div>\n")

/* What follows is hidden until the reader opens it. */
void page_details_begin(page *p, const char *summary);
#define page_details_end(p) page_markup(p, "</details>\n")

/* Two things side by side where the window is wide enough, else one below the other: what is written after
 * page_pair_begin, and what is written after page_pair_beside. */
#define page_pair_begin(p) page_markup(p, "<div class=\"pair\"><div>\n")
/* The same in two columns of equal width, for two figures. */
#define page_twins_begin(p) page_markup(p, "<div class=\"pair twins\"><div>\n")
#define page_pair_beside(p) page_markup(p, "</div><div>\n")
#define page_pair_end(p)    page_markup(p, "</div></div>\n")

/*
 * Draws a plot by gnuplot into the page: what no chart can show, contour lines. id: also the file's name. Without
 * gnuplot a line says so in its place. False when gnuplot fails or the file cannot be written.
 */
bool page_figure(page *p, plot *drawing, const char *id, const char *caption, error *e);

/*
 * A figure of one or some charts: below one another where they are a group, else side by side where there is room.
 * False with *e set when memory ran out for their data.
 */
bool page_charts(page *p, const chart *charts, size_t count, const char *id, const char *caption, error *e);
bool page_chart(page *p, const chart *drawn, const char *id, const char *caption, error *e);

/* Terms, each with what is said of it. */
#define page_terms_begin(p) page_markup(p, "<dl>\n")
void page_term(page *p, const char *term, const char *format, ...) ERROR_PRINTF(3, 4);
#define page_terms_end(p) page_markup(p, "</dl>\n")

/* A table, cell by cell; numbers are aligned right, and so are heads that begin with a tab. */
void page_table_begin(page *p, const char *const *heads, size_t columns);
#define page_row_begin(p) page_markup(p, "<tr>")
void page_cell(page *p, bool number, const char *format, ...) ERROR_PRINTF(3, 4);
#define page_row_end(p)   page_markup(p, "</tr>\n")
#define page_table_end(p) page_markup(p, "</table></div>\n")

#endif
