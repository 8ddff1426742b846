/** Bytes on the wire that carry each byte of a frame's parts. */

const plain = (bytes) => Array.from(bytes, (byte) => ({ byte, wire: [byte] }));

/** Take the frame apart into units: a byte of content, and its bytes on the wire. */
export function unstuff(sender, frame, data) {
  const { region } = sender;
  const nothing = { code: [], rest: [], fault: "", behind: [] };
  if (!region) return { ...nothing, units: plain(data) };
  const start = Math.min(data.length, region.before);
  const end = Math.max(start, data.length - closing(sender, data));
  const first = [...data.slice(start, Math.min(end, start + region.code))];
  const code = first[0] === 0 ? [] : first;
  const { units, rest, fault } = unstuffed(frame.transparency.decoder(), [...data.slice(start, end)], code.length);
  const [before, behind] = [plain(data.slice(0, start)), plain(data.slice(end))];
  if (rest.length || fault || units.length < region.least) {
    return { units: [...before, ...units], code, rest, fault, behind };
  }
  return { ...nothing, units: [...before, ...units, ...behind], code };
}

/** Bytes behind the region; 0 where the closing literal is missing, as the frame is cut. */
function closing(sender, data) {
  const last = sender.last ?? [];
  const tail = data.slice(data.length - last.length);
  const isClosed = tail.length === last.length && last.every((byte, at) => tail[at] === byte);
  return isClosed ? sender.region.behind : 0;
}

function unstuffed(unstuffer, region, code) {
  const units = [];
  let done = code;
  let fault = "";
  const share = (released, held) => {
    released.forEach((byte, index) => {
      const isLast = index === released.length - 1;
      units.push({ byte, wire: held.slice(index, isLast ? undefined : index + 1) });
    });
  };
  try {
    region.forEach((byte, index) => {
      const released = [...unstuffer.push(byte)];
      if (!released.length) return;
      share(released, region.slice(done, index + 1));
      done = index + 1;
    });
    share([...unstuffer.finish()], region.slice(done));
  } catch (error) {
    if (!error.reason) throw error;
    fault = error.problem;
  }
  const carried = units.reduce((sum, unit) => sum + unit.wire.length, code);
  return { units, rest: region.slice(carried), fault };
}
