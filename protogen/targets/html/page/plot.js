/** A plot of a series on a canvas: of what falls on one column, the least and the greatest value. */

const MARGIN = { left: 70, right: 12, top: 10, bottom: 24 };
/** Spans that are kept of a series: more than a canvas has columns. */
const MOST = 8192;

/** Values that follow each other, of any number: spans of so many, each with its least and greatest. */
export class Series {
  spans = [];
  count = 0;
  step = 1;

  add(across, value) {
    if (this.count++ % this.step) {
      const last = this.spans[this.spans.length - 1];
      last.low = Math.min(last.low, value);
      last.high = Math.max(last.high, value);
    } else {
      if (this.spans.length === MOST) this.halve();
      this.spans.push({ across, low: value, high: value });
    }
    this.right = across;
  }

  /** Each span takes in the next. */
  halve() {
    this.step *= 2;
    this.spans = this.spans.filter((span, at) => {
      const { low, high } = this.spans[at + 1] ?? span;
      [span.low, span.high] = [Math.min(span.low, low), Math.max(span.high, high)];
      return at % 2 === 0;
    });
  }

  /** With values as a function of them that only rises or only falls has them. */
  scaled(physical) {
    for (const span of this.spans) {
      const both = [physical(span.low), physical(span.high)];
      [span.low, span.high] = [Math.min(...both), Math.max(...both)];
    }
    return this;
  }
}

export class Plot {
  constructor(canvas, series, across, unit) {
    this.canvas = canvas;
    this.series = series;
    this.across = across;
    this.unit = unit;
  }

  /** Draw, and say what is seen. */
  draw() {
    const { canvas, series: { spans, count, right } } = this;
    const scale = globalThis.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth || 600, canvas.clientHeight || 220];
    [canvas.width, canvas.height] = [width * scale, height * scale];
    const context = canvas.getContext("2d");
    context.scale(scale, scale);
    if (!count) return "no values";
    const left = spans[0].across;
    const low = spans.reduce((least, span) => Math.min(least, span.low), Infinity);
    const high = spans.reduce((most, span) => Math.max(most, span.high), -Infinity);
    const x = (value) => MARGIN.left + ((value - left) / (right - left || 1)) * (width - MARGIN.left - MARGIN.right);
    const y = (value) => height - MARGIN.bottom - ((value - low) / (high - low || 1)) * (height - MARGIN.top - MARGIN.bottom);
    const style = getComputedStyle(canvas);
    this.axes(context, style, { x, y, left, right, low, high, height });
    context.strokeStyle = style.getPropertyValue("--link");
    context.beginPath();
    for (const [at, least, most] of columns(spans, x)) {
      context.lineTo(at, y(least));
      if (most !== least) context.lineTo(at, y(most));
    }
    context.stroke();
    const unit = this.unit ? ` ${this.unit}` : "";
    const start = this.across === "s" ? 0 : left;
    const end = this.across === "s" ? right - left : right;
    return `${count} values from ${low}${unit} to ${high}${unit}, ${start} to ${Number(end.toPrecision(6))} ${this.across}`;
  }

  axes(context, style, { x, y, left, right, low, high, height }) {
    context.fillStyle = style.color;
    context.strokeStyle = style.getPropertyValue("--line");
    context.font = "12px sans-serif";
    const short = (value) => String(Number(value.toPrecision(6)));
    context.textAlign = "right";
    for (const value of low === high ? [low] : [low, (low + high) / 2, high]) {
      context.fillText(short(value), MARGIN.left - 6, y(value) + 4);
      context.beginPath();
      context.moveTo(MARGIN.left, y(value));
      context.lineTo(x(right), y(value));
      context.stroke();
    }
    const begin = this.across === "s" ? left : 0;
    context.textAlign = "left";
    context.fillText(short(left - begin), x(left), height - 6);
    context.textAlign = "right";
    context.fillText(`${short(right - begin)} ${this.across}`, x(right), height - 6);
  }
}

/** For each column of the canvas its place, and the least and the greatest value there. */
function columns(spans, x) {
  const found = [];
  for (const { across, low, high } of spans) {
    const at = Math.round(x(across) * 2) / 2;
    const last = found[found.length - 1];
    if (last && last[0] === at) {
      last[1] = Math.min(last[1], low);
      last[2] = Math.max(last[2], high);
    } else found.push([at, low, high]);
  }
  return found;
}
