/*
 * The style sheet of a report page. Colours are variables, twice: light, and dark for those who prefer it.
 */
#ifndef SIM_HOST_REPORT_PAGE_STYLE_H
#define SIM_HOST_REPORT_PAGE_STYLE_H

static const char page_style[] =
    ":root{color-scheme:light "
    "dark;--paper:#fff;--ink:#333;--soft:#666;--rule:#ddd;--grid:#e3e3e3;--faint:#8c8c8c;"
    "--blue:#0072b2;--orange:#d55e00;--green:#009e73;--purple:#aa4499;--band:#f6d9c4}\n"
    "@media(prefers-color-scheme:dark){:root{--paper:#16181b;--ink:#d9d9d9;--soft:#9aa0a6;--rule:#3a3d41;"
    "--grid:#2c2f33;--faint:#85898e;--blue:#5ab4ec;--orange:#ff8f4a;--green:#3ccf9e;--purple:#e08ad2;"
    "--band:#4a3323}}\n"
    "*{box-sizing:border-box}\n"
    "body{margin:0 auto;max-width:78rem;padding:1.5rem 1rem 4rem;background:var(--paper);color:var(--ink);"
    "font:16px/1.5 system-ui,sans-serif}\n"
    "h1{font-size:1.7rem;line-height:1.2;margin:.5rem 0 .2rem}\n"
    "h2{font-size:1.35rem;margin:3rem 0 .5rem;padding-top:1rem;border-top:1px solid var(--rule)}\n"
    "h3{font-size:1.1rem;margin:2.2rem 0 .4rem}h4{font-size:1rem;margin:1.5rem 0 .3rem}\n"
    ".subtitle{color:var(--soft);margin:0 0 1.5rem}p{max-width:46rem;margin:.5rem 0}\n"
    "figure{margin:.8rem 0;min-width:0;max-width:46rem}figure svg{display:block;width:100%;height:auto}\n"
    "figcaption{color:var(--soft);font-size:.9rem;margin-top:.3rem;max-width:46rem}\n"
    ".pair{display:grid;grid-template-columns:minmax(0,1fr);gap:.5rem 2rem;align-items:start}\n"
    "@media(min-width:62rem){.pair{grid-template-columns:minmax(0,11fr) minmax(0,9fr)}"
    ".twins{grid-template-columns:minmax(0,1fr) minmax(0,1fr)}}\n"
    ".table{overflow-x:auto;margin:.8rem 0}\n"
    "table{border-collapse:collapse;font-size:.87rem;font-variant-numeric:tabular-nums}\n"
    "th,td{padding:.2rem .5rem .2rem 0;text-align:left;vertical-align:top}\n"
    "th{font-weight:600;border-bottom:1px solid var(--ink)}td{border-bottom:1px solid var(--rule)}\n"
    "td:first-child{min-width:8.8rem}td:nth-child(2){white-space:nowrap}\n"
    ".n{text-align:right;white-space:nowrap}\n"
    ".lead{font-size:1.25rem;line-height:1.4;max-width:52rem}\n"
    ".note{color:var(--soft);font-size:.85rem;margin:.25rem 0}\n"
    ".missing{color:var(--soft);border:1px dashed var(--rule);padding:2rem;text-align:center}\n";

#endif
