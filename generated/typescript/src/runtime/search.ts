/** The search for frames: where one may start, and what judges what begins there. */

import { Candidate, Cut, Failure, type Verdict } from "./candidate.js";
import { Fault } from "./errors.js";
import type { Sender } from "./sender.js";
import { startsOf, startsOfForms, type Starts } from "./starts.js";
import { Told } from "./told.js";

/** A possible frame of one sender, or of one of several. */
export interface Judge {
  /** The sender that the verdict is about. */
  readonly sender: Sender;
  push(byte: number): Verdict | null;
  flush(): Verdict;
}

/** A place in the first `size` bytes of some data. */
export interface Spot {
  readonly data: Uint8Array;
  readonly size: number;
  readonly place: number;
  /** True if nothing has come in front of it. */
  readonly isFresh: boolean;
}

/** Search for the frames of one sender, or of several forms at once. */
export class Search {
  readonly starts: Starts;
  readonly told: Told;
  private readonly each: readonly Starts[];

  /** Throws a RangeError where the frames are found in different ways. */
  constructor(readonly senders: readonly Sender[]) {
    this.told = new Told(senders);
    this.each = senders.map((sender) => startsOf(sender.frame));
    this.starts = senders.length === 1 ? this.each[0]! : startsOfForms(this.each);
    checkTogether(senders);
  }

  /** What begins there. */
  candidate(spot: Spot): Judge {
    this.told.beginFrame();
    const [first] = this.senders as readonly [Sender];
    if (this.senders.length === 1) return new Candidate(first, this.told.valuesFor(first));
    const begun = this.senders.flatMap((sender, index) => {
      const isBegun = hasBegun(sender, this.each[index]!, spot);
      return isBegun === null ? [] : [{ sender, isBegun }];
    });
    const told = this.told;
    return new FormsCandidate(
      begun.map(({ sender }) => new Candidate(sender, told.valuesFor(sender))),
      begun.map(({ isBegun }) => isBegun),
    );
  }

  /** What begins with the end of the frame before. */
  sharing(): Judge {
    this.told.beginFrame();
    const all = this.senders.map(
      (sender) => new Candidate(sender, this.told.valuesFor(sender), true),
    );
    return all.length === 1 ? all[0]! : new FormsCandidate(all, all.map(() => true));
  }
}

/** True if a frame may begin there, false if more bytes have to tell, null if none can. */
function hasBegun(sender: Sender, starts: Starts, spot: Spot): boolean | null {
  const { data, size, place, isFresh } = spot;
  if (isFresh && sender.frame.start === "after_end") return true;
  if (starts.find(data, size, place, place + 1) === place) return true;
  return place < size && starts.undecided(data, size, place) === place ? false : null;
}

/**
 * A possible frame of one of several forms. Of no use after its verdict.
 *
 * Where bytes are a valid frame of two forms, the first one wins, and a known message over a frame
 * whose identity is unknown.
 */
class FormsCandidate implements Judge {
  private readonly verdicts: (Verdict | null)[];
  private readonly isKnown: boolean[];
  private chosen = 0;

  constructor(
    private readonly candidates: readonly Candidate[],
    private readonly isBegun: readonly boolean[],
  ) {
    this.verdicts = candidates.map(() => null);
    this.isKnown = candidates.map(() => false);
  }

  get sender(): Sender {
    return this.candidates[this.chosen]!.sender;
  }

  push(byte: number): Verdict | null {
    this.candidates.forEach((candidate, index) => {
      if (!this.verdicts[index]) this.judge(index, candidate.push(byte));
    });
    return this.verdict();
  }

  flush(): Verdict {
    this.candidates.forEach((candidate, index) => {
      if (!this.verdicts[index]) this.judge(index, candidate.flush());
    });
    return this.verdict()!;
  }

  private judge(index: number, verdict: Verdict | null): void {
    const candidate = this.candidates[index]!;
    let found = verdict;
    if (verdict instanceof Cut) {
      try {
        const group = candidate.sender.group(verdict.values);
        if (group) candidate.sender.read(group, verdict.payload, verdict.values);
        this.isKnown[index] = group !== undefined;
      } catch (error) {
        if (!(error instanceof Fault)) throw error;
        found = new Failure(verdict.size, error);
      }
    } else if (verdict && !this.isBegun[index] && !candidate.beginsWithStart) {
      found = new Failure(0, verdict.fault); // No frame of it began here.
    }
    this.verdicts[index] = found;
  }

  /** The verdict, as soon as no form can change it. */
  private verdict(): Verdict | null {
    for (const [index, verdict] of this.verdicts.entries()) {
      if (!verdict) return null;
      if (verdict instanceof Cut && this.isKnown[index]) return this.choose(index);
    }
    const first = this.verdicts.findIndex((item) => item instanceof Cut);
    if (first >= 0) return this.choose(first);
    const sizes = this.verdicts.map((item) => item!.size);
    return this.choose(sizes.indexOf(Math.max(...sizes)));
  }

  private choose(index: number): Verdict {
    this.chosen = index;
    return this.verdicts[index]!;
  }
}

function checkTogether(senders: readonly Sender[]): void {
  const [first, ...others] = senders.map((sender) => kindOfStart(sender));
  if (others.some((other) => other !== first)) {
    const names = senders.map((sender) => sender.key).join(" and ");
    throw new RangeError(`frames of ${names} are found in different ways: name the sender`);
  }
}

/** What has to be the same in all forms. */
function kindOfStart({ frame }: Sender): string {
  if (frame.endsIdle) return `idle ${frame.start}`;
  if (frame.start === "word") {
    return frame.sharesDelimiter ? `shared ${frame.startBytes.join()}` : "word";
  }
  return frame.start === "after_end" ? `end ${frame.endIsUnique} ${frame.end.join()}` : "anywhere";
}
