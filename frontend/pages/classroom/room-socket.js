// The connection of a wall or a phone to its room. Every message is the whole state, so coming back needs nothing else.

const ALIVE = 8000; // ms between two words to the server, which takes a page that is silent for one that sleeps
const LONGEST = 5000; // ms between two tries
const GONE = new Set([4401, 4404]); // the room has ended, or the place in it was taken away
const ELSEWHERE = 4409; // the same student has opened the room in other tabs

/**
 * @typedef {object} Options
 * @property {string} path                     of the websocket
 * @property {string} token
 * @property {(data: string | ArrayBuffer) => void} onMessage
 * @property {(state: 'live' | 'lost' | 'gone' | 'elsewhere') => void} [onConnection]
 */

export class RoomSocket {
  /** @param {Options} options */
  constructor({path, token, onMessage, onConnection = () => {}}) {
    this.path = path;
    this.token = token;
    this.onMessage = onMessage;
    this.onConnection = onConnection;
    this.tries = 0;
    this.stopped = false;
    this.seen = Date.now();
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.awake = this.awake.bind(this);
    addEventListener('online', this.awake);
    document.addEventListener('visibilitychange', this.awake);
    this.beat = setInterval(() => this.alive(), ALIVE);
    this.socket = this.open();
  }

  open() {
    const address = new URL(this.path, location.origin.replace(/^http/, 'ws'));
    const socket = new WebSocket(address, ['thetascope', `token.${this.token}`]);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.tries = 0;
      this.seen = Date.now();
      this.onConnection('live');
    };
    socket.onmessage = ({data}) => this.onMessage(data);
    socket.onclose = ({code}) => this.closed(code);
    return socket;
  }

  /** @param {number} code */
  closed(code) {
    if (this.stopped) return;
    if (GONE.has(code) || code === ELSEWHERE) {
      this.stop();
      this.onConnection(code === ELSEWHERE ? 'elsewhere' : 'gone');
      return;
    }
    this.onConnection('lost');
    clearTimeout(this.timer);
    this.timer = setTimeout(
      () => {
        this.socket = this.open();
      },
      Math.min(LONGEST, 250 * 2 ** this.tries) * (0.75 + Math.random() / 2),
    );
    this.tries += 1;
  }

  /** Say that the page is awake. Where the clock has jumped the machine slept: what was open is dead. */
  alive() {
    const slept = Date.now() - this.seen > 2.5 * ALIVE;
    this.seen = Date.now();
    if (this.socket.readyState !== WebSocket.OPEN) return;
    if (slept) this.renew();
    else this.socket.send('.');
  }

  /** The page is visible, or the network is back: do not wait. */
  awake() {
    if (this.stopped || document.visibilityState === 'hidden') return;
    if (this.socket.readyState === WebSocket.OPEN) this.alive();
    else if (this.socket.readyState === WebSocket.CLOSED) this.renew();
  }

  renew() {
    clearTimeout(this.timer);
    this.tries = 0;
    this.socket.onclose = null;
    this.socket.close();
    this.socket = this.open();
  }

  stop() {
    this.stopped = true;
    clearTimeout(this.timer);
    clearInterval(this.beat);
    removeEventListener('online', this.awake);
    document.removeEventListener('visibilitychange', this.awake);
    this.socket.close();
  }
}
