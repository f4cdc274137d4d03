// What the page says: errors, progress, facts. All texts are text, wherever they come from.
const find = (id) => document.getElementById(id);

/** Shows an error; `again` adds a button that calls it. */
export function showError(error, again = null) {
  find('error').querySelector('p').textContent = error?.message ?? `${error}`;
  find('again').hidden = again === null;
  find('again').onclick = () => (hideError(), again());
  find('error').hidden = false;
}

export function hideError() {
  find('error').hidden = true;
}
find('dismiss').onclick = hideError;

/** A share from 0 to 1, or null when nothing loads. */
export function showProgress(share) {
  const bar = find('progress');
  bar.hidden = share === null;
  bar.firstElementChild.style.width = `${100 * (share ?? 0)}%`;
}

/** Pairs of a name and a value. */
export function showFacts(pairs) {
  find('facts').replaceChildren(...pairs.flatMap(([name, value]) => [['dt', name], ['dd', value]].map(([tag, text]) =>
    Object.assign(document.createElement(tag), {textContent: `${text}`}))));
}

export function showTitle(text) {
  find('title').textContent = text;
  document.title = text === 'gicodec' ? text : `${text} – gicodec`;
  find('hint').hidden = text !== 'gicodec';
}
