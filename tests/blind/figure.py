"""What the blind tests found, for the documentation: the confusion matrix as a figure (gnuplot, SVG), and tables."""

import os
import re
import subprocess

import group_score
import score

DOCS = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "docs")


PAGE = "blind_tests.md"
RELEASES = "release-sets.md"


def fill_page(name, text, page=PAGE):
    """Puts a table between <!-- blind: NAME --> and <!-- end --> of a page of docs/."""
    path = os.path.join(DOCS, page)
    with open(path, encoding="utf-8") as file:
        before = file.read()
    block = re.compile(rf"(<!-- blind: {name} -->\n).*?(<!-- end -->)", re.DOTALL)
    if not block.search(before):
        raise ValueError(f"{path} has no block <!-- blind: {name} -->")
    with open(path, "w", encoding="utf-8") as file:
        file.write(block.sub(lambda m: m.group(1) + text + m.group(2), before))


def percent(x):
    return "-" if x is None else f"{100.0 * x:.1f} %"


def rate_rows(s, asked):
    """(what, of how many, share, what is asked, whether recordings or values are counted) of each rate."""
    n = s["recordings"]

    def at_least(name):
        return f">= {100.0 * asked[name]:.0f} %"
    false_causes = None if s["unknown_without_cause"] is None else 1.0 - s["unknown_without_cause"]
    rows = [("single effects named exactly", n["single"], s["single_exact"], at_least("single_exact"), True),
            ("pairs named exactly", n["pair"], s["pair_exact"], at_least("pair_exact"), True)]
    if "triple_exact" in asked:
        rows += [("triples named exactly", n["triple"], s["triple_exact"], at_least("triple_exact"), True)]
    return rows + [
        ("clean recordings with no cause", n["clean"], s["clean_without_cause"], at_least("clean_without_cause"), True),
        ("unknown effects with a false cause", n["unknown"], false_causes,
         f"<= {100.0 * (1.0 - asked['unknown_without_cause']):.0f} %", True),
        ("true parameters inside their 95 % interval", s["parameters_counted"], s["coverage"],
         f"{100.0 * asked['coverage_low']:.0f} to {100.0 * asked['coverage_high']:.0f} %", True),
        ("gain over the oracle's, mean", n["single"] + n["pair"] + n["triple"], s["gain_share"], at_least("gain_share"), False)]


def rates_markdown(s, asked):
    """The rates and the requirements."""
    lines = ["| what | of | measured | asked |", "|---|---|---|---|"]
    lines += [f"| {what} | {count} | {percent(value)} | {want} |" for what, count, value, want, _ in rate_rows(s, asked)]
    second, main = s["by_plant"]["second"], s["by_plant"]["main"]
    lines += ["", f"{second} of the recordings are by the second plant, {main} by the project's own."]
    return "\n".join(lines) + "\n"


def span_of(hits, count):
    low, high = score.confidence(hits, count)
    return f"{100.0 * low:.1f} to {100.0 * high:.1f} %"


# What of a group is asked (group_score.ASKED), in words: of its outcomes the first, and the rate that is asked of it.
GROUP_ROWS = [("bench", "right", "benches: the larger causes named with their values, no false name", ">= 80 %"),
              ("bench_half", "right", "benches with smaller effects: the same", ">= 90 %"),
              ("bench", "false", "benches: a false cause", "-"),
              ("steady", "false", "one speed: a false cause", "<= 1 %"),
              ("steady", "right", "one speed: the cause, or that it cannot be separated", "-"),
              ("outside", "false", "effects outside the catalogue on benches: a false cause", "<= 1 %")]


def group_rows(of_groups):
    """Lines of a release set's table about the groups that were drawn."""
    lines = []
    for group, outcome, what, want in GROUP_ROWS:
        rows = of_groups.get(group, [])
        hits = sum(r["outcome"] == outcome for r in rows)
        if rows:
            lines.append(f"| {what} | {len(rows)} | {percent(hits / len(rows))} | {span_of(hits, len(rows))} | {want} |")
    rows = of_groups.get("bench", [])
    if rows:
        s = group_score.summary(rows)
        hits, count = (sum(pair[k] for pair in s["intervals"].values()) for k in (0, 1))
        if count:
            lines.append(f"| benches: true values inside their 95 % interval | {count} | {percent(hits / count)} | {span_of(hits, count)} "
                         "| 93 to 97 % |")
        if s["open_loop_share"]["mean"] is not None:
            lines.append(f"| benches: open-loop error reduction, share of the oracle's, mean | {len(rows)} "
                         f"| {percent(s['open_loop_share']['mean'])} | - | >= {100.0 * group_score.OPEN_LOOP:.0f} % |")
    return lines


def reliability_markdown(results):
    """The printed probabilities against the share of named causes that the drive has."""
    lines = ["| probability | causes named | mean probability | share that is right | 95 % confidence | the mean lies inside |",
             "|---|---:|---:|---:|---:|---|"]
    for low, high, count, said, real in group_score.reliability(results):
        hits = round(count * real)
        least, most = score.confidence(hits, count)
        lines.append(f"| {low} to {high} | {count} | {percent(said)} | {percent(real)} | {span_of(hits, count)} "
                     f"| {'yes' if least <= said <= most else 'no'} |")
    return "\n".join(lines) + "\n"


def release_markdown(number, commit, s, failed, of_groups, results):
    """A release set's figures as they fell, each rate with its 95 % confidence interval."""
    lines = [f"Release set {number}, commit {commit}:", "", "| what | of | measured | 95 % confidence | asked |", "|---|---|---|---|---|"]
    for what, count, value, want, is_rate in rate_rows(s, score.RELEASE_THRESHOLDS):
        span = span_of(round(value * count), count) if is_rate and count else "-"
        lines.append(f"| {what} | {count} | {percent(value)} | {span} | {want} |")
    lines.append(f"| recordings that the diagnosis refused | {sum(s['recordings'].values()) + failed} | {failed} | - | 0 |")
    lines += group_rows(of_groups)
    median, most, slowest = s["seconds"]["clock_s"]
    lines.append(f"| seconds a diagnosis: median, 95 %, slowest | {sum(s['recordings'].values())} | {median}, {most}, {slowest} "
                 "| - | median <= 1, slowest <= 5 |")
    return "\n".join(lines) + "\n\n" + reliability_markdown(results)


OUTCOMES = {"right": "right", "partly": "partly right", "held back": "the right causes are candidates, none is named",
            "missed": "missed", "false": "a false cause"}


def group_markdown(results, commit):
    """What became of a group's recordings, each rate with its 95 % confidence interval."""
    s, seeds = group_score.summary(results), [r["seed"] for r in results]

    def rate(what, hits, count):
        low, high = score.confidence(hits, count) if count else (0.0, 1.0)
        return f"| {what} | {hits} of {count} | {100.0 * low:.0f} to {100.0 * high:.0f} % |"
    lines = [f"{len(results)} recordings of `{results[0]['group']}`, seeds {min(seeds)} to {max(seeds)}, commit {commit}:", "",
             "| what | measured | 95 % confidence |", "|---|---|---|"]
    lines += [rate(words, s["outcomes"][outcome], len(results)) for outcome, words in OUTCOMES.items() if s["outcomes"][outcome]]
    inside, values = (sum(pair[k] for pair in s["intervals"].values()) for k in (0, 1))
    said = [real for low, _, count, _, mean in s["reliability"] if low >= 0.99 for real in [(count, round(count * mean))]]
    lines += [rate("true values inside their 95 % interval", inside, values)] if values else []
    lines += [rate("named with a probability of 0.99 or more: the drive has it", sum(hits for _, hits in said),
                   sum(count for count, _ in said))] if said else []
    if s["open_loop_share"]["median"] is not None:
        lines += [f"| open-loop error reduction, share of the oracle's, median | {s['open_loop_share']['median']:.2f} | - |"]
    return "\n".join(lines) + "\n"


def release_block():
    with open(os.path.join(DOCS, RELEASES), encoding="utf-8") as file:
        found = re.search(r"<!-- blind: releases -->\n(.*?)<!-- end -->", file.read(), re.DOTALL)
    if not found:
        raise ValueError(f"docs/{RELEASES} has no block <!-- blind: releases -->")
    return found.group(1)


def is_published(number):
    return f"Release set {number}, commit " in release_block()


def publish(number, commit, s, failed, of_groups, results):
    """Adds a release set below those on the page: none is ever removed."""
    before = release_block()
    between = "\n" if before.startswith("Release set") else ""
    fill_page("releases", (before + between if between else "") + release_markdown(number, commit, s, failed, of_groups, results), RELEASES)


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
     $labels using 1:2:(sprintf("%d", $3)):($3 > 60 ? 0xffffff : 0x000000) with labels tc rgb variable \\
     font ",11" notitle
"""
    subprocess.run(["gnuplot", "-"], input=script, text=True, check=True)
