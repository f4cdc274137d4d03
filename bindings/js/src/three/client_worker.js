// What runs in the worker of a GIClient.
import {ClientHost} from './client_host.js';

const host = new ClientHost((message, transfer) => self.postMessage(message, transfer));
self.onmessage = ({data}) => host.take(data);
