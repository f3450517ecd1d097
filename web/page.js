/* The page: files in, diagnosis out; sliders in, curves out. What computes is in the worker. */
"use strict";
(() => {
    const $ = (id) => document.getElementById(id);
    const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    window.iqfoc = {json: null, said: "", draws: 0, busy: 0}; // for who tests the page, and for the console

    /* ---- The worker: made of a blob, as a page from disk may load no other file ---- */
    const worker = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], {type: "text/javascript"})));
    const ready = unpacked(bytesOf($("wasm").textContent.trim())).then((wasm) => worker.postMessage({wasm}));
    const waiting = new Map();
    let questions = 0;
    worker.onmessage = ({data}) => {
        waiting.get(data.id)(data);
        waiting.delete(data.id);
        window.iqfoc.busy--;
    };
    function post(question) {
        window.iqfoc.busy++;
        return new Promise((answer) => {
            const id = ++questions;
            waiting.set(id, answer);
            ready.then(() => worker.postMessage({id, ...question}));
        });
    }
    const ask = (name, values, files) => post({name, values, files});

    async function unpacked(bytes) {
        if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) {
            return bytes;
        }
        const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        return new Uint8Array(await new Response(plain).arrayBuffer());
    }

    /* ---- Diagnosis ---- */
    const given = {recording: null, motor: null, log: null, map: null}; // {name, bytes}

    const textOf = (bytes) => new TextDecoder("latin1").decode(bytes);
    const isMap = (bytes) => /^\s*\[columns\]/m.test(textOf(bytes));
    /* Its first line that is no comment has the names that every recording has. */
    function isRecording(bytes) {
        const head = textOf(bytes.subarray(0, 65536)).split("\n").find((line) => !line.startsWith("#")) || "";
        const names = head.trim().split(",");
        return names.includes("t_s") && names.includes("theta_e_rad");
    }

    async function take(files) {
        let dropped = null;
        for (const file of files) {
            try {
                const bytes = await unpacked(new Uint8Array(await file.arrayBuffer()));
                if (!file.name.endsWith(".toml")) {
                    dropped = {name: file.name, bytes};
                } else if (isMap(bytes)) {
                    given.map = {name: file.name, bytes};
                } else {
                    given.motor = {name: file.name, bytes};
                }
            } catch (problem) {
                tell(`${file.name}: cannot be read: ${problem.message}`, true);
                return;
            }
        }
        if (dropped !== null) {
            const own = isRecording(dropped.bytes);
            given.recording = own ? dropped : null;
            given.log = own ? null : dropped;
        }
        have();
        if (given.log !== null) {
            await propose(dropped !== null);
        } else if (given.recording && given.motor) {
            await diagnose();
        }
    }

    function have() {
        const named = given.recording || given.log;
        $("have-recording").textContent = named ? named.name : "none yet";
        $("have-motor").textContent = given.motor ? given.motor.name : "none yet";
        $("import").hidden = given.log === null;
    }

    /* ---- A log of another program ---- */

    /* The log's first rows, a line for each column, with the quantity that the map takes it for. */
    function showHead() {
        const quantity = new Map();
        for (const [, key, plain, from] of $("map").value.matchAll(/^\s*(\w+)\s*=\s*(?:"([^"]*)"|\{\s*from\s*=\s*"([^"]*)")/gm)) {
            const name = plain === undefined ? from : plain;
            quantity.set(name, quantity.has(name) ? `${quantity.get(name)}, ${key}` : key);
        }
        $("head").replaceChildren();
        for (const [n, name] of log.names.entries()) {
            const row = $("head").insertRow();
            cell(row, quantity.get(name) || "–");
            cell(row, name);
            cell(row, log.units[n]);
            cell(row, log.rows.slice(0, 4).map((fields) => fields[n]).join("  "));
        }
    }

    let log = null; // {map, names, units, rows}
    async function propose(fresh) {
        $("result").hidden = true;
        if (fresh) {
            const done = await ask("page_propose", {names: {log: given.log.name}}, {[given.log.name]: given.log.bytes});
            if (done.status !== 0) {
                given.log = null;
                have();
                tell(done.said.trim(), true);
                return;
            }
            log = JSON.parse(done.out);
            $("log-name").textContent = given.log.name;
            $("map").value = log.map;
            $("checked").hidden = true;
        }
        if (given.map) {
            $("map").value = new TextDecoder().decode(given.map.bytes);
        }
        showHead();
        tell(given.motor ? "" : "The motor file is still missing: drop it on the page.", false);
    }

    async function withMap(call) {
        if (!given.motor) {
            tell("The motor file is missing: drop it on the page.", true);
            return null;
        }
        const map = given.map ? given.map.name : "map.toml";
        tell("Reading the log …", false);
        const done = await ask(call, {names: {log: given.log.name, map, motor: given.motor.name}},
            {[given.log.name]: given.log.bytes, [map]: new TextEncoder().encode($("map").value), [given.motor.name]: given.motor.bytes});
        tell(done.status === 0 ? "" : done.said.trim(), done.status !== 0);
        return done.status === 0 ? done : null;
    }

    $("map").addEventListener("input", showHead);
    $("convert").addEventListener("click", async () => {
        const done = await withMap("page_import");
        if (done !== null) {
            given.recording = {name: "recording.csv", bytes: done.files["recording.csv"]};
            await diagnose();
        }
    });
    $("check-map").addEventListener("click", async () => {
        const done = await withMap("page_check");
        $("checked").hidden = done === null;
        $("checked").textContent = done === null ? "" : done.said;
    });

    /* ---- The diagnosis ---- */

    function tell(text, bad) {
        $("state").textContent = text;
        $("state").className = bad ? "bad" : "note";
    }

    function cell(row, text, number) {
        const made = row.insertCell();
        made.textContent = text;
        made.className = number ? "n" : "";
    }

    const short = (x) => (x === null || x === undefined ? "–" : String(Number(Number(x).toPrecision(4))));

    function show(d) {
        $("verdict").textContent = d.verdict;
        $("verdict").className = "verdict " + d.verdict;
        $("summary").textContent = d.summary;
        const causes = $("causes");
        causes.replaceChildren();
        for (const cause of d.causes) {
            for (const [n, p] of cause.parameters.entries()) {
                const row = causes.insertRow();
                cell(row, n === 0 ? cause.id : "");
                cell(row, `${p.name} = ${short(p.value)} ${p.unit === "1" ? "" : p.unit}`);
                cell(row, `${short(p.ci95[0])} to ${short(p.ci95[1])}`);
                cell(row, short(p.nominal), true);
                cell(row, n === 0 ? short(cause.gain) : "", true);
            }
        }
        $("causes-table").hidden = d.causes.length === 0;
        const errors = $("errors");
        errors.replaceChildren();
        const most = Math.max(d.error.nominal, d.error.extended, d.error.noise_floor);
        for (const [words, value] of [["motor file as it is", d.error.nominal], ["with what was found", d.error.extended],
            ["noise floor", d.error.noise_floor]]) {
            const row = errors.insertRow();
            cell(row, words);
            cell(row, short(value) + " %", true);
            const bar = document.createElement("div");
            bar.className = "meter";
            bar.style.width = `${Math.max(0.5, (100 * value) / most)}%`;
            row.insertCell().append(bar);
        }
        $("next").textContent = d.next_experiment || "";
        $("words").textContent = window.iqfoc.said;
        $("result").hidden = false;
    }

    function link(name, bytes) {
        const made = document.createElement("a");
        made.textContent = name;
        made.download = name;
        made.href = URL.createObjectURL(new Blob([bytes]));
        return made;
    }

    async function diagnose() {
        const began = performance.now();
        $("result").hidden = true;
        window.iqfoc.json = null;
        window.iqfoc.files = {};
        window.iqfoc.recording = textOf(given.recording.bytes);
        tell("Diagnosing …", false);
        const {recording, motor} = given;
        const values = {names: {recording: recording.name, motor: motor.name}};
        const files = {[recording.name]: recording.bytes, [motor.name]: motor.bytes};
        const done = await ask("page_diagnose", values, files);
        window.iqfoc.said = done.said;
        if (done.status !== 0) {
            tell(done.said.trim(), true);
            return;
        }
        window.iqfoc.json = done.out;
        show(JSON.parse(done.out));
        tell(`Done in ${((performance.now() - began) / 1000).toFixed(1)} s, in this page; nothing was sent anywhere.`, false);
        $("save").href = URL.createObjectURL(new Blob([done.out], {type: "application/json"}));
        $("report").hidden = true;
        $("files").replaceChildren();
        $("tuned").hidden = true;
        $("tuned-files").replaceChildren();
        $("report-state").textContent = "A simulated drive with these causes is being compared with the recording …";
        const report = await ask("page_report", values, files);
        if (given.recording !== recording) {
            return; // the reader has gone on
        }
        $("report-state").textContent = report.status === 0 ? "" : report.said.trim();
        window.iqfoc.files = report.files;
        for (const name of ["report.html", "motor_extended.toml", "iqfoc_extension.h"].filter((n) => report.files[n])) {
            $("files").append(link(name, report.files[name]));
        }
        if (recording.name === "recording.csv") { // made here
            $("files").append(link(recording.name, recording.bytes));
        }
        if (report.files["report.html"]) {
            $("report").src = URL.createObjectURL(new Blob([report.files["report.html"]], {type: "text/html"}));
            $("report").hidden = false;
        }
    }

    $("tune").addEventListener("click", async () => {
        const {motor} = given;
        const name = "diagnosis.json";
        $("tune").disabled = true;
        $("tune-state").textContent = "Designing, and simulating 50 drives: up to a minute …";
        const done = await ask("page_tune", {names: {motor: motor.name, diagnosis: name}},
            {[motor.name]: motor.bytes, [name]: new TextEncoder().encode(window.iqfoc.json)});
        $("tune").disabled = false;
        $("tune-state").textContent = done.status === 0 ? "" : done.said.trim();
        window.iqfoc.tuned = done.files;
        $("tuned-files").replaceChildren();
        if (done.status === 0) {
            $("tuned-files").append(link("iqfoc_tuned.h", done.files["iqfoc_tuned.h"]), link("index.html", done.files["index.html"]));
        }
        $("tuned").hidden = done.status !== 0;
        $("tuned").textContent = done.said;
    });

    $("sample-motor").download = "motor.toml";
    $("sample-motor").href = URL.createObjectURL(new Blob([bytesOf($("example-motor").textContent.trim())]));
    $("example").addEventListener("click", async () => {
        const name = $("example-recording").dataset.name;
        given.log = null;
        given.recording = {name: name + ".csv.gz", bytes: await unpacked(bytesOf($("example-recording").textContent.trim()))};
        given.motor = {name: name + ".toml", bytes: bytesOf($("example-motor").textContent.trim())};
        have();
        await diagnose();
    });

    /* What live.js needs of this file. */
    window.iqfoc.page = {$, post, ask, cell, short, draw, colour: (name) => colour(name),
        async recorded(octets) {
            const name = "board.octets";
            const done = await ask("page_record", {names: {octets: name}}, {[name]: octets});
            if (done.status !== 0) {
                return done.said.trim();
            }
            given.log = null;
            given.recording = {name: "recording.csv", bytes: done.files["recording.csv"]};
            have();
            if (given.motor) {
                await diagnose();
                return done.said.trim();
            }
            return `${done.said.trim()}; drop the motor file for the diagnosis`;
        }};

    $("choose").addEventListener("change", (event) => take(event.target.files));
    for (const name of ["dragover", "drop"]) {
        document.addEventListener(name, (event) => {
            event.preventDefault();
            $("drop").classList.toggle("over", name === "dragover");
            if (name === "drop") {
                take(event.dataTransfer.files);
            }
        });
    }
    document.addEventListener("dragleave", () => $("drop").classList.remove("over"));

    $("check").addEventListener("click", async () => {
        $("golden").textContent = "computing …";
        $("golden").textContent = (await ask("page_golden", {})).out.trim();
    });

    /* ---- Sliders ---- */
    const sliders = {}; // id: how its value is shown and used
    for (const input of document.querySelectorAll("input[type=range]")) {
        const log = input.dataset.log === "1";
        sliders[input.id] = () => (log ? 10 ** Number(input.value) : Number(input.value)) * Number(input.dataset.scale || 1);
        input.addEventListener("input", moved);
    }
    const value = (id) => sliders[id]();
    function label() {
        for (const id of Object.keys(sliders)) {
            const input = $(id);
            $(id + "-is").textContent = `${short(value(id) / Number(input.dataset.scale || 1))} ${input.dataset.unit}`;
        }
    }

    const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const METHODS = [["standard", "--orange"], ["quasi_discrete", "--blue"], ["exact", "--green"]];
    const STEP_COLOURS = ["--purple", "--orange", "--blue", "--green"];
    const plots = {};

    function draw(id, data, series, axes, scales, mark) {
        const box = $(id);
        if (plots[id]) {
            plots[id].destroy();
        }
        const line = {stroke: colour("--ink"), grid: {stroke: colour("--grid"), width: 1}, ticks: {stroke: colour("--rule")}};
        plots[id] = new uPlot({
            width: box.clientWidth, height: 300, scales, legend: {live: false}, cursor: {drag: {x: false, y: false}},
            series: [{label: axes[0]}, ...series],
            axes: [{...line, label: axes[0]}, {...line, label: axes[1], size: 76,
                values: (u, ticks) => ticks.map((x) => (x === null ? "" : String(Number(x.toPrecision(3)))))}],
            hooks: {draw: [(u) => mark && mark(u)]},
        }, data, box);
    }

    const WRONG = [["all", "all together", "--purple"], ["R", "R", "--orange"], ["L", "L", "--blue"], ["psi_f", "psi", "--green"],
        ["voltage", "voltage", "--soft"]];
    const MARGINS = [["disk_measured", "measured angle", "--green"], ["disk_observed", "observed angle", "--purple"]];
    const OBSERVER_LOW = 3.5;
    const RATIO_LOW = 5, RATIO_HIGH = 100, POINTS = 20;
    const common = () => ["R", "L", "psi"].map(value);
    let last = null;

    function redraw() {
        if (last === null) {
            return;
        }
        const {points, step, observer} = last;
        const ratio = value("ratio");
        const atRatio = (u) => {
            const x = u.valToPos(ratio, "x", true);
            u.ctx.save();
            u.ctx.strokeStyle = colour("--soft");
            u.ctx.setLineDash([4, 4]);
            u.ctx.beginPath();
            u.ctx.moveTo(x, u.bbox.top);
            u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
            u.ctx.stroke();
            u.ctx.restore();
        };
        for (const kind of ["mean", "prediction"]) {
            draw("chart-" + kind, [points.map((p) => p.sffr), ...METHODS.map(([key]) => points.map((p) => p[kind][key]))],
                METHODS.map(([key, name]) => ({label: key.replace("_", "-"), stroke: colour(name), width: 2})),
                ["switching periods a revolution", "error, % of the current"],
                {x: {time: false, distr: 3}, y: {distr: 3}}, atRatio);
        }
        const cycles = step.methods[0].trace.map((_, k) => k - step.cycles_before);
        draw("chart-step", [cycles, ...step.methods.map((m) => m.trace)],
            step.methods.map((m, k) => ({label: m.method, stroke: colour(STEP_COLOURS[k]), width: 2})),
            ["control cycles since the step", "i_q over rated"],
            {x: {time: false}, y: {range: (u, low, high) => [Math.max(-0.5, Math.min(0.2, low)), Math.min(1.6, Math.max(0.9, high))]}});
        $("outcomes").textContent = step.methods.map((m) => `${m.method}: ${m.outcome}`).join("; ");
        const ratios = observer.points.map((p) => p.sffr);
        draw("chart-angle", [ratios, ...WRONG.map(([key]) => observer.points.map((p) => p.angle_deg[key]))],
            WRONG.map(([key, words, name]) => ({label: words, stroke: colour(name), width: key === "all" ? 3 : 1.5})),
            ["switching periods a revolution", "angle error, degrees"], {x: {time: false, distr: 3}}, atRatio);
        draw("chart-margin", [ratios, ...MARGINS.map(([key]) => observer.points.map((p) => p[key]))],
            MARGINS.map(([, words, name]) => ({label: words, stroke: colour(name), width: 2})),
            ["switching periods a revolution", "disk margin"],
            {x: {time: false, distr: 3}, y: {range: (u, low, high) => [0, Math.max(1, high)]}}, atRatio);
        const nearest = observer.points.reduce((a, b) => (Math.abs(Math.log(b.sffr / ratio)) < Math.abs(Math.log(a.sffr / ratio)) ? b : a));
        $("angle-noise").textContent = nearest.noise_deg === null ? "none, as the loop is not stable" : `${short(nearest.noise_deg)} degrees rms`;
        window.iqfoc.draws++;
    }

    let wanted = false, running = false;
    async function moved() {
        label();
        wanted = true;
        if (running) {
            return; // the newest position is computed when this one is done
        }
        running = true;
        while (wanted) {
            wanted = false;
            const rpm = value("speed");
            const [errors, step, observer] = await Promise.all([
                ask("page_errors", {numbers: [rpm, ...common(), RATIO_LOW, RATIO_HIGH, POINTS]}),
                ask("page_step", {numbers: [rpm, value("ratio"), ...common(), value("belief")]}),
                ask("page_observer", {numbers: [rpm, ...common(), ...["off-R", "off-L", "off-psi", "off-u", "loop"].map(value), OBSERVER_LOW,
                    RATIO_HIGH, POINTS]})]);
            const bad = [errors, step, observer].filter((done) => done.status !== 0).map((done) => done.said).join(" ");
            $("no-curves").textContent = bad.trim();
            if (bad !== "") { // no picture of other values than the sliders'
                last = null;
                $("outcomes").textContent = "";
                for (const id of Object.keys(plots)) {
                    plots[id].destroy();
                    delete plots[id];
                }
            } else {
                last = {...JSON.parse(errors.out), step: JSON.parse(step.out), observer: JSON.parse(observer.out)};
                window.iqfoc.last = last;
                redraw();
            }
        }
        running = false;
    }

    window.addEventListener("resize", redraw);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    moved();
})();
