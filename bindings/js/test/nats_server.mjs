// nats-server as packaging/nats/alone.conf has it, and a gi-server that publishes to it.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {connect} from 'node:net';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {setTimeout} from 'node:timers/promises';

import {portOf} from './browser_support.mjs';
import {SOURCE, program} from './support.mjs';

const PASSWORDS = {publisher: 'secret-of-the-publisher', viewer: 'secret-of-viewers'};

const answers = (port) => new Promise((resolve) => {
  const socket = connect(port, '127.0.0.1', () => { socket.destroy(); resolve(true); });
  socket.on('error', () => resolve(false));
});

/**
 * {options: what wsconnect() takes for a viewer, publisher: what differs for a publisher, publish(file, options),
 * start(), kill(), close()}. The certificate
 * is that of an authority of its own, `ca`.
 */
export async function natsServer() {
  const folder = mkdtempSync(join(tmpdir(), 'gicodec-nats-'));
  const packaging = join(SOURCE, 'packaging/nats'), certificates = join(folder, 'certificates');
  const [port, web] = [portOf(10), portOf(11)];
  execFileSync(join(packaging, 'certificates'), [certificates, 'localhost', '127.0.0.1'], {stdio: 'pipe'});
  for (const [user, password] of Object.entries(PASSWORDS)) writeFileSync(join(folder, user), `${password}\n`);
  const env = {...process.env, GI_CERTIFICATE: join(certificates, 'server.pem'), GI_KEY: join(certificates, 'server.key'),
               GI_LISTEN: `127.0.0.1:${port}`, GI_WEB: `127.0.0.1:${web}`, GI_STORE: join(folder, 'store'),
               GI_PUBLISHER_PASSWORD: PASSWORDS.publisher, GI_VIEWER_PASSWORD: PASSWORDS.viewer};
  const ca = join(certificates, 'ca.pem');
  let child;
  const children = [];
  const server = {
    ca,
    options: {servers: `wss://127.0.0.1:${web}`, user: 'viewer', pass: PASSWORDS.viewer},
    publisher: {user: 'publisher', pass: PASSWORDS.publisher},
    async start() {
      child = spawn('nats-server', ['-c', join(packaging, 'alone.conf')], {env, stdio: 'ignore'});
      for (const end = Date.now() + 30000; !(await answers(web)); await setTimeout(50)) {
        assert.ok(child.exitCode === null && Date.now() < end, 'nats-server does not start');
      }
    },
    kill: () => new Promise((resolve) => { child.on('exit', resolve); child.kill('SIGKILL'); }),
    /** A gi-server that plays a file again and again. */
    async publish(file, options = []) {
      const made = spawn(program('gi-server'), [
        '--play', file, '--loop', '--nats', `tls://127.0.0.1:${port}`, '--nats-user', 'publisher',
        '--nats-password-file', join(folder, 'publisher'), '--nats-ca', ca, '--proofs', ...options], {stdio: ['ignore', 'ignore', 'pipe']});
      children.push(made);
      let text = '';
      made.stderr.on('data', (data) => { text += data; });
      for (const end = Date.now() + 30000; !/publish|listening/.test(text); await setTimeout(50)) {
        assert.ok(made.exitCode === null && Date.now() < end, `gi-server does not publish: ${text}`);
      }
      return Object.assign(made, {said: () => text});
    },
    close() {
      for (const one of children) one.kill('SIGKILL');
      child.kill();
      rmSync(folder, {recursive: true, force: true});
    },
  };
  await server.start();
  return server;
}
