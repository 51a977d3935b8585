// The words of the panels, English. Functions take what stands in the sentence.

const count = (n, one, many) => `${['No', 'One', 'Two', 'Three', 'Four', 'Five', 'Six', 'Seven', 'Eight', 'Nine'][n] ?? n} ${n === 1 ? one : many}`;
const capital = (words) => words && words.replace(/^[a-z](?=[a-z])/, (first) => first.toUpperCase()); // a symbol stays as it is

export const en = {
  named: (words) => words, // names of the library; another language may have its own
  said: (words) => words, // what the server says, too
  tight: (words) => words, // blanks as the language has them
  skip: 'To the curves', wait: 'Loading …', stop: '.', and: '; ', close: 'Close', cancel: 'Cancel', remedyIs: (words) => `Remedy: ${words}`, copy: 'Copy', copied: 'Copied',

  pages: 'Pages', page: {live: 'Live', runs: 'Runs', plants: 'Plants', records: 'Records'},
  moreActions: 'Share, export, language and look',
  share: 'Share', shareHint: 'Links to this session', export: 'Export', exportHint: 'Data, pictures and a report of this session',
  present: 'Presentation', look: 'Light or dark', help: 'Keys',
  presentHint: 'Presentation: larger type, for a projector (P)', leave: 'Leave', leaveHint: 'Leave the presentation (P, Esc)', themeHint: 'Light or dark (T)', helpHint: 'Keys of the page (?)',
  languageHint: 'Language: English or 中文 (L)',
  connections: {starting: 'starting …', live: 'live', reconnecting: 'connection lost, trying again', ended: 'ended', full: 'full', failed: 'no session'},
  viewing: 'view only', viewers: (n) => `${n} watching`, slow: (rate) => `${rate}, the machine is busy`,

  chooseExperiment: 'Choose another experiment', findExperiment: 'Find an experiment',
  sizes: (channels, observers) => `${channels === 1 ? 'one fault channel' : `${channels} fault channels`}, ${observers === 1 ? 'one observer' : `${observers} observers`}`,

  plant: 'Plant', equations: 'equations', plantPicture: (title) => `${title}: inputs, fault sites, outputs and observers`,
  blocks: {actuator: 'actuator', plant: 'plant', l1: 'L1', hysteresis: 'hysteresis', l2: 'L2', sensor: 'sensor'},
  observersBlock: 'observers', fromInputs: 'from', fromOutputs: 'from', manyStates: (n) => `${n} states`, every: (s) => `every ${s} s`,
  activeNow: 'active', namedNow: 'found', perhapsNow: 'perhaps', siteOf: (title) => `Inject: ${title}`, siteOfOutput: (name) => `Disturb the measurement of ${name}`,

  injectTitle: 'Inject a fault', moreFaults: '+ stuck, dropout …', fewerFaults: '− stuck, dropout …', noChannels: 'This plant declares no fault channels.',
  inject: 'Inject', clear: 'Clear', change: 'Change', since: (t) => `since ${t}`, began: (from, to) => `began ${from}–${to}`, shapeOf: (title) => `Shape of the fault: ${title}`,
  kinds: {actuator: 'actuator', process: 'process', sensor: 'sensor', measurement: 'measurement'},
  measurementOf: (name) => capital(name), noise: 'Noise', noiseOf: (name) => `Noise of ${name}, standard deviation`, noiseHeld: (s) => `σ, held for ${s} s`,
  moreOf: (title) => `More about the fault: ${title}`, endsAfter: (s) => `for ${s} s`, endHint: 'Seconds until it ends by itself; empty: it stays',
  shapes: {step: 'step', ramp: 'ramp', drift: 'drift', exponential: 'incipient', sine: 'sine', 'pulse-train': 'pulses', 'random-walk': 'random walk', table: 'table',
    stuck: 'stuck', freeze: 'freeze', dropout: 'dropout', outliers: 'outliers', 'noise-burst': 'noise burst', quantisation: 'quantisation', delay: 'delay'},
  fields: {size: 'size', rate: 'rate', duration: 'duration', time_constant: 'time constant', frequency: 'frequency', phase: 'phase', period: 'period', width: 'width',
    intensity: 'intensity', sample_time: 'sample time', times: 'times', values: 'values', interpolation: 'between', value: 'value', probability: 'probability', std: 'σ',
    resolution: 'resolution', delay: 'delay', end: 'ends after'},

  tryThis: 'Try this', doIt: 'Do it',

  asOfNow: (t) => `now, ${t}`,
  diagnosis: 'Diagnosis', findings: 'Findings', howSure: 'how sure?', canSee: 'what can be seen?', or: 'or', foundIn: 'found in', notFound: 'not found yet', noFaultActs: 'no fault acts', faultElsewhere: 'not this one',
  isOver: 'it has ended', plannedAt: (t) => `from ${t}`, besides: (what) => `Together with ${what.join(' and ')}.`, inAll: (size) => ` In all ${size}.`, moreFrom: (what) => `Planned on top: ${what.join(', ')}.`,
  part: ({size, shape, t}) => `${size || shape} since ${t}`, partFrom: ({size, shape, t}) => `${size || shape} from ${t}`, coming: ({name, t}) => `Waiting: ${name} begins at ${t}.`, cleared: 'over', ifIt: (name) => `if it is ${name}`, tooSmall: (size) => `below ${size}, the least that shows now`, suspects: 'suspect the sensor: stuck, dropout, delay',
  invite: 'Click a circle in the plant, or press Inject. What watches sees only u and y, never the fault.',
  inviteOutputs: 'Click a circle in the plant, or press Inject. What watches sees only y, never the fault.',
  unknownSize: 'not in the model',
  sentences: {
    noDiagnosis: ({note}) => `No diagnosis: ${note}.`,
    broken: ({at}) => `The plant broke down at ${at}: nothing can be judged from there on. Go back to before it.`,
    lost: ({label, at, count: n, all, only}) => (only ? `No fault found. But ${label} diverged at ${at}, and nothing is estimated any more.`
      : all ? `No fault found. But all ${n} observers have diverged, and nothing is estimated any more.`
        : n > 1 ? `No fault found. But ${n} observers have diverged.` : `No fault found. But ${label} diverged at ${at}.`),
    early: ({from}) => `Nothing found yet; judging from ${from} s on.`,
    quiet: () => 'No fault. All is quiet.',
    quietAgain: () => 'All faults are over.',
    ending: () => 'The fault has ended; its alarm is about to clear.',
    one: ({name, kind, size, since}) => `${capital(name)}${kind ? ` ${kind} fault` : ''}: ${size} since ${since}.`,
    oneFound: ({name, kind, size, since, took}) => `${capital(name)}${kind ? ` ${kind} fault` : ''}: ${size} since ${since}, found in ${took}.`,
    oneAgain: ({name, kind, size, since, again}) => `${capital(name)}${kind ? ` ${kind} fault` : ''}: ${size} since ${since}. The one of ${again} came before that alarm was over.`,
    several: ({count: n}) => `${count(n, 'fault, named', 'faults, all named')}.`,
    allNamed: ({count: n, name, took}) => `${count(n, 'fault, named', 'faults, all named')}. ${capital(name)} was found ${took} after it began.`,
    either: ({names}) => `${capital(names.join(' or '))}: this input does not tell them apart.`,
    unexplained: ({name}) => `No fault of the model explains ${name}. Suspect its sensor.`,
    looking: ({name, count: n, open}) => (n > 0 ? `${count(n, 'fault is', 'faults are')} named. ${capital(name)} is not found yet.` : `${open > 1 ? `${count(open, '', 'faults')} act` : 'A fault acts'}. Not found yet.`),
    hidden: ({name, count: n}) => `${n > 0 ? `${count(n, 'fault is', 'faults are')} named. ` : ''}${capital(name)} acts unseen: it is not identifiable with this input.`,
    measurement: ({name}) => `The measurement ${name} is disturbed. Not found yet.`,
    falseAlarm: ({name}) => `${capital(name)} is alarmed, though no fault acts there.`,
    blamed: ({name, otherName, onChannel}) => `${capital(name)} is blamed for ${onChannel ? otherName : `the disturbed measurement ${otherName}`}.`,
  },
  calibrated: (rate, threshold, runs, hours) => `Asked for: ${rate}. The threshold of ${threshold} follows from ${runs} simulated runs without a fault, ${hours} h in all; none is typed in.`,
  oneIn: (hours) => `one false alarm in ${hours} h`, perHour: (n) => `${n} false alarms in an hour`,
  plusMinus: (percent) => `± is the ${percent} % interval of the size, if no other fault acts than those named.`, judgedFrom: (s) => `Nothing is judged before ${s} s.`,
  noiseSeen: (output, declared, seen) => `Noise of ${output}: ${declared === null ? 'none declared' : `${declared} declared`}, ${seen} seen.`,
  bandsAre: 'One detector raises the alarms, whatever observers watch. Their bands are theirs: two standard deviations on either side, wider where the input tells less.',
  alongTrajectory: 'Rank and condition along the run', rank: 'Rank', condition: 'Condition', windowFrom: (s) => `${s} s from, s`,
  byEquations: (rank, size) => `By the equations, rank ${rank} of ${size}.`,
  levelOf: (now, needed) => `Least visible: ${now} times above the noise; ${needed} asked for.`, overLast: (s) => `Over the last ${s} s.`,
  smallest: 'shows from', smallestHint: 'The smallest step that is found within the longest window, the other faults unknown', typical: 'typical',
  canBeSeen: 'told apart', underNoise: 'lost in the noise', notSeenNow: 'not identifiable now', hardlySeen: 'hardly told apart',
  unresolved: (names) => `${names.length > 1 ? `${names.slice(0, -1).join(', ')} and ${names.at(-1)}` : names[0]} cannot be resolved at this noise.`,
  propose: 'Propose an input', proposeHint: 'Tries some courses of the input on the plant, and takes the smallest that tells the faults apart', proposing: 'Trying inputs on the plant …',
  apply: 'Apply', dismiss: 'Close', applied: 'Applied. Watch the level rise.',

  observers: 'Observers', add: '+ add', addObserver: 'Add an observer', addIt: 'Add', kind: 'Kind of observer', label: 'label', estimates: 'estimates', whichChannels: 'all faults …', notHere: ' (not for this plant)', automatic: 'automatic',
  startObserver: 'Start again', startObserverHint: 'It begins anew from its initial estimates, with its gains as they are now',
  removeObserver: (label) => `Remove ${label}`, noObserver: 'No observer watches.', moreGains: 'more gains', fellAt: (t) => `Diverged at ${t}`, lostAt: (label, t) => `${label} diverged at ${t}; its card can start it again.`,
  assumptions: 'Assumptions', verdicts: {holds: 'holds', fails: 'fails', 'cannot tell': 'cannot tell'},
  kindNames: {'high-gain': 'High gain', 'zhao-adaptive': 'Adaptive, Zhao (34)', 'nonsmooth-adaptive': 'Nonsmooth adaptive', 'linear-adaptive': 'Linear adaptive',
    'reduced-order': 'Reduced order', 'full-order': 'Full order', 'sandwich-nonsmooth': 'Sandwich, non-smooth', 'sandwich-conventional': 'Sandwich, conventional',
    'adaptive-kalman': 'Adaptive Kalman', 'adaptive-kalman-discrete': 'Adaptive Kalman, sampled', 'joint-ekf': 'Joint EKF', 'joint-ukf': 'Joint UKF'},

  comparison: 'Comparison', rmseHint: 'Root mean square error of the state over the window shown', settle: 'settle', settleHint: 'Time from a step fault until its estimate stays within 10 % of the step, up to now or to the next fault; taken back where it leaves again',
  noiseShort: 'noise', noiseHint: 'Standard deviation of the estimate about its trend, over the last quarter of the window', notYet: 'not yet', notSoFar: 'This session has not come so far',
  alarmWasOn: 'Its alarm was on already', tooNoisy: 'too noisy', tooNoisyHint: 'The estimate has come to the truth, but its noise throws it further than 10 % of the step, so that it never stays within', whichState: 'State to compare', whichFault: 'Fault to compare', foundBy: 'found by the detector in', foundHint: 'Time from the fault to the alarm of the detector that names it; it does not depend on the observers',

  log: 'Log', emptyLog: 'Nothing has happened yet.', showMoment: 'Show this moment', backHere: 'Go back to here',
  events: {
    inject: ({name, size, quantity, shape, later}) => `you injected ${quantity || size === '' ? `${name}: ${shape}${size === '' ? '' : `, ${quantity} ${size}`}` : `${name} = ${size}, ${shape}`}${later ? `, to begin at ${later} s` : ''}`,
    clear: ({name, planned}) => `you cleared ${name || 'all faults'}${planned ? ', and what was planned' : ''}`,
    'fault-begins': ({name}) => `${name} begins`, 'fault-ends': ({name}) => `${name} ends`,
    gain: ({subject, gain, size}) => `you set ${[gain, 'of', subject].filter(Boolean).join(' ')}${size === '' ? '' : ` to ${size}`}`,
    signal: ({name}) => `you changed the signal ${name}`, noise: ({name, size}) => `you set the noise of ${name}${size === '' ? '' : ` to ${size}`}`,
    'observer-added': ({subject}) => `${subject} begins to watch`, 'observer-removed': ({subject}) => `${subject} watches no more`, restarted: ({subject}) => `you started ${subject} again`,
    alarm: ({names, explained, size}) => (explained ? `alarm: ${names.join(' or ')}${names.length > 1 ? ', not told apart' : `, ${size}`}` : `alarm: ${names[0]}, not explained by the model`),
    'alarm-over': ({names}) => `alarm over: ${names.join(' or ')}`,
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
    site: 'a fault channel; Enter injects', clear: 'clear all faults', equations: 'equations', present: 'presentation; Esc leaves it', desk: 'presentation: inject, observers, comparison, log, try this', theme: 'light or dark', language: 'English or 中文', share: 'share', help: 'this list'},
  keysNote: 'Tab reaches everything; arrows move a slider.',
  tabs: {curves: 'Curves', inject: 'Inject', observers: 'Observers', diagnosis: 'Diagnosis'}, tabsLabel: 'Parts of the page', deskLabel: 'Panels',
};
