/* The numbers of a page's charts: unpacked (chart_column.h), and thinned to what a width can show. */
"use strict";
const iqfocNumbers = (() => {
    function bytesOf(text) {
        const raw = atob(text);
        const bytes = new Uint8Array(raw.length);
        for (let n = 0; n < raw.length; n++) {
            bytes[n] = raw.charCodeAt(n);
        }
        return bytes;
    }

    function numbersOf(text, size, get) {
        const bytes = bytesOf(text);
        const view = new DataView(bytes.buffer);
        const numbers = new Float64Array(bytes.length / size);
        for (let n = 0; n < numbers.length; n++) {
            numbers[n] = view[get](n * size, true);
        }
        return numbers;
    }

    /* A column as chart_column.h describes it; a gap is NaN. */
    function columnOf(c) {
        if (c.pieces) {
            const numbers = new Float64Array(c.pieces.reduce((sum, piece) => sum + piece[2], 0));
            let at = 0;
            for (const [first, step, count] of c.pieces) {
                for (let n = 0; n < count; n++) {
                    numbers[at++] = first + n * step;
                }
            }
            return numbers;
        }
        if (c.f8 !== undefined) {
            return numbersOf(c.f8, 8, "getFloat64");
        }
        if (c.f4 !== undefined) {
            return numbersOf(c.f4, 4, "getFloat32");
        }
        return numbersOf(c.i2, 2, "getInt16").map((n) => (n === -32768 ? NaN : c.middle + n * c.step));
    }

    const gapOf = (y, log) => (y === undefined ? undefined : y === null || Number.isNaN(y) || (log && y <= 0) ? null : y);

    /* The first index whose x is not below `wanted`. */
    function indexOf(x, wanted) {
        let low = 0;
        let high = x.length;
        while (low < high) {
            const mid = (low + high) >> 1;
            if (x[mid] < wanted) {
                low = mid + 1;
            } else {
                high = mid;
            }
        }
        return low;
    }

    /* [x, y...] between two x as uPlot takes it: every row where there are few; else, of each bucket of rows, the least and the
     * greatest value of each curve in their order, so that no peak is lost. A row without any value separates curves, and divides
     * its bucket. */
    function seenOf(tables, low, high, width, log) {
        const x = tables[0];
        const from = Math.max(indexOf(x, low) - 1, 0);
        const to = Math.min(indexOf(x, high) + 1, x.length);
        const buckets = Math.max(2 * width, 200);
        if (to - from <= 4 * buckets) {
            return tables.map((t, k) => Array.from(t.slice(from, to), (y) => (k === 0 ? y : gapOf(y, log))));
        }
        const size = (to - from) / buckets;
        const seen = tables.map(() => []);
        const isGap = (n) => tables.every((t, k) => k === 0 || t[n] == null || t[n] !== t[n]);
        const put = (first, end) => {
            seen[0].push(x[first], x[end - 1]);
            for (let k = 1; k < tables.length; k++) {
                const y = tables[k];
                let least = -1;
                let most = -1;
                for (let n = first; n < end; n++) {
                    const value = y[n];
                    if (value != null && value === value && !(log && value <= 0)) {
                        least = least < 0 || value < y[least] ? n : least;
                        most = most < 0 || value > y[most] ? n : most;
                    }
                }
                if (least < 0) {
                    seen[k].push(null, null);
                } else {
                    seen[k].push(y[Math.min(least, most)], y[Math.max(least, most)]);
                }
            }
        };
        for (let b = 0; b < buckets; b++) {
            let first = from + Math.floor(b * size);
            const end = from + Math.floor((b + 1) * size);
            for (let n = first; n < end; n++) {
                if (isGap(n)) {
                    if (n > first) {
                        put(first, n);
                    }
                    put(n, n + 1);
                    while (n + 1 < end && isGap(n + 1)) {
                        n++;
                    }
                    first = n + 1;
                }
            }
            if (first < end) {
                put(first, end);
            }
        }
        return seen;
    }

    /* The curves of a chart over one x. */
    function tablesOf(chart, columns) {
        const xs = [...new Set(chart.series.map((s) => s.x))];
        if (xs.length === 1) {
            return [columns[xs[0]], ...chart.series.map((s) => columns[s.y])];
        }
        const plain = (c) => Array.from(c, (y) => (Number.isNaN(y) ? null : y));
        const joined = uPlot.join(chart.series.map((s) => [plain(columns[s.x]), plain(columns[s.y])]));
        return joined.map((column) => (column.every((y) => y != null) ? Float64Array.from(column) : column));
    }

    return {columnOf, seenOf, tablesOf};
})();
