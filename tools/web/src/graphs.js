// Graphs of the last minute of a live session.
const SECONDS = 60;
const SERIES = [['Mbps', 'Mbit/s'], ['delay', 'ms behind the best'], ['decode', 'ms an update'], ['blocks', 'blocks/s']];

export class Graphs {
  #series = new Map();
  #best = Infinity;
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
    const delay = performance.now() - state.time * 1000;
    // A clock that jumps, such as that of a file that begins again, is a new one.
    if (Math.abs(delay - this.#best) > 60000) this.#best = delay;
    this.#best = Math.min(this.#best, delay);
    this.#second.bytes += Math.max(0, state.bytes - this.#bytes);
    this.#bytes = state.bytes;
    this.#second.blocks += blocks;
    this.#second.decode.push(decodeMs);
    this.#second.delay.push(delay - this.#best);
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
