/** Search for places where a frame may start. */
import { standsAt } from "./bytes.js";
function startWords(words) {
    const wordSize = words[0].length;
    const begins = new Uint8Array(256);
    for (const word of words)
        begins[word[0]] = 1;
    const [first] = words;
    function stands(data, size, place) {
        return words.length === 1
            ? standsAt(data, size, place, first)
            : words.some((word) => standsAt(data, size, place, word));
    }
    return {
        context: 0,
        find(data, size, low, high) {
            const last = Math.min(high, size - wordSize + 1);
            for (let place = low; place < last; place++) {
                if (!begins[data[place]])
                    continue;
                if (wordSize === 1 || stands(data, size, place))
                    return place;
            }
            return -1;
        },
        undecided(data, size, low) {
            for (let place = Math.max(low, size - wordSize + 1); place < size; place++) {
                if (!begins[data[place]])
                    continue;
                const left = data.subarray(place, size);
                if (words.some((word) => standsAt(word, word.length, 0, left)))
                    return place;
            }
            return size;
        },
    };
}
function behind(end) {
    return {
        context: end.length,
        find(data, size, low, high) {
            for (let place = low; place < high && place <= size; place++) {
                if (standsAt(data, size, place - end.length, end))
                    return place;
            }
            return -1;
        },
        undecided: (_data, size) => size,
    };
}
const ANYWHERE = {
    context: 0,
    find: (_data, _size, low, high) => (low < high ? low : -1),
    undecided: (_data, size) => size,
};
/** The search for the starts of such frames. */
export function startsOf(frame) {
    if (frame.start === "word")
        return startWords(frame.startWords);
    return frame.start === "after_end" ? behind(frame.end) : ANYWHERE;
}
/** The search for the starts of frames of several forms. */
export function startsOfForms(each) {
    return {
        context: Math.max(...each.map((starts) => starts.context)),
        find(data, size, low, high) {
            const found = each.map((starts) => starts.find(data, size, low, high));
            const places = found.filter((place) => place >= 0);
            return places.length ? Math.min(...places) : -1;
        },
        undecided: (data, size, low) => Math.min(...each.map((starts) => starts.undecided(data, size, low))),
    };
}
