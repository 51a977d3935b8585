// The connection to a session: commands and their answers, samples, coming back after a loss. Knows no page.

/** @import {Ack, Command, Connection as ConnectionState, Frame, ServerMessage} from '../types.js' */
/** @import {Refused as Refusal} from '../../types/service.js' */

const HEADER = 24;
/** @type {Map<number, ConnectionState>} close codes of shared/thetascope_schemas/service/session.py */
const CLOSED = new Map([
  [4404, 'ended'],
  [4410, 'ended'],
  [4429, 'full'],
  [4430, 'full'],
  [4401, 'failed'],
  [4403, 'failed'],
]);
const SIGN_IN = 4411; // the access key is missing, or was changed
const SILENCE = 15_000; // ms without any message after which an offline browser's connection counts as lost
const LONGEST = 8000; // ms between two tries

/** A command that was not carried out. Its words are those of `code`; the server has rendered them, too. */
export class Refused extends Error {
  /**
   * @param {{field?: string, value?: unknown, code?: string, args?: {[name: string]: unknown}, problem?: string,
   *   remedy?: string}} refusal
   */
  constructor({field = '', value = null, code = '', args = {}, problem = '', remedy = ''}) {
    super(problem || code);
    this.name = 'Refused';
    this.field = field;
    this.value = value;
    this.code = code;
    this.args = args;
    this.problem = problem;
    this.remedy = remedy;
  }
}

/**
 * Decode a binary message.
 * @param {ArrayBuffer} buffer
 * @returns {Frame}
 */
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
 * @typedef {object} Options
 * @property {string} session
 * @property {string | null} token
 * @property {(message: ServerMessage) => void} onMessage   gets every event of the server, in order
 * @property {(frame: Frame) => void} onFrame               gets every frame of samples, in order with the events
 * @property {(state: ConnectionState) => void} onConnection
 */

/** @typedef {{done: (ack: Ack) => void, fail: (refusal: Refused) => void}} Waiting   for the answer to a command */

/**
 * Connect to a session, and connect again whenever the connection is lost.
 * @param {Options} options
 */
export const connect = (options) => new Connection(options);

class Connection {
  /** @param {Options} options */
  constructor({session, token, onMessage, onFrame, onConnection}) {
    this.session = session;
    this.token = token;
    this.onMessage = onMessage;
    this.onFrame = onFrame;
    this.onConnection = onConnection;
    /** @type {Map<number, Waiting>} */
    this.waiting = new Map();
    this.sequence = 0;
    this.next = 1;
    this.tries = 0;
    this.stopped = false;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.lastMessage = 0;
    this.hurry = this.hurry.bind(this);
    addEventListener('online', this.hurry);
    this.watch = setInterval(() => this.listen(), 2000);
    this.socket = this.open();
  }

  open() {
    const address = new URL(
      `/api/sessions/${encodeURIComponent(this.session)}/stream`,
      location.origin.replace(/^http/, 'ws'),
    );
    address.searchParams.set('lang', '*'); // the page renders sentences itself, and shows prose in its language
    address.searchParams.set('after', String(this.sequence));
    // the token travels as a subprotocol: addresses are written into logs
    const socket = new WebSocket(address, this.token ? ['thetascope', `token.${this.token}`] : ['thetascope']);
    socket.binaryType = 'arraybuffer';
    socket.onmessage = ({data}) => this.receive(data);
    socket.onclose = ({code}) => this.closed(code);
    return socket;
  }

  /** @param {string | ArrayBuffer} data */
  receive(data) {
    this.lastMessage = performance.now();
    if (typeof data !== 'string') {
      const frame = decode(data);
      this.sequence = frame.sequence;
      this.onFrame(frame);
      return;
    }
    /** @type {ServerMessage} */
    const message = JSON.parse(data);
    if (message.type === 'ack' || message.type === 'refused') this.answer(message);
    this.onMessage(message);
    if (message.type !== 'hello') return;
    this.tries = 0;
    this.onConnection('live');
  }

  /** @param {Ack | Refusal} message */
  answer(message) {
    const waiting = message.id === null ? undefined : this.waiting.get(message.id);
    if (!waiting || message.id === null) return;
    this.waiting.delete(message.id);
    if (message.type === 'ack') waiting.done(message);
    else waiting.fail(new Refused(message));
  }

  /** @param {number} code */
  closed(code) {
    for (const {fail} of this.waiting.values()) fail(new Refused({code: 'page.notice.answer-lost'}));
    this.waiting.clear();
    if (this.stopped) return;
    if (code === SIGN_IN) {
      this.stop();
      return location.reload(); // the server answers with its sign-in page, which leads back to this address
    }
    const end = CLOSED.get(code);
    if (end) {
      this.stop();
      this.onConnection(end);
      return;
    }
    this.onConnection('reconnecting');
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.reopen(), Math.min(LONGEST, 250 * 2 ** this.tries) * (0.75 + Math.random() / 2));
    this.tries += 1;
  }

  /** Reconnect as soon as the network is back, rather than at the end of a long wait. */
  hurry() {
    if (this.stopped || this.socket.readyState !== WebSocket.CLOSED) return;
    clearTimeout(this.timer);
    this.tries = 0;
    this.reopen();
  }

  reopen() {
    this.socket = this.open();
  }

  /** A browser that went offline may hold a dead connection open for minutes. */
  listen() {
    if (
      this.socket.readyState === WebSocket.OPEN &&
      navigator.onLine === false &&
      performance.now() - this.lastMessage > SILENCE
    )
      this.socket.close();
  }

  /**
   * Send a command.
   * @param {Command} command
   * @returns {Promise<Ack>}
   * @throws {Refused}
   */
  send(command) {
    if (this.socket.readyState !== WebSocket.OPEN) {
      return Promise.reject(new Refused({code: 'page.notice.no-connection'}));
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
