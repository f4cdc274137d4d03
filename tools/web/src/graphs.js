// Graphs of the last minute of a live session.
const SECONDS = 60;
const SERIES = [['Mbps', 'Mbit/s'], ['delay', 'ms later than the earliest'], ['decode', 'ms an update'], ['blocks', 'blocks/s']];

export class Graphs {
  #series = new Map();
  #arrivals = [];
  #second = {bytes: 0, blocks: 0, decode: [], delay: []};
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
    this.#second.delay.push(this.#behind(state.update));
  }

  /** Milliseconds by which an update comes later than the earliest of the last minute would have: updates are evenly spaced. */
  #behind(update) {
    const now = performance.now();
    if (update < (this.#arrivals.at(-1)?.update ?? 0)) this.#arrivals = [];  // another session
    this.#arrivals.push({now, update});
    while (now - this.#arrivals[0].now > 1000 * SECONDS) this.#arrivals.shift();
    const [first] = this.#arrivals;
    const interval = update > first.update ? (now - first.now) / (update - first.update) : 0;
    const late = this.#arrivals.map((one) => one.now - one.update * interval);
    return late.at(-1) - late.reduce((least, one) => Math.min(least, one), Infinity);
  }

  #tick() {
    const mean = (list) => (list.length ? list.reduce((a, b) => a + b) / list.length : 0);
    const {bytes, blocks, decode, delay} = this.#second;
    this.#second = {bytes: 0, blocks: 0, decode: [], delay: []};
    for (const [name, value] of [['Mbps', 8e-6 * bytes], ['delay', mean(delay)], ['decode', mean(decode)], ['blocks', blocks]]) {
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
