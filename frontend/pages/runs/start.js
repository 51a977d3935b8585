// The page of runs: an experiment with its run where the address names one, a comparison, else the notebook of all runs.

export {}; // a module

const asked = new URLSearchParams(location.search);
const single = ['experiment', 'run', 'set', 'new'].some((name) => asked.has(name));
document.body.classList.toggle('single', single);
document.body.classList.toggle('notebook', !single);
if (single) await import('./runs.js');
else if (asked.has('compare')) await import('./compare/compare.js');
else await import('./notebook/notebook.js');
