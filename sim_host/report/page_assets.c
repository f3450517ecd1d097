/* The embedded files (cmake/iqfoc-embed.cmake) as parts of a page (page_assets.h). */
#include "page_assets.h"

#include "../base/base64.h"
#include "../base/sha256.h"

#include <string.h>

extern const unsigned char asset_uplot_js[], asset_uplot_css[], asset_uplot_licence[];
extern const unsigned char asset_numbers_js[], asset_page_js[], asset_page_css[];

static const char *text_of(const unsigned char *asset)
{
    return (const char *)asset;
}

/* A policy names a script by the hash of the text between its tags. */
static void put_hash(FILE *out, const char *script)
{
    unsigned char digest[SHA256_BYTES];
    sha256 s = sha256_begin();
    base64 b = {.out = out};
    sha256_add(&s, script, strlen(script));
    sha256_end(&s, digest);
    fputs(" 'sha256-", out);
    base64_add(&b, digest, sizeof digest);
    base64_end(&b);
    fputs("'", out);
}

void page_assets_head(FILE *out)
{
    fputs("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
          "'unsafe-inline'; script-src",
          out);
    put_hash(out, text_of(asset_uplot_js));
    put_hash(out, text_of(asset_numbers_js));
    put_hash(out, text_of(asset_page_js));
    fprintf(out, "\">\n<style>\n%s\n%s</style>\n", text_of(asset_uplot_css), text_of(asset_page_css));
}

void page_assets_end(FILE *out)
{
    fprintf(out, "<!-- uPlot:\n%s-->\n<script>%s</script>\n<script>%s</script>\n<script>%s</script>\n",
            text_of(asset_uplot_licence), text_of(asset_uplot_js), text_of(asset_numbers_js),
            text_of(asset_page_js));
}
