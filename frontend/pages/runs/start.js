// The page of runs: the experiment with its run, or the comparison, that the address names; else the notebook.

export {}; // a module

const asked = new URLSearchParams(location.search);
const single = ['experiment', 'run', 'set', 'new'].some((name) => asked.has(name));
document.body.classList.toggle('single', single);
document.body.classList.toggle('notebook', !single);
if (single) await import('./runs.js');
else if (asked.has('compare')) await import('./compare/compare.js');
else await import('./notebook/notebook.js');
