/** Integers that are written as text in payloads. */
/** Read an integer of so many digits. */
export function readDigits(reader, form, step) {
    return Number(readBigDigits(reader, form, step));
}
/** The same of more than 53 bits. */
export function readBigDigits(reader, form, step) {
    const { alphabet, size, bits, signed } = form;
    const at = reader.take(size, step);
    let raw = 0n;
    for (let index = at; index < at + size; index++) {
        const digit = alphabet.indexOf(String.fromCharCode(reader.bytes[index]));
        if (digit < 0)
            throw reader.fault(step, "value", "a character is no digit here");
        raw = raw * BigInt(alphabet.length) + BigInt(digit);
    }
    if (raw >> BigInt(bits))
        throw reader.fault(step, "value", `${raw} does not fit ${bits} bits`);
    return signed ? BigInt.asIntN(bits, raw) : raw;
}
/** Write an integer as so many digits. */
export function writeDigits(writer, value, form, step) {
    const { alphabet, size, bits } = form;
    let rest = BigInt.asUintN(bits, BigInt(value));
    const base = BigInt(alphabet.length);
    const at = writer.room(size);
    for (let index = at + size - 1; index >= at; index--) {
        writer.bytes[index] = alphabet.charCodeAt(Number(rest % base));
        rest /= base;
    }
    if (rest)
        throw writer.error(step, `${value} has more than ${size} digits`);
}
/** Read an integer as text. */
export function readNumeral(reader, form, step) {
    return Number(readBigNumeral(reader, form, step));
}
/** The same of more than 53 bits. */
export function readBigNumeral(reader, form, step) {
    if (form.separator !== undefined && form.leads) {
        if (!reader.left)
            throw reader.fault(step, "size", "the separator in front is missing");
        if (reader.bytes[reader.at] !== form.separator) {
            throw reader.fault(step, "value", "the separator in front is another byte");
        }
        reader.at++;
    }
    let end = reader.end;
    if (form.separator !== undefined) {
        const found = reader.bytes.subarray(reader.at, reader.end).indexOf(form.separator);
        if (found >= 0)
            end = reader.at + found;
    }
    let text = "";
    for (let index = reader.at; index < end; index++) {
        text += String.fromCharCode(reader.bytes[index]);
    }
    const value = numberIn(reader, form, text, step);
    reader.at = end;
    return value;
}
function numberIn(reader, form, text, step) {
    const mayBeEmpty = form.separator !== undefined && form.empty;
    if (!text && mayBeEmpty)
        return BigInt(form.absent);
    if (text.length < 1 || text.length > form.longest) {
        const problem = `needs 1 to ${form.longest} characters, not ${text.length}`;
        throw reader.fault(step, "size", problem);
    }
    if (form.base === 256) {
        const code = text.charCodeAt(0);
        if (mayBeEmpty && code === form.absent) {
            throw reader.fault(step, "value", "this character stands for none");
        }
        return BigInt(code);
    }
    const hasSign = form.signed && (text[0] === "+" || text[0] === "-");
    const digits = hasSign ? text.slice(1) : text;
    const point = form.fraction ? digits.indexOf(".") : -1;
    const front = point < 0 ? digits : digits.slice(0, point);
    const behind = point < 0 ? "" : digits.slice(point + 1);
    const own = behind.slice(0, form.fraction);
    const allowed = form.base === 10 ? /^[0-9]+$/ : /^[0-9A-Fa-f]+$/;
    if (!allowed.test(front + own) || /[^0]/.test(behind.slice(form.fraction))) {
        throw reader.fault(step, "value", `${JSON.stringify(text)} is no number here`);
    }
    const plain = front + own.padEnd(form.fraction, "0");
    const value = BigInt(form.base === 16 ? `0x${plain}` : plain);
    if (value > form.greatest) {
        throw reader.fault(step, "value", `${JSON.stringify(text)} has too many digits`);
    }
    return text[0] === "-" && hasSign ? -value : value;
}
/** Write an integer as text. */
export function writeNumeral(writer, value, form, step) {
    if (form.separator !== undefined && form.leads)
        writer.byte(form.separator);
    if (form.separator !== undefined && form.empty && value === form.absent)
        return;
    const least = form.signed ? -BigInt(form.greatest) : 0n;
    if (BigInt(value) < least || value > form.greatest) {
        throw writer.error(step, `${value} is not in ${least}..${form.greatest}`);
    }
    if (form.base === 256) {
        writer.byte(Number(value));
        return;
    }
    const plain = BigInt(value) < 0n ? -BigInt(value) : BigInt(value);
    const lower = plain.toString(form.base);
    let digits = form.upper ? lower.toUpperCase() : lower;
    digits = digits.padStart(form.padded + form.fraction, "0");
    if (form.fraction) {
        digits = `${digits.slice(0, -form.fraction)}.${digits.slice(-form.fraction)}`;
    }
    if (BigInt(value) < 0n)
        digits = `-${digits}`;
    for (let index = 0; index < digits.length; index++)
        writer.byte(digits.charCodeAt(index));
}
