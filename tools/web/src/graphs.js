// Graphs of the last minute of a live session.
const SECONDS = 60;
const SERIES = [['Mbps', 'Mbit/s'], ['delay', 'ms later than the earliest'], ['decode', 'ms an update'], ['blocks', 'blocks/s']];

const mean = (list) => (list.length ? list.reduce((a, b) => a + b) / list.length : 0);

export class Graphs {
  #series = new Map();
  #arrivals = [];
  #second = {bytes: 0, blocks: 0, decode: []};
  #bytes = 0;
  #timer;

  constructor(parent) {
    parent.hidden = false;
    parent.replaceChildren();
    for (const [name, unit] of SERIES) {
      const figure = document.createElement('figure');
      const [caption, value] = [document.createElement('figcaption'), document.createElement('output')];
      caption.append(Object.assign(document.createElement('span'), {textContent: `${name}, ${unit}`}), value);
      const canvas = document.createElement('canvas');
      figure.append(caption, canvas);
      parent.append(figure);
      this.#series.set(name, {canvas, value, points: []});
    }
    this.#timer = setInterval(() => this.#tick(), 1000);
    this.parent = parent;
  }

  /** Takes an update of a GIClient. */
  add({state, blocks, decodeMs}) {
    this.#second.bytes += Math.max(0, state.bytes - this.#bytes);
    this.#bytes = state.bytes;
    this.#second.blocks += blocks;
    this.#second.decode.push(decodeMs);
    if (state.update < (this.#arrivals.at(-1)?.update ?? 0)) this.#arrivals = [];  // another session
    this.#arrivals.push({at: performance.now(), update: state.update});
  }

  /**
   * Milliseconds by which the updates of the last second came later, in the mean, than the earliest of the last
   * minute would have: updates are evenly spaced.
   */
  #delay() {
    const now = performance.now();
    this.#arrivals = this.#arrivals.filter(({at}) => now - at <= 1000 * SECONDS);
    if (this.#arrivals.length < 2) return 0;
    const [first, last] = [this.#arrivals[0], this.#arrivals.at(-1)];
    const interval = last.update > first.update ? (last.at - first.at) / (last.update - first.update) : 0;
    const late = this.#arrivals.map(({at, update}) => at - update * interval);
    const least = late.reduce((best, one) => Math.min(best, one), Infinity);
    return mean(late.filter((_, i) => now - this.#arrivals[i].at <= 1000).map((one) => one - least));
  }

  #tick() {
    const {bytes, blocks, decode} = this.#second;
    this.#second = {bytes: 0, blocks: 0, decode: []};
    for (const [name, value] of [['Mbps', 8e-6 * bytes], ['delay', this.#delay()], ['decode', mean(decode)], ['blocks', blocks]]) {
      const series = this.#series.get(name);
      series.points.push(value);
      if (series.points.length > SECONDS) series.points.shift();
      series.value.textContent = value < 10 ? value.toFixed(2) : Math.round(value).toLocaleString();
      draw(series);
    }
  }

  end() {
    clearInterval(this.#timer);
    this.parent.hidden = true;
  }
}

function draw({canvas, points}) {
  const {clientWidth, clientHeight} = canvas, scale = devicePixelRatio;
  Object.assign(canvas, {width: clientWidth * scale, height: clientHeight * scale});
  const context = canvas.getContext('2d');
  const top = Math.max(...points, 1e-9);
  context.strokeStyle = getComputedStyle(canvas).getPropertyValue('--accent');
  context.lineWidth = 1.5 * scale;
  context.beginPath();
  points.forEach((value, i) => context.lineTo(i / (SECONDS - 1) * canvas.width, canvas.height * (1 - 0.95 * value / top)));
  context.stroke();
}
