// Written by `python -m tools.page_types` from the service's schemas. Do not edit.
// Bodies of requests and commands have optional fields where the schema has a default; answers and events have all fields.

/** A command was carried out, and takes effect from this row on. */
export interface Ack {
  type: 'ack';
  id: number;
  row: number;
  t: number;
}

/** Let another observer watch from here on; its estimates start here. */
export interface AddObserver {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'add-observer';
  observer: ObserverConfig;
}

/** Let another observer watch from here on; its estimates start here. */
export interface AddObserverInput {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'add-observer';
  observer: ObserverConfigInput;
}

/** Add an observer, which starts now. */
export interface AddObserverNow {
  /** Number that the client gives the command. */
  id: number;
  type: 'add-observer';
  observer: ObserverConfigInput;
}

/** One fault that an observer's tests found. */
export interface Alarm {
  /** Id within the run or session: it stays while the alarm is revised. Empty in old results. */
  id: string;
  /** Label of the observer; empty: the detector, which watches the plant itself. */
  observer: string;
  /** Time in s at which the alarm was raised. */
  t: number;
  /** In a channel of the model, or not explained by it. */
  kind: 'fault' | 'unexplained';
  /** The channel that explains the data best; empty where none does. */
  channel: string;
  /** Not explained by the model: the output whose residual says so. */
  output: string;
  /** Channels that explain the data as well. */
  alternatives: (string)[];
  /** Estimated time in s at which the fault began. */
  onset: number;
  /** Earliest time in s at which it may have begun. */
  onset_from: number;
  /** Latest time in s at which it may have begun. */
  onset_to: number;
  /** Estimated size in the channel's unit. */
  size: number | null;
  /** Lower end of the interval of the size. */
  size_from: number | null;
  /** Upper end of the interval of the size. */
  size_to: number | null;
  /** The test that raised it. */
  test: string;
  /** What the test came to, without a unit. */
  statistic: number;
  /** What the statistic was held against. */
  threshold: number;
  /** Time in s at which the alarm was over; null: it is still on. */
  cleared: number | null;
  /** The finding in a sentence. */
  text: Text;
}

/** The verdict on one alarm, and what it means at the time of judging. */
export interface AlarmOutcome {
  /** Id of the alarm. */
  id: string;
  /** As it was raised: it names a fault that was present, another one was, or none was. */
  verdict: 'correct' | 'isolation-error' | 'false';
  /** Now: cleared; or still on, and a fault that it names acts; the fault that acts began later and is covered; another fault acts; none ever did; the fault has ended and the alarm is about to clear. */
  state: 'acting' | 'covering' | 'other-fault' | 'no-fault' | 'fault-over' | 'cleared';
  /** Ids of the faults that it was the first to find. */
  found: (string)[];
  /** Seconds from the newest of these to the alarm. */
  delay: number | null;
  /** Onset in s of the newest fault that it covers and that acts. */
  covers_since: number | null;
}

/** One assumption of an observer's theorem, checked on this plant, these gains and this run. */
export interface AssumptionCheck {
  name: Text;
  verdict: 'holds' | 'fails' | 'cannot tell';
  /** The check's result in a sentence. */
  text: Text;
  /** The number found. */
  value: number | null;
  /** The number it is held against. */
  threshold: number | null;
  /** Paper and equation. */
  source: string;
}

/** The assumption checks of one observer over the session so far. */
export interface Assumptions {
  type: 'assumptions';
  observer: string;
  checks: (AssumptionCheck)[];
}

/** Carry out several commands in order at the same row. If one is refused, none is carried out: one answer for all. */
export interface Batch {
  /** Number that the client gives the command. */
  id: number;
  type: 'batch';
  /** The commands, without their ids; a refusal names commands[i].field. */
  commands: (Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | AddObserverNow | RemoveObserverNow | Reset)[];
}

/** Where the thresholds come from. */
export interface Calibration {
  /** Rate per hour that was asked for. */
  false_alarms: number;
  /** By test: the level that raises an alarm. */
  thresholds: {[name: string]: number};
  /** Runs without faults that were simulated. */
  seeds: number;
  /** Time simulated in all, in hours. */
  hours: number;
  /** Time in s before which nothing is judged: the observer is still settling. */
  from_time: number;
  /** What limits the calibration, where something does. */
  note: Text | null;
}

/** Everything that a form needs. */
export interface Catalogue {
  plants: (PlantLine)[];
  experiments: (ExperimentLine)[];
  observers: (ObserverKind)[];
  faults: (FaultForm)[];
  signals: (SignalForm)[];
}

/** One fault θ and the equations it enters: coefficient·θ is added to each equation named. */
export interface Channel {
  /** Name of the fault; the equations do not mention it. */
  name: string;
  title: string;
  /** Actuator faults enter state equations, sensor faults output equations, process faults both. */
  kind: 'actuator' | 'process' | 'sensor';
  /** State or output: the coefficient of θ in its equation. */
  enters: {[name: string]: string};
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Typical size of the fault, in its unit. */
  typical: number;
  /** Range that makes sense, in the channel's unit. */
  bounds: [number | null, number | null];
  description: string;
}

/** One fault θ and the equations it enters: coefficient·θ is added to each equation named. */
export interface ChannelInput {
  /** Name of the fault; the equations do not mention it. */
  name: string;
  title?: string | {[name: string]: string};
  /** Actuator faults enter state equations, sensor faults output equations, process faults both. */
  kind: 'actuator' | 'process' | 'sensor';
  /** State or output: the coefficient of θ in its equation. */
  enters: {[name: string]: string};
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Typical size of the fault, in its unit. */
  typical?: number;
  /** Range that makes sense, in the channel's unit. */
  bounds?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** offset + amplitude·sin(2π(f0·t + (f1−f0)·t²/(2·duration))); from `duration` on the frequency stays f1. */
export interface ChirpSignal {
  kind: 'chirp';
  /** Amplitude, in the signal's unit. */
  amplitude: number;
  /** Frequency at t = 0 in Hz. */
  f0: number;
  /** Frequency at `duration` in Hz. */
  f1: number;
  /** Length of the sweep in s. */
  duration: number;
  /** Mean value, in the signal's unit. */
  offset: number;
}

/** offset + amplitude·sin(2π(f0·t + (f1−f0)·t²/(2·duration))); from `duration` on the frequency stays f1. */
export interface ChirpSignalInput {
  kind: 'chirp';
  /** Amplitude, in the signal's unit. */
  amplitude: number;
  /** Frequency at t = 0 in Hz. */
  f0: number;
  /** Frequency at `duration` in Hz. */
  f1: number;
  /** Length of the sweep in s. */
  duration: number;
  /** Mean value, in the signal's unit. */
  offset?: number;
}

/** End faults now: those of one channel, of one output, or all. */
export interface Clear {
  /** Number that the client gives the command. */
  id: number;
  type: 'clear';
  channel?: string | null;
  output?: string | null;
}

export type ClientMessage = Play | Pause | Step | Speed | Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | AddObserverNow | RemoveObserverNow | Reset | Seek | Batch;

/** The columns change from this row on (observers added or removed); a new epoch begins. */
export interface Columns {
  type: 'columns';
  epoch: number;
  row: number;
  columns: (string)[];
}

/** The observers of a run on the same data; backend/thetascope/diagnosis/evaluation/observer_comparison.py defines each measure. */
export interface Comparison {
  windows: (Window)[];
  observers: (ComparisonRow)[];
}

/** One observer's part of the comparison. Counts of alarms and faults are null if no tests ran on it. */
export interface ComparisonRow {
  label: string;
  /** Root mean square error by column (x.…, theta.…), one a window; null: not all rows have a number. */
  rmse: {[name: string]: (number | null)[]};
  /** Largest error likewise. */
  peak: {[name: string]: (number | null)[]};
  steps: (StepFollowed)[];
  /** The outcome for each fault, in order of time. */
  faults: (FaultOutcome)[] | null;
  /** The verdict on each alarm, in order of time. */
  alarms: (AlarmOutcome)[] | null;
  /** Faults that an alarm found. */
  found: number | null;
  /** Faults for whose channel an alarm was on already when they began. */
  covered: number | null;
  /** Faults neither found nor covered. */
  missed: number | null;
  /** Alarms raised while no fault was present, nor just before. */
  false_alarms: number | null;
  /** Alarms raised during a fault that name none of those present. */
  isolation_errors: number | null;
  /** Median delay in s of the faults found. */
  delay: number | null;
  /** Seconds after a fault within which an alarm is not false: θ̂ is coming back. */
  grace: number;
  /** Processor time in µs per simulated second, measured: another number each time. */
  cost: number | null;
}

/** The same value at all times. */
export interface ConstantSignal {
  kind: 'constant';
  /** Value, in the signal's unit. */
  value: number;
}

/** The same value at all times. */
export interface ConstantSignalInput {
  kind: 'constant';
  /** Value, in the signal's unit. */
  value: number;
}

/** Observers see y(t) at all times. */
export interface ContinuousMeasurement {
  mode: 'continuous';
}

/** Observers see y(t) at all times. */
export interface ContinuousMeasurementInput {
  mode: 'continuous';
}

/** The dynamics give derivatives. */
export interface ContinuousTime {
  kind: 'continuous';
}

/** The dynamics give derivatives. */
export interface ContinuousTimeInput {
  kind: 'continuous';
}

/** An intermediate quantity. The plant uses it as it is; observers saturate it to its domain. */
export interface Definition {
  /** Name in later definitions and in the equations. */
  name: string;
  /** Expression of states, inputs, earlier definitions, …. */
  expression: string;
  /** Physical range [low, high]: numbers, parameter names, or null for an open side. */
  domain: [number | string | null, number | string | null];
}

/** An intermediate quantity. The plant uses it as it is; observers saturate it to its domain. */
export interface DefinitionInput {
  /** Name in later definitions and in the equations. */
  name: string;
  /** Expression of states, inputs, earlier definitions, …. */
  expression: string;
  /** Physical range [low, high]: numbers, parameter names, or null for an open side. */
  domain?: [number | string | null, number | string | null];
}

/** The output arrives late. */
export interface DelayFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'delay';
  /** Delay in s. */
  delay: number;
}

/** The output arrives late. */
export interface DelayFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'delay';
  /** Delay in s. */
  delay: number;
}

/** The diagnosis of a run: by the detector, which looks at what was measured, and by each observer's own estimates. */
export interface Diagnosis {
  /** What the detector says: it watches the plant, not the observers. */
  detector: ObserverDiagnosis;
  /** What tests on each observer's θ̂ say, for comparison. */
  observers: (ObserverDiagnosis)[];
}

/** The diagnosis of the session so far. A newer one replaces an older one. */
export interface DiagnosisNow {
  type: 'diagnosis';
  diagnosis: ObserverDiagnosis;
}

/** What is asked of the diagnosis. Thresholds follow from it by simulation; none is typed in. */
export interface DiagnosisSettings {
  /** Whether anything is diagnosed at all. */
  enabled: boolean;
  /** False alarms per hour that are put up with, of each observer. */
  false_alarms: number;
  /** Test of the estimates that raises alarms. */
  test: 'glr' | 'cusum' | 'threshold';
  /** Of bands and intervals. */
  confidence: number;
  /** Share of a state's size by which its equation may be off within the plant's time constant. */
  doubt: number;
  /** Time in s that thresholds are simulated over and decisions are spaced for; null: the horizon. */
  span: number | null;
  /** Standard deviation asked of an estimate, as a share of the channel's typical fault. */
  accuracy: number;
}

/** What is asked of the diagnosis. Thresholds follow from it by simulation; none is typed in. */
export interface DiagnosisSettingsInput {
  /** Whether anything is diagnosed at all. */
  enabled?: boolean;
  /** False alarms per hour that are put up with, of each observer. */
  false_alarms?: number;
  /** Test of the estimates that raises alarms. */
  test?: 'glr' | 'cusum' | 'threshold';
  /** Of bands and intervals. */
  confidence?: number;
  /** Share of a state's size by which its equation may be off within the plant's time constant. */
  doubt?: number;
  /** Time in s that thresholds are simulated over and decisions are spaced for; null: the horizon. */
  span?: number | null;
  /** Standard deviation asked of an estimate, as a share of the channel's typical fault. */
  accuracy?: number;
}

/** The dynamics give the next sample's values. */
export interface DiscreteTime {
  kind: 'discrete';
  /** Sample period in s. */
  period: number;
}

/** The dynamics give the next sample's values. */
export interface DiscreteTimeInput {
  kind: 'discrete';
  /** Sample period in s. */
  period: number;
}

/** When a plant or an observer left all bounds, and the likely cause. */
export interface Divergence {
  /** Time in s from which the values are missing. */
  time: number;
  /** The likely cause. */
  cause: Text;
}

/** θ = rate·τ, without end. */
export interface DriftFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'drift';
  /** Rate, in the channel's unit per s. */
  rate: number;
}

/** θ = rate·τ, without end. */
export interface DriftFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'drift';
  /** Rate, in the channel's unit per s. */
  rate: number;
}

/** Each sample is lost with a probability; a lost one leaves the last value in place. */
export interface DropoutFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'dropout';
  /** Probability that a sample is lost. */
  probability: number;
  /** Time in s between samples. */
  sample_time: number;
}

/** Each sample is lost with a probability; a lost one leaves the last value in place. */
export interface DropoutFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'dropout';
  /** Probability that a sample is lost. */
  probability: number;
  /** Time in s between samples. */
  sample_time?: number;
}

/** A fault channel beside the equations. */
export interface EquationChannel {
  name: string;
  title: string;
  kind: string;
  unit: string;
}

/** One equation of a plant as MathML. */
export interface EquationLine {
  name: string;
  unit: string;
  description: string;
  math: string;
}

/** The equations of a plant and of kinds of observers. */
export interface Equations {
  plant: PlantEquations;
  observers: {[name: string]: ObserverEquations};
}

/** An event for the log. It is never dropped. */
export interface Event {
  type: 'event';
  row: number;
  t: number;
  kind: 'inject' | 'clear' | 'fault-begins' | 'fault-ends' | 'gain' | 'signal' | 'noise' | 'observer-added' | 'observer-removed' | 'alarm' | 'alarm-over' | 'diverged' | 'rewound' | 'reset' | 'substeps';
  /** Channel, output, observer label or signal; of "diverged", empty if it is the plant itself. */
  subject: string;
  /** The observer that raised it (alarms). */
  observer: string;
  /** Id of the fault that it is about (inject, fault-begins, fault-ends). */
  fault: string;
  /** Size, gain value, estimate … */
  value: JsonValue;
  /** The event in a sentence. */
  message: Text;
}

/** What the input tells about the faults: the smallest eigenvalue of the windowed Gramian of Ω in typical faults. */
export interface Excitation {
  /** Length of the window in s. */
  window: number;
  /** Smallest eigenvalue, in (typical fault / its standard deviation)². */
  level: number | null;
  /** Level that the accuracy asked for needs. */
  needed: number;
  /** The combination of faults that is seen least, per channel. */
  direction: {[name: string]: number};
  /** In words: what cannot be told apart. */
  text: Text | null;
  /** An input that would help. */
  proposal: string | null;
}

/** Everything that determines a run. The same spec gives the same numbers, bit for bit. */
export interface Experiment {
  id: string;
  title: string;
  description: string;
  /** Where the experiment comes from. */
  source: string;
  /** Where the printed source cannot be right. */
  errata: (string)[];
  /** Id of a library plant, or a plant in full. */
  plant: string | Plant;
  /** Parameters that differ. */
  parameters: {[name: string]: number};
  /** Initial states that differ. */
  initial: {[name: string]: number};
  /** Input: its course u(t). */
  inputs: {[name: string]: ConstantSignal | StepsSignal | PulseSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | TableSignal | ExpressionSignal};
  /** Known signal: its course φ(t). */
  signals: {[name: string]: ConstantSignal | StepsSignal | PulseSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | TableSignal | ExpressionSignal};
  faults: (StepFault | RampFault | DriftFault | ExponentialFault | SineFault | PulseTrainFault | RandomWalkFault | TableFault | StuckFault | FreezeFault | DropoutFault | OutliersFault | NoiseBurstFault | QuantisationFault | DelayFault)[];
  /** Output: its measurement noise. */
  noise: {[name: string]: Noise};
  /** Seed of all random numbers. */
  seed: number;
  /** End of the run in s. */
  horizon: number;
  /** Step of the integration in s; the period of a discrete plant. */
  step: number;
  /** Spacing of recorded rows in s, a multiple of the step; null: about 10 000 rows. */
  record: number | null;
  /** Steps that are taken within each step; null: one, or as many as stiff gains need. */
  substeps: number | null;
  measurement: ContinuousMeasurement | SampledMeasurement;
  observers: (ObserverConfig)[];
  /** What is changed while it runs, in order of time; faults apart. */
  commands: (SetGain | SetSignal | SetNoise | AddObserver | RemoveObserver | SetSubsteps)[];
  /** What is asked of the diagnosis. */
  diagnosis: DiagnosisSettings;
  figures: (Figure)[];
}

/** Everything that determines a run. The same spec gives the same numbers, bit for bit. */
export interface ExperimentInput {
  id?: string;
  title?: string | {[name: string]: string};
  description?: string | {[name: string]: string};
  /** Where the experiment comes from. */
  source?: string | {[name: string]: string};
  /** Where the printed source cannot be right. */
  errata?: (string | {[name: string]: string})[];
  /** Id of a library plant, or a plant in full. */
  plant: string | PlantInput;
  /** Parameters that differ. */
  parameters?: {[name: string]: number};
  /** Initial states that differ. */
  initial?: {[name: string]: number};
  /** Input: its course u(t). */
  inputs?: {[name: string]: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | TableSignalInput | ExpressionSignalInput};
  /** Known signal: its course φ(t). */
  signals?: {[name: string]: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | TableSignalInput | ExpressionSignalInput};
  faults?: (StepFaultInput | RampFaultInput | DriftFaultInput | ExponentialFaultInput | SineFaultInput | PulseTrainFaultInput | RandomWalkFaultInput | TableFaultInput | StuckFaultInput | FreezeFaultInput | DropoutFaultInput | OutliersFaultInput | NoiseBurstFaultInput | QuantisationFaultInput | DelayFaultInput)[];
  /** Output: its measurement noise. */
  noise?: {[name: string]: NoiseInput};
  /** Seed of all random numbers. */
  seed?: number;
  /** End of the run in s. */
  horizon: number;
  /** Step of the integration in s; the period of a discrete plant. */
  step?: number;
  /** Spacing of recorded rows in s, a multiple of the step; null: about 10 000 rows. */
  record?: number | null;
  /** Steps that are taken within each step; null: one, or as many as stiff gains need. */
  substeps?: number | null;
  measurement?: ContinuousMeasurementInput | SampledMeasurementInput;
  observers?: (ObserverConfigInput)[];
  /** What is changed while it runs, in order of time; faults apart. */
  commands?: (SetGainInput | SetSignalInput | SetNoiseInput | AddObserverInput | RemoveObserverInput | SetSubstepsInput)[];
  /** What is asked of the diagnosis. */
  diagnosis?: DiagnosisSettingsInput;
  figures?: (FigureInput)[];
}

/** An experiment in a list. */
export interface ExperimentLine {
  id: string;
  title: string;
  description: string;
  source: string;
  /** Id of the plant. */
  plant: string;
  horizon: number;
  step: number;
  /** Labels. */
  observers: (string)[];
  href: string;
}

/** The experiments of the library. */
export interface ExperimentList {
  experiments: (ExperimentLine)[];
}

/** Incipient fault: θ = size·(1 − exp(−τ/time_constant)). */
export interface ExponentialFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'exponential';
  /** Size it tends to, in the channel's unit. */
  size: number;
  /** Time constant in s. */
  time_constant: number;
}

/** Incipient fault: θ = size·(1 − exp(−τ/time_constant)). */
export interface ExponentialFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'exponential';
  /** Size it tends to, in the channel's unit. */
  size: number;
  /** Time constant in s. */
  time_constant: number;
}

/** A smooth function of the time t, as text. */
export interface ExpressionSignal {
  kind: 'expression';
  /** Expression of t alone. */
  text: string;
}

/** A smooth function of the time t, as text. */
export interface ExpressionSignalInput {
  kind: 'expression';
  /** Expression of t alone. */
  text: string;
}

/** Everything that follows from the experiment and its findings at one time, computed by one function for all. */
export interface Facts {
  /** The time in s: of a run, its end; of a session, the last row that was shown. */
  t: number;
  observers: (ObserverNow)[];
  /** All faults so far and to come, in the order of the experiment. */
  faults: (FaultNow)[];
  /** Measurement noise of every output that has some. */
  noise: {[name: string]: Noise};
  /** Time in s at which the plant itself diverged. */
  broken: number | null;
  /** The detector's alarms up to that time, in order of time. */
  alarms: (Alarm)[];
  /** The verdict on each of them. */
  alarm_verdicts: (AlarmOutcome)[];
  /** The outcome for each fault so far. */
  fault_outcomes: (FaultOutcome)[];
  /** Ids of the faults that act and that no alarm names now, one a site. */
  unseen: (string)[];
  /** The diagnosis in one sentence. */
  summary: Text;
}

/** The facts at the row that is shown, after every change of them. A newer one replaces an older one. */
export interface FactsNow {
  type: 'facts';
  /** Rows shown so far. */
  row: number;
  facts: Facts;
}

/** A fault shape with its fields. */
export interface FaultForm {
  shape: string;
  on: 'channel' | 'output';
  description: string;
  fields: (FormField)[];
  example: {[name: string]: JsonValue};
}

/** A fault of the experiment, and whether it acts at that time. */
export interface FaultNow {
  /** Id within the run or session; it stays when the fault is cleared. */
  id: string;
  /** Name of the channel or output. */
  subject: string;
  kind: 'channel' | 'output';
  shape: string;
  /** The fault itself; its times count from the start. */
  fault: StepFault | RampFault | DriftFault | ExponentialFault | SineFault | PulseTrainFault | RandomWalkFault | TableFault | StuckFault | FreezeFault | DropoutFault | OutliersFault | NoiseBurstFault | QuantisationFault | DelayFault;
  /** Time in s at which it begins. */
  onset: number;
  /** Time in s at which it ends; null: it stays. */
  end: number | null;
  /** Whether it acts. In a session: from the next row on. */
  active: boolean;
  /** Whether it is over. */
  ended: boolean;
}

/** The outcome for one fault: whether an observer's alarms found it (diagnosis/evaluation/verdicts.py has the rule). */
export interface FaultOutcome {
  /** Id of the fault within the experiment or session. */
  id: string;
  /** A channel of the model, or a measurement. */
  kind: 'channel' | 'output';
  /** Name of the channel or output. */
  name: string;
  /** Time in s at which it began. */
  onset: number;
  /** Time in s until which it could be found; null: the end of the run. */
  until: number | null;
  /** Covered: an alarm for its channel was on when it began, so none could be raised. */
  outcome: 'found' | 'covered' | 'missed';
  /** Seconds from the onset to the alarm that found it. */
  delay: number | null;
  /** Found only as one of the alternatives that an alarm leaves open. */
  alternative: boolean;
  /** Id of the alarm that found or covers it; empty: none. */
  alarm: string;
}

/** One reason for a refusal: the field, the value that arrived, the problem and the remedy. */
export interface FieldError {
  /** Path of the field, for example faults[0].end. */
  field: string;
  /** The value that arrived, shortened. */
  value: unknown;
  /** Key of the problem's sentence in the catalogues, GET /api/messages/{language}. */
  code: string;
  /** Arguments of both sentences by name. */
  args: {[name: string]: JsonValue};
  /** What is wrong with the value, in the asked language. */
  problem: string;
  /** How to correct it, in the asked language. */
  remedy: string;
}

/** One figure of an experiment, panels below one another. */
export interface Figure {
  /** Name in the address. */
  name: string;
  title: string;
  caption: string;
  panels: (Panel)[];
}

/** One figure of an experiment, panels below one another. */
export interface FigureInput {
  /** Name in the address. */
  name: string;
  title?: string | {[name: string]: string};
  caption?: string | {[name: string]: string};
  panels: (PanelInput)[];
}

/** A figure of a run. */
export interface FigureLine {
  name: string;
  title: string;
  href: string;
}

/** The figures of a run. */
export interface FigureList {
  figures: (FigureLine)[];
}

/** An estimate over the last tenth of the run, in the channel's unit. */
export interface FinalValue {
  /** The true value at the end. */
  truth: number | null;
  /** The estimate at the end. */
  estimate: number | null;
  /** Estimate less truth at the end. */
  error: number | null;
  /** Mean of estimate less truth. */
  mean_error: number | null;
  /** Standard deviation of estimate less truth. */
  std: number | null;
}

/** The time from which a second session continues on its own. */
export interface ForkRequest {
  /** Time in s, at most that of the session; null: the present. */
  t?: number | null;
}

/** A field of a fault or signal as a form shows it. */
export interface FormField {
  name: string;
  /** JSON type, or choice. */
  type: string;
  required: boolean;
  nullable: boolean;
  description: string;
  default: JsonValue;
  minimum: number | null;
  /** Exclusive lower bound. */
  above: number | null;
  maximum: number | null;
  choices: (string)[] | null;
}

/** The sensor goes on showing what it showed at the onset. */
export interface FreezeFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'freeze';
}

/** The sensor goes on showing what it showed at the onset. */
export interface FreezeFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'freeze';
}

/** A gain of an observer: its meaning, default and bounds. */
export interface GainForm {
  name: string;
  meaning: string;
  /** null: it depends on the plant and its noise. */
  default: number | (number)[] | null;
  low: number;
  high: number;
  /** Length of a column or rows of a matrix (n, m, p, …), null for a number. */
  size: string | null;
  /** Columns of a matrix (n, m, p, …), null for a number or a column. */
  columns: string | null;
  symbol: string;
  unit: string;
  /** Whether moving it during a run has an effect. */
  live: boolean;
}

/** Labels of a gain that is a column or a matrix. */
export interface GainLabels {
  /** States, outputs, channels or coordinates that the rows belong to. */
  rows: (string)[];
  /** The same for columns; empty for a column gain. */
  columns: (string)[];
}

/** The first message on a connection: everything that a page needs to draw itself. */
export interface Hello {
  type: 'hello';
  protocol: number;
  session: string;
  role: 'control' | 'view';
  /** The experiment with the faults and timed commands so far, its plant in full. */
  spec: Experiment;
  columns: (string)[];
  epoch: number;
  step: number;
  /** Time in s between rows. */
  record: number;
  /** Number of rows so far, which is the number of the next row. */
  row: number;
  playing: boolean;
  speed: number | null;
  /** The session that this one was forked from. */
  parent: string | null;
  /** All events so far. */
  log: (Event)[];
  /** Observers, faults, noise, alarms and verdicts at the row that is shown. */
  facts: Facts;
}

/** Inject a fault. Its onset and end count from now. */
export interface Inject {
  /** Number that the client gives the command. */
  id: number;
  type: 'inject';
  fault: StepFaultInput | RampFaultInput | DriftFaultInput | ExponentialFaultInput | SineFaultInput | PulseTrainFaultInput | RandomWalkFaultInput | TableFaultInput | StuckFaultInput | FreezeFaultInput | DropoutFaultInput | OutliersFaultInput | NoiseBurstFaultInput | QuantisationFaultInput | DelayFaultInput;
}

/** One known input u. */
export interface Input {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Value where an experiment gives no signal, in the input's unit. */
  default: number;
  /** Range that makes sense, in the input's unit. */
  bounds: [number | null, number | null];
  description: string;
}

/** One known input u. */
export interface InputInput {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Value where an experiment gives no signal, in the input's unit. */
  default?: number;
  /** Range that makes sense, in the input's unit. */
  bounds?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** An input that would restore excitation, or why there is none: `signal` can be sent as it is with set-signal. */
export interface InputProposal {
  /** The input to be changed; null: nothing that was tried helps. */
  input: string | null;
  /** Its course from now on. */
  signal: ConstantSignal | StepsSignal | PulseSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | TableSignal | ExpressionSignal | null;
  /** Smallest eigenvalue that it would reach, in (typical fault / its deviation)². */
  level: number;
  /** The same with the input as it is. */
  before: number;
  /** Level that the accuracy asked for needs. */
  needed: number;
  /** The proposal in a sentence, or why there is none. */
  text: Text;
}

export type JsonValue = unknown;

/** Rows `first` … `row` − 1 are not sent, because this viewer is too far behind; GET /api/sessions/{id}/data has them. */
export interface Jump {
  type: 'jump';
  epoch: number;
  first: number;
  row: number;
}

/** One known signal φ(t), which observers see. */
export interface KnownSignal {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  description: string;
  /** Its course where an experiment gives none. */
  default: ConstantSignal | StepsSignal | PulseSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | TableSignal | ExpressionSignal;
}

/** One known signal φ(t), which observers see. */
export interface KnownSignalInput {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  description?: string | {[name: string]: string};
  /** Its course where an experiment gives none. */
  default?: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | TableSignalInput | ExpressionSignalInput;
}

/** All lessons. */
export interface LessonList {
  lessons: (LessonPlan)[];
}

/** The questions about one experiment. */
export interface LessonPlan {
  id: string;
  questions: (LessonQuestion)[];
}

/** A question, and the commands of a live session that show its answer. The sender numbers them. */
export interface LessonQuestion {
  question: Words;
  do: ({[name: string]: JsonValue})[];
}

/** Gaussian measurement noise on one output; a drawn value holds for its sample time. */
export interface Noise {
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time: number;
}

/** Additional Gaussian noise. */
export interface NoiseBurstFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'noise-burst';
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time: number;
}

/** Additional Gaussian noise. */
export interface NoiseBurstFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'noise-burst';
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time?: number;
}

/** Gaussian measurement noise on one output; a drawn value holds for its sample time. */
export interface NoiseInput {
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time?: number;
}

/** Noise of one output: as declared, and as the residual shows it. */
export interface NoiseLevel {
  /** The measured output. */
  output: string;
  /** Standard deviation that the experiment declares; null: none. */
  declared: number | null;
  /** Standard deviation as the residual shows it; null: not known. */
  estimated: number | null;
}

/** One equation of an observer as MathML, with its number in the paper. */
export interface NumberedEquation {
  number: string;
  math: string;
}

/** What the outputs show of the states and of all faults together: by the equations, and along a run. */
export interface Observability {
  /** Generic rank of the observability matrix of states and faults (Lie derivatives); null: not decided. */
  rank: number | null;
  /** States and faults. */
  size: number;
  /** What no input could tell apart, in words. */
  text: Text;
  /** Length in s of the windows along the run. */
  window: number;
  /** When they begin, in s. */
  t: (number)[];
  /** Rank of the empirical Gramian over each; null: the plant does not stay finite. */
  ranks: (number | null)[];
  /** Its condition, in units of typical sizes; null below full rank. */
  conditions: (number | null)[];
  /** The same in words, with the combination that is seen least. */
  along: Text;
}

/** One observer of an experiment. Gains, options and their defaults are listed per kind in the catalogue. */
export interface ObserverConfig {
  /** Label, unique in the experiment; its columns start with it. */
  label: string;
  /** Kind, from the catalogue. */
  kind: string;
  /** Gains that differ from their defaults: a number, a list for a column, or a list of rows for a matrix. */
  gains: {[name: string]: number | (number)[] | ((number)[])[]};
  /** Options that differ from their defaults. */
  options: {[name: string]: boolean | string | number};
  /** Estimates at t = 0 by state or channel, in their units. Where none is given, a state starts from the plant's own initial value and a channel from 0. */
  initial: {[name: string]: number};
}

/** One observer of an experiment. Gains, options and their defaults are listed per kind in the catalogue. */
export interface ObserverConfigInput {
  /** Label, unique in the experiment; its columns start with it. */
  label: string;
  /** Kind, from the catalogue. */
  kind: string;
  /** Gains that differ from their defaults: a number, a list for a column, or a list of rows for a matrix. */
  gains?: {[name: string]: number | (number)[] | ((number)[])[]};
  /** Options that differ from their defaults. */
  options?: {[name: string]: boolean | string | number};
  /** Estimates at t = 0 by state or channel, in their units. Where none is given, a state starts from the plant's own initial value and a channel from 0. */
  initial?: {[name: string]: number};
}

/** What one observer says about the faults. */
export interface ObserverDiagnosis {
  /** Label of the observer; empty: the detector, which watches the plant itself. */
  observer: string;
  /** What was found, in order of time. */
  alarms: (Alarm)[];
  /** By channel: how small a fault can be and still be found. */
  resolution: (Resolution)[];
  /** What the input tells about the faults, at the end. */
  excitation: Excitation | null;
  /** Where the thresholds come from. */
  calibration: Calibration | null;
  /** Noise of each output. */
  noise: (NoiseLevel)[];
  /** The diagnosis in a sentence. */
  sentence: Text | null;
  /** Why there is no diagnosis, where there is none. */
  note: Text | null;
}

/** The equations of one kind of observer. */
export interface ObserverEquations {
  title: string;
  source: string;
  equations: (NumberedEquation)[];
  where: (WhereLine)[];
}

/** The figures of one observer over a window. */
export interface ObserverInWindow {
  label: string;
  /** Root mean square error of the state; null: not all rows have a value. */
  rmse: number | null;
  /** Standard deviation of θ̂ about its straight line, over the last quarter. */
  noise: number | null;
  /** Seconds from the step of θ until θ̂ stays within 10 % of its size. */
  settled: number | null;
  /** Too noisy: θ̂ has reached θ, but noise keeps moving it out of the 10 %. Unknown: no step, or no θ̂. */
  outcome: 'settled' | 'not-yet' | 'too-noisy' | 'unknown';
}

/** A kind of observer with its gains and options. */
export interface ObserverKind {
  id: string;
  title: string;
  source: string;
  summary: string;
  time: string;
  estimates_theta: boolean;
  gains: (GainForm)[];
  options: (OptionForm)[];
}

/** When an observer diverged, and the likely cause. */
export interface ObserverLost {
  /** Time in s. */
  t: number;
  /** The likely cause. */
  cause: Text;
}

/** An observer that runs at that time. */
export interface ObserverNow {
  label: string;
  kind: string;
  /** Present values of the gains that were set; others have their defaults. */
  gains: {[name: string]: number | (number)[] | ((number)[])[]};
  options: {[name: string]: JsonValue};
  /** Its configuration when it was started. */
  config: ObserverConfig;
  /** Time in s at which it was started. */
  since: number;
  diverged: ObserverLost | null;
}

/** What came out for one observer. */
export interface ObserverSummary {
  label: string;
  kind: string;
  /** The name of the kind. */
  title: Text | null;
  diverged: Divergence | null;
  /** Root mean square error per state over the run, null where undefined. */
  rmse: {[name: string]: number | null};
  /** The same over the last tenth of the run. */
  rmse_end: {[name: string]: number | null};
  /** Estimate of each channel at the end. */
  theta: {[name: string]: FinalValue};
  /** How soon each step of a fault was followed. */
  settling: (Settling)[];
  checks: (AssumptionCheck)[];
  /** What the observer reports about itself. */
  facts: {[name: string]: JsonValue};
}

/** A structural option of an observer. Another value means other equations. */
export interface OptionForm {
  name: string;
  meaning: string;
  kind: string;
  default: JsonValue;
  choices: (string)[];
  low: number;
  high: number;
}

/** Each sample is displaced by ±size with a probability. */
export interface OutliersFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'outliers';
  /** Probability that a sample is an outlier. */
  probability: number;
  /** Displacement, in the output's unit. */
  size: number;
  /** Time in s between samples. */
  sample_time: number;
}

/** Each sample is displaced by ±size with a probability. */
export interface OutliersFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'outliers';
  /** Probability that a sample is an outlier. */
  probability: number;
  /** Displacement, in the output's unit. */
  size: number;
  /** Time in s between samples. */
  sample_time?: number;
}

/** One measured output y. */
export interface Output {
  /** Name of the output. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Output equation, without the sensor faults. */
  expression: string;
  description: string;
}

/** One measured output y. */
export interface OutputInput {
  /** Name of the output. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Output equation, without the sensor faults. */
  expression: string;
  description?: string | {[name: string]: string};
}

/** One pair of axes. */
export interface Panel {
  title: string;
  /** Column of the horizontal axis. */
  x: string;
  x_title: string;
  y_title: string;
  /** Logarithmic vertical axis. */
  log: boolean;
  traces: (Trace)[];
}

/** One pair of axes. */
export interface PanelInput {
  title?: string | {[name: string]: string};
  /** Column of the horizontal axis. */
  x?: string;
  x_title?: string | {[name: string]: string};
  y_title?: string | {[name: string]: string};
  /** Logarithmic vertical axis. */
  log?: boolean;
  traces: (TraceInput)[];
}

/** One constant of the plant, which an experiment may override. */
export interface Parameter {
  /** Name in the equations. */
  name: string;
  /** Nominal value, in the parameter's unit. */
  value: number;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Permitted range, in the parameter's unit. */
  bounds: [number | null, number | null];
  description: string;
}

/** One constant of the plant, which an experiment may override. */
export interface ParameterInput {
  /** Name in the equations. */
  name: string;
  /** Nominal value, in the parameter's unit. */
  value: number;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Permitted range, in the parameter's unit. */
  bounds?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** Stop time. */
export interface Pause {
  /** Number that the client gives the command. */
  id: number;
  type: 'pause';
}

/** A plant x' = f(x,u,φ,t) + Σ coefficient·θ, y = h(x,u,φ,t) + Σ coefficient·θ (x(k+1) in discrete time). */
export interface Plant {
  /** Short name: lower-case letters, digits and hyphens. */
  id: string;
  title: string;
  description: string;
  /** Where the plant comes from. */
  source: string;
  /** Continuous, or discrete with a period. */
  time: ContinuousTime | DiscreteTime;
  states: (State)[];
  inputs: (Input)[];
  outputs: (Output)[];
  parameters: (Parameter)[];
  signals: (KnownSignal)[];
  /** Intermediate quantities, in order. */
  definitions: (Definition)[];
  /** State: its derivative, or its next value in discrete time. */
  dynamics: {[name: string]: string};
  /** The faults that can occur. */
  channels: (Channel)[];
}

/** The report on a plant's text. */
export interface PlantCheck {
  id: string;
  valid: true;
  time: 'continuous' | 'discrete';
  sizes: PlantSizes;
  channels: (string)[];
  Phi: ((string)[])[];
  Psi: ((string)[])[];
  affine: {[name: string]: boolean};
  observability: StructuralObservability;
  observers: (PossibleObserver)[];
}

/** The equations of a plant with its faults in them. */
export interface PlantEquations {
  id: string;
  title: string;
  source: string;
  time: 'continuous' | 'discrete';
  channels: (EquationChannel)[];
  states: (EquationLine)[];
  definitions: (EquationLine)[];
  outputs: (EquationLine)[];
}

/** A plant x' = f(x,u,φ,t) + Σ coefficient·θ, y = h(x,u,φ,t) + Σ coefficient·θ (x(k+1) in discrete time). */
export interface PlantInput {
  /** Short name: lower-case letters, digits and hyphens. */
  id: string;
  title?: string | {[name: string]: string};
  description?: string | {[name: string]: string};
  /** Where the plant comes from. */
  source?: string | {[name: string]: string};
  /** Continuous, or discrete with a period. */
  time?: ContinuousTimeInput | DiscreteTimeInput;
  states: (StateInput)[];
  inputs?: (InputInput)[];
  outputs: (OutputInput)[];
  parameters?: (ParameterInput)[];
  signals?: (KnownSignalInput)[];
  /** Intermediate quantities, in order. */
  definitions?: (DefinitionInput)[];
  /** State: its derivative, or its next value in discrete time. */
  dynamics: {[name: string]: string};
  /** The faults that can occur. */
  channels?: (ChannelInput)[];
}

/** A plant in a list. */
export interface PlantLine {
  id: string;
  title: string;
  description: string;
  source: string;
  time: 'continuous' | 'discrete';
  states: number;
  outputs: number;
  /** Names of the fault channels. */
  channels: (string)[];
  href: string;
}

/** The plants of the library. */
export interface PlantList {
  plants: (PlantLine)[];
}

/** Dimensions of a plant. */
export interface PlantSizes {
  states: number;
  inputs: number;
  outputs: number;
  channels: number;
}

/** Let time run. */
export interface Play {
  /** Number that the client gives the command. */
  id: number;
  type: 'play';
}

/** One figure as Plotly's JSON, its arrays as base64. */
export interface PlotlyFigure {
  data: ({[name: string]: JsonValue})[];
  layout: {[name: string]: JsonValue};
}

/** Whether a kind of observer can be built for a plant, and the reason if not. */
export interface PossibleObserver {
  kind: string;
  title: string;
  possible: boolean;
  why: string;
}

/** Pseudo-random binary sequence: every `hold` seconds `low` or `high`, drawn from its own seed. */
export interface PrbsSignal {
  kind: 'prbs';
  /** The one value. */
  low: number;
  /** The other value. */
  high: number;
  /** Time in s for which a drawn value holds. */
  hold: number;
  /** Seed of the sequence. */
  seed: number;
}

/** Pseudo-random binary sequence: every `hold` seconds `low` or `high`, drawn from its own seed. */
export interface PrbsSignalInput {
  kind: 'prbs';
  /** The one value. */
  low?: number;
  /** The other value. */
  high?: number;
  /** Time in s for which a drawn value holds. */
  hold: number;
  /** Seed of the sequence. */
  seed?: number;
}

/** Every gain of every observer of an experiment, by label and name. */
export interface PresentGains {
  gains: {[name: string]: {[name: string]: number | (number)[] | ((number)[])[]}};
  /** Labels of gains that are columns or matrices, by observer and gain. */
  labels: {[name: string]: {[name: string]: GainLabels}};
}

/** A refusal or failure as application/problem+json (RFC 9457), with its sentences in the asked language. */
export interface Problem {
  /** URI reference of the kind of problem. */
  type: string;
  /** Short text, the same for every problem of this kind. */
  title: string;
  /** HTTP status. */
  status: number;
  /** What happened here, and what to do. */
  detail: string;
  /** Key of the problem's sentence in the catalogues, GET /api/messages/{language}. */
  code: string;
  /** Arguments of the sentence by name. */
  args: {[name: string]: JsonValue};
  /** URI reference of this occurrence. */
  instance: string | null;
  /** Each field at fault, its value, the problem, the remedy. */
  errors: (FieldError)[];
}

/** How far a run is. */
export interface Progress {
  /** The run's id. */
  id: string;
  status: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  /** Share done, 0 to 1. */
  progress: number;
  detail: string;
  /** Why it failed. */
  problem: Problem | null;
  links: {[name: string]: string};
}

/** `high` on [start + k·period, start + k·period + width) for k = 0, 1, …, otherwise `low`. */
export interface PulseSignal {
  kind: 'pulse';
  /** Value outside the pulses. */
  low: number;
  /** Value within the pulses (may lie below `low`). */
  high: number;
  /** Period in s. */
  period: number;
  /** Length of one pulse in s, at most the period. */
  width: number;
  /** Start of the first pulse in s. */
  start: number;
}

/** `high` on [start + k·period, start + k·period + width) for k = 0, 1, …, otherwise `low`. */
export interface PulseSignalInput {
  kind: 'pulse';
  /** Value outside the pulses. */
  low?: number;
  /** Value within the pulses (may lie below `low`). */
  high?: number;
  /** Period in s. */
  period: number;
  /** Length of one pulse in s, at most the period. */
  width: number;
  /** Start of the first pulse in s. */
  start?: number;
}

/** Intermittent fault: θ = size on [k·period, k·period + width) of τ, otherwise 0. */
export interface PulseTrainFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'pulse-train';
  /** Size within the pulses, in the channel's unit. */
  size: number;
  /** Period in s. */
  period: number;
  /** Length of one pulse in s, at most the period. */
  width: number;
}

/** Intermittent fault: θ = size on [k·period, k·period + width) of τ, otherwise 0. */
export interface PulseTrainFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'pulse-train';
  /** Size within the pulses, in the channel's unit. */
  size: number;
  /** Period in s. */
  period: number;
  /** Length of one pulse in s, at most the period. */
  width: number;
}

/** The output is rounded to whole multiples of the resolution. */
export interface QuantisationFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'quantisation';
  /** Resolution, in the output's unit. */
  resolution: number;
}

/** The output is rounded to whole multiples of the resolution. */
export interface QuantisationFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'quantisation';
  /** Resolution, in the output's unit. */
  resolution: number;
}

/** θ rises linearly to `size` over `duration`, then stays. */
export interface RampFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'ramp';
  /** Final size, in the channel's unit. */
  size: number;
  /** Time in s to the final size. */
  duration: number;
}

/** θ rises linearly to `size` over `duration`, then stays. */
export interface RampFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'ramp';
  /** Final size, in the channel's unit. */
  size: number;
  /** Time in s to the final size. */
  duration: number;
}

/** `initial` until `start`, then rising by `slope` per second, held from `end` on. */
export interface RampSignal {
  kind: 'ramp';
  /** Start of the ramp in s. */
  start: number;
  /** Slope, in the signal's unit per s. */
  slope: number;
  /** Value until the start. */
  initial: number;
  /** Time in s from which the value is held; null: never. */
  end: number | null;
}

/** `initial` until `start`, then rising by `slope` per second, held from `end` on. */
export interface RampSignalInput {
  kind: 'ramp';
  /** Start of the ramp in s. */
  start?: number;
  /** Slope, in the signal's unit per s. */
  slope: number;
  /** Value until the start. */
  initial?: number;
  /** Time in s from which the value is held; null: never. */
  end?: number | null;
}

/** θ gains a Gaussian increment of std intensity·√sample_time every sample_time; the experiment's seed drives it. */
export interface RandomWalkFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'random-walk';
  /** Standard deviation gained per √s, in the channel's unit. */
  intensity: number;
  /** Time in s between increments. */
  sample_time: number;
}

/** θ gains a Gaussian increment of std intensity·√sample_time every sample_time; the experiment's seed drives it. */
export interface RandomWalkFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'random-walk';
  /** Standard deviation gained per √s, in the channel's unit. */
  intensity: number;
  /** Time in s between increments. */
  sample_time?: number;
}

/** Samples at equal distances, as columns or as CSV text with a line of names: ``t``, inputs, signals and outputs of the plant. */
export interface Record {
  /** Id of a library plant, or a plant in full. */
  plant: string | PlantInput;
  /** Columns by name, all as long … */
  columns?: {[name: string]: (number)[]} | null;
  /** … or the text of a CSV file. */
  csv?: string | null;
  /** Seconds at its beginning that are known to be sound: what they show belongs to the plant. */
  learn?: number;
  /** What is asked of the diagnosis. */
  diagnosis?: DiagnosisSettingsInput;
}

/** A command was not carried out; nothing has changed. */
export interface Refused {
  type: 'refused';
  /** The command's id; null if the message had none. */
  id: number | null;
  /** Path of the field at fault, for example fault.channel. */
  field: string;
  /** The value that arrived, shortened. */
  value: JsonValue;
  /** Key of the problem's sentence, GET /api/messages/{language}. */
  code: string;
  /** Arguments of both sentences by name. */
  args: {[name: string]: JsonValue};
  /** Why the command was refused, in the viewer's language. */
  problem: string;
  /** How to correct it, in the viewer's language. */
  remedy: string;
}

/** Let an observer watch no longer. */
export interface RemoveObserver {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'remove-observer';
  label: string;
}

/** Let an observer watch no longer. */
export interface RemoveObserverInput {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'remove-observer';
  label: string;
}

/** Remove an observer. */
export interface RemoveObserverNow {
  /** Number that the client gives the command. */
  id: number;
  type: 'remove-observer';
  label: string;
}

/** Go back to t = 0 and the experiment as it was at the start; the log is emptied. */
export interface Reset {
  /** Number that the client gives the command. */
  id: number;
  type: 'reset';
}

/** How small a fault in one channel can be and still be found, at this noise and with these gains. */
export interface Resolution {
  /** The fault channel. */
  channel: string;
  /** Standard deviation of the estimate in the fault's unit, at the end. */
  sigma: number | null;
  /** Size of a typical fault in this channel. */
  typical: number;
  /** Smallest step that is found within the longest window, null: none. */
  smallest: number | null;
  /** Whether a typical fault can be found at all. */
  resolvable: boolean;
  /** Whether the input of the last window excites it enough. */
  identifiable: boolean;
  /** In words: from what size on, or why not. */
  text: Text | null;
}

/** Rows from this one on are void; a new epoch begins. The log ends here as well. */
export interface Rewound {
  type: 'rewound';
  epoch: number;
  row: number;
  t: number;
}

/** A run of an experiment. Its id is the hash of what determines its numbers (`Experiment.spec_hash`). */
export interface Run {
  /** Hash of the canonical spec. */
  id: string;
  status: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  /** Share done, 0 to 1. */
  progress: number;
  spec: Experiment;
  /** Set when done. */
  summary: RunSummary | null;
  /** Set when failed. */
  problem: Problem | null;
  created: string;
  /** A pinned run is kept when the store needs room. */
  pinned: boolean;
  links: {[name: string]: string};
}

/** A run in a list. */
export interface RunLine {
  id: string;
  title: string;
  status: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  created: string;
  pinned: boolean;
  links: {[name: string]: string};
}

/** Runs, newest first, and what the store holds. */
export interface RunList {
  runs: (RunLine)[];
  store: {[name: string]: number};
}

/** An experiment of the library, with values changed by path. */
export interface RunRequest {
  /** Id of a library experiment. */
  experiment: string;
  /** Path: new value. Items of lists by index, label or name; a number for an input is that constant. */
  set?: {[name: string]: JsonValue};
}

/** What came out of a run, without its data. */
export interface RunSummary {
  /** Number of columns of the data. */
  columns: number;
  /** Number of recorded times. */
  rows: number;
  /** Step of the integration in s. */
  step: number;
  /** Steps that observers take within one step. */
  substeps: number;
  /** Divergence of the plant itself. */
  diverged: Divergence | null;
  observers: (ObserverSummary)[];
  /** Observers, faults, noise, alarms and verdicts at the end of the run. */
  facts: Facts | null;
  /** The observers compared on the same data. */
  comparison: Comparison | null;
  /** Which fault, since when, how large, how sure. */
  diagnosis: Diagnosis | null;
  notes: (Text)[];
  /** Wall time of each stage in s. */
  seconds: {[name: string]: number};
}

/** Observers see y at 0, period, 2·period, …, held in between. */
export interface SampledMeasurement {
  mode: 'sampled';
  /** Sample period in s. */
  period: number;
}

/** Observers see y at 0, period, 2·period, …, held in between. */
export interface SampledMeasurementInput {
  mode: 'sampled';
  /** Sample period in s. */
  period: number;
}

/** Go back to an earlier time. Rows and commands after it are discarded; fork first to keep them. */
export interface Seek {
  /** Number that the client gives the command. */
  id: number;
  type: 'seek';
  /** Time in s, rounded to a row, at most the present time. */
  t: number;
}

export type ServerMessage = Hello | Ack | Refused | Status | Event | Columns | Rewound | Jump | Spec | Assumptions | DiagnosisNow | FactsNow;

/** A new session. The token grants control. */
export interface SessionOpened {
  id: string;
  token: string;
  parent: string | null;
  links: {[name: string]: string};
}

/** A session on an experiment of the library, or on a spec. */
export interface SessionRequest {
  /** Id of a library experiment … */
  experiment?: string | null;
  /** … and values changed by path, as for runs. */
  set?: {[name: string]: JsonValue};
  /** Or a whole experiment, its timed commands included. */
  spec?: ExperimentInput | null;
  /** Start the time immediately. */
  play?: boolean;
  /** Simulated seconds per second; null: as fast as possible. */
  speed?: number | null;
  /** Time in s at which the session opens. */
  t?: number;
}

/** The state of a session, and its experiment with all faults and timed commands so far. */
export interface SessionState {
  id: string;
  spec: Experiment;
  row: number;
  t: number;
  playing: boolean;
  speed: number | null;
  viewers: number;
  ended: boolean;
  parent: string | null;
  links: {[name: string]: string};
}

/** Give an observer's gain another value. */
export interface SetGain {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-gain';
  /** Label of the observer. */
  observer: string;
  /** Name of the gain. */
  gain: string;
  /** The new value: a number, a list for a column, or a list of rows for a matrix. */
  value: number | (number)[] | ((number)[])[];
}

/** Give an observer's gain another value. */
export interface SetGainInput {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-gain';
  /** Label of the observer. */
  observer: string;
  /** Name of the gain. */
  gain: string;
  /** The new value: a number, a list for a column, or a list of rows for a matrix. */
  value: number | (number)[] | ((number)[])[];
}

/** Set a gain of an observer from now on. */
export interface SetGainNow {
  /** Number that the client gives the command. */
  id: number;
  type: 'set-gain';
  observer: string;
  gain: string;
  value: number | (number)[] | ((number)[])[];
}

/** Change the measurement noise of one output. */
export interface SetNoise {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-noise';
  /** Name of the output. */
  output: string;
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time: number;
}

/** Change the measurement noise of one output. */
export interface SetNoiseInput {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-noise';
  /** Name of the output. */
  output: string;
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time?: number;
}

/** Set the measurement noise of an output from now on. */
export interface SetNoiseNow {
  /** Number that the client gives the command. */
  id: number;
  type: 'set-noise';
  output: string;
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which a drawn value holds. */
  sample_time?: number;
}

/** Give an input or a known signal another course. Its time is that of the run, not counted from `at`. */
export interface SetSignal {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-signal';
  /** Name of an input or a known signal of the plant. */
  name: string;
  signal: ConstantSignal | StepsSignal | PulseSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | TableSignal | ExpressionSignal;
}

/** Give an input or a known signal another course. Its time is that of the run, not counted from `at`. */
export interface SetSignalInput {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-signal';
  /** Name of an input or a known signal of the plant. */
  name: string;
  signal: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | TableSignalInput | ExpressionSignalInput;
}

/** Set an input or known signal from now on; its time is the session's. */
export interface SetSignalNow {
  /** Number that the client gives the command. */
  id: number;
  type: 'set-signal';
  name: string;
  signal: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | TableSignalInput | ExpressionSignalInput;
}

/** Take every step of the integration in so many substeps from here on (stiff gains). */
export interface SetSubsteps {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-substeps';
  substeps: number;
}

/** Take every step of the integration in so many substeps from here on (stiff gains). */
export interface SetSubstepsInput {
  /** Time in s, a multiple of the step, from which it acts. */
  at: number;
  command: 'set-substeps';
  substeps: number;
}

/** How an estimate followed one step of a fault. */
export interface Settling {
  channel: string;
  /** Time of the step in s. */
  at: number;
  /** Size of the step. */
  size: number;
  /** Width of the band around the new value, as a fraction of the size. */
  within: number;
  /** Time in s after the step at which the band is first reached. */
  reached: number | null;
  /** Time in s after the step from which the estimate stays in the band. */
  time: number | null;
  /** Time in s up to which was looked: the next event, or the end. */
  until: number;
}

/** A kind of signal with its fields. */
export interface SignalForm {
  kind: string;
  description: string;
  fields: (FormField)[];
  example: {[name: string]: JsonValue};
}

/** θ = size·sin(2π·frequency·τ + phase). */
export interface SineFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'sine';
  /** Amplitude, in the channel's unit. */
  size: number;
  /** Frequency in Hz. */
  frequency: number;
  /** Phase at the onset in rad. */
  phase: number;
}

/** θ = size·sin(2π·frequency·τ + phase). */
export interface SineFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'sine';
  /** Amplitude, in the channel's unit. */
  size: number;
  /** Frequency in Hz. */
  frequency: number;
  /** Phase at the onset in rad. */
  phase?: number;
}

/** offset + amplitude·sin(2π·frequency·t + phase). */
export interface SineSignal {
  kind: 'sine';
  /** Amplitude, in the signal's unit. */
  amplitude: number;
  /** Frequency in Hz. */
  frequency: number;
  /** Phase at t = 0 in rad. */
  phase: number;
  /** Mean value, in the signal's unit. */
  offset: number;
}

/** offset + amplitude·sin(2π·frequency·t + phase). */
export interface SineSignalInput {
  kind: 'sine';
  /** Amplitude, in the signal's unit. */
  amplitude: number;
  /** Frequency in Hz. */
  frequency: number;
  /** Phase at t = 0 in rad. */
  phase?: number;
  /** Mean value, in the signal's unit. */
  offset?: number;
}

/** The experiment with everything done so far, after every command that changes it. */
export interface Spec {
  type: 'spec';
  spec: Experiment;
}

/** Simulated seconds per second; null: as fast as possible. */
export interface Speed {
  /** Number that the client gives the command. */
  id: number;
  type: 'speed';
  value: number | null;
}

/** One state variable. */
export interface State {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Value at t = 0, in the state's unit. */
  initial: number;
  /** Physical range [low, high]; observers saturate their model to it. */
  domain: [number | null, number | null];
  description: string;
}

/** One state variable. */
export interface StateInput {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Value at t = 0, in the state's unit. */
  initial?: number;
  /** Physical range [low, high]; observers saturate their model to it. */
  domain?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** The status of the session. A newer one replaces an older one. */
export interface Status {
  type: 'status';
  row: number;
  t: number;
  playing: boolean;
  speed: number | null;
  /** Measured speed: simulated seconds per second. */
  rate: number | null;
  viewers: number;
  /** The session has reached its last row, or the plant has diverged. */
  ended: boolean;
}

/** Advance by `rows` rows, as fast as possible, and stay paused. */
export interface Step {
  /** Number that the client gives the command. */
  id: number;
  type: 'step';
  rows?: number;
}

/** θ = size at once. */
export interface StepFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'step';
  /** Size, in the channel's unit. */
  size: number;
}

/** θ = size at once. */
export interface StepFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'step';
  /** Size, in the channel's unit. */
  size: number;
}

/** How soon an estimate followed one step of a fault. */
export interface StepFollowed {
  channel: string;
  /** Time of the step in s. */
  at: number;
  /** New value less the old, in the channel's unit. */
  size: number;
  /** Seconds until it stays within 10 % of the size; null: it does not. */
  ten: number | null;
  /** Seconds until it stays within 5 % of the size; null: it does not. */
  five: number | null;
}

/** The newest fault of a channel, and whether the detector has found it. */
export interface StepFound {
  /** Id of the fault. */
  id: string;
  /** The verdict so far; null without a detector, or if θ is zero. */
  outcome: 'found' | 'covered' | 'missed' | null;
  /** Seconds from the onset to the alarm that found it. */
  delay: number | null;
}

/** Piecewise constant: values[0] before times[0], values[i] from times[i-1] on. */
export interface StepsSignal {
  kind: 'steps';
  /** Times of the jumps in s, increasing. */
  times: (number)[];
  /** Values, one more than times. */
  values: (number)[];
}

/** Piecewise constant: values[0] before times[0], values[i] from times[i-1] on. */
export interface StepsSignalInput {
  kind: 'steps';
  /** Times of the jumps in s, increasing. */
  times: (number)[];
  /** Values, one more than times. */
  values: (number)[];
}

/** Faults and states that no input distinguishes. */
export interface StructuralGroup {
  channels: (string)[];
  states: (string)[];
  text: string;
}

/** The structural rank of states and faults. */
export interface StructuralObservability {
  decided: boolean;
  rank: number | null;
  size: number;
  state_rank: number | null;
  states: number;
  not_identifiable: (string)[];
  groups: (StructuralGroup)[];
  text: string;
}

/** The sensor shows `value`. */
export interface StuckFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'stuck';
  /** Value shown, in the output's unit. */
  value: number;
}

/** The sensor shows `value`. */
export interface StuckFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'stuck';
  /** Value shown, in the output's unit. */
  value: number;
}

/** θ read from a table over τ; the first value holds before its time and the last after it. */
export interface TableFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'table';
  /** Times in s after the onset, increasing. */
  times: (number)[];
  /** Values at these times, in the channel's unit. */
  values: (number)[];
  /** Between two times: linear, or hold the earlier value. */
  interpolation: 'hold' | 'linear';
}

/** θ read from a table over τ; the first value holds before its time and the last after it. */
export interface TableFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: it stays. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'table';
  /** Times in s after the onset, increasing. */
  times: (number)[];
  /** Values at these times, in the channel's unit. */
  values: (number)[];
  /** Between two times: linear, or hold the earlier value. */
  interpolation?: 'hold' | 'linear';
}

/** Values at given times; the first holds before them and the last after them. */
export interface TableSignal {
  kind: 'table';
  /** Times in s, increasing. */
  times: (number)[];
  /** Values at these times. */
  values: (number)[];
  /** Between two times: linear, or hold the earlier value. */
  interpolation: 'hold' | 'linear';
}

/** Values at given times; the first holds before them and the last after them. */
export interface TableSignalInput {
  kind: 'table';
  /** Times in s, increasing. */
  times: (number)[];
  /** Values at these times. */
  values: (number)[];
  /** Between two times: linear, or hold the earlier value. */
  interpolation?: 'hold' | 'linear';
}

/** A message: code, arguments, and the sentence in the asked language. */
export interface Text {
  /** Key of the sentence in the catalogues, GET /api/messages/{language}. */
  code: string;
  /** Arguments of the sentence by name; a nested message is {code, args}. */
  args: {[name: string]: JsonValue};
  /** The sentence in the asked language. */
  text: string;
}

/** One line of a panel: a column, or the difference of two. */
export interface Trace {
  /** Column of the result. */
  column: string;
  /** Column to subtract. */
  minus: string | null;
  /** Text in the legend; the column's name when empty. */
  label: string;
  style: 'solid' | 'dash' | 'dot';
  /** Draw the absolute value. */
  absolute: boolean;
}

/** One line of a panel: a column, or the difference of two. */
export interface TraceInput {
  /** Column of the result. */
  column: string;
  /** Column to subtract. */
  minus?: string | null;
  /** Text in the legend; the column's name when empty. */
  label?: string | {[name: string]: string};
  style?: 'solid' | 'dash' | 'dot';
  /** Draw the absolute value. */
  absolute?: boolean;
}

/** A symbol of an observer's equations and its meaning. */
export interface WhereLine {
  math: string;
  text: string;
}

/** A stretch of the run between two events: onsets and ends of faults, the run's beginning and end. */
export interface Window {
  /** Time in s of the event at which it begins. */
  start: number;
  /** Time in s of the event at which it ends. */
  end: number;
}

/** The observers of a session over the window that a page shows. */
export interface WindowComparison {
  /** Time in s up to which the session has come. */
  t: number;
  /** The state whose error is given. */
  state: string;
  /** The fault channel; null: the plant has none. */
  channel: string | null;
  /** Its newest fault; null: none so far. */
  fault: StepFound | null;
  observers: (ObserverInWindow)[];
}

/** A text in the languages of the page. */
export interface Words {
  en: string;
  zh: string;
}
