// The words of the panels, English. Functions take what stands in the sentence.

const count = (n, one, many) => `${['No', 'One', 'Two', 'Three', 'Four', 'Five', 'Six', 'Seven', 'Eight', 'Nine'][n] ?? n} ${n === 1 ? one : many}`;
const capital = (words) => words && words.replace(/^[a-z](?=[a-z])/, (first) => first.toUpperCase()); // a symbol stays as it is

export const en = {
  named: (words) => words, // names of the library; another language may have its own
  skip: 'To the curves', wait: 'Loading …', close: 'Close', cancel: 'Cancel', remedy: 'Remedy', copy: 'Copy', copied: 'Copied',

  pages: 'Pages', page: {live: 'Live', runs: 'Runs', plants: 'Plants'},
  moreActions: 'Share, export, language and look',
  share: 'Share', shareHint: 'Links to this session', export: 'Export', exportHint: 'Data, pictures and a report of this session',
  presentHint: 'Presentation: larger type, for a projector (P)', themeHint: 'Light or dark (T)', helpHint: 'Keys of the page (?)',
  languageHint: 'Language: English or 中文 (L)',
  connections: {starting: 'starting …', live: 'live', reconnecting: 'connection lost, trying again', ended: 'ended', full: 'full', failed: 'no session'},
  viewing: 'view only', viewers: (n) => `${n} watching`, slow: (rate) => `${rate}, the machine is busy`,

  chooseExperiment: 'Choose another experiment', findExperiment: 'Find an experiment',
  sizes: (channels, observers) => `${channels === 1 ? 'one fault channel' : `${channels} fault channels`}, ${observers === 1 ? 'one observer' : `${observers} observers`}`,

  plant: 'Plant', equations: 'equations', plantPicture: (title) => `${title}: inputs, fault sites, outputs and observers`,
  blocks: {actuator: 'actuator', plant: 'plant', l1: 'L1', hysteresis: 'hysteresis', l2: 'L2', sensor: 'sensor'},
  observersBlock: 'observers', fromInputs: 'from', fromOutputs: 'from', manyStates: (n) => `${n} states`, every: (s) => `every ${s} s`,
  activeNow: 'active', siteOf: (title) => `Inject: ${title}`, siteOfOutput: (name) => `Disturb the measurement of ${name}`,

  injectTitle: 'Inject a fault', moreFaults: '+ stuck, dropout …', fewerFaults: '− stuck, dropout …', noChannels: 'This plant declares no fault channels.',
  inject: 'Inject', clear: 'Clear', change: 'Change', since: (t) => `since ${t}`, shapeOf: (title) => `Shape of the fault: ${title}`,
  kinds: {actuator: 'actuator', process: 'process', sensor: 'sensor', measurement: 'measurement'},
  measurementOf: (name) => capital(name), noise: 'Noise', noiseOf: (name) => `Noise of ${name}, standard deviation`, noiseHeld: (s) => `σ, held for ${s} s`,
  moreOf: (title) => `More about the fault: ${title}`, endsAfter: (s) => `for ${s} s`, endHint: 'Seconds until it ends by itself; empty: it stays',
  shapes: {step: 'step', ramp: 'ramp', drift: 'drift', exponential: 'incipient', sine: 'sine', 'pulse-train': 'pulses', 'random-walk': 'random walk', table: 'table',
    stuck: 'stuck', freeze: 'freeze', dropout: 'dropout', outliers: 'outliers', 'noise-burst': 'noise burst', quantisation: 'quantisation', delay: 'delay'},
  fields: {size: 'size', rate: 'rate', duration: 'duration', time_constant: 'time constant', frequency: 'frequency', phase: 'phase', period: 'period', width: 'width',
    intensity: 'intensity', sample_time: 'sample time', times: 'times', values: 'values', interpolation: 'between', value: 'value', probability: 'probability', std: 'σ',
    resolution: 'resolution', delay: 'delay', end: 'ends after'},

  tryThis: 'Try this', doIt: 'Do it',

  diagnosis: 'Diagnosis', howSure: 'how sure?', foundIn: 'found in', notFound: 'not found yet', noFaultActs: 'no fault acts there', isOver: 'it is over; the estimate is on its way back',
  invite: 'Click a circle in the plant, or press Inject. The observers see only u and y, never the fault.',
  inviteOutputs: 'Click a circle in the plant, or press Inject. The observers see only y, never the fault.',
  unknownSize: 'size unknown',
  howSureText: '± is two standard deviations, from the observer’s own covariance. It counts the noise of the measurement, not an error of the model. An alarm comes when the whole band has left zero and stays away.',
  sentences: {
    nobody: () => 'Nobody watches. Add an observer.',
    allDiverged: () => 'Every observer has diverged. Lower a gain, or start again.',
    quiet: () => 'No fault. All is quiet.',
    quietAgain: () => 'All faults are over.',
    cannotName: () => 'A fault acts, and no observer here estimates faults. See the residual.',
    allNamed: ({count: n, name, took}) => `${count(n, 'fault', 'faults, all')}${n === 1 ? ', named' : ' named'}. ${capital(name)} was found ${took} after it began.`,
    looking: ({name, count: n, open}) => (n > 0 ? `${count(n, 'fault is', 'faults are')} named. ${capital(name)} is not found yet.` : `${open > 1 ? `${count(open, '', 'faults')} act` : 'A fault acts'}. Not found yet.`),
    measurement: ({name}) => `The measurement ${name} is disturbed. No channel stands for that: see the residual.`,
    falseAlarm: ({name}) => `${capital(name)} is alarmed, though no fault acts there.`,
    blamed: ({name, otherName, onChannel}) => `${capital(name)} is blamed for ${onChannel ? otherName : `the disturbed measurement ${otherName}`}.`,
  },

  observers: 'Observers', add: '+ add', addObserver: 'Add an observer', addIt: 'Add', kind: 'Kind of observer', label: 'label', estimates: 'estimates', whichChannels: 'all faults …', notHere: ' (not for this plant)', automatic: 'automatic',
  removeObserver: (label) => `Remove ${label}`, noObserver: 'No observer watches.', moreGains: 'more gains', fellAt: (t) => `Diverged at ${t}`,
  assumptions: 'Assumptions', verdicts: {holds: 'holds', fails: 'fails', 'cannot tell': 'cannot tell'}, checkNames: {},
  kindNames: {'high-gain': 'High gain', 'zhao-adaptive': 'Adaptive, Zhao (34)', 'nonsmooth-adaptive': 'Nonsmooth adaptive', 'linear-adaptive': 'Linear adaptive',
    'reduced-order': 'Reduced order', 'full-order': 'Full order', 'sandwich-nonsmooth': 'Sandwich, non-smooth', 'sandwich-conventional': 'Sandwich, conventional',
    'adaptive-kalman': 'Adaptive Kalman', 'adaptive-kalman-discrete': 'Adaptive Kalman, sampled', 'joint-ekf': 'Joint EKF', 'joint-ukf': 'Joint UKF'},

  comparison: 'Comparison', rmseHint: 'Root mean square error of the state over the window shown', settle: 'settle', settleHint: 'Time from the fault until its estimate stays within 10 % of it for a hundredth of the horizon',
  noiseShort: 'noise', noiseHint: 'Standard deviation of the estimate about its trend, over the last quarter of the window', notYet: 'not yet', whichState: 'State to compare', whichFault: 'Fault to compare',

  log: 'Log', emptyLog: 'Nothing has happened yet.', showMoment: 'Show this moment', backHere: 'Go back to here',
  events: {
    inject: ({name, size, shape}) => `you injected ${name}${size === '' ? '' : ` = ${size}`}${shape ? `, ${shape}` : ''}`,
    clear: ({name}) => (name ? `you cleared ${name}` : 'you cleared all faults'),
    'fault-begins': ({name}) => `${name} begins`, 'fault-ends': ({name}) => `${name} ends`,
    gain: ({subject, gain, size}) => `you set ${[gain, 'of', subject].filter(Boolean).join(' ')}${size === '' ? '' : ` to ${size}`}`,
    signal: ({name}) => `you changed the signal ${name}`, noise: ({name, size}) => `you set the noise of ${name}${size === '' ? '' : ` to ${size}`}`,
    'observer-added': ({subject}) => `${subject} begins to watch`, 'observer-removed': ({subject}) => `${subject} watches no more`,
    alarm: ({name, size, observer}) => `alarm: ${name}${size === '' ? '' : `, size ${size}`} (${observer})`, 'alarm-over': ({name, observer}) => `alarm over: ${name} (${observer})`,
    diverged: ({subject}) => `${subject || 'the plant'} diverged`, rewound: ({t}) => `back to ${t} s`, reset: () => 'back to the start',
  },

  dialogs: {equations: 'Equations', help: 'Keys', share: 'Share this session', export: 'Take it with you'},
  with: 'with', measured: 'measured', faultsIn: 'faults, the amber terms', nextSample: (s) => `x⁺ is the value one sample later; a sample is ${s} s.`,
  controlLink: 'The same session anew', controlLinkHint: 'Opens the same plant, faults and changes at this time, with the same numbers. Whoever opens it may change it.',
  viewLink: 'Watch this one', viewLinkHint: 'Shows this very session while it runs. Whoever opens it can look, not touch.',
  exportData: 'Data', exportPicture: 'The curves as a picture', exportReport: 'The session as a run', exportNote: 'The session up to now is saved as a run; its numbers are the same, bit for bit.',
  saving: 'Saving …', report: 'Report', reportHint: 'One HTML file that opens offline', spec: 'Specification', specHint: 'Everything that determines the numbers, as JSON',
  openRun: 'Open the run', openRunHint: 'The run with its figures, on a page of its own', csvHint: 'All columns as text', matHint: 'All columns for MATLAB', jsonHint: 'All columns as JSON',
  pngHint: 'What the scope shows, as pixels', svgHint: 'What the scope shows, as lines',
  keyNames: {Space: 'Space', ArrowLeft: '←', ArrowRight: '→', Home: 'Home', End: 'End', Escape: 'Esc'},
  keys: {toggle: 'play or pause', step: 'one step', back: 'look back', on: 'look on', now: 'back to now', reset: 'back to the start', faster: 'faster', slower: 'slower', fork: 'fork here: a second session',
    site: 'a fault channel: its injection', clear: 'clear all faults', equations: 'equations', present: 'presentation', theme: 'light or dark', language: 'English or 中文', share: 'share', help: 'this list'},
  keysNote: 'Tab reaches everything; arrows move a slider.',
  tabs: {curves: 'Curves', inject: 'Inject', observers: 'Observers', diagnosis: 'Diagnosis'}, tabsLabel: 'Parts of the page',
};
