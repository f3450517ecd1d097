/* A board on a serial line: its recorder's octets as they come, a scope of them, requests to it, and at the end the recording. */
"use strict";
(() => {
    const {$, post, cell, short, draw, colour, recorded} = window.iqfoc.page;
    const ANSWER_MS = 5000;
    const ROWS_KEPT = 20000; // for the scope; the octets are all kept
    const GROUPS = [["currents, A", /^i_/], ["voltages, V", /^u_([abc]|alpha|beta)_/], ["duties", /^d_/]];
    const COLOURS = ["--blue", "--orange", "--green", "--purple", "--soft"];
    let port = null, reader = null;
    let pieces = []; // octets
    let seen = null; // the last answer, and rows: [follows, cycle, values ...]
    let frozen = null; // the window that the trigger took once
    let asked = {sequence: 0, stop: false}; // the last request
    window.iqfoc.line = {rows: 0, taken: 0};

    function say(text, bad) {
        $("line-state").textContent = text;
        $("line-state").className = bad ? "bad" : "note";
    }

    function choices(select, texts, values = texts) {
        if ([...select.options].map((o) => o.value).join() === values.join()) {
            return;
        }
        select.replaceChildren(...texts.map((text, n) => new Option(text, values[n])));
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
        choices($("board-column"), columns.filter((c) => c !== "status"));
        choices($("board-bit"), seen.status_names.map(([, name]) => name), seen.status_names.map(([bit]) => String(bit)));
    }

    /* "VOLTAGE_LIMIT, LATE": of a word of status bits; a bit without a name by its number. */
    function bitsOf(word) {
        const names = new Map(seen.status_names.map(([bit, name]) => [bit, name]));
        const set = Array.from({length: 32}, (_, k) => 2 ** k).filter((bit) => Math.floor((word >>> 0) / bit) % 2 === 1);
        return set.map((bit) => names.get(bit) || `bit ${Math.log2(bit)}`);
    }

    /* Of the status column: which bits the rows of the picture have, and those of the last row. */
    function statusBits(rows) {
        const at = seen.columns.indexOf("status");
        $("status-bits").hidden = at < 0;
        if (at >= 0 && rows.length > 0) {
            const any = bitsOf(rows.reduce((all, row) => all | row[2 + at], 0));
            const last = bitsOf(rows[rows.length - 1][2 + at]);
            window.iqfoc.line.status = {any, last};
            $("status-bits").textContent = `Status in the picture: ${any.join(", ") || "none"}; in its last row: ${last.join(", ") || "none"}.`;
        }
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
        statusBits(rows);
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
        answered();
        if (seen.count > 0) {
            say("Receiving …");
        }
        soon();
        return !seen.ended || $("several").checked;
    }

    /* ---- Requests to the board ---- */

    function boardSay(text, bad) {
        $("board-state").textContent = text;
        $("board-state").className = bad ? "bad" : "note";
    }

    /* The recording begins with the board's last answer: rows ahead of it may have another distance. */
    function forget() {
        const last = pieces.slice(-2);
        const octets = new Uint8Array(last.reduce((all, piece) => all + piece.length, 0));
        last.reduce((at, piece) => {
            octets.set(piece, at);
            return at + piece.length;
        }, 0);
        for (let at = octets.length - 3; at >= 0; at--) {
            if (octets[at] === 0xC0 && octets[at + 1] === 1 && octets[at + 2] === 5) { // mark, version, type of the answer
                pieces = [octets.subarray(at)];
                window.iqfoc.line.from = window.iqfoc.line.taken - octets.length + at;
                return;
            }
        }
    }

    function answered() {
        const {answer} = seen;
        window.iqfoc.line.answer = answer;
        if (answer.count === 0 || answer.sequence !== asked.sequence || window.iqfoc.line.confirmed === asked.sequence) {
            return;
        }
        window.iqfoc.line.confirmed = asked.sequence;
        if (answer.error === 0 && !asked.stop) {
            forget();
        }
        boardSay(answer.error === 0 ? `The board has it: recording ${answer.stream}.` : `The board refuses it: error ${answer.error}.`, answer.error !== 0);
    }

    async function request() {
        if (port === null || !port.writable) {
            boardSay("Connect first.", true);
            return;
        }
        const trigger = Number($("board-trigger").value);
        const columns = seen === null ? [] : seen.columns;
        const number = (name) => Number($(name).value);
        const sequence = asked.sequence % 65535 + 1;
        const done = await post({request: [sequence, trigger, trigger === 1 ? number("board-bit") : 0,
            Math.max(0, columns.indexOf($("board-column").value)), number("board-level"), number("board-before") / 100, number("board-decimation")]});
        if (done.status !== 0) {
            boardSay(done.said.trim(), true);
            return;
        }
        asked = {sequence, stop: trigger === 4};
        boardSay("Sent; waiting for the board's answer …");
        const writer = port.writable.getWriter();
        try {
            await writer.write(Uint8Array.from(JSON.parse(done.out).octets));
        } catch (problem) {
            boardSay(problem.message, true);
        } finally {
            writer.releaseLock();
        }
        setTimeout(() => {
            if (asked.sequence === sequence && window.iqfoc.line.confirmed !== sequence && port !== null) {
                boardSay("No answer: does the firmware call iqfoc_recorder_receive and iqfoc_recorder_obey?", true);
            }
        }, ANSWER_MS);
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
        asked = {sequence: 0, stop: false};
        window.iqfoc.line = {rows: 0, taken: 0, from: 0};
        $("board").hidden = false;
        boardSay("");
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
        $("board").hidden = true;
    }

    $("connect").addEventListener("click", connect);
    $("board-set").addEventListener("click", request);
    $("stop").addEventListener("click", () => reader && reader.cancel());
    for (const id of ["show", "window", "trigger", "trigger-column", "level", "single"]) {
        $(id).addEventListener("input", () => {
            frozen = null;
            redraw();
        });
    }
})();
