/* The page: files in, diagnosis out; sliders in, curves out. What computes is in the worker. */
"use strict";
(() => {
    const $ = (id) => document.getElementById(id);
    const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    window.iqfoc = {json: null, said: "", draws: 0, busy: 0}; // for who tests the page, and for the console

    /* ---- The worker: made of a blob, as a page from disk may load no other file ---- */
    const worker = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], {type: "text/javascript"})));
    worker.postMessage({wasm: bytesOf($("wasm").textContent.trim())});
    const waiting = new Map();
    let questions = 0;
    worker.onmessage = ({data}) => {
        waiting.get(data.id)(data);
        waiting.delete(data.id);
        window.iqfoc.busy--;
    };
    function ask(name, values, files) {
        window.iqfoc.busy++;
        return new Promise((answer) => {
            waiting.set(++questions, answer);
            worker.postMessage({id: questions, name, values, files});
        });
    }

    /* ---- Diagnosis ---- */
    const given = {recording: null, motor: null}; // {name, bytes}

    async function bytesOfFile(file) {
        const bytes = new Uint8Array(await file.arrayBuffer());
        if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) {
            return bytes;
        }
        const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        return new Uint8Array(await new Response(plain).arrayBuffer());
    }

    async function take(files) {
        for (const file of files) {
            try {
                given[file.name.endsWith(".toml") ? "motor" : "recording"] = {name: file.name, bytes: await bytesOfFile(file)};
            } catch (problem) {
                tell(`${file.name}: cannot be read: ${problem.message}`, true);
                return;
            }
        }
        $("have-recording").textContent = given.recording ? given.recording.name : "none yet";
        $("have-motor").textContent = given.motor ? given.motor.name : "none yet";
        if (given.recording && given.motor) {
            await diagnose();
        }
    }

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

    async function diagnose() {
        const began = performance.now();
        $("result").hidden = true;
        window.iqfoc.json = null;
        tell("Diagnosing …", false);
        const {recording, motor} = given;
        const done = await ask("page_diagnose", {names: {page_recording_name: recording.name, page_motor_name: motor.name}},
            {[recording.name]: recording.bytes, [motor.name]: motor.bytes});
        window.iqfoc.said = done.said;
        if (done.status !== 0) {
            tell(done.said.trim(), true);
            return;
        }
        window.iqfoc.json = done.out;
        show(JSON.parse(done.out));
        tell(`Done in ${((performance.now() - began) / 1000).toFixed(1)} s, in this page; nothing was sent anywhere.`, false);
        $("save").href = URL.createObjectURL(new Blob([done.out], {type: "application/json"}));
    }

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
