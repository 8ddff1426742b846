/** A serial port that is read until it is closed or lost. */

/** Names of what the system says of single characters, after which the port has a new stream. */
const PASSING = ["BreakError", "BufferOverrunError", "FramingError", "ParityError"];

export class Line {
  /** `on.bytes(bytes)`, `on.state(state)` and `on.error(error)` are called as things happen. */
  constructor(on) {
    this.on = on;
    this.port = null;
    this.reader = null;
    this.reading = null;
    this.writing = Promise.resolve();
    this.state = "closed";
  }

  /** Open a port, and read it. `signals` are put on the line at once; a port may have none. */
  async open(port, options, signals) {
    this.enter("opening");
    try {
      await port.open(options);
    } catch (error) {
      this.enter("closed");
      throw error;
    }
    this.port = port;
    try {
      await port.setSignals(signals);
    } catch (error) {
      this.on.error(error);
    }
    this.enter("open");
    this.reading = this.read();
  }

  /** Write bytes, behind those that are being written. */
  write(bytes) {
    const done = this.writing.then(() => this.writeNow(bytes));
    this.writing = done.catch(() => undefined);
    return done;
  }

  async writeNow(bytes) {
    if (this.state !== "open" || !this.port.writable) throw new Error("the port is not open");
    const writer = this.port.writable.getWriter();
    try {
      await writer.write(bytes);
    } finally {
      writer.releaseLock();
    }
  }

  async close() {
    if (this.state !== "open") return;
    this.enter("closing");
    await this.reader?.cancel().catch(() => undefined);
    await this.reading;
  }

  /** Read until nothing more can come, and let the port go. */
  async read() {
    while (this.state === "open" && this.port.readable) {
      if (!(await this.readStream(this.port.readable))) break;
    }
    const { port } = this;
    const isLost = this.state === "open";
    this.port = null;
    await this.writing;
    // A lost port has to be closed as well before it can be opened again.
    await port.close().catch((error) => isLost || this.on.error(error));
    this.enter(isLost ? "lost" : "closed");
  }

  /** Read a stream to its end; true if another one follows. */
  async readStream(stream) {
    this.reader = stream.getReader();
    try {
      for (;;) {
        const { value, done } = await this.reader.read();
        if (done) return false;
        this.on.bytes(value);
      }
    } catch (error) {
      this.on.error(error);
      return PASSING.includes(error.name);
    } finally {
      this.reader.releaseLock();
    }
  }

  enter(state) {
    this.state = state;
    this.on.state(state);
  }
}
