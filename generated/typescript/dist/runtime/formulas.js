/** Whole numbers that are worked out of fields. Divisors are above 0. */
/** The quotient, rounded down. */
export function floor(over, under) {
    return Math.floor(over / under);
}
/** What remains, which is never negative. */
export function modulo(over, under) {
    return ((over % under) + under) % under;
}
/** Elements of this size in so many bytes; -1 where a part is left. */
export function elements(bytes, size) {
    return modulo(bytes, size) ? -1 : floor(bytes, size);
}
/** The quotient, rounded down. */
export function floorBig(over, under) {
    return (over - moduloBig(over, under)) / under;
}
/** What remains, which is never negative. */
export function moduloBig(over, under) {
    return ((over % under) + under) % under;
}
/** Elements of this size in so many bytes; -1 where a part is left. */
export function elementsBig(bytes, size) {
    return moduloBig(bytes, size) ? -1n : floorBig(bytes, size);
}
/** The bits `low` to `high` of an integer, both included. */
export function bits(value, low, high) {
    const mask = (1n << BigInt(high - low + 1)) - 1n;
    return Number((BigInt(value) >> BigInt(low)) & mask);
}
/** Elements, bytes or characters of a value; 0 of what has none. */
export function sizeOf(value) {
    const length = value?.length;
    return typeof length === "number" ? length : 0;
}
/** A list of some type that has no elements yet. */
export function noneOf(_values) {
    return [];
}
