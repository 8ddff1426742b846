// CPU time of contenders by turns, so that whatever else the machine does befalls them alike.

/** Microseconds of one measurement, at least. */
const LEAST = 25_000;
/** Microseconds that everything runs before, so that it is compiled. */
const WARM = 600_000;

/** Nanoseconds of CPU time that each run takes, in each of the rounds. */
export async function measure(runs, rounds, least = LEAST, warm = WARM) {
  const names = Object.keys(runs);
  const times = {};
  const found = {};
  for (const name of names) {
    found[name] = [];
    for (let taken = 0; taken < warm; ) taken += await timed(runs[name], 1);
  }
  for (const name of names) {
    times[name] = await calibrated(runs[name], least);
  }
  for (let round = 0; round < rounds; round++) {
    for (const name of round % 2 ? names.toReversed() : names) {
      await runs[name](); // In the processor's caches is what the one before had.
      found[name].push(((await timed(runs[name], times[name])) / times[name]) * 1000);
    }
  }
  return found;
}

/** Number of runs that take long enough. */
async function calibrated(run, least) {
  let times = 1;
  for (let taken = 0; ; times = Math.max(times + 1, Math.ceil((times * 1.2 * least) / Math.max(taken, least / 100)))) {
    taken = await timed(run, times);
    if (taken >= least) return times;
  }
}

async function timed(run, times) {
  const start = process.cpuUsage();
  for (let count = 0; count < times; count++) {
    const pending = run();
    if (pending instanceof Promise) await pending;
  }
  const { user, system } = process.cpuUsage(start);
  return user + system;
}
