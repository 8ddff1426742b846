/** A plot of points on a canvas: of those that fall on one column, the least and the greatest. */

const MARGIN = { left: 70, right: 12, top: 10, bottom: 24 };

export class Plot {
  constructor(canvas, points, across, unit) {
    this.canvas = canvas;
    this.points = points;
    this.across = across;
    this.unit = unit;
  }

  /** Draw, and say what is seen. */
  draw() {
    const { canvas, points } = this;
    const scale = globalThis.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth || 600, canvas.clientHeight || 220];
    [canvas.width, canvas.height] = [width * scale, height * scale];
    const context = canvas.getContext("2d");
    context.scale(scale, scale);
    if (!points.length) return "no values";
    const bounds = (place) =>
      points.reduce(([least, most], point) => [Math.min(least, point[place]), Math.max(most, point[place])], [Infinity, -Infinity]);
    const [[left, right], [low, high]] = [bounds(0), bounds(1)];
    const x = (value) => MARGIN.left + ((value - left) / (right - left || 1)) * (width - MARGIN.left - MARGIN.right);
    const y = (value) => height - MARGIN.bottom - ((value - low) / (high - low || 1)) * (height - MARGIN.top - MARGIN.bottom);
    const style = getComputedStyle(canvas);
    this.axes(context, style, { x, y, left, right, low, high, height });
    context.strokeStyle = style.getPropertyValue("--link");
    context.beginPath();
    for (const [at, least, most] of columns(points, x)) {
      context.lineTo(at, y(least));
      if (most !== least) context.lineTo(at, y(most));
    }
    context.stroke();
    const unit = this.unit ? ` ${this.unit}` : "";
    const start = this.across === "s" ? 0 : left;
    const end = this.across === "s" ? right - left : right;
    return `${points.length} values from ${low}${unit} to ${high}${unit}, ${start} to ${Number(end.toPrecision(6))} ${this.across}`;
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
function columns(points, x) {
  const found = [];
  for (const [across, value] of points) {
    const at = Math.round(x(across) * 2) / 2;
    const last = found[found.length - 1];
    if (last && last[0] === at) {
      last[1] = Math.min(last[1], value);
      last[2] = Math.max(last[2], value);
    } else found.push([at, value, value]);
  }
  return found;
}
