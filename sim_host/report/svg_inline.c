/* gnuplot's SVG with a page's colours and ids (svg_inline.h). */
#include "svg_inline.h"

#include "plot.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* The plot's colours and the names of the page's variables (page_style.h). */
static const struct {
    const char *hex, *variable;
} colours[] = {{PLOT_BLUE, "--blue"},     {PLOT_ORANGE, "--orange"}, {PLOT_GREEN, "--green"},
               {PLOT_PURPLE, "--purple"}, {PLOT_FAINT, "--faint"},   {PLOT_INK, "--ink"},
               {PLOT_GRID, "--grid"},     {PLOT_BAND, "--band"}};

enum { COLOURS = sizeof colours / sizeof colours[0] };

void html_text(FILE *out, const char *text)
{
    static const char special[] = "<>&\"";
    static const char *const escaped[] = {"&lt;", "&gt;", "&amp;", "&quot;"};
    for (; *text != '\0'; text++) {
        const char *at = strchr(special, *text);
        if (at != NULL) {
            fputs(escaped[at - special], out);
        } else {
            fputc(*text, out);
        }
    }
}

/* gnuplot writes rgb(0,114,178), and with blanks rgb(  0, 114, 178). Returns what is behind it, or NULL. */
static const char *put_colour(FILE *out, const char *at)
{
    unsigned long rgb = 0;
    const char *from = at + strlen("rgb(");
    for (int n = 0; n < 3; n++) {
        char *end;
        rgb = rgb << 8 | (strtoul(from, &end, 10) & 0xFF);
        if (*end != (n < 2 ? ',' : ')')) {
            return NULL;
        }
        from = end + 1;
    }
    for (int n = 0; n < COLOURS; n++) {
        if (strtoul(colours[n].hex + 1, NULL, 16) == rgb) {
            fprintf(out, "var(%s)", colours[n].variable);
            return from;
        }
    }
    fprintf(out, "#%06lx", rgb);
    return from;
}

static bool starts(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* The SVG without its first tag, which svg_inline writes itself. */
static void put_body(FILE *out, const char *svg, const char *prefix)
{
    /* The background of a boxed label. */
    static const char box_colour[] = "flood-color='white'";
    static const char *const id_marks[] = {"id='", "id=\"", "href='#", "href=\"#", "url(#"};
    while (*svg != '\0') {
        const char *next = starts(svg, "rgb(") ? put_colour(out, svg) : NULL;
        if (next != NULL) {
            svg = next;
            continue;
        }
        if (starts(svg, box_colour)) {
            fputs("flood-color='var(--paper)'", out);
            svg += strlen(box_colour);
            continue;
        }
        for (size_t n = 0; n < sizeof id_marks / sizeof id_marks[0]; n++) {
            if (starts(svg, id_marks[n])) {
                fprintf(out, "%s%s-", id_marks[n], prefix);
                svg += strlen(id_marks[n]);
                break;
            }
        }
        fputc(*svg++, out);
    }
}

void svg_inline(FILE *out, const char *svg, const char *prefix, const char *label)
{
    const char *box = strstr(svg, "viewBox=\"");
    const char *body = strstr(svg, "<g id=");
    if (box == NULL || body == NULL) {
        return;
    }
    const size_t box_length = strcspn(box + strlen("viewBox=\""), "\"") + strlen("viewBox=\"") + 1;
    fprintf(out,
            "<svg %.*s xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
            "role=\"img\" aria-label=\"",
            (int)box_length, box);
    html_text(out, label);
    fputs("\">\n", out);
    put_body(out, body, prefix);
}
