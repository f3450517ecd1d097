/* The page's HTML, piece by piece (page.h). */
#include "page.h"

#include "page_assets.h"
#include "svg_inline.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

bool page_begin(page *p, const char *directory, const char *title, const char *subtitle, error *e)
{
    return page_begin_as(p, directory, "index.html", title, subtitle, e);
}

bool page_begin_as(page *p, const char *directory, const char *name, const char *title, const char *subtitle,
                   error *e)
{
    *p = (page){.figures = 0};
    char path[sizeof p->directory + 256];
    if ((size_t)snprintf(p->directory, sizeof p->directory, "%s", directory) >= sizeof p->directory) {
        return error_input(e, directory, 0, 0, "too long a name for a directory");
    }
    if ((size_t)snprintf(path, sizeof path, "%s/%s", directory, name) >= sizeof path) {
        return error_input(e, name, 0, 0, "too long a name for a file");
    }
    if (!out_file_open(&p->file, path, e)) {
        return false;
    }
    FILE *out = p->file.stream;
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n",
          out);
    page_assets_head(out);
    fputs("<title>", out);
    html_text(out, title);
    fputs("</title>\n</head>\n<body>\n<h1>", out);
    html_text(out, title);
    fputs("</h1>\n<p class=\"subtitle\">", out);
    html_text(out, subtitle);
    fputs("</p>\n", out);
    return true;
}

bool page_end(page *p, error *e)
{
    page_assets_end(p->file.stream);
    fputs("</body>\n</html>\n", p->file.stream);
    return out_file_commit(&p->file, e);
}

void page_abandon(page *p)
{
    out_file_abandon(&p->file);
}

bool page_finish(page *p, bool ok, error *e)
{
    if (!ok) {
        page_abandon(p);
    }
    return ok && page_end(p, e);
}

void page_heading(page *p, int level, const char *text)
{
    fprintf(p->file.stream, "<h%d>", level);
    html_text(p->file.stream, text);
    fprintf(p->file.stream, "</h%d>\n", level);
}

void page_markup(page *p, const char *html)
{
    fputs(html, p->file.stream);
}

static void put_formatted(FILE *out, const char *format, va_list args)
{
    char usual[2048];
    va_list again;
    va_copy(again, args);
    const int length = vsnprintf(usual, sizeof usual, format, args);
    char *text = length >= (int)sizeof usual ? malloc((size_t)length + 1) : NULL;
    if (text != NULL) {
        vsnprintf(text, (size_t)length + 1, format, again);
    }
    va_end(again);
    html_text(out, text != NULL ? text : usual);
    free(text);
}

void page_paragraph(page *p, const char *class_name, const char *format, ...)
{
    va_list args;
    if (class_name != NULL) {
        fprintf(p->file.stream, "<p class=\"%s\">", class_name);
    } else {
        fputs("<p>", p->file.stream);
    }
    va_start(args, format);
    put_formatted(p->file.stream, format, args);
    va_end(args);
    fputs("</p>\n", p->file.stream);
}

void page_verdict(page *p, const char *verdict, const char *sentence)
{
    FILE *out = p->file.stream;
    fprintf(out, "<p class=\"lead\"><strong class=\"badge %s\">%s</strong> ", verdict, verdict);
    html_text(out, sentence);
    fputs("</p>\n", out);
}

void page_meters_begin(page *p, const char *title)
{
    fputs("<div class=\"meters\"><p>", p->file.stream);
    html_text(p->file.stream, title);
    fputs("</p><dl>\n", p->file.stream);
}

void page_meter(page *p, const char *name, double value, const char *unit, double full_scale,
                chart_colour colour)
{
    const double share = full_scale > 0.0 ? value / full_scale : 0.0;
    FILE *out = p->file.stream;
    fputs("<dt>", out);
    html_text(out, name);
    fprintf(out, "</dt><dd><i style=\"width:%.1f%%;background:var(--%s)\"></i><b>%.3g%s%s</b></dd>\n",
            60.0 * (share < 1.0 ? share : 1.0), chart_colour_name(colour), value, unit[0] != '\0' ? " " : "",
            unit);
}

void page_details_begin(page *p, const char *summary)
{
    fputs("<details><summary>", p->file.stream);
    html_text(p->file.stream, summary);
    fputs("</summary>\n", p->file.stream);
}

static bool write_side_file(const page *p, const char *id, const char *svg, error *e)
{
    char path[sizeof p->directory + 80];
    out_file f;
    snprintf(path, sizeof path, "%s/%s.svg", p->directory, id);
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    fputs(svg, f.stream);
    return out_file_commit(&f, e);
}

bool page_figure(page *p, plot *drawing, const char *id, const char *caption, error *e)
{
    FILE *out = p->file.stream;
    char prefix[16];
    snprintf(prefix, sizeof prefix, "f%d", ++p->figures);
    fprintf(out, "<figure id=\"%s\">\n", id);
    if (plot_available()) {
        char *svg = plot_draw(drawing, e);
        if (svg == NULL || !write_side_file(p, id, svg, e)) {
            free(svg);
            return false;
        }
        svg_inline(out, svg, prefix, caption);
        free(svg);
    } else {
        plot_abandon(drawing);
        fputs("<p class=\"missing\">These contour lines are left out: gnuplot is not installed.</p>\n", out);
    }
    fputs("<figcaption>", out);
    html_text(out, caption);
    fputs("</figcaption>\n</figure>\n", out);
    return true;
}

/* For readers who cannot see it: "phase current, A against time, s: measured, nominal model". */
static void put_chart_label(FILE *out, const chart *c)
{
    const char *const name = c->y_label != NULL ? c->y_label : c->title != NULL ? c->title : "chart";
    html_text(out, name);
    if (c->x_label != NULL) {
        fputs(" against ", out);
        html_text(out, c->x_label);
    }
    for (size_t n = 0; n < CHART_SERIES && c->series[n].label != NULL; n++) {
        fputs(n == 0 ? ": " : ", ", out);
        html_text(out, c->series[n].label);
    }
}

bool page_charts(page *p, const chart *charts, size_t count, const char *id, const char *caption, error *e)
{
    FILE *out = p->file.stream;
    const bool wide = charts[0].group != NULL;
    fprintf(out, "<figure id=\"%s\" class=\"charts%s\">\n<div class=\"panels%s\">\n", id,
            wide || count > 1 ? " wide" : "", !wide && count > 1 ? " tiled" : "");
    for (size_t n = 0; n < count; n++) {
        fputs("<div class=\"chart\" role=\"group\" aria-label=\"", out);
        put_chart_label(out, &charts[n]);
        fputs("\"></div>\n", out);
    }
    fputs("</div>\n<script type=\"application/json\">\n", out);
    const bool whole = chart_write(out, charts, count);
    fputs("</script>\n<noscript>The curves are drawn by the browser and need "
          "JavaScript.</noscript>\n<figcaption>",
          out);
    html_text(out, caption);
    fputs("</figcaption>\n</figure>\n", out);
    return whole || error_failure(e, 0, "out of memory");
}

bool page_chart(page *p, const chart *drawn, const char *id, const char *caption, error *e)
{
    return page_charts(p, drawn, 1, id, caption, e);
}

void page_term(page *p, const char *term, const char *format, ...)
{
    va_list args;
    fputs("<dt>", p->file.stream);
    html_text(p->file.stream, term);
    fputs("</dt>\n<dd>", p->file.stream);
    va_start(args, format);
    put_formatted(p->file.stream, format, args);
    va_end(args);
    fputs("</dd>\n", p->file.stream);
}

void page_table_begin(page *p, const char *const *heads, size_t columns)
{
    fputs("<div class=\"table\" role=\"region\" aria-label=\"table\" tabindex=\"0\"><table>\n<tr>",
          p->file.stream);
    for (size_t n = 0; n < columns; n++) {
        /* A head that starts with a tab is that of a column of numbers. */
        const bool number = heads[n][0] == '\t';
        fputs(number ? "<th class=\"n\">" : "<th>", p->file.stream);
        html_text(p->file.stream, heads[n] + number);
        fputs("</th>", p->file.stream);
    }
    fputs("</tr>\n", p->file.stream);
}

void page_cell(page *p, bool number, const char *format, ...)
{
    va_list args;
    fputs(number ? "<td class=\"n\">" : "<td>", p->file.stream);
    va_start(args, format);
    put_formatted(p->file.stream, format, args);
    va_end(args);
    fputs("</td>", p->file.stream);
}
