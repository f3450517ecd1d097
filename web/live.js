/* A board on a serial line: its recorder's octets as they come, a scope of them, and at the end the recording. */
"use strict";
(() => {
    const {$, post, cell, short, draw, colour, recorded} = window.iqfoc.page;
    const ROWS_KEPT = 20000; // for the scope; the octets are all kept
    const GROUPS = [["currents, A", /^i_/], ["voltages, V", /^u_([abc]|alpha|beta)_/], ["duties", /^d_/]];
    const COLOURS = ["--blue", "--orange", "--green", "--purple", "--soft"];
    let port = null, reader = null;
    let pieces = []; // octets
    let seen = null; // the last answer, and rows: [follows, cycle, values ...]
    let frozen = null; // the window that the trigger took once
    window.iqfoc.line = {rows: 0, taken: 0};

    function say(text, bad) {
        $("line-state").textContent = text;
        $("line-state").className = bad ? "bad" : "note";
    }

    function choices(select, texts) {
        if ([...select.options].map((o) => o.value).join() === texts.join()) {
            return;
        }
        select.replaceChildren(...texts.map((text) => new Option(text, text)));
    }

    /* The columns that a choice of #show means. */
    function chosen(columns) {
        const group = GROUPS.find(([name]) => name === $("show").value);
        return columns.map((name, n) => [name, n]).filter(([name]) => (group ? group[1].test(name) : name === $("show").value));
    }

    function offer(columns) {
        const grouped = GROUPS.filter(([, names]) => columns.some((c) => names.test(c))).map(([name]) => name);
        choices($("show"), [...grouped, ...columns.filter((c) => !GROUPS.some(([, names]) => names.test(c)))]);
        choices($("trigger-column"), columns);
    }

    /* Of rows in a row: those of one stream, from the last restart of its cycles on. */
    function latest(rows) {
        const restart = rows.findLastIndex((row, n) => n > 0 && row[1] < rows[n - 1][1]);
        return restart < 0 ? rows : rows.slice(restart);
    }

    /* The rows to draw: the last ones, or those around the last crossing of the level, a quarter of them before it. */
    function view() {
        const {rows, columns} = seen;
        const count = Math.max(20, Math.min(ROWS_KEPT, Number($("window").value) || 400));
        const way = Number($("trigger").value);
        if (way === 0) {
            frozen = null;
            return latest(rows.slice(-count));
        }
        if (frozen !== null && $("single").checked) {
            return frozen;
        }
        const at = 2 + columns.indexOf($("trigger-column").value);
        const level = Number($("level").value);
        const before = Math.floor(count / 4);
        for (let k = rows.length - (count - before); k > before; k--) {
            if (!rows[k][0] || way * (rows[k - 1][at] - level) >= 0 || way * (rows[k][at] - level) < 0) {
                continue;
            }
            const around = rows.slice(k - before, k - before + count);
            if (latest(around).length === around.length) {
                frozen = around;
                window.iqfoc.line.crossing = [rows[k - 1][at], rows[k][at]];
                return frozen;
            }
        }
        return frozen || [];
    }

    function redraw() {
        if (seen === null || seen.columns.length === 0) {
            return;
        }
        $("scope").hidden = false;
        offer(seen.columns);
        const rows = view();
        window.iqfoc.line.drawn = rows.length;
        window.iqfoc.line.rises = rows.every((row, n) => n === 0 || row[1] > rows[n - 1][1]);
        if (rows.length > 1) {
            const first = rows[0][1];
            const curves = chosen(seen.columns);
            draw("chart-live", [rows.map((r) => (r[1] - first) * seen.cycle_s * 1e3),
                ...curves.map(([, n]) => rows.map((r) => (r[0] ? r[2 + n] : null)))],
            curves.map(([name], k) => ({label: name, stroke: colour(COLOURS[k % COLOURS.length]), width: 1.5})),
            ["ms", $("show").value], {x: {time: false}});
        }
        $("status").replaceChildren();
        const trigger = $("trigger").value === "" ? "none" : frozen === null ? "waiting" : "taken";
        for (const [words, value] of [["rows", seen.count], ["rows a second", short(1 / seen.row_s)], ["trigger", trigger],
            ["frames", seen.frames], ["damaged frames", seen.damaged], ["lost frames", seen.lost], ["missing rows", seen.missing]]) {
            const row = $("status").insertRow();
            cell(row, words);
            cell(row, value, true);
        }
    }

    let due = false;
    function soon() {
        if (!due) {
            due = true;
            setTimeout(() => {
                due = false;
                redraw();
            }, 100);
        }
    }

    /* False: the stream has ended. */
    async function hear(octets) {
        const done = await post({octets, fresh: pieces.length === 0});
        pieces.push(octets);
        window.iqfoc.line.taken += octets.length;
        if (done.status !== 0) {
            throw new Error(done.said.trim());
        }
        for (const {out} of done.answers) {
            const news = JSON.parse(out);
            const rows = seen === null ? [] : seen.rows;
            rows.push(...news.rows);
            rows.splice(0, rows.length - ROWS_KEPT);
            seen = {...news, rows, count: (seen === null ? 0 : seen.count) + news.rows.length};
        }
        window.iqfoc.line.rows = seen.count;
        if (seen.count > 0) {
            say("Receiving …");
        }
        soon();
        return !seen.ended || $("several").checked;
    }

    async function finish() {
        const all = new Uint8Array(await new Blob(pieces).arrayBuffer());
        redraw();
        say("Making the recording …");
        say(await recorded(all));
        window.iqfoc.line.finished = true;
    }

    async function listen() {
        reader = port.readable.getReader();
        try {
            for (let more = true; more;) {
                const {value, done} = await reader.read();
                more = !done && await hear(value);
            }
            await reader.cancel();
        } finally {
            reader.releaseLock();
            reader = null;
            await port.close();
            port = null;
        }
    }

    async function connect() {
        if (!navigator.serial) {
            say("This browser cannot talk to a serial line: Chrome, Edge and Opera on a computer can. Record with `iqfoc record` and drop the recording.", true);
            return;
        }
        try {
            port = await navigator.serial.requestPort();
            await port.open({baudRate: Number($("baud").value), bufferSize: 65536});
        } catch (problem) {
            port = null;
            say(problem.message, true);
            return;
        }
        pieces = [];
        seen = frozen = null;
        window.iqfoc.line = {rows: 0, taken: 0};
        say("Connected; waiting for the recorder …");
        $("connect").disabled = true;
        $("stop").disabled = false;
        try {
            await listen();
            await finish();
        } catch (problem) {
            say(problem.message, true);
        }
        $("connect").disabled = false;
        $("stop").disabled = true;
    }

    $("connect").addEventListener("click", connect);
    $("stop").addEventListener("click", () => reader && reader.cancel());
    for (const id of ["show", "window", "trigger", "trigger-column", "level", "single"]) {
        $(id).addEventListener("input", () => {
            frozen = null;
            redraw();
        });
    }
})();
