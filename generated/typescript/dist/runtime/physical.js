/** Physical values: raw x factor + term, all divided by a divisor, exact as far as floats are. */
export function physical(raw, factor, term, divisor, some = []) {
    if (Array.isArray(raw))
        return raw.map((item) => physical(item, factor, term, divisor, some));
    if (raw === null || some.includes(raw))
        return null;
    return scaled(raw, factor, term, divisor);
}
function scaled(raw, factor, term, divisor) {
    if (typeof raw === "number") {
        const over = raw * Number(factor) + Number(term);
        if (Number.isSafeInteger(over) && divisor <= BigInt(Number.MAX_SAFE_INTEGER)) {
            return over / Number(divisor);
        }
        if (!Number.isInteger(raw))
            return (raw * Number(factor) + Number(term)) / Number(divisor);
    }
    return ratio(BigInt(raw) * factor + term, divisor);
}
/** The float nearest to a fraction, ties to even. */
function ratio(over, under) {
    if (over < 0n)
        return -ratio(-over, under);
    if (over === 0n)
        return 0;
    // So many bits that those behind the last one only tell on which side of a tie it lies.
    const shift = 66 - (over.toString(2).length - under.toString(2).length);
    const moved = shift > 0 ? over << BigInt(shift) : over;
    const divisor = shift > 0 ? under : under << BigInt(-shift);
    const quotient = moved / divisor;
    const sticky = moved % divisor ? 1n : 0n;
    return Number((quotient << 1n) | sticky) * 2 ** -(shift + 1);
}
/** The fraction that a float is. */
function exact(value) {
    let divisor = 1n;
    let over = value;
    while (!Number.isInteger(over)) {
        over *= 2;
        divisor *= 2n;
    }
    return [BigInt(over), divisor];
}
/** The whole number nearest to a fraction, ties to even. */
function rounded(over, under) {
    const [top, bottom] = under < 0n ? [-over, -under] : [over, under];
    let quotient = top / bottom;
    let left = top % bottom;
    if (left < 0n) {
        quotient -= 1n;
        left += bottom;
    }
    const twice = 2n * left;
    return twice > bottom || (twice === bottom && quotient & 1n) ? quotient + 1n : quotient;
}
/**
 * The raw integer nearest to a physical value, ties to even.
 *
 * Throws a RangeError where the wire can't hold it, or it is a special value: that would be read back
 * as no reading at all.
 */
export function nearest(value, factor, term, divisor, low, high, special) {
    if (!Number.isFinite(value))
        throw new RangeError(`${value} is no physical value`);
    const [over, under] = exact(value);
    const raw = rounded(over * divisor - term * under, factor * under);
    if (raw < low || raw > high)
        throw new RangeError(`${value} does not fit the wire`);
    if (special.some((item) => BigInt(item) === raw)) {
        throw new RangeError(`${value} would be sent as ${raw}, which means no reading`);
    }
    return raw;
}
