/** What has come in so far: by message and by reason, with rates. */

/** Milliseconds over which rates are taken. */
const SPAN = 5000;

/** Frames of one kind: how many, how often, and the last one. */
class Count {
  constructor(name, sender) {
    this.name = name;
    this.sender = sender;
    this.count = 0;
    this.size = 0;
    this.event = null;
    this.time = 0;
    this.times = [];
  }

  add(event, time) {
    this.count += 1;
    this.size += event.size;
    this.event = event;
    this.time = time;
    this.times.push(time);
    if (this.times.length > 2 && this.times[0] < time - 2 * SPAN) this.forget(time);
  }

  forget(now) {
    const from = this.times.findIndex((time) => time > now - SPAN);
    this.times = from < 0 ? [] : this.times.slice(from);
  }

  /** How many a second in the last seconds, or since `start`. */
  rate(now, start) {
    this.forget(now);
    return this.times.length / (Math.min(SPAN, Math.max(1000, now - start)) / 1000);
  }
}

export class Tally {
  constructor(now) {
    this.start = now;
    this.bytes = 0;
    this.frames = new Map();
    this.invalid = new Map();
  }

  /** Take a portion of the line and the events that it made certain. */
  add(size, events, time) {
    this.bytes += size;
    for (const event of events) {
      const [counts, name] =
        event.kind === "invalid"
          ? [this.invalid, event.reason]
          : [this.frames, event.kind === "message" ? event.message.message : ""];
      const key = `${event.sender} ${name}`;
      if (!counts.has(key)) counts.set(key, new Count(name, event.sender));
      counts.get(key).add(event, time);
    }
  }

  get messages() {
    return [...this.frames.values()].reduce((sum, item) => sum + item.count, 0);
  }

  get invalidBytes() {
    return [...this.invalid.values()].reduce((sum, item) => sum + item.size, 0);
  }
}
