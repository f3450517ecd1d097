"""A chart of a report page (sim_host/report/chart.h) as an SVG picture by gnuplot, for documents, which cannot run a script."""

import base64
import html.parser
import json
import math
import struct
import subprocess

COLOURS = {"blue": "#0072b2", "orange": "#d55e00", "green": "#009e73", "purple": "#aa4499", "faint": "#8c8c8c"}
INK, GRID = "#333333", "#e3e3e3"
WITH = {"line": "lines", "points": "points", "linepoints": "linespoints", "steps": "steps"}
WIDTH = 720


class Figure(html.parser.HTMLParser):
    """The content of the script of the figure of that id, and its caption's length."""

    def __init__(self, name):
        super().__init__()
        self.name, self.inside, self.script, self.text = name, False, False, None

    def handle_starttag(self, tag, attrs):
        if tag == "figure":
            self.inside = dict(attrs).get("id") == self.name
        self.script = tag == "script" and self.inside

    def handle_data(self, data):
        if self.script:
            self.text = (self.text or "") + data

    def handle_endtag(self, tag):
        self.script = False
        if tag == "figure":
            self.inside = False


def figure(page, name):
    """The charts of a page's figure with their numbers, or None."""
    parser = Figure(name)
    parser.feed(page)
    if parser.text is None:
        return None
    told = json.loads(parser.text)
    told["columns"] = [numbers(column) for column in told["columns"]]
    return told


def numbers(column):
    """As sim_host/report/chart_column.h describes them."""
    if "pieces" in column:
        return [first + n * step for first, step, count in column["pieces"] for n in range(count)]
    kind, size = {"f8": ("d", 8), "f4": ("f", 4), "i2": ("h", 2)}[next(k for k in ("f8", "f4", "i2") if k in column)]
    raw = base64.b64decode(column[{"d": "f8", "f": "f4", "h": "i2"}[kind]])
    values = struct.unpack(f"<{len(raw) // size}{kind}", raw)
    if kind == "h":
        return [math.nan if n == -32768 else column["middle"] + n * column["step"] for n in values]
    return list(values)


def quoted(text):
    """For gnuplot, which knows \\n between double quotes only."""
    if "\n" in text:
        return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
    return "'" + text.replace("'", "''") + "'"


def axis_lines(chart, key):
    axis = chart[key]
    lines = [f"set {key}label {quoted(axis['label'])} noenhanced" if axis.get("label") else f"unset {key}label",
             f"set logscale {key}" if axis["log"] else f"unset logscale {key}", f"set {key}tics autofreq"]
    if axis["log"] and key == "x":
        lines.append("set xtics (" + ", ".join(f"{m * 10.0 ** k:g}" for k in range(-3, 6) for m in (1, 2, 5)) + ")")
    low, high = chart.get("view", axis.get("range", (None, None))) if key == "x" else axis.get("range", (None, None))
    if low is not None:
        lines.append(f"set {key}range [{low:.7g}:{high:.7g}]")
    elif axis.get("least"):
        lines.append(f"set {key}range [*<{-axis['least']:.3g}:{axis['least']:.3g}<*]")
    else:
        lines.append(f"set {key}range [*:*]" + (" noextend" if key == "x" else ""))
    if key == "x" and chart.get("names"):
        places = ", ".join(f"{quoted(name)} {n}" for n, name in enumerate(chart["names"]))
        lines += [f"set xrange [-0.6:{len(chart['names']) - 0.4}]", f"set xtics ({places})"]
    return lines


def chart_lines(chart, columns, number):
    """The data of a chart as gnuplot's blocks, and the command that draws it."""
    lines, curves = [], []
    bars = [series for series in chart["series"] if series["mark"] == "bars"]
    low, high = chart.get("view", (-math.inf, math.inf))
    for n, series in enumerate(chart["series"]):
        x, y = columns[series["x"]], columns[series["y"]]
        step = x[1] - x[0] if len(x) > 1 else 0.0
        shift = (bars.index(series) - 0.5 * (len(bars) - 1)) * 0.38 if series in bars else 0.0
        lines.append(f"$chart{number}_{n} << END_OF_DATA")
        lines += [f"{a + shift:.7g} {b:.6g}" if math.isfinite(b) else "" for a, b in zip(x, y)
                  if low - step <= a <= high + step]
        lines.append("END_OF_DATA")
        dash = " dashtype 2" if series["dashed"] else ""
        dots = " pointtype 7 pointsize 0.55" if "points" in series["mark"] else ""
        style = "boxes fill solid 0.85 noborder" if series in bars else WITH[series["mark"]]
        curves.append(f"$chart{number}_{n} using 1:2 with {style} linecolor rgb {quoted(COLOURS[series['colour']])}"
                      f" linewidth {series['width'] or 1.8:g}{dash}{dots} title {quoted(series['label'])} noenhanced")
    lines += axis_lines(chart, "x") + axis_lines(chart, "y")
    lines += [f"set title {quoted(chart.get('title', ''))} noenhanced offset 0,-0.4", "set boxwidth 0.34", "plot " + ", ".join(curves)]
    return lines


def svg(told):
    """The picture of a figure, as text."""
    charts = told["charts"]
    stacked = len(charts) == 1 or charts[0].get("group")
    columns = 1 if stacked else 2
    rows = -(-len(charts) // columns)
    height = sum(chart["height"] or 290 for chart in charts) * 1.2 if stacked else 330 * rows
    script = [f"set terminal svg size {WIDTH},{height:.0f} dynamic enhanced font 'sans-serif,12' linewidth 1 butt", "set encoding utf8",
              f"set border 3 linecolor rgb '{INK}' linewidth 0.8", f"set tics nomirror out scale 0.6 textcolor rgb '{INK}'",
              f"set grid linetype 1 linecolor rgb '{GRID}' linewidth 0.8 dashtype solid", "set xtics offset 0,0.4",
              f"set key textcolor rgb '{INK}' Left reverse samplen 1.6 spacing 1.1 above maxrows 2", "set minussign",
              f"set xlabel offset 0,0.8 textcolor rgb '{INK}'", f"set ylabel offset 0.6,0 textcolor rgb '{INK}'",
              f"set multiplot layout {rows},{columns}"]
    if stacked:
        script.append("set lmargin 9\nset rmargin 2")
    # Side by side the same curves are named once, in the first chart.
    alike = not stacked and len({tuple(series["label"] for series in chart["series"]) for chart in charts}) == 1
    if alike:
        script.append("set key inside vertical maxrows 8 right top" if any(chart["y"]["log"] for chart in charts) else
                      "set key inside vertical maxrows 8 left top")
    for number, chart in enumerate(charts):
        script += chart_lines(chart, told["columns"], number)
        if alike:
            script.append("unset key")
    script.append("unset multiplot\n")
    done = subprocess.run(["gnuplot", "-"], input="\n".join(script), text=True, capture_output=True, check=False,
                          env={"LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"})
    if done.returncode or "</svg>" not in done.stdout:
        raise ValueError("gnuplot drew nothing: " + done.stderr.strip()[-300:])
    return done.stdout
