// A navigator.serial of the standard's shape, with one port. `fake` plugs it, feeds it and tells what
// the page did with it. No browser lists a pseudo-terminal, so nothing else can stand for a device.
(() => {
  class Port extends EventTarget {
    constructor() {
      super();
      this.readable = this.writable = null;
      this.isThere = true;
      this.log = [];
      this.written = [];
    }

    getInfo() {
      return { usbVendorId: 0x2341, usbProductId: 0x43 };
    }

    async open(options) {
      if (this.readable) throw new DOMException("The port is already open.", "InvalidStateError");
      if (!this.isThere) throw new DOMException("Failed to open serial port.", "NetworkError");
      this.log.push(["open", { ...options }]);
      this.makeReadable();
      this.writable = new WritableStream({ write: (chunk) => void this.written.push(...chunk) });
    }

    makeReadable() {
      this.readable = new ReadableStream({ start: (controller) => (this.incoming = controller) });
    }

    async setSignals(signals) {
      this.log.push(["signals", { ...signals }]);
    }

    async close() {
      if (this.readable?.locked || this.writable?.locked) throw new TypeError("Cannot close a locked stream.");
      this.log.push(["close"]);
      this.readable = this.writable = null;
    }
  }

  class Serial extends EventTarget {
    granted = [];

    async getPorts() {
      return [...this.granted];
    }

    async requestPort() {
      if (!fake.isChosen) throw new DOMException("No port selected by the user.", "NotFoundError");
      if (!this.granted.includes(fake.port)) this.granted.push(fake.port);
      return fake.port;
    }
  }

  const serial = new Serial();
  const fake = {
    port: new Port(),
    isChosen: true,
    feed: (bytes) => fake.port.incoming.enqueue(Uint8Array.from(bytes)),
    /** The page has taken what came in. */
    async taken() {
      for (let turn = 0; turn < 10; turn++) await Promise.resolve();
    },
    /** Something that is wrong with one character: the port goes on with a new stream. */
    disturb(name) {
      const { incoming } = fake.port;
      fake.port.makeReadable();
      incoming.error(new DOMException("A character was wrong.", name));
    },
    unplug() {
      const { port } = fake;
      const { incoming } = port;
      port.isThere = false;
      port.readable = port.writable = null;
      incoming.error(new DOMException("The device has been lost.", "NetworkError"));
      fake.tell("disconnect");
    },
    plug() {
      fake.port.isThere = true;
      fake.tell("connect");
    },
    /** An event of the port, which bubbles to `serial`. */
    tell(name) {
      const event = new Event(name);
      Object.defineProperty(event, "target", { value: fake.port });
      serial.dispatchEvent(event);
    },
  };
  Object.defineProperty(Navigator.prototype, "serial", { value: serial, configurable: true });
  globalThis.fake = fake;
})();
