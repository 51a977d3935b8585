// What this browser keeps of classrooms: the room that a teacher has opened here, and the place that a student has.

const ROOM = 'thetascope.room';
const SEAT = 'thetascope.seat';

/** @typedef {{token: string, code: string}} Kept */

/** @param {string} key @returns {Kept | null} */
function read(key) {
  try {
    const kept = JSON.parse(localStorage.getItem(key) ?? 'null');
    return typeof kept?.token === 'string' && typeof kept.code === 'string' ? kept : null;
  } catch {
    return null;
  }
}

/** @param {string} key @param {Kept | null} value */
function write(key, value) {
  try {
    if (value) localStorage.setItem(key, JSON.stringify(value));
    else localStorage.removeItem(key);
  } catch {
    /* private windows keep nothing */
  }
}

/** The secret with which somebody comes from a learning platform; it can be used once. */
export const launchSecret = () => new URLSearchParams(location.search).get('launch') ?? '';
/** The room that was opened in this browser. */
export const teacherRoom = () => read(ROOM);
/** @param {Kept | null} room */
export const keepRoom = (room) => write(ROOM, room);
/** The place in a room that this device has. */
export const studentSeat = () => read(SEAT);
/** @param {Kept | null} seat */
export const keepSeat = (seat) => write(SEAT, seat);
