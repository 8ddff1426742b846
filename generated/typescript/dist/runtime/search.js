/** The search for frames: where one may start, and what judges what begins there. */
import { Candidate, Cut, Failure } from "./candidate.js";
import { Fault } from "./errors.js";
import { startsOf, startsOfForms } from "./starts.js";
import { Told } from "./told.js";
/** Search for the frames of one sender, or of several forms at once. */
export class Search {
    /** Throws a RangeError where the frames are found in different ways. */
    constructor(senders) {
        this.senders = senders;
        this.told = new Told(senders);
        this.each = senders.map((sender) => startsOf(sender.frame));
        this.starts = senders.length === 1 ? this.each[0] : startsOfForms(this.each);
        checkTogether(senders);
    }
    /** What begins there. */
    candidate(spot) {
        this.told.beginFrame();
        const [first] = this.senders;
        if (this.senders.length === 1)
            return new Candidate(first, this.told.valuesFor(first));
        const begun = this.senders.flatMap((sender, index) => {
            const isBegun = hasBegun(sender, this.each[index], spot);
            return isBegun === null ? [] : [{ sender, isBegun }];
        });
        const told = this.told;
        return new FormsCandidate(begun.map(({ sender }) => new Candidate(sender, told.valuesFor(sender))), begun.map(({ isBegun }) => isBegun));
    }
    /** What begins with the end of the frame before. */
    sharing() {
        this.told.beginFrame();
        const all = this.senders.map((sender) => new Candidate(sender, this.told.valuesFor(sender), true));
        return all.length === 1 ? all[0] : new FormsCandidate(all, all.map(() => true));
    }
}
/** True if a frame may begin there, false if more bytes have to tell, null if none can. */
function hasBegun(sender, starts, spot) {
    const { data, size, place, isFresh } = spot;
    if (isFresh && sender.frame.start === "after_end")
        return true;
    if (starts.find(data, size, place, place + 1) === place)
        return true;
    return place < size && starts.undecided(data, size, place) === place ? false : null;
}
/**
 * A possible frame of one of several forms. Of no use after its verdict.
 *
 * Where bytes are a valid frame of two forms, the first one wins, and a known message over a frame
 * whose identity is unknown.
 */
class FormsCandidate {
    constructor(candidates, isBegun) {
        this.candidates = candidates;
        this.isBegun = isBegun;
        this.chosen = 0;
        this.verdicts = candidates.map(() => null);
        this.isKnown = candidates.map(() => false);
    }
    get sender() {
        return this.candidates[this.chosen].sender;
    }
    push(byte) {
        this.candidates.forEach((candidate, index) => {
            if (!this.verdicts[index])
                this.judge(index, candidate.push(byte));
        });
        return this.verdict();
    }
    flush() {
        this.candidates.forEach((candidate, index) => {
            if (!this.verdicts[index])
                this.judge(index, candidate.flush());
        });
        return this.verdict();
    }
    judge(index, verdict) {
        const candidate = this.candidates[index];
        let found = verdict;
        if (verdict instanceof Cut) {
            try {
                const group = candidate.sender.group(verdict.values);
                if (group)
                    candidate.sender.read(group, verdict.payload, verdict.values);
                this.isKnown[index] = group !== undefined;
            }
            catch (error) {
                if (!(error instanceof Fault))
                    throw error;
                found = new Failure(verdict.size, error);
            }
        }
        else if (verdict && !this.isBegun[index] && !candidate.beginsWithStart) {
            found = new Failure(0, verdict.fault); // No frame of it began here.
        }
        this.verdicts[index] = found;
    }
    /** The verdict, as soon as no form can change it. */
    verdict() {
        for (const [index, verdict] of this.verdicts.entries()) {
            if (!verdict)
                return null;
            if (verdict instanceof Cut && this.isKnown[index])
                return this.choose(index);
        }
        const first = this.verdicts.findIndex((item) => item instanceof Cut);
        if (first >= 0)
            return this.choose(first);
        const sizes = this.verdicts.map((item) => item.size);
        return this.choose(sizes.indexOf(Math.max(...sizes)));
    }
    choose(index) {
        this.chosen = index;
        return this.verdicts[index];
    }
}
function checkTogether(senders) {
    const [first, ...others] = senders.map((sender) => kindOfStart(sender));
    if (others.some((other) => other !== first)) {
        const names = senders.map((sender) => sender.key).join(" and ");
        throw new RangeError(`frames of ${names} are found in different ways: name the sender`);
    }
}
/** What has to be the same in all forms. */
function kindOfStart({ frame }) {
    if (frame.endsIdle)
        return `idle ${frame.start}`;
    if (frame.start === "word") {
        return frame.sharesDelimiter ? `shared ${frame.startBytes.join()}` : "word";
    }
    return frame.start === "after_end" ? `end ${frame.endIsUnique} ${frame.end.join()}` : "anywhere";
}
