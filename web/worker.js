/* The thread that computes: page.wasm with the few calls of WASI that it makes, and the files that the page gave it. */
"use strict";

const OK = 0, BAD_DESCRIPTOR = 8, NO_ENTRY = 44, NOT_THERE = 52;
const FOLDER = 3;

/* The numbers of page.h. */
const NAMES = ["recording", "motor", "log", "map", "diagnosis", "octets"];
const CREATE = 1;

const textOf = (parts) => new TextDecoder().decode(joined(parts));

function joined(parts) {
    const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
    let at = 0;
    for (const part of parts) {
        all.set(part, at);
        at += part.length;
    }
    return all;
}

/* An instance of the module, which sees these files. */
async function begin(module, files) {
    const open = new Map(); // descriptor: {bytes, at}, or {parts} of one that is written
    const made = {}; // name: parts
    const written = {1: [], 2: []};
    let next = FOLDER + 1;
    let memory = null;
    const view = () => new DataView(memory.buffer);
    const bytesAt = (at, length) => new Uint8Array(memory.buffer, at, length);
    const textAt = (at, length) => new TextDecoder().decode(bytesAt(at, length).slice());

    /* Descriptor `to` gets or gives the pieces that the list at `list` names. */
    function pieces(list, count, take) {
        let sum = 0;
        for (let n = 0; n < count; n++) {
            const done = take(view().getUint32(list + 8 * n, true), view().getUint32(list + 8 * n + 4, true));
            sum += done;
        }
        return sum;
    }

    function stat(at, type, size) {
        bytesAt(at, 64).fill(0);
        view().setUint8(at + 16, type);
        view().setBigUint64(at + 32, BigInt(size), true);
        return OK;
    }

    const calls = {
        fd_prestat_get(fd, at) {
            if (fd !== FOLDER) {
                return BAD_DESCRIPTOR;
            }
            view().setUint8(at, 0);
            view().setUint32(at + 4, 1, true);
            return OK;
        },
        fd_prestat_dir_name(fd, at) {
            bytesAt(at, 1)[0] = 47; // "/"
            return OK;
        },
        fd_fdstat_get(fd, at) {
            bytesAt(at, 24).fill(0);
            view().setUint8(at, fd === FOLDER ? 3 : fd < FOLDER ? 2 : 4);
            view().setBigUint64(at + 8, ~0n & 0xffffffffffffffffn, true);
            view().setBigUint64(at + 16, ~0n & 0xffffffffffffffffn, true);
            return fd <= FOLDER || open.has(fd) ? OK : BAD_DESCRIPTOR;
        },
        fd_fdstat_set_flags: () => OK,
        path_open(fd, flags, path, length, oflags, base, inheriting, fdflags, result) {
            const name = textAt(path, length).replace(/^\.\//, "");
            if (files[name] === undefined && (oflags & CREATE) === 0) {
                return NO_ENTRY;
            }
            open.set(next, (oflags & CREATE) === 0 ? {bytes: files[name], at: 0} : {parts: made[name] = []});
            view().setUint32(result, next++, true);
            return OK;
        },
        path_filestat_get(fd, flags, path, length, at) {
            const bytes = files[textAt(path, length)];
            return bytes === undefined ? NO_ENTRY : stat(at, 4, bytes.length);
        },
        fd_filestat_get(fd, at) {
            const file = open.get(fd);
            return file === undefined ? stat(at, 2, 0) : stat(at, 4, (file.bytes || []).length);
        },
        fd_read(fd, list, count, result) {
            const file = open.get(fd);
            if (file === undefined || file.bytes === undefined) {
                return BAD_DESCRIPTOR;
            }
            const sum = pieces(list, count, (at, length) => {
                const part = file.bytes.subarray(file.at, file.at + length);
                bytesAt(at, part.length).set(part);
                file.at += part.length;
                return part.length;
            });
            view().setUint32(result, sum, true);
            return OK;
        },
        fd_write(fd, list, count, result) {
            const to = open.has(fd) ? open.get(fd).parts : written[fd];
            if (to === undefined) {
                return BAD_DESCRIPTOR;
            }
            const sum = pieces(list, count, (at, length) => {
                to.push(bytesAt(at, length).slice());
                return length;
            });
            view().setUint32(result, sum, true);
            return OK;
        },
        fd_seek(fd, offset, whence, result) {
            const file = open.get(fd);
            if (file === undefined || file.bytes === undefined) {
                return BAD_DESCRIPTOR;
            }
            file.at = Number(offset) + (whence === 0 ? 0 : whence === 1 ? file.at : file.bytes.length);
            view().setBigUint64(result, BigInt(file.at), true);
            return OK;
        },
        fd_close: (fd) => (open.delete(fd) ? OK : BAD_DESCRIPTOR),
        clock_time_get(id, precision, at) {
            const ms = id === 0 ? Date.now() : performance.now(); // of the day, or since the page began
            view().setBigUint64(at, BigInt(Math.round(ms * 1e6)), true);
            return OK;
        },
        environ_sizes_get(count, size) {
            view().setUint32(count, 0, true);
            view().setUint32(size, 0, true);
            return OK;
        },
        environ_get: () => OK,
        proc_exit(code) {
            throw new Error(`the program ended itself with ${code}`);
        },
    };
    const imports = {};
    for (const {module: from, name: wanted} of WebAssembly.Module.imports(module)) {
        imports[from] = imports[from] || {};
        imports[from][wanted] = calls[wanted] || (() => NOT_THERE);
    }
    const {exports} = await WebAssembly.instantiate(module, imports);
    memory = exports.memory;
    exports._initialize();
    function setName(name, text) {
        const at = exports.page_name_at(NAMES.indexOf(name));
        bytesAt(at, 256).fill(0);
        bytesAt(at, 255).set(new TextEncoder().encode(text).subarray(0, 255));
    }
    /* What the call `name` did since the last one: {status, out, said, files}. */
    function call(name, numbers) {
        const status = exports[name](...numbers);
        const done = {status, out: textOf(written[1]), said: textOf(written[2]), files: {}};
        for (const [file, parts] of Object.entries(made)) {
            done.files[file] = joined(parts);
        }
        written[1].length = written[2].length = 0;
        return done;
    }
    return {exports, bytesAt, setName, call};
}

/* An instance for each question: nothing of the one before is left. */
async function ask(module, {files, name, values}) {
    const instance = await begin(module, files || {});
    for (const [which, text] of Object.entries((values || {}).names || {})) {
        instance.setName(which, text);
    }
    return instance.call(name, (values || {}).numbers || []);
}

/* The line of a board has one instance, from one connection to the next. Returns a list of answers, one for each piece. */
let line = null;
const OCTETS_AT_ONCE = 4096; // page_live.c
async function hear(module, {octets, fresh}) {
    if (line === null || fresh) {
        line = await begin(module, {});
    }
    const answers = [];
    for (let at = 0; at < octets.length; at += OCTETS_AT_ONCE) {
        const part = octets.subarray(at, at + OCTETS_AT_ONCE);
        line.bytesAt(line.exports.page_live_octets(), part.length).set(part);
        answers.push(line.call("page_live_take", [part.length]));
    }
    return {status: Math.max(0, ...answers.map((a) => a.status)), said: answers.map((a) => a.said).join(""), answers};
}

/* A request for the board on that line: {status, out, said}. */
async function request(module, {request: numbers}) {
    if (line === null) {
        line = await begin(module, {});
    }
    return line.call("page_live_ask", numbers);
}

let module = null;
let before = Promise.resolve(); // one after the other, or the line's octets would change places
self.onmessage = ({data}) => {
    if (data.wasm) {
        before = WebAssembly.compile(data.wasm).then((compiled) => {
            module = compiled;
        });
        return;
    }
    before = before.then(async () => {
        try {
            self.postMessage({id: data.id, ...(await (data.octets ? hear : data.request ? request : ask)(module, data))});
        } catch (problem) {
            self.postMessage({id: data.id, status: 1, out: "", said: `iqfoc: ${problem.message}\n`, files: {}, answers: []});
        }
    });
};
