// What the types of a generated package say: tsd reads this, and runs nothing.
import { expectAssignable, expectError, expectNotAssignable, expectType } from "tsd";
import * as matty from "./dist/matty.js";
import * as rn1 from "./dist/rn1.js";
import * as dagny from "./dist/dagny.js";

const decoder = new matty.Decoder("esp");
for (const event of decoder.feed(new Uint8Array(4))) {
  if (event.kind === "message") {
    expectType<matty.EspMessage>(event.message);
    expectType<number>(event.parts.counter);
    switch (event.message.message) {
      case "status":
        expectType<matty.Status>(event.message);
        expectType<number>(matty.statusAngleDeg(event.message));
        break;
      case "gps":
        expectType<string>(event.message.nmea);
        break;
      default:
        expectType<matty.Ack | matty.Nack>(event.message);
    }
  } else if (event.kind === "unknown") {
    expectType<Uint8Array>(event.payload);
  } else {
    expectAssignable<string>(event.reason);
  }
}

// A decoder of all endpoints gives the messages of all of them.
expectType<matty.Message>(matty.decode(new Uint8Array(0)));
expectType<matty.PcMessage>(matty.decode(new Uint8Array(0), { sender: "pc" }));
expectError(matty.decode(new Uint8Array(0), { sender: "nobody" }));
expectError(new matty.Decoder("nobody"));

expectType<Uint8Array>(matty.encode({ message: "go", speed: 1, steer: 2 }));
expectType<Uint8Array>(matty.encode({ message: "stop" }, { parts: { counter: 1 } }));
expectError(matty.encode({ message: "go", speed: 1 }));
expectError(matty.encode({ message: "go", speed: "1", steer: 2 }));
expectError(matty.encode({ message: "stop" }, { parts: { number: 1 } }));

// Enums are objects, and the unions of their values; a value without a name is a number.
expectType<1>(matty.RobotMode.remote);
expectAssignable<matty.RobotMode>(2);
expectNotAssignable<matty.RobotMode>(3);
expectAssignable<matty.Mode>({ message: "mode", mode: 3 });

const stream: TransformStream<Uint8Array, matty.Event<"esp">> = matty.decoderStream("esp");
expectType<ReadableStream<matty.Event<"esp">>>(stream.readable);
expectType<rn1.BrainMessage["message"]>({} as rn1.Senders["brain"]["message"]["message"]);
expectType<string>(dagny.jsonLine({} as dagny.Event));
