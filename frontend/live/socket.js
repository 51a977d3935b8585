// The connection to a session: commands and their answers, samples, coming back after a loss. Knows no page.

const HEADER = 24;
const CLOSED = {4404: 'ended', 4410: 'ended', 4429: 'full', 4401: 'failed', 4403: 'failed'}; // shared/session.py
const SILENCE = 15_000; // ms without any message after which the connection counts as lost while time runs

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
    sequence: view.getUint32(0, true), epoch: view.getUint32(4, true), first: Number(view.getBigUint64(8, true)),
    count: view.getUint32(16, true), columns: view.getUint32(20, true), data: new Float32Array(buffer, HEADER),
  };
}

/**
 * @param {object} options
 * @param {string} options.session
 * @param {string | null} options.token
 * @param {(message: object) => void} options.onMessage   every event of the server, in order
 * @param {(frame: object) => void} options.onFrame       every frame of samples, in order with the events
 * @param {(state: string) => void} options.onConnection  live, reconnecting, ended, full, failed
 */
export function connect({session, token, onMessage, onFrame, onConnection}) {
  const waiting = new Map(); // id → {done, fail}
  let socket = null;
  let sequence = 0;
  let next = 1;
  let tries = 0;
  let stopped = false;
  let timer = 0;
  let heard = 0;

  function open() {
    const address = new URL(`/api/sessions/${encodeURIComponent(session)}/stream`, location.href.replace(/^http/, 'ws'));
    address.hash = '';
    if (token) address.searchParams.set('token', token);
    address.searchParams.set('after', sequence);
    socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    socket.onmessage = ({data}) => {
      heard = performance.now();
      if (typeof data === 'string') receive(JSON.parse(data));
      else {
        const frame = decode(data);
        sequence = frame.sequence;
        onFrame(frame);
      }
    };
    socket.onclose = ({code}) => closed(code);
  }

  function receive(message) {
    if (message.type === 'ack' || message.type === 'refused') answer(message);
    if (message.type === 'hello') {
      tries = 0;
      onMessage(message);
      onConnection('live');
    } else onMessage(message);
  }

  function answer(message) {
    const asked = waiting.get(message.id);
    if (!asked) return;
    waiting.delete(message.id);
    if (message.type === 'ack') asked.done(message);
    else asked.fail(new Refused(message));
  }

  function closed(code) {
    for (const {fail} of waiting.values()) fail(new Refused({problem: 'the connection was lost before the answer came', remedy: 'try again'}));
    waiting.clear();
    if (stopped) return;
    if (CLOSED[code]) {
      stopped = true;
      onConnection(CLOSED[code]);
      return;
    }
    onConnection('reconnecting');
    clearTimeout(timer);
    timer = setTimeout(open, Math.min(8000, 250 * 2 ** tries) * (0.75 + Math.random() / 2));
    tries += 1;
  }

  /** Come back at once when the network does, rather than at the end of a long wait. */
  function hurry() {
    if (stopped || socket.readyState !== WebSocket.CLOSED) return;
    clearTimeout(timer);
    tries = 0;
    open();
  }

  addEventListener('online', hurry);
  const watch = setInterval(() => {
    if (socket.readyState === WebSocket.OPEN && navigator.onLine === false && performance.now() - heard > SILENCE) socket.close();
  }, 2000);
  open();

  return {
    /** Send a command (without its id); the answer is the Ack. */
    send(command) {
      if (socket.readyState !== WebSocket.OPEN) {
        return Promise.reject(new Refused({problem: 'there is no connection at the moment', remedy: 'wait until it is back'}));
      }
      const id = next;
      next += 1;
      socket.send(JSON.stringify({...command, id}));
      return new Promise((done, fail) => waiting.set(id, {done, fail}));
    },
    /** Lose the connection as a fault of the network would (tests do). */
    drop() { socket.close(4000); },
    stop() {
      stopped = true;
      clearTimeout(timer);
      clearInterval(watch);
      removeEventListener('online', hurry);
      socket.close();
    },
  };
}
