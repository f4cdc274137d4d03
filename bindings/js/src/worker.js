// What runs in a worker: players by number, each with an instance of its own. The build makes one text
// of this and of what it imports, see workers.js.
import {GicodecError} from './error.js';
import {Instance} from './instance.js';
import {LocalPlayer} from './local_player.js';

const players = new Map();
let module = null;

/** Answers one message: {request, player, method, values}; `post` is postMessage. */
export async function answer({request, player, method, values}, post) {
  try {
    let result;
    if (method === 'module') {
      module = values[0];
    } else if (method === 'create') {
      players.set(player, new LocalPlayer(await Instance.create(module)));
    } else if (method === 'close') {
      players.delete(player);
    } else {
      result = players.get(player)[method](...values);
    }
    post({request, result: portable(result)}, ArrayBuffer.isView(result) && result.buffer instanceof ArrayBuffer ? [result.buffer] : []);
  } catch (error) {
    const {message, status} = error;
    post({request, error: {message, status: error instanceof GicodecError ? status : undefined,
                           type: error.name}}, []);
  }
}

/** A container's textures without the constructors of their arrays, which cannot be posted. */
function portable(result) {
  if (!result?.textures) return result;
  return {...result, textures: result.textures.map(({ArrayType, ...desc}) =>
    (ArrayType ? {...desc, arrayType: ArrayType.name} : desc))};
}

if (typeof self !== 'undefined' && typeof self.postMessage === 'function') {
  self.onmessage = ({data}) => answer(data, (message, transfer) => self.postMessage(message, transfer));
}
