/* The thread that computes: page.wasm with the few calls of WASI that it makes, and the files that the page gave it. */
"use strict";

const OK = 0, BAD_DESCRIPTOR = 8, NO_ENTRY = 44, NOT_THERE = 52;
const FOLDER = 3;

/* An instance for each question: nothing of the one before is left. Returns {status, out, said}. */
async function ask(module, files, name, values) {
    const open = new Map(); // descriptor: {bytes, at}
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
            const bytes = files[textAt(path, length)];
            if (bytes === undefined) {
                return NO_ENTRY;
            }
            open.set(next, {bytes, at: 0});
            view().setUint32(result, next++, true);
            return OK;
        },
        path_filestat_get(fd, flags, path, length, at) {
            const bytes = files[textAt(path, length)];
            return bytes === undefined ? NO_ENTRY : stat(at, 4, bytes.length);
        },
        fd_filestat_get: (fd, at) => (open.has(fd) ? stat(at, 4, open.get(fd).bytes.length) : stat(at, 2, 0)),
        fd_read(fd, list, count, result) {
            const file = open.get(fd);
            if (file === undefined) {
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
            if (written[fd] === undefined) {
                return BAD_DESCRIPTOR;
            }
            const sum = pieces(list, count, (at, length) => {
                written[fd].push(bytesAt(at, length).slice());
                return length;
            });
            view().setUint32(result, sum, true);
            return OK;
        },
        fd_seek(fd, offset, whence, result) {
            const file = open.get(fd);
            if (file === undefined) {
                return BAD_DESCRIPTOR;
            }
            file.at = Number(offset) + (whence === 0 ? 0 : whence === 1 ? file.at : file.bytes.length);
            view().setBigUint64(result, BigInt(file.at), true);
            return OK;
        },
        fd_close: (fd) => (open.delete(fd) ? OK : BAD_DESCRIPTOR),
        clock_time_get(id, precision, at) {
            view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
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
    for (const [where, text] of Object.entries(values.names || {})) {
        const at = exports[where]();
        bytesAt(at, 256).fill(0);
        bytesAt(at, 255).set(new TextEncoder().encode(text).subarray(0, 255));
    }
    const status = exports[name](...(values.numbers || []));
    const text = (parts) => new TextDecoder().decode(new Uint8Array(parts.flatMap((part) => [...part])));
    return {status, out: text(written[1]), said: text(written[2])};
}

let module = null;
self.onmessage = async ({data}) => {
    try {
        if (data.wasm) {
            module = await WebAssembly.compile(data.wasm);
            return;
        }
        while (module === null) {
            await new Promise((go) => setTimeout(go, 10));
        }
        self.postMessage({id: data.id, ...(await ask(module, data.files || {}, data.name, data.values || {}))});
    } catch (problem) {
        self.postMessage({id: data.id, status: 1, out: "", said: `iqfoc: ${problem.message}\n`});
    }
};
