// A page to drop a .gic file on, or to watch a gi-server by: ?file=URL, ?scene=URL, ?server=URL.
import {GIClient, GILoader} from 'gicodec/three';

import {Graphs} from './graphs.js';
import {hideError, showError, showFacts, showProgress, showTitle} from './notices.js';
import {Stage} from './stage.js';
import {Timeline} from './timeline.js';

const find = (id) => document.getElementById(id);
const stage = new Stage(find('view'));
const timeline = new Timeline(() => stage.refresh(), showError);
let live = null, graphs = null, opened = [];  // what the file shows, without the one beside

const megabytes = (bytes) => `${(bytes * 1e-6).toFixed(bytes < 1e7 ? 2 : 1)} MB`;
const lightsOf = (object) => (object.isGroup ? [...object.children] : [object]);

/** Ends what is followed, and what is compared. */
function disconnect() {
  live?.dispose();
  graphs?.end();
  live = graphs = null;
  opened = [];
  stage.setLights([], true);
  if (find('difference').firstElementChild.checked) document.querySelector('[name=mode][value=both]').click();
  find('difference').hidden = true;
}

/** Shows a container: bytes, a File or a URL. `beside`: to be compared with what is shown. */
async function openContainer(source, name, beside = false) {
  const loader = new GILoader().detectSupport(stage.renderer);
  let size = source.size ?? source.byteLength ?? 0;
  const object = typeof source === 'string'
    ? await loader.loadAsync(source, ({loaded, total}) => { size = total; showProgress(total ? loaded / total : 0.5); })
    : await loader.parse(source);
  const lights = lightsOf(object);
  if (beside) {
    stage.setLights([object], true);
    timeline.follow([...opened, ...lights]);
    find('difference').hidden = false;
    find('difference').firstElementChild.click();
    return;
  }
  disconnect();
  stage.setLights([object]);
  opened = lights;
  timeline.follow(lights);
  showTitle(name);
  const [first] = lights;
  const probes = first.grid ?? first.resolution?.toArray();
  showFacts([['file', megabytes(size)], ['states', first.states.length], ...(probes ? [['probes', probes.join(' × ')]] : []),
             ...lights.filter(({isTextureVolume}) => isTextureVolume).map(({name: volume, textures}) => (
               [volume, `${[...textures.keys()].join(', ')}, which nothing on this page shades by`]))]);
  if (find('modes').querySelector(':checked').value !== 'direct' && !stage.lit) setProbes('light');
}

function setProbes(kind) {
  document.querySelector(`[name=probes][value=${kind}]`).checked = true;
  stage.probes = kind;
}

/** Follows a server, by packets of its own or, where there is no more room for such, by those of all. */
function connect(url, token, delivery = 'unicast') {
  const {host, username, password} = new URL(url);
  if (username || password) throw new TypeError('an address with a name or a password in front of its host is not followed');
  disconnect();
  hideError();
  timeline.follow([]);
  showTitle(host);
  const client = (live = new GIClient(stage.renderer, url, {delivery, ...(token ? {token} : {})}));
  graphs = new Graphs(find('graphs'));
  stage.setLights([client.object]);
  const retry = () => connect(url, token);
  let framed = false, lost = false, unseen = [];
  client.addEventListener('volumes', ({names}) => {
    const seen = client.object.children.map(({name}) => name);
    unseen = names.filter((name) => !seen.includes(name));
    if (!framed && !stage.lit) setProbes('light');
  });
  client.addEventListener('update', (event) => {
    graphs?.add(event);
    stage.refresh();
    if (lost) hideError();
    lost = false;
    if (!framed) { framed = true; if (!stage.lit) stage.frame(); }
    const {statistics, state} = client;
    showFacts([['received', megabytes(statistics.bytes)], ['updates', state.serial], ['time', `${state.time.toFixed(2)} s`],
               ...unseen.map((name) => [name, 'which nothing on this page shows'])]);
  });
  client.addEventListener('lost', ({wait, why}) => {
    lost = true;
    showError({message: `The connection was lost: ${why}.\nThe next try is in ${(wait * 1e-3).toFixed(1)} s.`}, retry);
  });
  client.addEventListener('closed', ({reason}) => {
    if (delivery === 'unicast' && reason.includes('unicast')) connect(url, token, 'shared');
    else showError({message: `The server ended the session: ${reason}`}, retry);
  });
  client.addEventListener('error', ({error}) => showError(error, retry));
}

/** Opens what was dropped or chosen: scenes first, then containers; a second one is compared. */
async function openFiles(list) {
  const files = [...list];
  const ending = ({name}) => name.slice(name.lastIndexOf('.')).toLowerCase();
  const scenes = files.filter((file) => ['.glb', '.gltf'].includes(ending(file)));
  const containers = files.filter((file) => ending(file) === '.gic');
  const strange = files.filter((file) => !scenes.includes(file) && !containers.includes(file));
  await guard(async () => {
    if (strange.length) throw new TypeError(`${strange.map(({name}) => name).join(', ')}: not a .gic, .glb or .gltf file`);
    for (const scene of scenes) await openScene(await scene.arrayBuffer());
    for (const [i, file] of containers.entries()) await openContainer(file, file.name, i > 0);
  });
}

async function openScene(source) {
  await stage.setModel(source, ({loaded, total}) => showProgress(total ? loaded / total : 0.5));
  setProbes('none');
}

async function guard(body) {
  hideError();
  showProgress(0.05);
  try {
    await body();
  } catch (error) {
    console.error(error);
    showError(error);
  } finally {
    showProgress(null);
  }
}

/** Asks for a server and a token, which is kept nowhere. */
async function askForServer(url, why = '') {
  const dialog = find('server');
  find('ask').textContent = why;
  find('url').value = url;
  find('token').value = '';
  dialog.returnValue = '';
  dialog.showModal();
  await new Promise((resolve) => dialog.addEventListener('close', resolve, {once: true}));
  const token = find('token').value;
  find('token').value = '';
  if (dialog.returnValue !== 'connect') return;
  try {
    connect(find('url').value, token);
  } catch (error) {
    showError(error);
  }
}

/** Where an address leads, whatever it looks like. */
function hostOf(url) {
  try {
    return new URL(url).host;
  } catch {
    return 'whose address is none';
  }
}

const ownServer = () => `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}`;

function listen() {
  find('files').onchange = ({target}) => openFiles(target.files);
  find('connect').onclick = () => askForServer(location.protocol.startsWith('http') ? ownServer() : '');
  find('toggle').onclick = ({target}) => {
    find('panel').hidden = !find('panel').hidden;
    target.setAttribute('aria-expanded', `${!find('panel').hidden}`);
  };
  for (const [name, set] of [['mode', (value) => { stage.mode = value; }], ['probes', (value) => { stage.probes = value; }],
                             ['camera', (value) => { stage.walking = value === 'walk'; find('view').focus(); }]]) {
    document.querySelectorAll(`[name=${name}]`).forEach((input) => { input.onchange = () => set(input.value); });
  }
  find('exposure').oninput = ({target}) => { stage.exposure = Number(target.value); };
  addEventListener('dragover', (event) => { event.preventDefault(); document.body.classList.add('dropping'); });
  addEventListener('dragleave', ({relatedTarget}) => relatedTarget || document.body.classList.remove('dropping'));
  addEventListener('drop', (event) => {
    event.preventDefault();
    document.body.classList.remove('dropping');
    openFiles(event.dataTransfer.files);
  });
  find('view').addEventListener('keydown', (event) => {
    const act = {Space: () => timeline.toggle(), Comma: () => timeline.step(-1), Period: () => timeline.step(1),
                 KeyF: () => stage.frame()}[event.code];
    if (act && !event.repeat) { event.preventDefault(); act(); }
  });
  stage.onframe = () => live?.setView(stage.camera);
}

/** A file that stands in this page: its bytes and its name; null: there is none. */
function inside(id) {
  const element = find(id);
  if (!element) return null;
  const text = atob(element.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  element.textContent = '';
  return {bytes, name: element.dataset.name};
}

/** What this page has inside, and what the address asks for. Another server than the page's own is asked about first. */
async function begin() {
  const [model, container] = ['scene', 'container'].map(inside);
  if (model) await guard(() => openScene(model.bytes.buffer));
  if (container) await guard(() => openContainer(container.bytes, container.name));
  if (container) return;  // it may connect to nothing
  const wanted = new URLSearchParams(location.search);
  const [file, scene, server] = ['file', 'scene', 'server'].map((name) => wanted.get(name));
  if (scene) await guard(() => openScene(new URL(scene, location.href).href));
  if (file) await guard(() => openContainer(new URL(file, location.href).href, new URL(file, location.href).pathname.split('/').at(-1)));
  if (server === null) return;
  const url = server === '' || server === '1' ? ownServer() : server;
  if (url.replace(/\/$/, '') === ownServer()) connect(url, '');
  else await askForServer(url, `The link to this page asks to connect to another server, ${hostOf(url)}. Connect only to one that you know.`);
}

listen();
if (matchMedia('(max-width: 640px)').matches) find('toggle').click();
begin();
