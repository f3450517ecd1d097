/* What a report page does in the reader's browser: draws its charts by uPlot, zooms into them, shows and hides curves. */
"use strict";
(() => {
    const root = document.documentElement;
    const panels = []; // every chart of the page: {box, chart, tables, plot, shown, view, full}
    const hidden = new Set(); // the roles that are switched off
    const PRINT_WIDTH = 640;
    const USUAL_HEIGHT = 290;
    let printing = false;

    const {columnOf, seenOf, tablesOf} = iqfocNumbers;

    /* ---- A chart ---- */

    const colour = (name) => getComputedStyle(root).getPropertyValue("--" + name).trim();
    const short = (value) => (value == null ? "–" : String(Number(value.toPrecision(5))).replace("-", "−"));
    const nameOf = (chart, value) => (value == null ? "–" : (chart.names[Math.round(value)] || "").replace("\n", ", "));

    const marks = {
        line: () => ({points: {}}),
        points: () => ({paths: () => null, points: {show: true}}),
        linepoints: () => ({points: {show: true, size: 5}}),
        steps: () => ({paths: uPlot.paths.stepped({align: 1}), points: {show: false}}),
        bars: (side) => ({paths: uPlot.paths.bars({size: [0.38, 40], align: side}), points: {show: false}}),
    };

    function curveOf(p, s, n) {
        const {chart} = p;
        const bars = chart.series.filter((other) => other.mark === "bars");
        const side = bars.length < 2 ? 0 : bars.indexOf(s) === 0 ? -1 : 1;
        const paint = colour(s.colour);
        const curve = {
            label: s.label,
            stroke: paint,
            width: s.width || 1.6,
            dash: s.dashed ? [6, 4] : undefined,
            show: p.shown ? p.shown[n] : !hidden.has(s.role),
            value: (u, value) => short(value),
            ...marks[s.mark](side),
        };
        if (s.mark === "bars") {
            curve.fill = paint;
        }
        if (s.mark === "line" && p.tables[0].length < 200) {
            curve.points.show = false; // of long ones uPlot shows the samples where the zoom parts them
        }
        if (s.mark === "points") {
            curve.points.fill = paint;
            curve.points.size = p.tables[0].length > 80 ? 4 : 7;
        }
        return curve;
    }

    function rangeOf(axis, bars) {
        if (axis.range) {
            return () => axis.range;
        }
        if (axis.log) {
            return (u, low, high) => (low == null ? [1, 10] : [low / 1.25, high * 1.25]);
        }
        return (u, low, high) => {
            if (low == null) {
                return [0, 1];
            }
            const [least, most] = axis.least ? [Math.min(low, -axis.least), Math.max(high, axis.least)] : [low, high];
            const room = 0.06 * (most - least) || 0.1 * Math.abs(most) || 1;
            return [least >= 0 && (bars || least < 0.5 * most) ? 0 : least - room, most + room];
        };
    }

    function axisOf(axis, names, size) {
        const drawn = {
            label: axis.label,
            stroke: colour("ink"),
            grid: {stroke: colour("grid"), width: 1},
            ticks: {stroke: colour("rule"), width: 1, size: 5},
            font: "12px system-ui, sans-serif",
            labelFont: "13px system-ui, sans-serif",
            labelSize: 20,
            values: (u, splits) => splits.map((value) => (value == null ? "" : short(value))),
            size,
        };
        if (names) {
            const many = names.length > 14;
            drawn.splits = () => names.map((name, n) => n);
            drawn.values = () => names.map((name) => (many ? name.split("\n")[0] : name));
            drawn.grid.show = false;
            drawn.rotate = many ? -90 : 0;
            drawn.size = many ? 40 : names.some((name) => name.includes("\n")) ? 42 : 28;
        }
        return drawn;
    }

    /* A logarithmic axis has a line at 1, 2 ... 9 of each decade, and a number at as many of them as there is room for. */
    function logarithmic(axis) {
        const mantissa = (value) => Number((value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toPrecision(3));
        axis.splits = (u, which, low, high) => {
            const lines = [];
            for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); decade++) {
                for (let n = 1; n < 10; n++) {
                    lines.push(Number((n * 10 ** decade).toPrecision(3)));
                }
            }
            return lines.filter((value) => value >= low && value <= high);
        };
        axis.filter = (u, splits) => {
            const decades = Math.log10(splits[splits.length - 1] / splits[0]);
            const keep = decades < 1.5 ? [1, 2, 3, 5, 7] : decades < 3 ? [1, 2, 5] : [1];
            return splits.map((value) => (keep.includes(mantissa(value)) ? value : null));
        };
    }

    function optionsOf(p, width) {
        const {chart} = p;
        const x = axisOf(chart.x, chart.names, 28);
        const y = axisOf(chart.y, null, 58);
        if (chart.x.log) {
            logarithmic(x);
        }
        if (chart.y.log) {
            logarithmic(y);
        }
        return {
            title: chart.title,
            width,
            height: chart.height || USUAL_HEIGHT,
            scales: {x: {time: false, distr: chart.x.log ? 3 : 1, range: (u, low, high) => [low, high]}, y: {distr: chart.y.log ? 3 : 1, range: rangeOf(chart.y, chart.series.some((s) => s.mark === "bars"))}},
            axes: [x, y],
            legend: {markers: {width: 0, fill: (u, n) => colour(chart.series[n - 1].colour)}},
            series: [{label: chart.x.label, value: (u, value) => (chart.names ? nameOf(chart, value) : short(value))},
                ...chart.series.map((s, n) => curveOf(p, s, n))],
            cursor: {
                drag: {x: !chart.names, y: false, setScale: false},
                sync: chart.group ? {key: chart.group, scales: ["x", null], setSeries: false, filters: {pub: isMove}} : undefined,
                bind: {dblclick: () => () => zoom(p, p.full)},
            },
            hooks: {
                setSelect: [(u) => {
                    if (u.select.width > 3) {
                        zoom(p, [u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]);
                    }
                    if (u.select.width > 0) {
                        u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
                    }
                }],
                draw: chart.group || chart.names ? [] : [(u) => nameCurves(u, chart)],
            },
        };
    }

    /* ---- Names on the curves ---- */

    /* The places where a name may stand: above and below its curve. */
    function placesOf(u, n, height) {
        const {left, top, width, height: full} = u.bbox;
        const places = [];
        u.data[n].forEach((value, k) => {
            if (value == null) {
                return;
            }
            const x = u.valToPos(u.data[0][k], "x", true);
            const y = u.valToPos(value, u.series[n].scale, true);
            for (const lines of [-1, 1, -2, 2, -3, 3]) {
                const at = y + lines * height;
                if (x > left && x < left + width && at - 0.6 * height > top && at + 0.6 * height < top + full) {
                    places.push({x, y: at, lines});
                }
            }
        });
        return places;
    }

    /* A curve as points in the canvas; a line has more of them between its samples. */
    function pointsOf(u, n, joined) {
        const points = [];
        let before = null;
        u.data[n].forEach((value, k) => {
            const here = value == null ? null : {x: u.valToPos(u.data[0][k], "x", true), y: u.valToPos(value, u.series[n].scale, true), n};
            if (here && before && joined) {
                const steps = Math.min(Math.ceil(Math.hypot(here.x - before.x, here.y - before.y) / (8 * devicePixelRatio)), 60);
                for (let j = 1; j < steps; j++) {
                    points.push({x: before.x + (here.x - before.x) * j / steps, y: before.y + (here.y - before.y) * j / steps, n});
                }
            }
            if (here) {
                points.push(here);
            }
            before = here;
        });
        return points;
    }

    /* Each name is written next to its own curve, as far as possible from the other curves and names. */
    function nameCurves(u, chart) {
        const shown = u.series.map((s, n) => n).filter((n) => n > 0 && u.series[n].show);
        if (shown.length < 2 || u.data[0].length > 400) {
            return;
        }
        const ratio = devicePixelRatio;
        const height = 14 * ratio;
        const {left, width} = u.bbox;
        const points = shown.flatMap((n) => pointsOf(u, n, chart.series[n - 1].mark !== "points"));
        const names = [];
        u.ctx.save();
        u.ctx.font = `600 ${12 * ratio}px system-ui, sans-serif`;
        u.ctx.textAlign = "center";
        u.ctx.textBaseline = "middle";
        for (const n of shown) {
            const half = 0.5 * u.ctx.measureText(u.series[n].label).width;
            let best = null;
            for (const {x, y, lines} of placesOf(u, n, height)) {
                const middle = Math.min(Math.max(x, left + half + 2), left + width - half - 2);
                const room = (q, extra) => Math.hypot(Math.max(Math.abs(q.x - middle) - half - extra, 0), Math.abs(q.y - y));
                const other = Math.min(...points.filter((q) => q.n !== n).map((q) => room(q, 0)), ...names.map((m) => room(m, m.half)));
                const own = Math.min(...points.filter((q) => q.n === n).map((q) => room(q, 0)));
                const free = 10 * Math.min(own, other, 0.9 * height) + Math.min(other, 6 * height) - 3 * height * Math.abs(lines);
                if (!best || free > best.free) {
                    best = {x: middle, y, half, free, n};
                }
            }
            if (best) {
                names.push(best);
            }
        }
        for (const {x, y, n} of names) {
            const text = u.series[n].label;
            u.ctx.lineWidth = 4 * ratio;
            u.ctx.lineJoin = "round";
            u.ctx.strokeStyle = colour("paper");
            u.ctx.strokeText(text, x, y);
            u.ctx.fillStyle = colour("ink");
            u.ctx.fillStyle = `color-mix(in srgb, ${colour(chart.series[n - 1].colour)} 65%, ${colour("ink")})`;
            u.ctx.fillText(text, x, y);
        }
        u.ctx.restore();
    }

    /* What the charts of a group hear of one another: zoom() sees to the rest. */
    function isMove(kind) {
        return kind === "mousemove" || kind === "mouseleave";
    }

    const widthOf = (p) => Math.max(Math.floor(printing ? Math.min(PRINT_WIDTH, p.box.clientWidth) : p.box.clientWidth), 200);

    function show(p) {
        const data = seenOf(p.tables, p.view[0], p.view[1], p.plot.width, p.chart.y.log);
        p.plot.batch(() => {
            p.plot.setData(data, false);
            p.plot.setScale("x", {min: p.view[0], max: p.view[1]});
        });
    }

    function draw(p) {
        if (p.plot) {
            p.shown = p.plot.series.slice(1).map((s) => s.show);
            p.plot.destroy();
        }
        p.plot = new uPlot(optionsOf(p, widthOf(p)), p.tables.map(() => []), p.box);
        show(p);
    }

    function fullOf(p) {
        const {x, names} = p.chart;
        if (names) {
            return [-0.6, names.length - 0.4];
        }
        if (x.range) {
            const room = x.log ? 0 : 0.015 * (x.range[1] - x.range[0]);
            return [x.range[0] - room, x.range[1] + room];
        }
        const first = p.tables[0][0];
        const last = p.tables[0][p.tables[0].length - 1];
        return first < last ? [first, last] : [first - 1, first + 1];
    }

    /* ---- Zoom ---- */

    function zoom(p, view) {
        const [least, most] = p.full;
        const size = Math.min(Math.max(view[1] - view[0], 1e-7 * (most - least)), most - least);
        const low = Math.min(Math.max(view[0], least), most - size);
        for (const other of panels.filter((q) => q === p || (p.chart.group && q.chart.group === p.chart.group))) {
            other.view = [low, low + size];
            show(other);
        }
    }

    function zoomBar(p, figure) {
        const bar = document.createElement("div");
        const button = (text, says, act) => {
            const made = document.createElement("button");
            made.type = "button";
            made.textContent = text;
            made.title = says;
            made.setAttribute("aria-label", says);
            made.addEventListener("click", act);
            bar.append(made);
        };
        const by = (factor, shift) => () => {
            const [low, high] = p.view;
            const half = 0.5 * factor * (high - low);
            const mid = 0.5 * (low + high) + shift * (high - low);
            zoom(p, [mid - half, mid + half]);
        };
        bar.className = "zoom";
        button("+", "zoom in", by(0.4, 0));
        button("−", "zoom out", by(2.5, 0));
        button("◀", "earlier", by(1, -0.5));
        button("▶", "later", by(1, 0.5));
        button("all", "show all", () => zoom(p, p.full));
        if (p.chart.view) {
            button("first view", "back to what was shown first", () => zoom(p, p.chart.view));
        }
        bar.append("or drag over a curve to zoom; a double click shows all.");
        figure.querySelector(".panels").before(bar);
    }

    /* ---- The page ---- */

    function switchRole(role, on) {
        if (on) {
            hidden.delete(role);
        } else {
            hidden.add(role);
        }
        for (const p of panels) {
            p.chart.series.forEach((s, n) => s.role === role && p.plot.setSeries(n + 1, {show: on}));
        }
    }

    function switchOf(role, says, paint) {
        const label = document.createElement("label");
        const box = document.createElement("input");
        const line = document.createElement("i");
        box.type = "checkbox";
        box.checked = true;
        box.name = role;
        line.style.background = `var(--${paint})`;
        box.addEventListener("change", () => switchRole(role, box.checked));
        label.append(box, line, says);
        return label;
    }

    function themeChoice() {
        const label = document.createElement("label");
        const choice = document.createElement("select");
        for (const [value, says] of [["", "as the system"], ["light", "light"], ["dark", "dark"]]) {
            choice.append(new Option(says, value));
        }
        choice.name = "theme";
        choice.addEventListener("change", () => {
            if (choice.value) {
                root.dataset.theme = choice.value;
            } else {
                delete root.dataset.theme;
            }
            panels.forEach(draw);
        });
        label.append("colours ", choice);
        return label;
    }

    function pageBar() {
        const bar = document.createElement("div");
        const roles = new Set(panels.flatMap((p) => p.chart.series.map((s) => s.role)));
        bar.className = "bar";
        if (roles.has("nominal") && roles.has("extended")) {
            bar.append(switchOf("nominal", "nominal model", "orange"), switchOf("extended", "extended model", "blue"));
        }
        bar.append(themeChoice());
        document.querySelector(".subtitle").after(bar);
    }

    function drawFigure(figure) {
        const told = JSON.parse(figure.querySelector("script").textContent);
        const columns = told.columns.map(columnOf);
        const boxes = figure.querySelectorAll(".chart");
        let first = null;
        told.charts.forEach((chart, n) => {
            const p = {box: boxes[n], chart, tables: tablesOf(chart, columns)};
            p.full = fullOf(p);
            p.view = chart.view || p.full;
            draw(p);
            panels.push(p);
            first = first || p;
        });
        if (first && !first.chart.names && (first.chart.group || told.charts.length === 1) && first.tables[0].length > 100) {
            zoomBar(first, figure);
        }
    }

    function start() {
        for (const figure of document.querySelectorAll("figure.charts")) {
            try {
                drawFigure(figure);
            } catch (problem) {
                figure.querySelector(".panels").textContent = "This chart could not be drawn: " + problem.message;
                figure.classList.add("failed");
                console.error(problem);
            }
        }
        /* Of one group all that is shown together: the widest of them. */
        for (const p of panels.filter((q) => q.chart.group)) {
            const all = panels.filter((q) => q.chart.group === p.chart.group);
            p.full = [Math.min(...all.map((q) => q.full[0])), Math.max(...all.map((q) => q.full[1]))];
        }
        pageBar();
        const wide = new ResizeObserver(() => {
            for (const p of panels) {
                if (!printing && p.plot.width !== widthOf(p)) {
                    p.plot.setSize({width: widthOf(p), height: p.chart.height || USUAL_HEIGHT});
                    show(p);
                }
            }
        });
        panels.forEach((p) => wide.observe(p.box));
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => panels.forEach(draw));
        let theme;
        addEventListener("beforeprint", () => {
            printing = true;
            theme = root.dataset.theme;
            root.dataset.theme = "light";
            panels.forEach(draw);
        });
        addEventListener("afterprint", () => {
            printing = false;
            if (theme) {
                root.dataset.theme = theme;
            } else {
                delete root.dataset.theme;
            }
            panels.forEach(draw);
        });
        window.iqfocReport = {panels, zoom};
    }

    start();
})();
