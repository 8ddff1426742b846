/** The codec of a protocol: encode, decode, and an encoder that counts. */
import { makerOf } from "./assembly.js";
import { standsAt } from "./bytes.js";
import { Candidate, Failure, verdictOn } from "./candidate.js";
import { DecodeError, EncodeError, Fault } from "./errors.js";
import { framed, Source } from "./events.js";
import { NONE_GIVEN } from "./given.js";
import { Sender } from "./sender.js";
import { Told } from "./told.js";
/** Makes each frame in the first form that can be made. */
class FirstThatFits {
    constructor(forms) {
        this.forms = forms;
    }
    /** The frame. Throws the EncodeError of the last form. */
    make(message, parts, strict, counts) {
        const last = this.forms.length - 1;
        for (let index = 0; index < last; index++) {
            try {
                return this.forms[index].make(message, parts, strict, counts);
            }
            catch (error) {
                if (!(error instanceof EncodeError))
                    throw error;
            }
        }
        return this.forms[last].make(message, parts, strict, counts);
    }
}
/** What makes the frames of a message that all of these send, of which there is one at least. */
function makerOfAll(senders, name) {
    const makers = senders.map((sender) => makerOf(sender, sender.named(name)));
    return makers.length > 1 ? new FirstThatFits(makers) : makers[0];
}
/** What makes frames where such a sender and form are asked for. */
class Choice {
    constructor(sender, form) {
        this.sender = sender;
        this.form = form;
        /** By the names of messages. */
        this.makers = new Map();
    }
    is(sender, form) {
        return this.sender === sender && this.form === form;
    }
}
const NO_OPTIONS = {};
/** The senders of a protocol. */
export class Protocol {
    constructor(
    /** Give the frame of each sender; they are asked when one is first needed. */
    frames, 
    /** Names of the senders whose frames are alike, so that any may stand for the others. */
    alike) {
        this.frames = frames;
        this.alike = alike;
        this.kept = null;
        this.chosen = [];
        /** The one that was chosen last, and most often is chosen again. */
        this.recent = new Choice(undefined, undefined);
    }
    get made() {
        this.kept ?? (this.kept = this.frames.map((frame) => new Sender(frame())));
        return this.kept;
    }
    /** An endpoint as a sender, in each form of its frames. Throws a RangeError. */
    senders(name) {
        const found = this.made.filter((sender) => name === undefined || sender.frame.sender === name || sender.key === name);
        if (!found.length)
            throw new RangeError(`"${name}" sends nothing`);
        return found;
    }
    /** The event of exactly one frame. Throws a DecodeError. */
    read(frame, options = {}) {
        const senders = this.senders(options.sender);
        const told = new Told(senders);
        told.tell(options.told ?? {});
        told.beginFrame();
        let found = null;
        for (const sender of senders) {
            try {
                const values = told.valuesForOne(sender, options.told ?? {}, frame.length);
                return readAs(sender, frame, values);
            }
            catch (error) {
                if (!(error instanceof DecodeError))
                    throw error;
                if (!found || error.offset > found.offset)
                    found = error;
            }
        }
        throw found;
    }
    /** The message of exactly one frame. Throws a DecodeError. Modules know its type. */
    decode(frame, options = {}) {
        const event = this.read(frame, options);
        if (!event.message)
            throw new DecodeError("unknown", "no message has this identity");
        return event.message;
    }
    /** The frame of a message. Throws an EncodeError. */
    encode(message, options = NO_OPTIONS) {
        const { parts = NONE_GIVEN, strict = true } = options;
        return this.maker(message, options).make(message, parts, strict, null);
    }
    maker(message, options) {
        const { recent } = this;
        const isSame = recent.is(options.sender, options.form);
        return (isSame && recent.makers.get(message.message)) || this.another(message, options);
    }
    /** The same of a message that was not made with these options last. Throws an EncodeError. */
    another(message, options) {
        const { sender, form } = options;
        const { message: name } = message;
        const known = this.chosen.find((item) => item.is(sender, form));
        const choice = known ?? new Choice(sender, form);
        let maker = choice.makers.get(name);
        if (!maker)
            choice.makers.set(name, (maker = makerOfAll(this.choose(message, options), name)));
        if (!known)
            this.chosen.push(choice);
        this.recent = choice;
        return maker;
    }
    /** An endpoint that sends a message, in the forms that carry it. Throws an EncodeError. */
    choose(message, options) {
        const { message: name } = message;
        const all = this.made.filter((sender) => sender.named(name));
        const chosen = options.sender;
        const named = all.filter(({ frame, key }) => chosen === undefined || frame.sender === chosen || key === chosen);
        const [first] = named;
        if (!first) {
            const problem = all.length ? `${chosen} does not send ${name}` : `there is no ${name}`;
            throw new EncodeError("message", problem);
        }
        const names = [...new Set(named.map(({ frame }) => frame.sender))];
        if (names.length > 1 && !this.alike.some((set) => names.every((item) => set.includes(item)))) {
            throw new EncodeError("sender", `${name} needs a sender: ${names.join(" or ")}`);
        }
        const own = named.filter(({ frame }) => frame.sender === first.frame.sender);
        const inForm = own.filter(({ frame }) => options.form === undefined || frame.form === options.form);
        if (!inForm.length)
            throw new EncodeError("form", `"${options.form}" is no form of ${name}`);
        return inForm;
    }
}
function readAs(sender, data, told) {
    const { startWords } = sender.frame;
    if (startWords.length && !startWords.some((word) => standsAt(data, data.length, 0, word))) {
        throw new DecodeError("noise", "no frame starts so");
    }
    const [verdict, offset] = verdictOn(sender, data, told);
    if (verdict instanceof Failure) {
        throw new DecodeError(verdict.fault.reason, verdict.fault.problem, offset);
    }
    if (verdict.size < data.length) {
        const problem = `the frame has only ${verdict.size} of these ${data.length} bytes`;
        throw new DecodeError("size", problem, verdict.size);
    }
    try {
        return framed(new Source(sender, data.slice(), 0), 0, verdict);
    }
    catch (error) {
        if (!(error instanceof Fault))
            throw error;
        const place = Math.min(error.offset, verdict.payload.length);
        const offset = wireOffset(sender, data, told, place);
        throw new DecodeError(error.reason, error.problem, offset, error.path);
    }
}
/** Place of a byte of the payload in the frame, stuffing included. */
function wireOffset(sender, data, told, offset) {
    const candidate = new Candidate(sender, told);
    for (let place = 0; place < data.length; place++) {
        candidate.push(data[place]);
        if (candidate.contentSize > sender.frame.headSize + offset)
            return place;
    }
    return data.length;
}
/** Makes the frames of one endpoint, one after another, and advances their counters. */
export class Encoder {
    constructor(protocol, sender) {
        this.counts = new Map();
        /** By the names of messages. */
        this.known = new Map();
        this.senders = protocol.senders(sender);
        for (const part of this.senders.flatMap((sender) => sender.valueParts)) {
            if (part.isCounter)
                this.counts.set(part.name, part.default ?? part.least);
        }
    }
    /**
     * The frame of a message, with the next value of each counter that `parts` does not give.
     *
     * A given value is used once and does not change the count, nor does an EncodeError.
     */
    encode(message, options = NO_OPTIONS) {
        const { form, strict = true } = options;
        const { message: name } = message;
        let maker = form === undefined ? this.known.get(name) : undefined;
        if (!maker) {
            maker = this.maker(name, form);
            if (form === undefined)
                this.known.set(name, maker);
        }
        const parts = (options.parts ?? NONE_GIVEN);
        return maker.make(message, parts, strict, this.counts);
    }
    maker(name, form) {
        const senders = this.senders.filter((sender) => sender.named(name) && (form === undefined || sender.frame.form === form));
        if (!senders.length)
            throw new EncodeError("message", `${name} is not sent`);
        return makerOfAll(senders, name);
    }
}
