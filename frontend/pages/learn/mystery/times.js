// Times of a record.

/** A time with as many decimals as a record of this length wants. @param {number} time @param {number} end */
export const digits = (time, end) => time.toFixed(end >= 300 ? 0 : end >= 30 ? 1 : 2);
