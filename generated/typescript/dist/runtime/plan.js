/** What a generated module says of a sender: its frame, as the compiler worked it out. */
/** A number as a part. */
export function single(part) {
    return { kind: "number", name: part.name, size: part.number.size, part };
}
/** What an object has of its own by a name: every object inherits a `constructor`, for example. */
export function ownOf(given, name) {
    return Object.prototype.hasOwnProperty.call(given, name) ? given[name] : undefined;
}
/** None of them. */
export const NO_PARTS = {};
/**
 * The plan of a message of one size, or of sizes from the least to the greatest in steps.
 *
 * Without `more`, it has no parts of the frame as fields, and what is known of it is its one size.
 */
export function plan(name, identities, [least, greatest = least, step = 0], read, write, more = {}) {
    const sizes = { least, greatest, step };
    const { known = step ? null : least, tellsItsEnd = false, held = [] } = more;
    return { name, identities, sizes, known, tellsItsEnd, held, read, write };
}
/** A group; without `more`, its identities and the sizes in frames are those of its messages. */
export function group(messages, more = {}) {
    const { identities = messages[0].identities } = more;
    const { carried = messages.map((message) => message.sizes) } = more;
    const [{ least }] = carried;
    const isFixed = carried.every((sizes) => sizes.least === least && sizes.greatest === least);
    const greatest = Math.max(...messages.map((message) => message.sizes.greatest));
    return { identities, messages, fixed: isFixed ? least : null, greatest, carried };
}
/** What is so of most frames. */
const USUAL = {
    form: "",
    startIsUnique: false,
    endIsUnique: false,
    sharesDelimiter: false,
    endsIdle: false,
    sevenBit: false,
    rescans: false,
    takesWhole: false,
    whole: null,
    put: null,
    cutAmbiguous: false,
    isBounded: false,
    isCut: false,
    identityIsEarly: false,
    told: [],
    virtual: [],
    shown: [],
    sums: [],
    groups: [],
    transparency: null,
    kept: null,
    encodeOnly: [],
};
/** A frame, of which is said what is not so of most. */
export function frame(given) {
    return { ...USUAL, ...given };
}
/** The place in the content of a frame with such a payload. */
export function at(place, headSize, payload) {
    if (!place.isTail)
        return place.offset;
    return headSize + payload + place.offset - (payload ? 0 : place.absent);
}
export function holds(sizes, size) {
    if (size < sizes.least || size > sizes.greatest)
        return false;
    return sizes.step === 0 || (size - sizes.least) % sizes.step === 0;
}
/** True if the values are some of these identities. */
export function areAmong(identities, values) {
    return identities.every((runs, index) => {
        const value = values[index];
        return runs.some(([first, last]) => first <= value && value <= last);
    });
}
