// The connection to a session: commands and their answers, samples, coming back after a loss. Knows no page.

const HEADER = 24;
const CLOSED = {4404: 'ended', 4410: 'ended', 4429: 'full', 4401: 'failed', 4403: 'failed'}; // shared/thetascope_schemas/service/session.py
const SILENCE = 15_000; // ms without any message after which an offline browser's connection counts as lost
const LONGEST = 8000; // ms between two tries

/** A command that was not carried out. */
export class Refused extends Error {
  constructor({field = '', value = null, problem, remedy = ''}) {
    super(problem);
    Object.assign(this, {name: 'Refused', field, value, problem, remedy});
  }
}

/** A binary message as {sequence, epoch, first, count, columns, data}; data is column after column. */
export function decode(buffer) {
  const view = new DataView(buffer);
  return {
    sequence: view.getUint32(0, true),
    epoch: view.getUint32(4, true),
    first: Number(view.getBigUint64(8, true)),
    count: view.getUint32(16, true),
    columns: view.getUint32(20, true),
    data: new Float32Array(buffer, HEADER),
  };
}

/**
 * Connect to a session and stay connected.
 * @param {object} options
 * @param {string} options.session
 * @param {string | null} options.token
 * @param {(message: object) => void} options.onMessage   every event of the server, in order
 * @param {(frame: object) => void} options.onFrame       every frame of samples, in order with the events
 * @param {(state: string) => void} options.onConnection  live, reconnecting, ended, full, failed
 */
export const connect = (options) => new Connection(options);

class Connection {
  constructor(options) {
    Object.assign(this, options, {
      waiting: new Map(),
      sequence: 0,
      next: 1,
      tries: 0,
      stopped: false,
      timer: 0,
      heard: 0,
    });
    this.hurry = this.hurry.bind(this);
    addEventListener('online', this.hurry);
    this.watch = setInterval(() => this.listen(), 2000);
    this.open();
  }

  open() {
    const address = new URL(
      `/api/sessions/${encodeURIComponent(this.session)}/stream`,
      location.origin.replace(/^http/, 'ws'),
    );
    if (this.token) address.searchParams.set('token', this.token);
    address.searchParams.set('after', this.sequence);
    this.socket = new WebSocket(address);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onmessage = ({data}) => this.receive(data);
    this.socket.onclose = ({code}) => this.closed(code);
  }

  receive(data) {
    this.heard = performance.now();
    if (typeof data !== 'string') {
      const frame = decode(data);
      this.sequence = frame.sequence;
      this.onFrame(frame);
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'ack' || message.type === 'refused') this.answer(message);
    this.onMessage(message);
    if (message.type !== 'hello') return;
    this.tries = 0;
    this.onConnection('live');
  }

  answer(message) {
    const asked = this.waiting.get(message.id);
    if (!asked) return;
    this.waiting.delete(message.id);
    if (message.type === 'ack') asked.done(message);
    else asked.fail(new Refused(message));
  }

  closed(code) {
    for (const {fail} of this.waiting.values())
      fail(new Refused({problem: 'the connection was lost before the answer came', remedy: 'try again'}));
    this.waiting.clear();
    if (this.stopped) return;
    if (CLOSED[code]) {
      this.stop();
      this.onConnection(CLOSED[code]);
      return;
    }
    this.onConnection('reconnecting');
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.open(), Math.min(LONGEST, 250 * 2 ** this.tries) * (0.75 + Math.random() / 2));
    this.tries += 1;
  }

  /** Come back at once when the network does, rather than at the end of a long wait. */
  hurry() {
    if (this.stopped || this.socket.readyState !== WebSocket.CLOSED) return;
    clearTimeout(this.timer);
    this.tries = 0;
    this.open();
  }

  /** A browser that went offline may hold a dead connection open for minutes. */
  listen() {
    if (
      this.socket.readyState === WebSocket.OPEN &&
      navigator.onLine === false &&
      performance.now() - this.heard > SILENCE
    )
      this.socket.close();
  }

  /** Send a command (without its id); the answer is the Ack. */
  send(command) {
    if (this.socket.readyState !== WebSocket.OPEN) {
      return Promise.reject(
        new Refused({problem: 'there is no connection at the moment', remedy: 'wait until it is back'}),
      );
    }
    const id = this.next;
    this.next += 1;
    this.socket.send(JSON.stringify({...command, id}));
    return new Promise((done, fail) => this.waiting.set(id, {done, fail}));
  }

  /** Lose the connection as a fault of the network would (tests do). */
  drop() {
    this.socket.close(4000);
  }

  stop() {
    this.stopped = true;
    clearTimeout(this.timer);
    clearInterval(this.watch);
    removeEventListener('online', this.hurry);
    this.socket.close();
  }
}
