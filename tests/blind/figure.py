"""The confusion matrix as a figure (gnuplot, SVG) and as a Markdown table."""

import subprocess

import score


def markdown(results):
    order, names, matrix, counts = score.confusion(results)
    lines = ["| hidden \\ named | n | " + " | ".join(name.replace("_", " ") for name in names) + " |",
             "|---|" + "---|" * (len(names) + 1)]
    for row, values, count in zip(order, matrix, counts):
        cells = " | ".join("" if v == 0.0 else f"{100.0 * v:.0f}" for v in values)
        lines.append(f"| {row.replace('_', ' ')} | {count} | {cells} |")
    lines += ["", "Pairs, per cause:", "", "| cause | hidden | found | named but not hidden |", "|---|---|---|---|"]
    lines += [f"| {c.replace('_', ' ')} | {a} | {b} | {f} |" for c, (a, b, f) in score.pair_table(results).items()]
    return "\n".join(lines) + "\n"


def write_svg(results, path):
    order, names, matrix, counts = score.confusion(results)
    cells = "\n".join(f"{x} {y} {100.0 * v:.1f}" for y, row in enumerate(matrix) for x, v in enumerate(row))
    labels = "\n".join(f"{x} {y} {100.0 * v:.0f}" for y, row in enumerate(matrix) for x, v in enumerate(row) if v > 0.0)
    x_tics = ", ".join(f'"{n.replace("_", " ")}" {k}' for k, n in enumerate(names))
    y_tics = ", ".join(f'"{n.replace("_", " ")} ({c})" {k}' for k, (n, c) in enumerate(zip(order, counts)))
    script = f"""set terminal svg size 900,760 dynamic font "sans-serif,13" background "white"
set output "{path}"
$cells << EOD
{cells}
EOD
$labels << EOD
{labels}
EOD
set title "Share of recordings (percent) in which a cause is named, by what is hidden"
set xlabel "named by the diagnosis"
set ylabel "hidden in the recording (number of recordings)"
set xtics rotate by 50 right ({x_tics})
set ytics ({y_tics})
set xrange [-0.5:{len(names) - 0.5}]
set yrange [{len(order) - 0.5}:-0.5]
set palette defined (0 "#ffffff", 1 "#c6dbef", 50 "#6baed6", 100 "#08519c")
set cbrange [0:100]
unset colorbox
set tics scale 0
plot $cells using 1:2:3 with image pixels notitle, \\
     $labels using 1:2:(sprintf("%d", $3)):($3 > 60 ? 0xffffff : 0x000000) with labels tc rgb variable font ",11" notitle
"""
    subprocess.run(["gnuplot", "-"], input=script, text=True, check=True)
