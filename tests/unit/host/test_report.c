/*
 * Report pages: what is special to HTML, colours and ids of inlined plots, and a whole page.
 */
/* POSIX: mkdtemp, open_memstream. */
#define _POSIX_C_SOURCE 200809L

#include "base/confine.h"
#include "report/page.h"
#include "report/svg_inline.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char *text;
static size_t size;

void setUp(void)
{
    text = NULL;
}

void tearDown(void)
{
    free(text);
}

static void test_text_is_escaped(void)
{
    FILE *out = open_memstream(&text, &size);
    html_text(out, "a < b & \"c\" > d");
    fclose(out);
    TEST_ASSERT_EQUAL_STRING("a &lt; b &amp; &quot;c&quot; &gt; d", text);
}

static void test_colours_become_variables_and_ids_get_a_prefix(void)
{
    static const char svg[] =
        "<?xml?><svg viewBox=\"0 0 6 4\"><g id=\"canvas\"><path stroke='rgb(  0, 114, 178)'/>"
        "<path stroke='rgb(1,2,3)'/><use xlink:href='#gpPt5'/></g></svg>";
    FILE *out = open_memstream(&text, &size);
    svg_inline(out, svg, "f1", "a \"b\"");
    fclose(out);
    TEST_ASSERT_NOT_NULL(strstr(text, "<svg viewBox=\"0 0 6 4\" "));
    TEST_ASSERT_NOT_NULL(strstr(text, "aria-label=\"a &quot;b&quot;\""));
    TEST_ASSERT_NOT_NULL(strstr(text, "<g id=\"f1-canvas\">"));
    TEST_ASSERT_NOT_NULL(strstr(text, "stroke='var(--blue)'"));
    TEST_ASSERT_NOT_NULL(strstr(text, "stroke='#010203'"));
    TEST_ASSERT_NOT_NULL(strstr(text, "xlink:href='#f1-gpPt5'"));
}

static void test_cut_off_colour_is_passed_on(void)
{
    static const char svg[] = "<svg viewBox=\"0 0 6 4\"><g id=\"a\">rgb(1,2";
    FILE *out = open_memstream(&text, &size);
    svg_inline(out, svg, "f1", "");
    fclose(out);
    TEST_ASSERT_NOT_NULL(strstr(text, "rgb(1,2"));
}

static char *read_file(const char *path)
{
    static char content[400000];
    FILE *f = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(f, path);
    content[fread(content, 1, sizeof content - 1, f)] = '\0';
    fclose(f);
    return content;
}

static void test_page_holds_its_figure(void)
{
    char directory[] = "/tmp/iqfoc-report-XXXXXX";
    char path[64];
    page p;
    plot drawing;
    error e = {0};
    TEST_ASSERT_NOT_NULL(mkdtemp(directory));
    TEST_ASSERT_TRUE_MESSAGE(page_begin(&p, directory, "T < U", "sub", &e), e.text);
    TEST_ASSERT_TRUE(plot_begin(&drawing, 300, 200, &e));
    plot_say(&drawing, "plot x with lines linestyle 1 notitle\n");
    TEST_ASSERT_TRUE_MESSAGE(page_figure(&p, &drawing, "line", "A line.", &e), e.text);
    const bool drawn = plot_available();
    TEST_ASSERT_TRUE_MESSAGE(page_end(&p, &e), e.text);

    snprintf(path, sizeof path, "%s/index.html", directory);
    const char *html = read_file(path);
    TEST_ASSERT_NOT_NULL(strstr(html, "<h1>T &lt; U</h1>"));
    TEST_ASSERT_NOT_NULL(strstr(html, "<figcaption>A line.</figcaption>"));
    TEST_ASSERT_NOT_NULL(strstr(html, drawn ? "var(--blue)" : "gnuplot is not installed"));
    unlink(path);
    snprintf(path, sizeof path, "%s/line.svg", directory);
    TEST_ASSERT_EQUAL_INT(drawn ? 0 : -1, unlink(path));
    TEST_ASSERT_EQUAL_INT(0, rmdir(directory));
}

/* gnuplot looks at whose rights it has before it begins, and a filter that is too narrow would end it there. */
static void test_gnuplot_answers_a_confined_process(void)
{
    if (!plot_available()) {
        TEST_IGNORE_MESSAGE("gnuplot is not installed");
    }
    const pid_t child = fork();
    if (child == 0) {
        confine(CONFINE_MAY_START);
        _exit(plot_available() ? 0 : 1);
    }
    int status = 0;
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE(WIFEXITED(status));
    TEST_ASSERT_EQUAL_INT(0, WEXITSTATUS(status));
}

static void test_gnuplot_that_fails_is_an_error(void)
{
    plot drawing;
    error e = {0};
    if (!plot_available()) {
        TEST_IGNORE_MESSAGE("gnuplot is not installed");
    }
    TEST_ASSERT_TRUE(plot_begin(&drawing, 300, 200, &e));
    plot_say(&drawing, "exit status 3\n");
    TEST_ASSERT_NULL(plot_draw(&drawing, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_FAILED, e.status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_text_is_escaped);
    RUN_TEST(test_colours_become_variables_and_ids_get_a_prefix);
    RUN_TEST(test_cut_off_colour_is_passed_on);
    RUN_TEST(test_page_holds_its_figure);
    RUN_TEST(test_gnuplot_answers_a_confined_process);
    RUN_TEST(test_gnuplot_that_fails_is_an_error);
    return UNITY_END();
}
