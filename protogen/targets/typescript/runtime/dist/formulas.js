/** Whole numbers that are worked out of fields. Divisors are above 0. */
export function floor(over, under) {
    return (over - modulo(over, under)) / under;
}
export function modulo(over, under) {
    return ((over % under) + under) % under;
}
export function elements(bytes, size) {
    if (modulo(bytes, size))
        return typeof bytes === "bigint" ? -1n : -1;
    return bytes / size;
}
/** The bits `low` to `high` of an integer, both included. */
export function bits(value, low, high) {
    const mask = (1n << BigInt(high - low + 1)) - 1n;
    return Number((BigInt(value) >> BigInt(low)) & mask);
}
/**
 * The number that counts so many elements, bytes or characters: times `factor`, and `offset` more,
 * it is the number of bytes, of which each element has `size`. What has none counts as none.
 */
export function counted(value, factor, offset, size) {
    const length = value?.length;
    const count = typeof length === "number" ? length : 0;
    return Math.floor((count * size - offset) / factor);
}
/** A list of some type that has no elements yet. */
export function noneOf(_values) {
    return [];
}
