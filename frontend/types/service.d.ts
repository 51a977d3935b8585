// Written by `python -m tools.page_types` from the service's schemas. Do not edit.
// Bodies of requests and commands have optional fields where the schema has a default; answers and events have all
// fields.

/** The accuracy that the integration reached: estimated errors relative to the scale of each state. */
export interface Accuracy {
  /** Largest error of a plant state, propagated along the run; 1: unknown. */
  plant: number;
  /** Largest error of an observer's estimate, over about 100 steps. */
  observers: number;
  /** Error of the plant that the steps were chosen for. */
  tolerance: number;
  /** The same for observers. */
  observer_tolerance: number;
  /** Most implicit substeps of a step; 0: none were needed. */
  implicit: number;
}

/** A channel that was named before the answer, and taken back. */
export interface Accusation {
  channel: string;
  /** Time in s of the record at which it was named. */
  at: number;
}

/** A command was executed; it takes effect from this row on. */
export interface Ack {
  type: 'ack';
  id: number;
  row: number;
  t: number;
}

/** Add a note at the present time or an earlier one, or replace the note that has its id. No row changes. */
export interface AddNote {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'add-note';
  note: NoteInput;
}

/** Add an observer, whose estimates start at that time. */
export interface AddObserver {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  command: 'add-observer';
  observer: ObserverConfig;
}

/** Add an observer, whose estimates start at that time. */
export interface AddObserverInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  command: 'add-observer';
  observer: ObserverConfigInput;
}

/** Add an observer, whose estimates start now. */
export interface AddObserverNow {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'add-observer';
  observer: ObserverConfigInput;
}

/** One fault found by the tests of an observer or of the detector. */
export interface Alarm {
  /** Id within the run or session; it does not change when the alarm is revised. Empty in old results. */
  id: string;
  /** Label of the observer; empty: the detector, which uses the measurements only. */
  observer: string;
  /** Time in s at which the alarm was raised. */
  t: number;
  /** A fault in a channel of the model, or one that the model does not explain. */
  kind: 'fault' | 'unexplained';
  /** The channel that explains the data best; empty if none does. */
  channel: string;
  /** Of an unexplained fault: the output whose residual shows it. */
  output: string;
  /** Other channels that explain the data equally well. */
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
  /** The test that raised the alarm. */
  test: string;
  /** Value of the test statistic, without a unit. */
  statistic: number;
  /** Threshold of the test statistic. */
  threshold: number;
  /** Time in s at which the alarm was cleared; null: it is still on. */
  cleared: number | null;
  /** The finding in a sentence. */
  text: Text;
}

/** The verdict on one alarm, and its state at the time of evaluation. */
export interface AlarmOutcome {
  /** Id of the alarm. */
  id: string;
  /** When it was raised, it named a fault that was present, another fault was present, or none was. */
  verdict: 'correct' | 'isolation-error' | 'false';
  /** Cleared, or on while: a fault that it names is active; the active fault began later and is covered; another fault is active; there has been no fault; the fault has ended, so the alarm clears soon. */
  state: 'acting' | 'covering' | 'other-fault' | 'no-fault' | 'fault-over' | 'cleared';
  /** Ids of the faults that it found first. */
  found: (string)[];
  /** Seconds from the newest of these faults to the alarm. */
  delay: number | null;
  /** Onset in s of the newest active fault that it covers. */
  covers_since: number | null;
}

/** A quantity without memory that an equation determines, solved at every instant. */
export interface AlgebraicVariable {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Equation `left = right`, or an expression that is 0, in all quantities of the plant. */
  equation: string;
  /** First guess of the value, in states, inputs, parameters and definitions of these. */
  guess: string;
  /** Physical range [low, high]; observers saturate their model to it. */
  domain: [number | null, number | null];
  description: string;
}

/** A quantity without memory that an equation determines, solved at every instant. */
export interface AlgebraicVariableInput {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Equation `left = right`, or an expression that is 0, in all quantities of the plant. */
  equation: string;
  /** First guess of the value, in states, inputs, parameters and definitions of these. */
  guess?: string;
  /** Physical range [low, high]; observers saturate their model to it. */
  domain?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** The service answers. */
export interface Alive {
  status: 'alive';
}

/** One of the answers to a step's question. It is right where its conditions hold in the student's session. */
export interface Answer {
  text: Words;
  /** A channel or an output: the answer is given by pointing at its place in the plant's picture. */
  site: string | null;
  right_if: (Condition)[];
}

/** One of the answers to a step's question. It is right where its conditions hold in the student's session. */
export interface AnswerInput {
  text: WordsInput;
  /** A channel or an output: the answer is given by pointing at its place in the plant's picture. */
  site?: string | null;
  right_if: (ConditionInput)[];
}

/** A student's answer about the hidden fault. It may be changed until the round is revealed. */
export interface AnswerRequest {
  /** Number of the round, counted from 1. */
  round: number;
  verdict: 'channel' | 'none' | 'cannot-be-told';
  channel?: string | null;
  /** The channels that look alike, where it cannot be told. */
  alike?: (string)[];
  /** Time in s at which it is thought to have begun. */
  onset?: number | null;
  /** Size in the unit of the channel; of a ramp, its final one. */
  size?: number | null;
}

/** The check of one assumption of an observer's theorem for the plant, the gains and the run. */
export interface AssumptionCheck {
  name: Text;
  verdict: 'holds' | 'fails' | 'cannot tell';
  /** The check's result in a sentence. */
  text: Text;
  /** The computed value. */
  value: number | null;
  /** The value that it is compared with. */
  threshold: number | null;
  /** Paper and equation. */
  source: string;
  /** Other gains, designed so that they meet this check; null where there are none. */
  gains: {[name: string]: (number)[]} | null;
}

/** The assumption checks of one observer over the session up to now. */
export interface Assumptions {
  type: 'assumptions';
  observer: string;
  checks: (AssumptionCheck)[];
}

/** Execute several commands in order at the same row. If one is refused, none is executed. There is one answer. */
export interface Batch {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'batch';
  /** The commands without ids; a refusal names commands[i].field. */
  commands: (Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | SetTruthNow | AddObserverNow | RemoveObserverNow | AddNote | RemoveNote | Reset)[];
}

/** Calibration of the thresholds by simulation. */
export interface Calibration {
  /** Accepted false alarms per hour. */
  false_alarms: number;
  /** Threshold of each test. */
  thresholds: {[name: string]: number};
  /** Number of simulated runs without faults. */
  seeds: number;
  /** Total simulated time in hours. */
  hours: number;
  /** Time in s from which the tests decide; before it the observer is settling. */
  from_time: number;
  /** A limitation of the calibration, if there is one. */
  note: Text | null;
}

/** A short text in both languages of the page. */
export interface Caption {
  en: string;
  zh: string;
}

/** Named cases; each changes several values at once. */
export interface CasesFactor {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name: string;
  kind: 'cases';
  cases: {[name: string]: {[name: string]: JsonValue}};
}

/** Named cases; each changes several values at once. */
export interface CasesFactorInput {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name?: string;
  kind: 'cases';
  cases: {[name: string]: {[name: string]: JsonValue}};
}

/** Plants, experiments, kinds of observers, and the forms of faults and signals. */
export interface Catalogue {
  plants: (PlantLine)[];
  experiments: (ExperimentLine)[];
  observers: (ObserverKind)[];
  faults: (FaultForm)[];
  signals: (SignalForm)[];
}

/** An answer: one channel with onset and size, no fault, or some that look alike. */
export interface ChallengeAnswer {
  verdict: 'channel' | 'none' | 'cannot-be-told';
  channel: string | null;
  /** The channels that look alike, where it cannot be told. */
  alike: (string)[];
  /** Time in s at which it is thought to have begun. */
  onset: number | null;
  /** Size in the unit of the channel; of a ramp, its final one. */
  size: number | null;
  /** Time in s of the record at which the answer was given. */
  at: number;
  accused: (Accusation)[];
}

/** An answer: one channel with onset and size, no fault, or some that look alike. */
export interface ChallengeAnswerInput {
  verdict: 'channel' | 'none' | 'cannot-be-told';
  channel?: string | null;
  /** The channels that look alike, where it cannot be told. */
  alike?: (string)[];
  /** Time in s at which it is thought to have begun. */
  onset?: number | null;
  /** Size in the unit of the channel; of a ramp, its final one. */
  size?: number | null;
  /** Time in s of the record at which the answer was given. */
  at: number;
  accused?: (Accusation)[];
}

/** What was hidden, and what could be told of it and when. */
export interface ChallengeTruth {
  /** Null: there is no fault. */
  fault: HiddenFault | null;
  /** Length of the record in s. */
  end: number;
  /** All other explanations; none where there is no fault. */
  rivals: (Rival)[];
  /** Times in s, and how many deviations of the noise separate the record from no fault. */
  seen: ([number, number])[];
}

/** One fault θ and its equations: coefficient·θ is added to each equation in `enters`. */
export interface Channel {
  /** Name of the fault; the equations do not contain it. */
  name: string;
  title: string;
  /** Actuator faults enter state equations, sensor faults output equations, process faults both. */
  kind: 'actuator' | 'process' | 'sensor';
  /** Coefficient of θ by state or output, in whose equation it enters. */
  enters: {[name: string]: string};
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Typical size of the fault, in its unit. */
  typical: number;
  /** Plausible range, in the channel's unit. */
  bounds: [number | null, number | null];
  description: string;
}

/** One fault θ and its equations: coefficient·θ is added to each equation in `enters`. */
export interface ChannelInput {
  /** Name of the fault; the equations do not contain it. */
  name: string;
  title?: string | {[name: string]: string};
  /** Actuator faults enter state equations, sensor faults output equations, process faults both. */
  kind: 'actuator' | 'process' | 'sensor';
  /** Coefficient of θ by state or output, in whose equation it enters. */
  enters: {[name: string]: string};
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Typical size of the fault, in its unit. */
  typical?: number;
  /** Plausible range, in the channel's unit. */
  bounds?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** The faults of a channel by size. */
export interface ChannelSizes {
  channel: string;
  points: (SizeAnswer)[];
  /** The smallest size from which on the wanted share is found; null: there is none. */
  smallest: number | null;
}

/** offset + amplitude·sin(2π(f0·τ + (f1−f0)·τ²/(2·duration))) with τ = t − start, for 0 ≤ τ < duration. */
export interface ChirpSignal {
  kind: 'chirp';
  /** Amplitude, in the signal's unit. */
  amplitude: number;
  /** Frequency at `start` in Hz. */
  f0: number;
  /** Frequency at start + duration in Hz. */
  f1: number;
  /** Length of the sweep in s. */
  duration: number;
  /** Mean value, in the signal's unit. */
  offset: number;
  /** Start of the sweep in s. */
  start: number;
}

/** offset + amplitude·sin(2π(f0·τ + (f1−f0)·τ²/(2·duration))) with τ = t − start, for 0 ≤ τ < duration. */
export interface ChirpSignalInput {
  kind: 'chirp';
  /** Amplitude, in the signal's unit. */
  amplitude: number;
  /** Frequency at `start` in Hz. */
  f0: number;
  /** Frequency at start + duration in Hz. */
  f1: number;
  /** Length of the sweep in s. */
  duration: number;
  /** Mean value, in the signal's unit. */
  offset?: number;
  /** Start of the sweep in s. */
  start?: number;
}

/** A button that does something to the session, then runs it. */
export interface Choice {
  text: Words;
  /** Commands of a live session, without ids. */
  do: ({[name: string]: unknown})[];
}

/** A button that does something to the session, then runs it. */
export interface ChoiceInput {
  text: WordsInput;
  do?: (Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | SetTruthNow | AddObserverNow | RemoveObserverNow | AddNote | RemoveNote | Reset)[];
}

/** Who published a paper, under which title, and where. */
export interface Citation {
  authors: Words;
  title: Words;
  journal: Words;
}

/** A plant in which faults can be hidden. */
export interface ClassSetup {
  id: string;
  title: Words;
}

/** The plants in which faults can be hidden. */
export interface ClassSetups {
  setups: (ClassSetup)[];
}

/** End faults now: those of one channel, of one output, or all. */
export interface Clear {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'clear';
  channel?: string | null;
  output?: string | null;
}

export type ClientMessage = Play | Pause | Step | Speed | Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | SetTruthNow | AddObserverNow | RemoveObserverNow | AddNote | RemoveNote | Reset | Seek | Batch;

/** How columns become the time and the quantities of a plant; what is not given is guessed. */
export interface ColumnMapping {
  /** The times; null: the guess. */
  time: TimeMapping | null;
  /** By name of an input, known signal or output of the plant; others are guessed. */
  quantities: {[name: string]: QuantityMapping};
}

/** How columns become the time and the quantities of a plant; what is not given is guessed. */
export interface ColumnMappingInput {
  /** The times; null: the guess. */
  time?: TimeMappingInput | null;
  /** By name of an input, known signal or output of the plant; others are guessed. */
  quantities?: {[name: string]: QuantityMappingInput};
}

/** The columns change from this row on, because an observer was added or removed; a new epoch begins. */
export interface Columns {
  type: 'columns';
  epoch: number;
  row: number;
  columns: (string)[];
}

/** The observers of a run on the same data. */
export interface Comparison {
  windows: (Window)[];
  observers: (ComparisonRow)[];
}

/** What a client notes about a comparison. */
export interface ComparisonNotes {
  /** Notes as plain text; empty: none. */
  text: string;
}

/** The comparison's row of one observer. Counts of alarms and faults are null if no tests ran on its estimates. */
export interface ComparisonRow {
  label: string;
  /** Root mean square error of each column (x.…, theta.…), by window; null: some rows have no number. */
  rmse: {[name: string]: (number | null)[]};
  /** Largest absolute error, in the same form. */
  peak: {[name: string]: (number | null)[]};
  steps: (StepFollowed)[];
  /** The outcome for each fault, in order of time. */
  faults: (FaultOutcome)[] | null;
  /** The verdict on each alarm, in order of time. */
  alarms: (AlarmOutcome)[] | null;
  /** Number of faults that an alarm found. */
  found: number | null;
  /** Number of faults that began while an alarm for their channel was on. */
  covered: number | null;
  /** Number of faults neither found nor covered. */
  missed: number | null;
  /** Number of alarms raised while no fault was present, nor just before. */
  false_alarms: number | null;
  /** Number of alarms raised during a fault that name none of the faults present. */
  isolation_errors: number | null;
  /** Median delay in s of the faults found. */
  delay: number | null;
  /** Seconds after the end of a fault in which an alarm is not false, because θ̂ is returning to 0. */
  grace: number;
  /** Measured processor time in µs per simulated second; it differs between runs. */
  cost: number | null;
}

/** A point of the design by two measures. */
export interface CompromiseAnswer {
  /** Number of the point. */
  point: number;
  /** Number of its first run. */
  run: number;
  /** Median of the first measure. */
  a: number;
  /** Median of the second measure. */
  b: number;
  /** No other point is better in one of them and as good in the other. */
  best: boolean;
  /** The values of the factors there. */
  values: {[name: string]: number | string};
}

/** All points of the design by two measures, of which less is better. */
export interface Compromises {
  points: (CompromiseAnswer)[];
}

/** A condition on one measured number: at least, at most, or that it does not exist. */
export interface Condition {
  measure: string;
  at_least: number | null;
  at_most: number | null;
  /** True where there must be no such number. */
  none: boolean;
}

/** A condition on one measured number: at least, at most, or that it does not exist. */
export interface ConditionInput {
  measure: string;
  at_least?: number | null;
  at_most?: number | null;
  /** True where there must be no such number. */
  none?: boolean;
}

/** What the first alarm named: true faults → name → runs. */
export interface Confusion {
  /** `none`: no fault, or no alarm; empty: an alarm that names nothing. */
  counts: {[name: string]: {[name: string]: number}};
}

/** A constant value. */
export interface ConstantSignal {
  kind: 'constant';
  /** Value, in the signal's unit. */
  value: number;
}

/** A constant value. */
export interface ConstantSignalInput {
  kind: 'constant';
  /** Value, in the signal's unit. */
  value: number;
}

/** Continuous measurement: observers see y(t) at all times. */
export interface ContinuousMeasurement {
  mode: 'continuous';
}

/** Continuous measurement: observers see y(t) at all times. */
export interface ContinuousMeasurementInput {
  mode: 'continuous';
}

/** Continuous time: the dynamics are derivatives. */
export interface ContinuousTime {
  kind: 'continuous';
}

/** Continuous time: the dynamics are derivatives. */
export interface ContinuousTimeInput {
  kind: 'continuous';
}

/** A controller: states and expressions that read measured outputs, references and inputs, never true states. */
export interface Controller {
  /** Name of the controller; expressions do not contain it. */
  name: string;
  title: string;
  /** Sample period in s, a multiple of the step; null: continuous. */
  period: number | null;
  states: (ControllerState)[];
  /** Intermediate quantities, in order. */
  definitions: (ControllerDefinition)[];
  /** Right-hand side by state: its derivative, or its next value with a period or in discrete time. */
  dynamics: {[name: string]: string};
  /** The inputs of the plant that it sets. */
  outputs: (ControllerOutput)[];
  description: string;
}

/** An intermediate quantity of a controller. */
export interface ControllerDefinition {
  /** Name in later expressions of the same controller. */
  name: string;
  expression: string;
}

/** A controller: states and expressions that read measured outputs, references and inputs, never true states. */
export interface ControllerInput {
  /** Name of the controller; expressions do not contain it. */
  name: string;
  title?: string | {[name: string]: string};
  /** Sample period in s, a multiple of the step; null: continuous. */
  period?: number | null;
  states?: (ControllerStateInput)[];
  /** Intermediate quantities, in order. */
  definitions?: (ControllerDefinition)[];
  /** Right-hand side by state: its derivative, or its next value with a period or in discrete time. */
  dynamics?: {[name: string]: string};
  /** The inputs of the plant that it sets. */
  outputs: (ControllerOutputInput)[];
  description?: string | {[name: string]: string};
}

/** The law by which a controller sets one input of the plant. */
export interface ControllerOutput {
  /** The input of the plant that is set. */
  input: string;
  /** Value of the input before saturation. */
  expression: string;
  /** Range [low, high] to which it is limited: numbers, parameters, or null. */
  saturation: [number | string | null, number | string | null];
}

/** The law by which a controller sets one input of the plant. */
export interface ControllerOutputInput {
  /** The input of the plant that is set. */
  input: string;
  /** Value of the input before saturation. */
  expression: string;
  /** Range [low, high] to which it is limited: numbers, parameters, or null. */
  saturation?: [number | string | null, number | string | null];
}

/** One state variable of a controller. */
export interface ControllerState {
  /** Name in the controller's expressions. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Value at t = 0, in the state's unit. */
  initial: number;
  description: string;
}

/** One state variable of a controller. */
export interface ControllerStateInput {
  /** Name in the controller's expressions. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Value at t = 0, in the state's unit. */
  initial?: number;
  description?: string | {[name: string]: string};
}

/** How often a column, or the difference of two, comes beyond ±level: as often as a detector with it cries alarm. */
export interface Counts {
  kind: 'counts';
  /** A column of the session, say y.y1. */
  column: string;
  minus: string | null;
  /** A level; dial: the one that the student has set. */
  level: number | 'dial';
  /** Time in s after the mark. */
  start: number;
  /** None: until the end of the step. */
  end: number | null;
}

/** How often a column, or the difference of two, comes beyond ±level: as often as a detector with it cries alarm. */
export interface CountsInput {
  kind: 'counts';
  /** A column of the session, say y.y1. */
  column: string;
  minus?: string | null;
  /** A level; dial: the one that the student has set. */
  level: number | 'dial';
  /** Time in s after the mark. */
  start?: number;
  /** None: until the end of the step. */
  end?: number | null;
}

/** A lesson: experiments, and steps that run them. */
export interface CourseLesson {
  id: string;
  /** Its place in the course; 0: none. */
  number: number;
  minutes: number;
  title: Words;
  /** What one can do afterwards. */
  outcome: Words;
  experiments: {[name: string]: Experiment};
  steps: (CourseStep)[];
}

/** A lesson: experiments, and steps that run them. */
export interface CourseLessonInput {
  id: string;
  /** Its place in the course; 0: none. */
  number?: number;
  minutes: number;
  title: WordsInput;
  /** What one can do afterwards. */
  outcome: WordsInput;
  experiments: {[name: string]: ExperimentInput};
  steps: (CourseStepInput)[];
}

/** A lesson of the course without its steps. */
export interface CourseLine {
  id: string;
  number: number;
  minutes: number;
  title: Words;
  outcome: Words;
  steps: number;
}

/** The lessons of the course in their order. */
export interface CourseList {
  lessons: (CourseLine)[];
}

/** One step of a lesson: one idea, one question. */
export interface CourseStep {
  title: Words;
  /** Paragraphs; **bold**. */
  say: (Words)[];
  /** Fewer words, for the projector. */
  short: Words | null;
  /** None: the session of the step before stays; such a step runs nothing. */
  start: StepStart | null;
  show: StepView;
  ask: Words | null;
  answers: (Answer)[];
  choices: (Choice)[];
  dial: Dial | null;
  sketch: Sketch | null;
  /** Of a step with choices, a dial or a sketch. */
  right_if: (Condition)[];
  run: StepRun | null;
  measures: {[name: string]: Settles | Level | Crosses | Counts | Decays | Rises | Found | Diverged | GainNow};
  /** The first whose conditions hold is shown. */
  saw: (Saw)[];
  /** Where to look first after a wrong answer. */
  look: Words | null;
  why: (Words)[];
  /** The cause in large type, where an observer diverges. */
  cause: Words | null;
}

/** One step of a lesson: one idea, one question. */
export interface CourseStepInput {
  title: WordsInput;
  /** Paragraphs; **bold**. */
  say: (WordsInput)[];
  /** Fewer words, for the projector. */
  short?: WordsInput | null;
  /** None: the session of the step before stays; such a step runs nothing. */
  start?: StepStartInput | null;
  show?: StepViewInput;
  ask?: WordsInput | null;
  answers?: (AnswerInput)[];
  choices?: (ChoiceInput)[];
  dial?: DialInput | null;
  sketch?: SketchInput | null;
  /** Of a step with choices, a dial or a sketch. */
  right_if?: (ConditionInput)[];
  run?: StepRunInput | null;
  measures?: {[name: string]: SettlesInput | LevelInput | CrossesInput | CountsInput | DecaysInput | RisesInput | FoundInput | DivergedInput | GainNowInput};
  /** The first whose conditions hold is shown. */
  saw?: (SawInput)[];
  /** Where to look first after a wrong answer. */
  look?: WordsInput | null;
  why?: (WordsInput)[];
  /** The cause in large type, where an observer diverges. */
  cause?: WordsInput | null;
}

/** The time in s after `since` at which a column, or the difference of two, is first above, below or beyond a level. */
export interface Crosses {
  kind: 'crosses';
  /** A column of the session, say y.y1. */
  column: string;
  minus: string | null;
  side: 'above' | 'below' | 'beyond';
  /** A level; dial: the one that the student has set. */
  level: number | 'dial';
  /** Time in s after the mark. */
  since: number;
}

/** The time in s after `since` at which a column, or the difference of two, is first above, below or beyond a level. */
export interface CrossesInput {
  kind: 'crosses';
  /** A column of the session, say y.y1. */
  column: string;
  minus?: string | null;
  side: 'above' | 'below' | 'beyond';
  /** A level; dial: the one that the student has set. */
  level: number | 'dial';
  /** Time in s after the mark. */
  since?: number;
}

/** A curve: a column of the session, or the difference of two. */
export interface CurveLine {
  /** A column of the session, say y.y1. */
  column: string;
  minus: string | null;
  /** Of its observer, for the colour. */
  place: number;
  role: 'truth' | 'measured' | 'estimate';
}

/** A curve: a column of the session, or the difference of two. */
export interface CurveLineInput {
  /** A column of the session, say y.y1. */
  column: string;
  minus?: string | null;
  /** Of its observer, for the colour. */
  place?: number;
  role?: 'truth' | 'measured' | 'estimate';
}

/** A strip of its own for one curve. */
export interface CurvePanel {
  symbol: string;
  title: Caption;
  unit: string;
  line: CurveLine;
}

/** A measure at one value of a factor. */
export interface CurvePoint {
  /** The value of the factor. */
  value: number | string;
  /** The value of the second factor, by which curves are told apart. */
  curve: number | string | null;
  spread: SpreadAnswer;
  /** Of columns of 0 and 1: the share of ones. */
  rate: RateAnswer | null;
  /** Number of the first run there. */
  run: number;
}

/** The strip of curves that students see. */
export interface CurveStrip {
  /** Name of the quantity. */
  symbol: string;
  /** Whether it is measured minus predicted. */
  residual: boolean;
  title: Caption | null;
  unit: string;
  lines: (CurveLine)[];
}

/** The strip of curves that students see. */
export interface CurveStripInput {
  /** Name of the quantity. */
  symbol: string;
  /** Whether it is measured minus predicted. */
  residual?: boolean;
  title?: Caption | null;
  unit?: string;
  lines: (CurveLineInput)[];
}

/** A measure against a factor. */
export interface Curves {
  points: (CurvePoint)[];
}

/** The first text on the stream of curves, and again after every change of columns; binary frames follow it. */
export interface CurvesHead {
  type: 'curves';
  /** null: there are no curves of the teacher's session now. */
  strip: CurveStrip | null;
  /** A strip for each curve of a record of one's own. */
  panels: (CurvePanel)[];
  /** Time in s between rows. */
  record: number;
  epoch: number;
  /** Number of the first row that follows. */
  row: number;
  /** Length of the axis of time in s; null: it grows. */
  horizon: number | null;
}

/** The rate in 1/s at which |column|, or the distance of two, falls: that of a line through its logarithm. */
export interface Decays {
  kind: 'decays';
  /** A column of the session, say y.y1. */
  column: string;
  minus: string | null;
  /** Time in s after the mark. */
  start: number;
  /** None: until the end of the step. */
  end: number | null;
}

/** The rate in 1/s at which |column|, or the distance of two, falls: that of a line through its logarithm. */
export interface DecaysInput {
  kind: 'decays';
  /** A column of the session, say y.y1. */
  column: string;
  minus?: string | null;
  /** Time in s after the mark. */
  start?: number;
  /** None: until the end of the step. */
  end?: number | null;
}

/** An intermediate quantity. Observers saturate it to its domain; the plant does not. */
export interface Definition {
  /** Name in later definitions and in the equations. */
  name: string;
  /** Expression in states, inputs, parameters, signals and earlier definitions. */
  expression: string;
  /** Physical range [low, high]: numbers, names of parameters, or null for no bound. */
  domain: [number | string | null, number | string | null];
}

/** An intermediate quantity. Observers saturate it to its domain; the plant does not. */
export interface DefinitionInput {
  /** Name in later definitions and in the equations. */
  name: string;
  /** Expression in states, inputs, parameters, signals and earlier definitions. */
  expression: string;
  /** Physical range [low, high]: numbers, names of parameters, or null for no bound. */
  domain?: [number | string | null, number | string | null];
}

/** The output is delayed. */
export interface DelayFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'delay';
  /** Delay in s. */
  delay: number;
}

/** The output is delayed. */
export interface DelayFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'delay';
  /** Delay in s. */
  delay: number;
}

/** The diagnosis of a run: by the detector, from the measurements, and by each observer, from its estimates. */
export interface Diagnosis {
  /** Diagnosis by the detector, which does not depend on the observers. */
  detector: ObserverDiagnosis;
  /** Diagnosis by tests on each observer's θ̂, for comparison. */
  observers: (ObserverDiagnosis)[];
}

/** The diagnosis of the session up to now; it replaces earlier ones. */
export interface DiagnosisNow {
  type: 'diagnosis';
  diagnosis: ObserverDiagnosis;
}

/** Settings of the diagnosis. Thresholds are not set directly; they are calibrated by simulation. */
export interface DiagnosisSettings {
  /** Whether the run is diagnosed. */
  enabled: boolean;
  /** Accepted false alarms per hour, for each observer. */
  false_alarms: number;
  /** Test that raises alarms. */
  test: 'glr' | 'cusum' | 'threshold';
  /** Confidence level of bands and intervals. */
  confidence: number;
  /** Accepted model error of a state within the plant's time constant, as a share of its size. */
  doubt: number;
  /** Time in s over which thresholds are simulated and decisions are spaced; null: the horizon. */
  span: number | null;
  /** Required standard deviation of an estimate, as a share of the channel's typical fault. */
  accuracy: number;
}

/** Settings of the diagnosis. Thresholds are not set directly; they are calibrated by simulation. */
export interface DiagnosisSettingsInput {
  /** Whether the run is diagnosed. */
  enabled?: boolean;
  /** Accepted false alarms per hour, for each observer. */
  false_alarms?: number;
  /** Test that raises alarms. */
  test?: 'glr' | 'cusum' | 'threshold';
  /** Confidence level of bands and intervals. */
  confidence?: number;
  /** Accepted model error of a state within the plant's time constant, as a share of its size. */
  doubt?: number;
  /** Time in s over which thresholds are simulated and decisions are spaced; null: the horizon. */
  span?: number | null;
  /** Required standard deviation of an estimate, as a share of the channel's typical fault. */
  accuracy?: number;
}

/** A slider for a gain of an observer, or for a level that is drawn on a strip and used by measures. */
export interface Dial {
  text: Words;
  /** The observer whose gain it is; null: a level. */
  observer: string | null;
  gain: string | null;
  /** The strip on which the level is drawn. */
  strip: string | null;
  /** The least value. */
  low: number;
  /** The greatest value. */
  high: number;
  /** The value at the beginning, which does not meet the step's conditions. */
  value: number;
  /** A value that meets them. */
  solution: number;
  unit: string;
}

/** A slider for a gain of an observer, or for a level that is drawn on a strip and used by measures. */
export interface DialInput {
  text: WordsInput;
  /** The observer whose gain it is; null: a level. */
  observer?: string | null;
  gain?: string | null;
  /** The strip on which the level is drawn. */
  strip?: string | null;
  /** The least value. */
  low: number;
  /** The greatest value. */
  high: number;
  /** The value at the beginning, which does not meet the step's conditions. */
  value: number;
  /** A value that meets them. */
  solution: number;
  unit?: string;
}

/** Discrete time: the dynamics are the values at the next sample. */
export interface DiscreteTime {
  kind: 'discrete';
  /** Sample period in s. */
  period: number;
}

/** Discrete time: the dynamics are the values at the next sample. */
export interface DiscreteTimeInput {
  kind: 'discrete';
  /** Sample period in s. */
  period: number;
}

/** The time in s after the mark at which an observer diverged; none where it did not. */
export interface Diverged {
  kind: 'diverged';
  observer: string;
}

/** The time in s after the mark at which an observer diverged; none where it did not. */
export interface DivergedInput {
  kind: 'diverged';
  observer: string;
}

/** The divergence of a plant or an observer: its time and likely cause. */
export interface Divergence {
  /** Time in s from which the values are missing. */
  time: number;
  /** The likely cause. */
  cause: Text;
}

/** θ = rate·τ, without limit. */
export interface DriftFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'drift';
  /** Rate, in the channel's unit per s. */
  rate: number;
}

/** θ = rate·τ, without limit. */
export interface DriftFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'drift';
  /** Rate, in the channel's unit per s. */
  rate: number;
}

/** Each sample is lost with a probability; the last value is then kept. */
export interface DropoutFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'dropout';
  /** Probability that a sample is lost. */
  probability: number;
  /** Time in s between samples. */
  sample_time: number;
}

/** Each sample is lost with a probability; the last value is then kept. */
export interface DropoutFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'dropout';
  /** Probability that a sample is lost. */
  probability: number;
  /** Time in s between samples. */
  sample_time?: number;
}

/** A plant's text after a change. */
export interface EditedText {
  text: string;
  /** Numbers of the lines that are new, from 1. */
  lines: (number)[];
}

/** A fault channel in the equations of a plant. */
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

/** The plant and the observers whose equations are requested. */
export interface EquationsRequest {
  plant: string | PlantInput;
  /** Kinds of observers; null: all. */
  observers?: (string)[] | null;
}

/** What a paper prints, what is used in its place, and why. */
export interface Erratum {
  printed: Words;
  used: Words;
  reason: Words;
  /** Null: reading is enough, no run shows it. */
  evidence: Evidence | null;
}

/** The figures of one estimate of an observer over a window. */
export interface EstimateInWindow {
  /** Column of the true value: x.… of a state, theta.… of a fault. */
  name: string;
  /** Root mean square error; null: some rows have no value. */
  rmse: number | null;
  /** Of a fault: standard deviation of θ̂ about a fitted line, over the last quarter. */
  noise: number | null;
  /** Of a fault: seconds from its newest step until θ̂ stays within 10 % of the step. */
  settled: number | null;
  /** As in the comparison of one state and one fault. */
  outcome: 'settled' | 'not-yet' | 'too-noisy' | 'unknown';
}

/** An event for the log. It is never dropped. */
export interface Event {
  type: 'event';
  row: number;
  t: number;
  kind: 'inject' | 'clear' | 'fault-begins' | 'fault-ends' | 'gain' | 'signal' | 'noise' | 'truth' | 'observer-added' | 'observer-removed' | 'alarm' | 'alarm-over' | 'diverged' | 'rewound' | 'reset' | 'substeps';
  /** Channel, output, observer label or signal; of "diverged", empty if it is the plant itself. */
  subject: string;
  /** Label of the observer that raised an alarm. */
  observer: string;
  /** Id of the fault (inject, fault-begins, fault-ends). */
  fault: string;
  /** Size, gain value, estimate … */
  value: JsonValue;
  /** The event in a sentence. */
  message: Text;
}

/** A run that shows an erratum. */
export interface Evidence {
  experiment: string;
  /** Name of a figure of the run. */
  figure: string;
  numbers: (PaperNumber)[];
}

/** Excitation of the faults: the smallest eigenvalue of the windowed Gramian of Ω, in units of typical faults. */
export interface Excitation {
  /** Length of the window in s. */
  window: number;
  /** Smallest eigenvalue, in (typical fault / its standard deviation)². */
  level: number | null;
  /** Level that the required accuracy needs. */
  needed: number;
  /** The least excited combination of faults: its component for each channel. */
  direction: {[name: string]: number};
  /** The result in a sentence: the faults that cannot be distinguished. */
  text: Text | null;
  /** An input that would excite the faults more. */
  proposal: string | null;
}

/** Everything that determines a run. The same spec gives the same numbers, bit for bit. */
export interface Experiment {
  id: string;
  title: string;
  description: string;
  /** Source of the experiment, such as a paper and its figure. */
  source: string;
  /** Errors in the printed source. */
  errata: (string)[];
  /** Id of a library plant or of one that the sender has saved, or a complete plant. */
  plant: string | Plant;
  /** Parameters that differ from the plant's values. */
  parameters: {[name: string]: number};
  /** Initial states that differ from the plant's values. */
  initial: {[name: string]: number};
  /** Inputs u(t) and references r(t) that differ from the plant's defaults, by name. */
  inputs: {[name: string]: ConstantSignal | StepsSignal | PulseSignal | SquareSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | NoiseSignal | TableSignal | ExpressionSignal};
  /** Known signals φ(t) that differ from the plant's defaults, by name. */
  signals: {[name: string]: ConstantSignal | StepsSignal | PulseSignal | SquareSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | NoiseSignal | TableSignal | ExpressionSignal};
  faults: (StepFault | RampFault | DriftFault | ExponentialFault | SineFault | PulseTrainFault | RandomWalkFault | TableFault | StuckFault | FreezeFault | DropoutFault | OutliersFault | NoiseBurstFault | QuantisationFault | DelayFault)[];
  /** Measurement noise of each output, by name. */
  noise: {[name: string]: Noise};
  /** Seed of all random numbers. */
  seed: number;
  /** End of the run in s. */
  horizon: number;
  /** Integration step in s; the period of a discrete plant. */
  step: number;
  /** Spacing of the result's rows in s, a multiple of the step; null: as `evaluate`. */
  record: number | null;
  /** Spacing in s of the rows at which checks, bands, excitation and the detector examine the run, a multiple of the step; null: 1, 2 or 5·10^k steps, so that there are at most 10 000 rows. A live session shows these rows. */
  evaluate: number | null;
  /** Substeps of each integration step; null: as many as its accuracy needs. */
  substeps: number | null;
  measurement: ContinuousMeasurement | SampledMeasurement;
  /** Where the simulated plant differs from the model that observers know. */
  truth: Truth;
  observers: (ObserverConfig)[];
  /** Changes during the run other than faults, in order of time. */
  commands: (SetGain | SetSignal | SetNoise | SetTruth | AddObserver | RemoveObserver | SetSubsteps)[];
  /** Settings of the diagnosis. */
  diagnosis: DiagnosisSettings;
  figures: (Figure)[];
  /** Notes and bookmarks on the time of the run. */
  notes: (Note)[];
}

/** Everything that determines a run. The same spec gives the same numbers, bit for bit. */
export interface ExperimentInput {
  id?: string;
  title?: string | {[name: string]: string};
  description?: string | {[name: string]: string};
  /** Source of the experiment, such as a paper and its figure. */
  source?: string | {[name: string]: string};
  /** Errors in the printed source. */
  errata?: (string | {[name: string]: string})[];
  /** Id of a library plant or of one that the sender has saved, or a complete plant. */
  plant: string | PlantInput;
  /** Parameters that differ from the plant's values. */
  parameters?: {[name: string]: number};
  /** Initial states that differ from the plant's values. */
  initial?: {[name: string]: number};
  /** Inputs u(t) and references r(t) that differ from the plant's defaults, by name. */
  inputs?: {[name: string]: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput};
  /** Known signals φ(t) that differ from the plant's defaults, by name. */
  signals?: {[name: string]: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput};
  faults?: (StepFaultInput | RampFaultInput | DriftFaultInput | ExponentialFaultInput | SineFaultInput | PulseTrainFaultInput | RandomWalkFaultInput | TableFaultInput | StuckFaultInput | FreezeFaultInput | DropoutFaultInput | OutliersFaultInput | NoiseBurstFaultInput | QuantisationFaultInput | DelayFaultInput)[];
  /** Measurement noise of each output, by name. */
  noise?: {[name: string]: NoiseInput};
  /** Seed of all random numbers. */
  seed?: number;
  /** End of the run in s. */
  horizon: number;
  /** Integration step in s; the period of a discrete plant. */
  step?: number;
  /** Spacing of the result's rows in s, a multiple of the step; null: as `evaluate`. */
  record?: number | null;
  /** Spacing in s of the rows at which checks, bands, excitation and the detector examine the run, a multiple of the step; null: 1, 2 or 5·10^k steps, so that there are at most 10 000 rows. A live session shows these rows. */
  evaluate?: number | null;
  /** Substeps of each integration step; null: as many as its accuracy needs. */
  substeps?: number | null;
  measurement?: ContinuousMeasurementInput | SampledMeasurementInput;
  /** Where the simulated plant differs from the model that observers know. */
  truth?: TruthInput;
  observers?: (ObserverConfigInput)[];
  /** Changes during the run other than faults, in order of time. */
  commands?: (SetGainInput | SetSignalInput | SetNoiseInput | SetTruthInput | AddObserverInput | RemoveObserverInput | SetSubstepsInput)[];
  /** Settings of the diagnosis. */
  diagnosis?: DiagnosisSettingsInput;
  figures?: (FigureInput)[];
  /** Notes and bookmarks on the time of the run. */
  notes?: (NoteInput)[];
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
  /** Labels of the observers. */
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
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'exponential';
  /** Limit of the size, in the channel's unit. */
  size: number;
  /** Time constant in s. */
  time_constant: number;
}

/** Incipient fault: θ = size·(1 − exp(−τ/time_constant)). */
export interface ExponentialFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'exponential';
  /** Limit of the size, in the channel's unit. */
  size: number;
  /** Time constant in s. */
  time_constant: number;
}

/** A smooth function of the time t, as text. */
export interface ExpressionSignal {
  kind: 'expression';
  /** Expression in t (s). */
  text: string;
}

/** A smooth function of the time t, as text. */
export interface ExpressionSignalInput {
  kind: 'expression';
  /** Expression in t (s). */
  text: string;
}

/** All facts that follow from an experiment and its alarms at one time. One function computes them. */
export interface Facts {
  /** The time in s: the end of a run, or the last row shown of a session. */
  t: number;
  observers: (ObserverNow)[];
  /** All faults, past and future, in the order of the experiment. */
  faults: (FaultNow)[];
  /** Measurement noise of the noisy outputs, by name. */
  noise: {[name: string]: Noise};
  /** Where the simulated plant differs from the model. */
  truth: Truth;
  /** Time in s at which the plant diverged; null: it has not. */
  broken: number | null;
  /** The detector's alarms up to that time, in order of time. */
  alarms: (Alarm)[];
  /** The verdict on each alarm. */
  alarm_verdicts: (AlarmOutcome)[];
  /** The outcome for each fault so far. */
  fault_outcomes: (FaultOutcome)[];
  /** Ids of the active faults that no present alarm names, one for each site. */
  undetected: (string)[];
  /** Time in s up to which the detector has judged the rows, while it is a decision or more behind; null: it has judged all of them, or there is no detector. */
  judged: number | null;
  /** The diagnosis in one sentence. */
  summary: Text;
}

/** The facts at the last row shown, sent after every change; they replace earlier ones. */
export interface FactsNow {
  type: 'facts';
  /** Number of rows shown so far. */
  row: number;
  facts: Facts;
}

/** One explanation of a fault. */
export interface FaultCandidate {
  /** The fault channel. */
  channel: string;
  /** Its title in the plant. */
  title: Text;
  /** Its unit. */
  unit: string;
  /** Its course; a drift is a step that goes on as a ramp, a plateau is a ramp that ends. */
  shape: 'step' | 'ramp' | 'drift' | 'rise' | 'plateau';
  /** Time in s after the first row at which it began. */
  onset: Interval;
  /** Its size at its end, or at the end of the record. */
  size: Interval;
  /** Its rate of change there, per second. */
  rate: number;
  /** The bound of the channel that the size has reached, or null. */
  bound: number | null;
  /** By how much −2 log L with penalties is worse than the best one's. */
  behind: number;
  /** Whether the data exclude it, compared with the best; true for the best. */
  separable: boolean;
  /** The explanation in a sentence. */
  text: Text;
}

/** A fault shape with its fields. */
export interface FaultForm {
  shape: string;
  on: 'channel' | 'output';
  description: string;
  fields: (FormField)[];
  example: {[name: string]: JsonValue};
}

/** A fault of the experiment, and whether it is active at that time. */
export interface FaultNow {
  /** Id within the run or session; it does not change when the fault is cleared. */
  id: string;
  /** Name of the channel or output. */
  subject: string;
  kind: 'channel' | 'output';
  shape: string;
  /** The fault; its times count from the start of the run. */
  fault: StepFault | RampFault | DriftFault | ExponentialFault | SineFault | PulseTrainFault | RandomWalkFault | TableFault | StuckFault | FreezeFault | DropoutFault | OutliersFault | NoiseBurstFault | QuantisationFault | DelayFault;
  /** Time in s at which it begins. */
  onset: number;
  /** Time in s at which it ends; null: never. */
  end: number | null;
  /** Whether it is active; in a session, from the next row on. */
  active: boolean;
  /** Whether it has ended. */
  ended: boolean;
}

/** The outcome for one fault: whether an alarm found it, by the rule in thetascope.diagnosis.evaluation.verdicts. */
export interface FaultOutcome {
  /** Id of the fault within the experiment or session. */
  id: string;
  /** Fault of a channel of the model, or of a measured output. */
  kind: 'channel' | 'output';
  /** Name of the channel or output. */
  name: string;
  /** Time in s at which it began. */
  onset: number;
  /** Time in s until which an alarm counts as finding it; null: the end of the run. */
  until: number | null;
  /** Covered: an alarm for its channel was on when the fault began, so no new one could be raised. */
  outcome: 'found' | 'covered' | 'missed';
  /** Seconds from the onset to the alarm that found it. */
  delay: number | null;
  /** Whether the alarm names it only as an alternative. */
  alternative: boolean;
  /** Id of the alarm that found or covers it; empty without an alarm. */
  alarm: string;
}

/** A fault that may act in an equation, ready to be added to the plant's text. */
export interface FaultPattern {
  pattern: 'loss' | 'leak' | 'bias' | 'gain' | 'lag';
  /** The quantity that is disturbed; empty: the whole equation. */
  term: string;
  /** What happens, in a sentence. */
  about: Text;
  /** The term with θ as MathML. */
  math: string;
  channel: Channel;
  /** Coefficients of θ in the other equations with the term, so that nothing vanishes, by state. */
  conserved: {[name: string]: string};
  /** States to add. */
  states: (State)[];
  /** Parameters to add. */
  parameters: (Parameter)[];
  /** Equations of the states to add. */
  equations: {[name: string]: string};
}

/** The equation of a plant in which a fault is to be added. */
export interface FaultPatternRequest {
  plant: string | PlantInput;
  /** The state or output whose equation it is. */
  name: string;
}

/** The faults that may act in an equation. */
export interface FaultPatterns {
  patterns: (FaultPattern)[];
}

/** Each of some faults alone, and every pair of them if wanted, in place of the experiment's faults. */
export interface FaultsFactor {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name: string;
  kind: 'faults';
  /** Fault channel → size of its step. */
  sizes: {[name: string]: number};
  /** Time in s at which they begin. */
  onset: number;
  /** Time in s at which they end; null: never. */
  end: number | null;
  /** Also every two of them together. */
  pairs: boolean;
}

/** Each of some faults alone, and every pair of them if wanted, in place of the experiment's faults. */
export interface FaultsFactorInput {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name?: string;
  kind: 'faults';
  /** Fault channel → size of its step. */
  sizes: {[name: string]: number};
  /** Time in s at which they begin. */
  onset: number;
  /** Time in s at which they end; null: never. */
  end?: number | null;
  /** Also every two of them together. */
  pairs?: boolean;
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
  /** The problem, in the requested language. */
  problem: string;
  /** The remedy, in the requested language. */
  remedy: string;
}

/** One reason for a refusal: the field, the value that arrived, the problem and the remedy. */
export interface FieldErrorInput {
  /** Path of the field, for example faults[0].end. */
  field: string;
  /** The value that arrived, shortened. */
  value?: unknown;
  /** Key of the problem's sentence in the catalogues, GET /api/messages/{language}. */
  code?: string;
  /** Arguments of both sentences by name. */
  args?: {[name: string]: JsonValue};
  /** The problem, in the requested language. */
  problem: string;
  /** The remedy, in the requested language. */
  remedy: string;
}

/** One figure of an experiment: panels from top to bottom. */
export interface Figure {
  /** Name, which is part of the figure's URL. */
  name: string;
  title: string;
  caption: string;
  panels: (Panel)[];
}

/** One figure of an experiment: panels from top to bottom. */
export interface FigureInput {
  /** Name, which is part of the figure's URL. */
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
  /** Estimate minus truth at the end. */
  error: number | null;
  /** Mean of estimate minus truth. */
  mean_error: number | null;
  /** Standard deviation of estimate minus truth. */
  std: number | null;
}

/** Does the model fit the healthy stretch? */
export interface FitReport {
  /** Faults are only named if it fits, as it is or with fitted parameters. */
  verdict: 'fits' | 'fits-after-fit' | 'does-not-fit';
  /** The verdict in a sentence. */
  text: Text;
  /** How well each output fits. */
  outputs: (OutputFitReport)[];
  /** The same with the parameters as they were, if parameters were fitted. */
  before: (OutputFitReport)[];
  /** Tests that the model failed. */
  reasons: (MisfitReason)[];
  /** What would explain a misfit, the likeliest first. */
  suspects: (MisfitSuspect)[];
  /** Fitted parameters. */
  parameters: (FittedParameterReport)[];
  /** Standard deviation of the process noise of each state over one row, in its unit. */
  process_noise: {[name: string]: number};
  /** What would help. */
  advice: (Text)[];
}

/** A parameter that was fitted on the healthy stretch. */
export interface FittedParameterReport {
  name: string;
  unit: string;
  /** Its value in the plant. */
  before: number;
  /** Its fitted value. */
  value: number;
  /** Standard deviation of the fitted value; null: unknown. */
  std: number | null;
  /** Whether it was held, because the rows do not determine it. */
  held: boolean;
}

/** The time at which the new session branches off. */
export interface ForkRequest {
  /** Time in s, at most that of the session; null: the present. */
  t?: number | null;
}

/** A field of a fault or signal, described for a form. */
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

/** The time in s from `since` to the first alarm of the detector that names a channel; none without one. */
export interface Found {
  kind: 'found';
  /** None: any channel. */
  channel: string | null;
  /** Time in s after the mark. */
  since: number;
}

/** What is found of faults of each size, and how soon. */
export interface FoundBySize {
  /** The wanted share of faults that are found, from 0 to 1. */
  share: number;
  channels: (ChannelSizes)[];
}

/** The time in s from `since` to the first alarm of the detector that names a channel; none without one. */
export interface FoundInput {
  kind: 'found';
  /** None: any channel. */
  channel?: string | null;
  /** Time in s after the mark. */
  since?: number;
}

/** The measurement keeps the value that it had at the onset. */
export interface FreezeFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'freeze';
}

/** The measurement keeps the value that it had at the onset. */
export interface FreezeFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'freeze';
}

/** A gain of an observer: its meaning, default and bounds. */
export interface GainForm {
  name: string;
  meaning: string;
  /** Default; null: it depends on the plant and its noise. */
  default: number | (number)[] | null;
  /** Smallest permitted value; null: no bound. */
  low: number | null;
  /** Largest permitted value; null: no bound. */
  high: number | null;
  /** Whether every value must be greater than 0. */
  positive: boolean;
  /** Length of a column, or number of rows of a matrix (n, m, p, …); null for a number. */
  size: string | null;
  /** Number of columns of a matrix (n, m, p, …); null for a number or a column. */
  columns: string | null;
  symbol: string;
  unit: string;
  /** Whether a change during a run has an effect. */
  live: boolean;
}

/** Labels of a gain that is a column or a matrix. */
export interface GainLabels {
  /** Labels of the rows: states, outputs, channels or coordinates. */
  rows: (string)[];
  /** Labels of the columns; empty for a column gain. */
  columns: (string)[];
}

/** The present value of a gain that is one number. */
export interface GainNow {
  kind: 'gain';
  observer: string;
  gain: string;
}

/** The present value of a gain that is one number. */
export interface GainNowInput {
  kind: 'gain';
  observer: string;
  gain: string;
}

/** The points of students who came from a learning platform, on their way to its gradebook. */
export interface GradesView {
  /** Students whose points the gradebook has taken. */
  sent: number;
  /** Students whose points are being sent. */
  waiting: number;
  /** Students whose points the gradebook did not take. */
  failed: number;
  /** Why, in a few words, as `HTTP 403`; empty: nothing failed. */
  why: string;
}

/** The versions and the usage of the service. */
export interface Health {
  status: 'ok';
  /** Version of the program. */
  version: string;
  /** Version of the schemas. */
  schema_version: number;
  /** Version of the numbers: results of other versions are computed again. */
  engine: string;
  runs: RunUsage;
  workers: WorkUsage;
}

/** The stretch on which the noise was estimated and the fit was checked. */
export interface HealthyStretch {
  /** Its beginning in s after the first row. */
  begin: number;
  /** Its end in s after the first row. */
  end: number;
  /** Whether it was declared; else it was found. */
  given: boolean;
  /** Its rows. */
  rows: number;
}

/** The first message on a connection: everything that a page needs to display the session. */
export interface Hello {
  type: 'hello';
  protocol: number;
  session: string;
  role: 'control' | 'view';
  /** The experiment with its complete plant and all faults and timed commands up to now. */
  spec: Experiment;
  columns: (string)[];
  epoch: number;
  step: number;
  /** Time in s between rows. */
  record: number;
  /** Number of rows so far, and number of the next row. */
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

/** The fault that is to be found: sudden, or a ramp. */
export interface HiddenFault {
  channel: string;
  shape: 'step' | 'ramp';
  /** Time in s at which it begins. */
  onset: number;
  /** Size in the unit of the channel; of a ramp, its final one. */
  size: number;
  /** Time in s that a ramp takes; null: it is sudden. */
  duration: number | null;
}

/** Inject a fault. Its onset and end are relative to the present time. */
export interface Inject {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'inject';
  fault: StepFaultInput | RampFaultInput | DriftFaultInput | ExponentialFaultInput | SineFaultInput | PulseTrainFaultInput | RandomWalkFaultInput | TableFaultInput | StuckFaultInput | FreezeFaultInput | DropoutFaultInput | OutliersFaultInput | NoiseBurstFaultInput | QuantisationFaultInput | DelayFaultInput;
}

/** The innovations of the filter without faults in their standard deviations, for drawing. */
export interface Innovations {
  /** Beginnings of intervals of time, in s after the first row. */
  t: (number)[];
  /** Smallest in each interval, by output; null: it has no reading. */
  low: {[name: string]: (number | null)[]};
  /** Largest in each interval, by output. */
  high: {[name: string]: (number | null)[]};
}

/** One known input u. */
export interface Input {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Value if an experiment sets no signal, in the input's unit. */
  default: number;
  /** Plausible range, in the input's unit. */
  bounds: [number | null, number | null];
  description: string;
}

/** One known input u. */
export interface InputInput {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Value if an experiment sets no signal, in the input's unit. */
  default?: number;
  /** Plausible range, in the input's unit. */
  bounds?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** An input that would restore excitation, or the reason why it is missing. Send `signal` with set-signal. */
export interface InputProposal {
  /** The input to change; null: no signal that was tried helps. */
  input: string | null;
  /** The proposed signal, from now on. */
  signal: ConstantSignal | StepsSignal | PulseSignal | SquareSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | NoiseSignal | TableSignal | ExpressionSignal | null;
  /** Smallest eigenvalue with that signal, in (typical fault / its standard deviation)². */
  level: number;
  /** Smallest eigenvalue with the present input. */
  before: number;
  /** Level that the required accuracy needs. */
  needed: number;
  /** The proposal in a sentence, or the reason why it is missing. */
  text: Text;
}

/** A number with its 95 % interval. */
export interface Interval {
  /** The estimate. */
  value: number;
  /** Lower end of its interval. */
  low: number;
  /** Upper end of its interval. */
  high: number;
}

/** The code with which a student joins a room. */
export interface JoinRequest {
  /** Six letters; case, blanks and dashes do not matter. */
  code: string;
}

/** A student's place in a room. The token keeps it. */
export interface JoinedRoom {
  token: string;
  seat: SeatView;
}

export type JsonValue = unknown;

/** Which step to judge, and when it was started. */
export interface JudgeRequest {
  lesson: string;
  /** Place of the step in its lesson, counted from 0. */
  step: number;
  /** Time of the session in s at which the step was started. */
  mark?: number;
  /** The value of the step's dial; null: it has none. */
  dial?: number | null;
  /** What was drawn; null: the step has no sketch. */
  sketch?: (number)[] | null;
}

/** What the session shows: measured numbers, and which answers they make right. */
export interface Judged {
  /** The measured numbers by name; null: nothing was measured. */
  values: {[name: string]: number | null};
  /** Whether each answer is right. */
  right: (boolean)[];
  /** Whether the conditions of the step itself hold. */
  met: boolean;
  /** Place of the first sentence whose conditions hold; null: none does. */
  saw: number | null;
}

/** Rows `first` … `row` − 1 are skipped for this viewer, which is too slow; GET /api/sessions/{id}/data has them. */
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
  /** The signal if an experiment sets none. */
  default: ConstantSignal | StepsSignal | PulseSignal | SquareSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | NoiseSignal | TableSignal | ExpressionSignal;
}

/** One known signal φ(t), which observers see. */
export interface KnownSignalInput {
  /** Name in the equations. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  description?: string | {[name: string]: string};
  /** The signal if an experiment sets none. */
  default?: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput;
}

/** The secret of a launch from a learning platform, as it stands in the address of the page. */
export interface LaunchedRequest {
  /** It can be used once. */
  launch: string;
}

/** What the teacher shows now: a live session, and perhaps a step of a lesson. */
export interface LeadRequest {
  /** Id of the teacher's session. */
  session?: string;
  /** The curves of the session that students see. */
  strip?: CurveStripInput | null;
  /** A name for the step; '': no lesson is shown. */
  step?: string;
  /** The step's words. */
  card?: StepCardInput | null;
  /** Where the axis of time begins, in s; null: it follows. */
  since?: number | null;
  /** Time in s until which the step will run; null: it has run. */
  until?: number | null;
  /** before: students vote; after: the step was run, and is judged. */
  phase?: 'before' | 'running' | 'after';
  /** Whether each answer was right in the teacher's session. */
  right?: (boolean)[];
}

/** What the teacher shows. */
export interface LeadView {
  /** Whether curves of a session come on the stream of curves. */
  live: boolean;
  step: string;
  card: StepCard | null;
  phase: 'before' | 'running' | 'after';
  /** Where the axis of time begins, in s; null: it follows. */
  since: number | null;
  /** Time in s until which the step will run; null: it has run. */
  until: number | null;
  right: (boolean)[];
}

/** All lessons. */
export interface LessonList {
  lessons: (LessonPlan)[];
}

/** The questions of the lesson about one experiment. */
export interface LessonPlan {
  id: string;
  questions: (LessonQuestion)[];
}

/** A question, and the commands of a live session that show its answer, without ids. */
export interface LessonQuestion {
  question: Words;
  do: ({[name: string]: JsonValue})[];
}

/** The mean, standard deviation, greatest, least, last or root-mean-square value of a column or a difference. */
export interface Level {
  kind: 'level';
  take: 'mean' | 'std' | 'max' | 'min' | 'last' | 'rms';
  /** A column of the session, say y.y1. */
  column: string;
  minus: string | null;
  /** Time in s after the mark. */
  start: number;
  /** None: until the end of the step. */
  end: number | null;
}

/** The mean, standard deviation, greatest, least, last or root-mean-square value of a column or a difference. */
export interface LevelInput {
  kind: 'level';
  take: 'mean' | 'std' | 'max' | 'min' | 'last' | 'rms';
  /** A column of the session, say y.y1. */
  column: string;
  minus?: string | null;
  /** Time in s after the mark. */
  start?: number;
  /** None: until the end of the step. */
  end?: number | null;
}

/** A level that is drawn on a strip, above zero and below. */
export interface LevelLine {
  /** A column of the session, say y.y1. */
  strip: string;
  /** Its distance from zero, in the unit of the strip. */
  at: number;
}

/** A value that takes each item of a list. In a sampled design all items are equally probable. */
export interface ListFactor {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name: string;
  kind: 'list';
  /** Where in the experiment, say `observers.adaptive.gains.rho`, `noise.y.std`, `faults.theta3.size`. */
  path: string;
  values: (JsonValue)[];
}

/** A value that takes each item of a list. In a sampled design all items are equally probable. */
export interface ListFactorInput {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name?: string;
  kind: 'list';
  /** Where in the experiment, say `observers.adaptive.gains.rho`, `noise.y.std`, `faults.theta3.size`. */
  path: string;
  values: (JsonValue)[];
}

/** An input, known signal or output of the plant, and the column that it is read from. */
export interface MappedQuantity {
  /** Its name in the plant. */
  name: string;
  role: 'input' | 'signal' | 'output';
  /** Its unit in the plant. */
  unit: string;
  /** Its description in the plant. */
  description: string;
  /** Plausible range in the plant's unit. */
  bounds: [number | null, number | null];
  /** The column; null: the record has none. */
  column: string | null;
  /** The unit that its cells are taken to have. */
  column_unit: string;
  /** Units that can be chosen for its cells. */
  units: (string)[];
  /** The plant's value is factor · cell + offset. */
  factor: number;
  /** See `factor`. */
  offset: number;
  /** Smallest value in the plant's unit, without sentinels. */
  low: number | null;
  /** Largest value in the plant's unit, without sentinels. */
  high: number | null;
  /** Whether names or written units give the column; else it should be looked at. */
  certain: boolean;
  /** Why this column and this unit, or why no column. */
  reason: Text;
  /** Another mapping that would fit better, or null. */
  proposal: QuantityMapping | null;
}

/** The plant of a record, and what is to be changed in the guess. */
export interface MappingRequest {
  /** Id of a library plant, or a complete plant. */
  plant: string | PlantInput;
  /** Changes of the guess. */
  mapping?: ColumnMappingInput;
}

/** A measure of the compared observers; the smaller the better. */
export interface MeasureRow {
  /** Name of the measure. */
  label: Text;
  unit: string;
  /** Value in each run; null: it has none. */
  values: (number | null)[];
}

/** The measured numbers by name. */
export interface Measured {
  /** In the unit of the column, or in s; null: nothing was measured. */
  values: {[name: string]: number | null};
}

/** What to measure in a run, by names that the client chooses. */
export interface MeasuresRequest {
  measures: {[name: string]: SettlesInput | LevelInput | CrossesInput | CountsInput | DecaysInput | RisesInput | FoundInput | DivergedInput | GainNowInput};
}

/** A test that the model failed. */
export interface MisfitReason {
  /** bias, coloured, jump, driven, still, input-bounds, not-healthy, blind, unit, later or many. */
  kind: string;
  /** The output or input that it concerns; empty: the whole record. */
  name: string;
  /** Time in s after the first row at which it shows, or null. */
  t: number | null;
  /** The reason in a sentence. */
  text: Text;
}

/** Something that would explain a misfit. */
export interface MisfitSuspect {
  /** What would have to be different. */
  kind: 'time' | 'output' | 'offset' | 'fahrenheit' | 'input' | 'swap-inputs' | 'swap-outputs' | 'parameter';
  /** Of the output, input or parameter; `*`: all of them; two names for a swap. */
  name: string;
  /** By which it would have to be multiplied; of an offset the addend. */
  factor: number | null;
  /** Fall of −2 log L with it. */
  gain: number;
  /** Fit of the simulation with it; null: it was not simulated. */
  simulated: number | null;
  /** The suspicion in a sentence. */
  text: Text;
}

/** An additive fault that the plant lacks and that would explain the record better than its channels. */
export interface MissingFault {
  /** The state equation or output that it enters. */
  target: string;
  /** Id of the fault that it would explain. */
  fault: string;
  /** By how much it explains better. */
  gain: number;
  /** Its size at the end. */
  size: number;
  /** Its unit. */
  unit: string;
  /** The proposal in a sentence. */
  text: Text;
}

/** A saved lesson with its steps. */
export interface MyLesson {
  /** Its id, by which the address of a lesson names it. */
  id: string;
  /** Number of the version, from 1. */
  version: number;
  title: Words;
  outcome: Words;
  /** Time in minutes that it takes. */
  minutes: number;
  /** Number of steps. */
  steps: number;
  /** Time in seconds since 1970. */
  saved: number;
  /** Whether this client may change and delete it; others may read, play and copy it. */
  mine: boolean;
  lesson: CourseLesson;
}

/** The latest version of a saved lesson, without its steps. */
export interface MyLessonLine {
  /** Its id, by which the address of a lesson names it. */
  id: string;
  /** Number of the version, from 1. */
  version: number;
  title: Words;
  outcome: Words;
  /** Time in minutes that it takes. */
  minutes: number;
  /** Number of steps. */
  steps: number;
  /** Time in seconds since 1970. */
  saved: number;
  /** Whether this client may change and delete it; others may read, play and copy it. */
  mine: boolean;
}

/** Saved lessons, the last one that was saved first. */
export interface MyLessonList {
  lessons: (MyLessonLine)[];
}

/** A version of a saved plant with its text. */
export interface MyPlant {
  /** Id in the text, by which experiments and records name the plant. */
  id: string;
  /** Number of the version, from 1; `id@version` names it. */
  version: number;
  title: string;
  format: 'yaml' | 'json';
  /** Number of fault channels; 0 in a draft that cannot be read. */
  faults: number;
  /** Whether it had no errors when it was saved; a draft cannot be simulated. */
  ready: boolean;
  /** Time in seconds since 1970. */
  saved: number;
  /** Whether this client may delete it; others' plants can be read and used. */
  mine: boolean;
  href: string;
  /** The plant as YAML or JSON, as it was typed. */
  text: string;
}

/** A version of a saved plant, without its text. */
export interface MyPlantLine {
  /** Id in the text, by which experiments and records name the plant. */
  id: string;
  /** Number of the version, from 1; `id@version` names it. */
  version: number;
  title: string;
  format: 'yaml' | 'json';
  /** Number of fault channels; 0 in a draft that cannot be read. */
  faults: number;
  /** Whether it had no errors when it was saved; a draft cannot be simulated. */
  ready: boolean;
  /** Time in seconds since 1970. */
  saved: number;
  /** Whether this client may delete it; others' plants can be read and used. */
  mine: boolean;
  href: string;
}

/** Saved plants, or the versions of one of them, the last one that was saved first. */
export interface MyPlantList {
  plants: (MyPlantLine)[];
}

/** What the page gets: what was measured, and what may have happened. Nothing in it depends on the truth alone. */
export interface Mystery {
  seed: string;
  setup: string;
  title: Words;
  plant: Words;
  /** Length of the record in s. */
  end: number;
  /** Time in s from row to row. */
  record: number;
  /** Time in s that a gradual fault takes. */
  ramp: number;
  choices: (MysteryChoice)[];
  columns: (MysteryColumn)[];
}

/** A channel among which one chooses, and the sizes that may be answered. */
export interface MysteryChoice {
  channel: string;
  title: Words;
  unit: string;
  /** Smallest size in the unit of the channel. */
  low: number;
  /** Largest size in the unit of the channel. */
  high: number;
}

/** A column of the record: what is measured and commanded, or an observer's estimate. */
export interface MysteryColumn {
  name: string;
  /** u, y, residual (measured minus predicted), or theta. */
  of: string;
  /** The input, output or channel. */
  subject: string;
  /** Channel that its observer suspects; empty: none, or no observer. */
  observer: string;
  unit: string;
  /** One value for each row in the unit of the column. */
  values: (number | null)[];
}

/** A set-up without what is drawn from it. */
export interface MysterySetupLine {
  id: string;
  title: Words;
  /** Number of channels in which a fault may be hidden. */
  suspects: number;
}

/** The set-ups of mysteries, those with the fewest suspects first. */
export interface MysterySetups {
  setups: (MysterySetupLine)[];
}

/** The truth, the answer and the detector's, each with its points, and the experiment with everything in it. */
export interface MysterySolution {
  truth: ChallengeTruth;
  answer: ChallengeAnswer;
  score: Score;
  /** Null: the detector named nothing that can be graded. */
  detector: ChallengeAnswer | null;
  detector_score: Score;
  experiment: Experiment;
}

/** The name that a student chooses; without one the student gets another animal. */
export interface NameRequest {
  /** A name; null: another animal. */
  name?: string | null;
}

/** Gaussian measurement noise of one output; each drawn value is held for the sample time. */
export interface Noise {
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time: number;
}

/** Additional Gaussian noise. */
export interface NoiseBurstFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'noise-burst';
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time: number;
}

/** Additional Gaussian noise. */
export interface NoiseBurstFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'noise-burst';
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time?: number;
}

/** Gaussian measurement noise of one output; each drawn value is held for the sample time. */
export interface NoiseInput {
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time?: number;
}

/** Noise of one output: declared, and estimated from the residual. */
export interface NoiseLevel {
  /** The measured output. */
  output: string;
  /** Standard deviation declared in the experiment; null: none. */
  declared: number | null;
  /** Standard deviation estimated from the residual; null: unknown. */
  estimated: number | null;
}

/** offset + std·ξ, where ξ is drawn from the standard normal distribution every `hold` seconds, by the seed. */
export interface NoiseSignal {
  kind: 'noise';
  /** Standard deviation, in the signal's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  hold: number;
  /** Seed of the sequence. */
  seed: number;
  /** Mean value, in the signal's unit. */
  offset: number;
}

/** offset + std·ξ, where ξ is drawn from the standard normal distribution every `hold` seconds, by the seed. */
export interface NoiseSignalInput {
  kind: 'noise';
  /** Standard deviation, in the signal's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  hold: number;
  /** Seed of the sequence. */
  seed?: number;
  /** Mean value, in the signal's unit. */
  offset?: number;
}

/** A note at a moment of the experiment; without a text it is a bookmark. */
export interface Note {
  /** Id, which no other note of the experiment has. */
  id: string;
  /** The moment, time in s. */
  t: number;
  text: string;
}

/** A note at a moment of the experiment; without a text it is a bookmark. */
export interface NoteInput {
  /** Id, which no other note of the experiment has. */
  id: string;
  /** The moment, time in s. */
  t: number;
  text?: string;
}

/** One equation of an observer as MathML, with its number in the paper. */
export interface NumberedEquation {
  number: string;
  math: string;
}

/** Joint observability of the states and all faults: from the equations, and along a run. */
export interface Observability {
  /** Generic rank of the observability matrix of states and faults (Lie derivatives); null: undecided. */
  rank: number | null;
  /** Number of states and faults. */
  size: number;
  /** The states and faults that no input can distinguish, in a sentence. */
  text: Text;
  /** Length in s of the windows along the run. */
  window: number;
  /** Times in s at which the windows begin. */
  t: (number)[];
  /** Rank of the empirical Gramian over each window; null: the plant diverges. */
  ranks: (number | null)[];
  /** Its condition number, in units of typical sizes; null below full rank. */
  conditions: (number | null)[];
  /** The same in a sentence, with the least observable combination. */
  along: Text;
}

/** One observer of an experiment. The catalogue lists the gains and options of each kind, and their defaults. */
export interface ObserverConfig {
  /** Label, unique in the experiment, and prefix of the observer's columns. */
  label: string;
  /** Kind of observer, from the catalogue. */
  kind: string;
  /** Gains that differ from their defaults: a number, a list (column) or a list of rows (matrix). */
  gains: {[name: string]: number | (number)[] | ((number)[])[]};
  /** Options that differ from their defaults. */
  options: {[name: string]: boolean | string | number};
  /** Estimates at t = 0 by state or channel. Default: the plant's initial state, and 0 for a channel. */
  initial: {[name: string]: number};
}

/** One observer of an experiment. The catalogue lists the gains and options of each kind, and their defaults. */
export interface ObserverConfigInput {
  /** Label, unique in the experiment, and prefix of the observer's columns. */
  label: string;
  /** Kind of observer, from the catalogue. */
  kind: string;
  /** Gains that differ from their defaults: a number, a list (column) or a list of rows (matrix). */
  gains?: {[name: string]: number | (number)[] | ((number)[])[]};
  /** Options that differ from their defaults. */
  options?: {[name: string]: boolean | string | number};
  /** Estimates at t = 0 by state or channel. Default: the plant's initial state, and 0 for a channel. */
  initial?: {[name: string]: number};
}

/** The diagnosis by one observer or by the detector. */
export interface ObserverDiagnosis {
  /** Label of the observer; empty: the detector, which uses the measurements only. */
  observer: string;
  /** Alarms in order of time. */
  alarms: (Alarm)[];
  /** For each channel, the smallest fault that can be found. */
  resolution: (Resolution)[];
  /** Excitation of the faults by the input, at the end. */
  excitation: Excitation | null;
  /** Calibration of the thresholds. */
  calibration: Calibration | null;
  /** Noise of each output. */
  noise: (NoiseLevel)[];
  /** The diagnosis in a sentence. */
  sentence: Text | null;
  /** The reason if there is no diagnosis. */
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
  /** Root mean square error of the state; null: some rows have no value. */
  rmse: number | null;
  /** Standard deviation of θ̂ about a fitted line, over the last quarter of the window. */
  noise: number | null;
  /** Seconds from the step of θ until θ̂ stays within 10 % of the step's size. */
  settled: number | null;
  /** Too noisy: θ̂ reached θ, but noise moves it out of the 10 % band. Unknown: no step, or no θ̂. */
  outcome: 'settled' | 'not-yet' | 'too-noisy' | 'unknown';
  /** Whether since the last change θ̂ still moves, or y − ŷ is larger, than noise explains, so that the bias of θ̂ may exceed its band; null: unknown, or without a band. */
  converging: boolean | null;
}

/** A kind of observer with its gains and options. */
export interface ObserverKind {
  id: string;
  title: string;
  source: string;
  summary: string;
  /** When to take it: the end of a sentence. */
  when: string;
  time: string;
  estimates_theta: boolean;
  /** Whether faults of the plant can be chosen for it. */
  takes_channels: boolean;
  /** Whether it has residuals that name a fault; above 1 is an alarm. */
  residuals: boolean;
  /** Whether it takes, by default, only the faults of a plant that it can tell apart. */
  chooses: boolean;
  gains: (GainForm)[];
  options: (OptionForm)[];
}

/** The divergence of an observer: its time and likely cause. */
export interface ObserverLost {
  /** Time in s. */
  t: number;
  /** The likely cause. */
  cause: Text;
}

/** An observer that is running at that time. */
export interface ObserverNow {
  label: string;
  kind: string;
  /** Present values of the gains that were set; the others have their defaults. */
  gains: {[name: string]: number | (number)[] | ((number)[])[]};
  options: {[name: string]: JsonValue};
  /** Its configuration at the start. */
  config: ObserverConfig;
  /** Time in s at which it was started. */
  since: number;
  diverged: ObserverLost | null;
}

/** All kinds of observers, the best for a plant first. */
export interface ObserverRanking {
  observers: (RankedObserver)[];
}

/** The results of one observer. */
export interface ObserverSummary {
  label: string;
  kind: string;
  /** The name of the kind. */
  title: Text | null;
  diverged: Divergence | null;
  /** Root mean square error of each state over the run; null if undefined. */
  rmse: {[name: string]: number | null};
  /** The same over the last tenth of the run. */
  rmse_end: {[name: string]: number | null};
  /** Estimate of each channel at the end. */
  theta: {[name: string]: FinalValue};
  /** Settling after each step of a fault. */
  settling: (Settling)[];
  checks: (AssumptionCheck)[];
  /** Facts determined during the observer's construction. */
  facts: {[name: string]: JsonValue};
}

/** All estimates of one observer over a window. */
export interface ObserverTable {
  label: string;
  /** States first, then faults, in the plant's order. */
  estimates: (EstimateInWindow)[];
}

/** Each of the experiment's observers alone. */
export interface ObserversFactor {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name: string;
  kind: 'observers';
  labels: (string)[];
}

/** Each of the experiment's observers alone. */
export interface ObserversFactorInput {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name?: string;
  kind: 'observers';
  labels: (string)[];
}

/** A structural option of an observer: another value gives other equations. */
export interface OptionForm {
  name: string;
  meaning: string;
  kind: string;
  default: JsonValue;
  choices: (string)[];
  low: number;
  high: number;
}

/** An answer after the reveal: the truth, what could be told of it, and what the detector found. */
export interface Outcome {
  /** null: there was no answer. */
  right: boolean | null;
  /** Of 100; null: there was no answer. */
  points: number | null;
  /** null: nothing was wrong. */
  fault: HiddenFault | null;
  /** Seconds of the record from its beginning to the answer. */
  after: number | null;
  /** Time in s from which it could be told from all others; null: never. */
  told: number | null;
  /** The channels that look alike until the end. */
  alike: (string)[];
  detector: ChallengeAnswer | null;
  /** Points of the detector's answer, of 100. */
  detector_points: number;
}

/** Each sample is displaced by ±size with a probability. */
export interface OutliersFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
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
  /** Time in s at which it disappears; null: never. */
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
  /** Right-hand side of the output equation, without faults. */
  expression: string;
  /** Size of a typical change, in the output's unit; null: found in a simulation without faults. */
  scale: number | null;
  description: string;
}

/** How well the model fits one output on the healthy stretch. */
export interface OutputFitReport {
  /** The output. */
  output: string;
  /** Its unit. */
  unit: string;
  /** 1 − ‖error‖/‖y − mean‖ of predictions from row to row; 1: perfect. */
  predicted: number;
  /** The same of the simulation from the first row on, without corrections; null: it diverges. */
  simulated: number | null;
  /** Standard deviation of the measurement noise, in the output's unit. */
  noise: number;
  /** Correlation of the noise from one row to the next; 0: white. */
  memory: number;
  /** Standard deviation of the innovations, in the output's unit. */
  innovation: number;
  /** Mean of the innovations in standard errors; healthy: within ±4. */
  bias: number;
  /** Probability of the autocorrelation of the innovations if they were white. */
  whiteness: number;
  /** The same in a sentence. */
  text: Text;
}

/** One measured output y. */
export interface OutputInput {
  /** Name of the output. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Right-hand side of the output equation, without faults. */
  expression: string;
  /** Size of a typical change, in the output's unit; null: found in a simulation without faults. */
  scale?: number | null;
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

/** A paper as a page shows it. Its id is that of its experiment; variants of that add a word to the id. */
export interface Paper {
  id: string;
  citation: Citation;
  /** The claim of the paper, in two sentences. */
  claim: Words;
  /** How the paper is read here so that its example runs. */
  reading: Words;
  equations: (PaperEquation)[];
  figures: (PaperFigure)[];
  numbers: (PaperNumber)[];
  errata: (Erratum)[];
  /** What of the claims holds. */
  holds: (Words)[];
  /** What does not hold, or holds with a restriction only. */
  fails: (Words)[];
}

/** An equation of a paper, with its number there. */
export interface PaperEquation {
  /** Its number in the paper; empty: it has none. */
  number: string;
  /** The formula in TeX, in the paper's notation. */
  tex: string;
  /** Its purpose, or its reading here. */
  about: Words | null;
}

/** A figure of a paper: what is printed, and the figure of a run that is drawn beside it. */
export interface PaperFigure {
  /** Its number in the paper. */
  number: string;
  experiment: string;
  /** Name of a figure of the run. */
  figure: string;
  /** What the paper draws, and what its text says about it. */
  printed: Words;
  /** How the computed figure agrees or differs. */
  ours: Words | null;
}

/** A paper in the list. */
export interface PaperLine {
  id: string;
  citation: Citation;
  claim: Words;
}

/** The papers whose experiments the library has. */
export interface PaperList {
  papers: (PaperLine)[];
}

/** A number that is measured in a run, beside the one that the paper prints. */
export interface PaperNumber {
  what: Words;
  /** What the paper says; null: nothing. */
  printed: Words | null;
  experiment: string;
  measure: Settles | Level | Crosses | Counts | Decays | Rises | Found | Diverged | GainNow;
  unit: string;
  /** The value of an independent computation; null: not computed. */
  expected: number | null;
  /** How far the measured value may be from it, in the same unit. */
  within: number;
}

/** A paper and its equations as MathML. */
export interface PaperPage {
  paper: Paper;
  /** MathML of each equation, in their order. */
  equations: (string)[];
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

/** Pause the clock. */
export interface Pause {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'pause';
}

/** A plant x' = f(x,u,φ,t) + Σ coefficient·θ, y = h(x,u,φ,t) + Σ coefficient·θ (x(k+1) in discrete time). */
export interface Plant {
  /** Short name: lower-case letters, digits and hyphens. */
  id: string;
  title: string;
  description: string;
  /** Source of the plant, such as a paper and its equations. */
  source: string;
  /** Continuous, or discrete with a period. */
  time: ContinuousTime | DiscreteTime;
  states: (State)[];
  inputs: (Input)[];
  outputs: (Output)[];
  parameters: (Parameter)[];
  signals: (KnownSignal)[];
  /** Tables y(x), for interp(x, name) in expressions. */
  tables: (Table)[];
  /** Intermediate quantities, in order. */
  definitions: (Definition)[];
  /** Quantities that equations determine at every instant. */
  algebraic: (AlgebraicVariable)[];
  /** Right-hand side by state: its derivative, or its next value in discrete time. */
  dynamics: {[name: string]: string};
  /** Changes of states at conditions, in order (continuous time). */
  events: (StateEvent)[];
  /** The faults that can occur. */
  channels: (Channel)[];
  /** Set points of the controllers. */
  references: (SetPoint)[];
  /** Controllers that set inputs of the plant; empty: an open loop. */
  controllers: (Controller)[];
}

/** The result of checking a plant. */
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

/** The equations of a plant, with its faults. */
export interface PlantEquations {
  id: string;
  title: string;
  source: string;
  time: 'continuous' | 'discrete';
  channels: (EquationChannel)[];
  states: (EquationLine)[];
  definitions: (EquationLine)[];
  outputs: (EquationLine)[];
  controllers: (EquationLine)[];
}

/** A plant x' = f(x,u,φ,t) + Σ coefficient·θ, y = h(x,u,φ,t) + Σ coefficient·θ (x(k+1) in discrete time). */
export interface PlantInput {
  /** Short name: lower-case letters, digits and hyphens. */
  id: string;
  title?: string | {[name: string]: string};
  description?: string | {[name: string]: string};
  /** Source of the plant, such as a paper and its equations. */
  source?: string | {[name: string]: string};
  /** Continuous, or discrete with a period. */
  time?: ContinuousTimeInput | DiscreteTimeInput;
  states: (StateInput)[];
  inputs?: (InputInput)[];
  outputs: (OutputInput)[];
  parameters?: (ParameterInput)[];
  signals?: (KnownSignalInput)[];
  /** Tables y(x), for interp(x, name) in expressions. */
  tables?: (TableInput)[];
  /** Intermediate quantities, in order. */
  definitions?: (DefinitionInput)[];
  /** Quantities that equations determine at every instant. */
  algebraic?: (AlgebraicVariableInput)[];
  /** Right-hand side by state: its derivative, or its next value in discrete time. */
  dynamics: {[name: string]: string};
  /** Changes of states at conditions, in order (continuous time). */
  events?: (StateEvent)[];
  /** The faults that can occur. */
  channels?: (ChannelInput)[];
  /** Set points of the controllers. */
  references?: (SetPointInput)[];
  /** Controllers that set inputs of the plant; empty: an open loop. */
  controllers?: (ControllerInput)[];
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

/** Simulations of a plant without noise: healthy, and with a fault of usual size in each channel from `onset` on. */
export interface PlantPreview {
  /** Times in s. */
  t: (number)[];
  /** Time in s at which the faults begin. */
  onset: number;
  /** Inputs without faults, by name. */
  inputs: {[name: string]: (number)[]};
  /** Outputs without faults, by name. */
  outputs: {[name: string]: (number)[]};
  /** Outputs with the fault of a channel, by channel and output; a list ends where the plant diverges. */
  faulty: {[name: string]: {[name: string]: (number)[]}};
  /** Size of the fault, by channel. */
  sizes: {[name: string]: number};
  /** Row i, column j: seconds until fault i is distinguished from j, on the diagonal until it is found, for the best test that knows the onset; null: not within the experiment. */
  seconds: ((number | null)[])[];
}

/** Dimensions of a plant. */
export interface PlantSizes {
  states: number;
  inputs: number;
  outputs: number;
  channels: number;
}

/** The check of a plant's text. A text with errors is an answer, too, and not a refusal. */
export interface PlantTextCheck {
  format: 'yaml' | 'json';
  /** The plant's id, as far as the text can be read. */
  id: string;
  title: string;
  /** Whether the plant can be simulated: there are no errors. */
  valid: boolean;
  /** Errors and warnings in the order of the text. */
  errors: (TextError)[];
  /** The plant in full; null unless it is valid. */
  plant: Plant | null;
  sizes: PlantSizes | null;
  equations: PlantEquations | null;
}

/** An experiment that suits a plant, without observers, and its preview. */
export interface PlantTrial {
  experiment: Experiment;
  preview: PlantPreview;
}

/** A plant, and values that differ from its own. */
export interface PlantTrialRequest {
  plant: string | PlantInput;
  /** Parameters that differ. */
  parameters?: {[name: string]: number};
  /** Initial states that differ. */
  initial?: {[name: string]: number};
  /** Inputs; default: square waves. */
  inputs?: {[name: string]: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput};
}

/** Start or resume the clock. */
export interface Play {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'play';
}

/** A lesson, and which of its steps to play. */
export interface PlayRequest {
  lesson: CourseLessonInput;
  /** Place of the step, counted from 0. */
  step: number;
}

/** A step as it goes in the lesson's own experiment. */
export interface Played {
  /** Time in s of the session at which the step begins. */
  mark: number;
  /** By choice; of a dial and a sketch first wrong, then right. */
  deeds: (PlayedDeed)[];
  /** Times in s of the curves. */
  t: (number)[];
  curves: (PlayedCurve)[];
  /** Names of all columns that a measure can read. */
  columns: (string)[];
}

/** A curve on a strip: the truth, a reading, or what an observer estimates. */
export interface PlayedCurve {
  /** Name of the strip. */
  strip: string;
  /** Label of the observer; empty: the true value or a signal. */
  label: string;
  /** Its values at the times `t`, in the unit of the strip. */
  values: (number | null)[];
}

/** What the session shows after one of the things that a student can do: a choice, a value of the dial, a sketch. */
export interface PlayedDeed {
  judged: Judged;
  /** Time in s of the session from which each answer is right until the end; null: it is wrong there. */
  since: (number | null)[];
  /** The same for the conditions of the step itself. */
  met_since: number | null;
}

/** One figure as Plotly's JSON, its arrays as base64. */
export interface PlotlyFigure {
  data: ({[name: string]: JsonValue})[];
  layout: {[name: string]: JsonValue};
}

/** A point of the design with a cell for each measure. */
export interface PointAnswer {
  /** Number of the point. */
  point: number;
  /** Number of its first run. */
  run: number;
  /** Runs there. */
  runs: number;
  /** The values of the factors. */
  values: {[name: string]: number | string};
  /** Median [middle half], or count/runs (interval). */
  cells: (string)[];
  /** Median, or share, of each measure. */
  numbers: (number | null)[];
}

/** The table of points. */
export interface PointAnswers {
  /** Names of the columns. */
  measures: (string)[];
  points: (PointAnswer)[];
}

/** Points for one of the four things that count. */
export interface Points {
  of: 'name' | 'size' | 'soon' | 'accused';
  /** Points that were earned. */
  points: number;
  /** Points that could be earned. */
  most: number;
  why: Text;
}

/** Whether a kind of observer can be built for a plant, and the reason if not. */
export interface PossibleObserver {
  kind: string;
  title: string;
  possible: boolean;
  why: string;
}

/** Pseudo-random binary sequence: every `hold` seconds `low` or `high` is drawn, from the signal's seed. */
export interface PrbsSignal {
  kind: 'prbs';
  /** First of the two values. */
  low: number;
  /** Second of the two values. */
  high: number;
  /** Time in s for which each drawn value is held. */
  hold: number;
  /** Seed of the sequence. */
  seed: number;
  /** Order of a maximum-length sequence, 2 to 16; null: independent draws. */
  order: number | null;
}

/** Pseudo-random binary sequence: every `hold` seconds `low` or `high` is drawn, from the signal's seed. */
export interface PrbsSignalInput {
  kind: 'prbs';
  /** First of the two values. */
  low?: number;
  /** Second of the two values. */
  high?: number;
  /** Time in s for which each drawn value is held. */
  hold: number;
  /** Seed of the sequence. */
  seed?: number;
  /** Order of a maximum-length sequence, 2 to 16; null: independent draws. */
  order?: number | null;
}

/** Every gain of every observer of an experiment, by label and name. */
export interface PresentGains {
  gains: {[name: string]: {[name: string]: number | (number)[] | ((number)[])[]}};
  /** Labels of gains that are columns or matrices, by observer and gain. */
  labels: {[name: string]: {[name: string]: GainLabels}};
}

/** One curve for drawing: the smallest and largest value in each interval of time. */
export interface PreviewSeries {
  /** The plant's quantity, or the name of an unused column. */
  name: string;
  role: 'time' | 'input' | 'signal' | 'output' | 'unused';
  /** The column of the file. */
  column: string | null;
  /** Unit of the values. */
  unit: string;
  /** Smallest value in each interval; null: it has no data. */
  low: (number | null)[];
  /** Largest value in each interval; null: it has no data. */
  high: (number | null)[];
}

/** The options of a figure for print. Curves and panels are named as in its description, format `json`. */
export interface PrintSettings {
  /** pdf, svg, png (600 dpi), tex (TikZ with its data), or json: the description. */
  format?: 'pdf' | 'svg' | 'png' | 'tex' | 'json';
  /** Width in cm. */
  width?: number;
  /** Height in cm; by default by the panels. */
  height?: number | null;
  /** times: STIX, which fits Times; sans: DejaVu Sans; serif: DejaVu Serif. */
  font?: 'times' | 'sans' | 'serif';
  /** Size of the type in pt. */
  size?: number;
  /** Line styles differ in each; grey and black do without colours. */
  colour?: 'colour' | 'grey' | 'black';
  legend?: 'inside' | 'above' | 'none';
  /** First time in s. */
  start?: number | null;
  /** Last time in s. */
  end?: number | null;
  /** Keys of the curves to draw; default: all. */
  curves?: (string)[];
  /** Numbers of the panels to draw, the first is 1; default: all. */
  panels?: (number)[];
  /** Line styles as curve=style, for example adaptive=dash-dot. */
  styles?: (string)[];
  /** Language of the words in the figure, en or zh; default: en. */
  lang?: string | null;
}

/** One curve that the figure can show: the same quantity of the same observer in all panels. */
export interface PrintedCurve {
  key: string;
  /** Text of the legend. */
  label: string;
  style: 'line' | 'dashes' | 'dash-dot' | 'dots' | 'thin-grey' | 'long-dashes' | 'dash-dot-dot' | 'thick-grey' | 'grey-dashes' | 'grey-dash-dot';
  drawn: boolean;
}

/** The description of a figure for print. */
export interface PrintedFigure {
  title: string;
  /** A caption with the id of the run. */
  caption: string;
  /** The command that draws the figure again. */
  command: string;
  filename: string;
  /** Width in cm. */
  width: number;
  /** Height in cm. */
  height: number;
  curves: (PrintedCurve)[];
  panels: (PrintedPanel)[];
  /** All line styles. */
  styles: ('line' | 'dashes' | 'dash-dot' | 'dots' | 'thin-grey' | 'long-dashes' | 'dash-dot-dot' | 'thick-grey' | 'grey-dashes' | 'grey-dash-dot')[];
  /** Size of the type in pt. */
  type_size: number;
  /** Width of the thinnest line in pt. */
  thinnest: number;
  /** Whether all curves differ without colour. */
  apart: boolean;
  /** First and last time of the run in s. */
  span: [number, number];
}

/** One panel that the figure can show. */
export interface PrintedPanel {
  number: number;
  label: string;
  drawn: boolean;
}

/** A refusal or failure as application/problem+json (RFC 9457), with its sentences in the requested language. */
export interface Problem {
  /** URI reference of the problem type. */
  type: string;
  /** Short text, the same for every problem of this type. */
  title: string;
  /** HTTP status. */
  status: number;
  /** The problem of this request, and its remedy. */
  detail: string;
  /** Key of the problem's sentence in the catalogues, GET /api/messages/{language}. */
  code: string;
  /** Arguments of the sentence by name. */
  args: {[name: string]: JsonValue};
  /** URI reference of this occurrence. */
  instance: string | null;
  /** For each offending field, its value, the problem and the remedy. */
  errors: (FieldError)[];
}

/** A refusal or failure as application/problem+json (RFC 9457), with its sentences in the requested language. */
export interface ProblemInput {
  /** URI reference of the problem type. */
  type?: string;
  /** Short text, the same for every problem of this type. */
  title: string;
  /** HTTP status. */
  status: number;
  /** The problem of this request, and its remedy. */
  detail?: string;
  /** Key of the problem's sentence in the catalogues, GET /api/messages/{language}. */
  code?: string;
  /** Arguments of the sentence by name. */
  args?: {[name: string]: JsonValue};
  /** URI reference of this occurrence. */
  instance?: string | null;
  /** For each offending field, its value, the problem and the remedy. */
  errors?: (FieldErrorInput)[];
}

/** The progress of a run. */
export interface Progress {
  /** The run's id. */
  id: string;
  status: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  /** Completed share, 0 to 1. */
  progress: number;
  detail: string;
  /** The reason of a failure. */
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
  /** Time in s at which it disappears; null: never. */
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
  /** Time in s at which it disappears; null: never. */
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

/** The output is rounded to multiples of the resolution. */
export interface QuantisationFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'quantisation';
  /** Resolution, in the output's unit. */
  resolution: number;
}

/** The output is rounded to multiples of the resolution. */
export interface QuantisationFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'quantisation';
  /** Resolution, in the output's unit. */
  resolution: number;
}

/** The column from which an input, signal or output of the plant is read. */
export interface QuantityMapping {
  /** Name of the column; null: the record has none. */
  column: string | null;
  /** Unit of the column; null: the one in the file, or the plant's. */
  unit: string | null;
  /** Instead of a unit: the plant's value is factor · cell + offset. */
  factor: number | null;
  /** See `factor`; null: 0. */
  offset: number | null;
}

/** The column from which an input, signal or output of the plant is read. */
export interface QuantityMappingInput {
  /** Name of the column; null: the record has none. */
  column?: string | null;
  /** Unit of the column; null: the one in the file, or the plant's. */
  unit?: string | null;
  /** Instead of a unit: the plant's value is factor · cell + offset. */
  factor?: number | null;
  /** See `factor`; null: 0. */
  offset?: number | null;
}

/** θ rises linearly to `size` over `duration`, then is constant. */
export interface RampFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'ramp';
  /** Final size, in the channel's unit. */
  size: number;
  /** Time in s to the final size. */
  duration: number;
}

/** θ rises linearly to `size` over `duration`, then is constant. */
export interface RampFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'ramp';
  /** Final size, in the channel's unit. */
  size: number;
  /** Time in s to the final size. */
  duration: number;
}

/** `initial` until `start`, then rising by `slope` per second, constant from `end` on. */
export interface RampSignal {
  kind: 'ramp';
  /** Start of the ramp in s. */
  start: number;
  /** Slope, in the signal's unit per s. */
  slope: number;
  /** Value until the start. */
  initial: number;
  /** Time in s from which the value is constant; null: never. */
  end: number | null;
}

/** `initial` until `start`, then rising by `slope` per second, constant from `end` on. */
export interface RampSignalInput {
  kind: 'ramp';
  /** Start of the ramp in s. */
  start?: number;
  /** Slope, in the signal's unit per s. */
  slope: number;
  /** Value until the start. */
  initial?: number;
  /** Time in s from which the value is constant; null: never. */
  end?: number | null;
}

/** Random walk: every sample_time θ gains a Gaussian increment of std intensity·√sample_time (experiment's seed). */
export interface RandomWalkFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'random-walk';
  /** Standard deviation per √s, in the channel's unit. */
  intensity: number;
  /** Time in s between increments. */
  sample_time: number;
}

/** Random walk: every sample_time θ gains a Gaussian increment of std intensity·√sample_time (experiment's seed). */
export interface RandomWalkFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'random-walk';
  /** Standard deviation per √s, in the channel's unit. */
  intensity: number;
  /** Time in s between increments. */
  sample_time?: number;
}

/** A number between two bounds: evenly spaced in a grid, anywhere between them in a sampled design. */
export interface RangeFactor {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name: string;
  kind: 'range';
  /** Where in the experiment, say `observers.adaptive.gains.rho`, `noise.y.std`, `faults.theta3.size`. */
  path: string;
  /** The least value. */
  low: number;
  /** The greatest value. */
  high: number;
  scale: 'linear' | 'log';
  /** Number of values in a grid, the bounds among them. */
  points: number | null;
}

/** A number between two bounds: evenly spaced in a grid, anywhere between them in a sampled design. */
export interface RangeFactorInput {
  /** Name of its column in the table; empty: the path, or the kind if it has no path. */
  name?: string;
  kind: 'range';
  /** Where in the experiment, say `observers.adaptive.gains.rho`, `noise.y.std`, `faults.theta3.size`. */
  path: string;
  /** The least value. */
  low: number;
  /** The greatest value. */
  high: number;
  scale?: 'linear' | 'log';
  /** Number of values in a grid, the bounds among them. */
  points?: number | null;
}

/** A kind of observer for a plant, and how well it estimates the plant's faults. */
export interface RankedObserver {
  kind: string;
  /** Whether it can be built for the plant. */
  possible: boolean;
  /** Root mean square error in faults of usual size; null: it was not run. */
  error: number | null;
  /** Whether none of its assumptions failed in the run. */
  holds: boolean;
  /** The reason for its rank. */
  why: Text;
}

/** A share of runs with its exact 95 % interval. */
export interface RateAnswer {
  /** Runs that count. */
  count: number;
  /** Runs that were counted. */
  of: number;
  /** Lower end of the interval, from 0 to 1. */
  low: number;
  /** Upper end of the interval, from 0 to 1. */
  high: number;
}

/** Whether the service accepts work; status 503 if it does not. */
export interface Ready {
  status: 'ready' | 'not ready';
  checks: (ReadyCheck)[];
  /** Free bytes of the folder of the store. */
  free: number;
}

/** One condition for accepting work. */
export interface ReadyCheck {
  name: 'store' | 'disk' | 'queue';
  ok: boolean;
  /** Its present value, or why it does not hold. */
  detail: string;
}

/** Samples of times, inputs, signals and outputs of the plant: columns, or CSV with a header. */
export interface Record {
  /** Id of a library plant, or a complete plant. */
  plant: string | PlantInput;
  /** Columns by name, all of the same length; or give `csv`. */
  columns?: {[name: string]: (number)[]} | null;
  /** Text of a CSV file; or give `columns`. */
  csv?: string | null;
  /** Changes of the guessed mapping. */
  mapping?: ColumnMappingInput;
  /** Settings of the diagnosis. */
  settings?: RecordSettingsInput;
}

/** A column of the file. */
export interface RecordColumn {
  /** Its name in the file, or col1, col2, … where the file has none. */
  name: string;
  /** Its place in the file, from 1 on. */
  position: number;
  /** Its content; `constant` numbers never change, `index` counts the rows. */
  kind: 'number' | 'datetime' | 'text' | 'empty' | 'constant' | 'index';
  /** Its unit as the file writes it; empty: none is written. */
  unit: string;
  /** Where the unit is written: in the name, in a line below, or in the file's metadata. */
  unit_from: 'head' | 'second-line' | 'file' | '';
  /** Its first cells that are not empty, shortened. */
  first: (string)[];
  /** Smallest number, sentinels included; null: there are no numbers. */
  low: number | null;
  /** Largest number; null: there are no numbers. */
  high: number | null;
  /** Empty cells and cells such as NaN. */
  missing: number;
  /** What it is used as. */
  role: 'time' | 'input' | 'signal' | 'output' | 'unused';
  /** The plant's quantity that is read from it; empty: none. */
  target: string;
  /** Why it is not used, or null. */
  note: Text | null;
}

/** One alarm, and what became of it. */
export interface RecordDecision {
  /** Time in s after the first row of the alarm. */
  t: number;
  /** The statistic. */
  statistic: number;
  /** Time in s up to which rows were used for the name. */
  judged: number;
  /** Whether a fault was added or the last one revised. */
  action: 'added' | 'revised';
  /** The channel that was named then. */
  channel: string;
  /** The onset that was estimated then. */
  onset: number;
}

/** The diagnosis of a record. */
export interface RecordDiagnosis {
  /** The result in a sentence. */
  sentence: Text;
  /** Does the model fit? */
  fit: FitReport;
  /** The stretch on which this was checked. */
  healthy: HealthyStretch;
  /** The faults in the order of their onsets; empty if it does not fit. */
  faults: (RecordFault)[];
  /** Faults that the plant lacks and that would explain more. */
  missing: (MissingFault)[];
  /** The smallest fault of each channel that would be found. */
  visible: (VisibleFault)[];
  /** All alarms in the order of time. */
  decisions: (RecordDecision)[];
  /** Threshold of the statistic along this record; null: not needed. */
  threshold: number | null;
  /** Accepted false alarms per hour. */
  false_alarms: number;
  /** False alarms per hour that can be promised with 95 % certainty: the noise was estimated from the rows of the healthy stretch; null: not needed. */
  promised_false_alarms: number | null;
  /** Rows of the record. */
  rows: number;
  /** Length of the record in s. */
  duration: number;
  /** The statistic along the record, or null. */
  statistic: StatisticCurve | null;
  /** The simulation from the healthy stretch's first row on, to compare with the readings. */
  simulated: SimulatedOutputs | null;
  /** Innovations from the healthy stretch's first row on. */
  innovations: Innovations | null;
  /** The estimated state in the healthy stretch's first row. */
  initial: {[name: string]: number};
  /** Course of the inputs between two rows that fits best. */
  between: 'held' | 'held-before' | 'linear';
  /** Assumptions and limitations. */
  notes: (Text)[];
}

/** The plant of a stored record, the mapping of its columns, and how it is to be diagnosed. */
export interface RecordDiagnosisRequest {
  /** Id of a library plant, or a complete plant. */
  plant: string | PlantInput;
  /** Changes of the guessed mapping. */
  mapping?: ColumnMappingInput;
  /** Settings of the diagnosis. */
  settings?: RecordSettingsInput;
}

/** A fault that the record shows. */
export interface RecordFault {
  /** Id within the diagnosis. */
  id: string;
  /** The best explanation. */
  best: FaultCandidate;
  /** Other channels, the better ones first. */
  alternatives: (FaultCandidate)[];
  /** Time in s after the first row at which it was noticed. */
  alarm: number;
  /** The statistic of that alarm. */
  statistic: number;
  /** Time in s at which it ended; null: it lasts. */
  ended: number | null;
  /** Whether the interval of its size excludes zero. */
  confirmed: boolean;
  /** Whether the inputs at its onset are covered by the healthy stretch; else the model may err there. */
  covered: boolean;
  /** The fault in a sentence. */
  text: Text;
  /** A reservation, or null. */
  note: Text | null;
}

/** A peculiarity of the record, and how it is treated. */
export interface RecordFinding {
  /** Id within the inspection. */
  id: string;
  /** Its kind: gap, jitter, repeated, reversed, sentinel, missing, frozen, … */
  kind: string;
  /** note: nothing is changed; changed: rows or cells are; doubtful: probably a mistake; wrong: no diagnosis is possible. */
  severity: 'note' | 'changed' | 'doubtful' | 'wrong';
  /** The plant's quantity that it concerns, or null. */
  quantity: string | null;
  /** The column of the file that it concerns, or null. */
  column: string | null;
  /** Number of rows or cells. */
  count: number;
  /** The first few of these rows, as numbered in the file. */
  rows: (number)[];
  /** Their times in s, for marks in the picture. */
  times: (number)[];
  /** Time in s at which it ends, if it is one stretch; else null. */
  until: number | null;
  /** The finding. */
  text: Text;
  /** What is done about it, or what to do. */
  treatment: Text | null;
  /** A part of a ColumnMapping that would remove it, such as {time: {unit: min}}, or null. */
  proposal: JsonValue;
}

/** The fit of a plant on the healthy stretch of a record, and the plant with the fitted parameters. */
export interface RecordFit {
  /** Does the model fit, as it is and with the fitted parameters? */
  report: FitReport;
  /** The complete plant with the fitted parameters. */
  plant: string | Plant;
}

/** A record as it was read: columns, mapping, peculiarities, and what was looked for and not found. */
export interface RecordInspection {
  /** Hash of the file; empty if it is not stored. */
  id: string;
  /** Name of the file. */
  name: string;
  /** Its format: csv, xlsx, parquet, … */
  format: string;
  /** Format, separator, encoding and the like. */
  dialect: Text;
  /** Bytes of the file. */
  size: number;
  /** Rows of data, after repeated ones were dropped. */
  rows: number;
  /** Id of the plant; empty: none was chosen, and nothing is mapped. */
  plant: string;
  /** The times; null: there is neither a column of times nor a period. */
  times: RecordTimes | null;
  /** All columns of the file in their order. */
  columns: (RecordColumn)[];
  /** The plant's inputs, signals and outputs, in this order. */
  quantities: (MappedQuantity)[];
  /** The mapping that is in effect, complete. */
  mapping: ColumnMapping;
  /** What was found, in the order of time. */
  findings: (RecordFinding)[];
  /** What was looked for and not found. */
  checked: (Text)[];
  /** How the record's length and period compare with the plant's time constants, or null. */
  plant_text: Text | null;
  /** Why the record cannot be diagnosed yet, or null. */
  problem: Text | null;
  /** Whether it can be diagnosed. */
  ready: boolean;
  /** Addresses of its parts. */
  links: {[name: string]: string};
}

/** A record in a list. */
export interface RecordLine {
  id: string;
  name: string;
  /** Bytes of the file. */
  size: number;
  /** Seconds since 1970 of the last change of its plant or mapping. */
  changed: number;
  links: {[name: string]: string};
}

/** The records of a client. */
export interface RecordList {
  records: (RecordLine)[];
}

/** A record in intervals of time, for drawing. */
export interface RecordPreview {
  /** Beginnings of the intervals in s. */
  t: (number)[];
  /** Length of an interval in s. */
  interval: number;
  /** Shortest and longest time in s from row to row in each interval. */
  steps: {[name: string]: (number | null)[]};
  series: (PreviewSeries)[];
}

/** Observers that are to run on a stored record, with its plant, mapping and diagnosis. */
export interface RecordRunRequest {
  /** Id of a library plant, or a complete plant. */
  plant: string | PlantInput;
  /** Changes of the guessed mapping. */
  mapping?: ColumnMappingInput;
  /** Settings of the diagnosis. */
  settings?: RecordSettingsInput;
  /** The observers; by default a joint extended Kalman filter. */
  observers?: (ObserverConfigInput)[];
}

/** How a record is diagnosed. */
export interface RecordSettings {
  /** A stretch that is known to be healthy; null: the longest beginning that shows no fault by itself. */
  healthy: Stretch | null;
  /** Accepted false alarms per hour. */
  false_alarms: number;
  /** auto: parameters are fitted on the healthy stretch where one alone lets the model fit clearly better; never; chosen: `parameters` are fitted. */
  fit: 'auto' | 'never' | 'chosen';
  /** With chosen: the parameters that are fitted; empty: all. */
  parameters: (string)[];
}

/** How a record is diagnosed. */
export interface RecordSettingsInput {
  /** A stretch that is known to be healthy; null: the longest beginning that shows no fault by itself. */
  healthy?: Stretch | null;
  /** Accepted false alarms per hour. */
  false_alarms?: number;
  /** auto: parameters are fitted on the healthy stretch where one alone lets the model fit clearly better; never; chosen: `parameters` are fitted. */
  fit?: 'auto' | 'never' | 'chosen';
  /** With chosen: the parameters that are fitted; empty: all. */
  parameters?: (string)[];
}

/** The times of a record in numbers. */
export interface RecordTimes {
  /** Date and time of the first row, if the file has dates. */
  begin: string | null;
  /** Time in s from the first to the last row. */
  duration: number;
  /** Median of the times in s from row to row. */
  period: number;
  /** Shortest time in s from row to row. */
  shortest: number;
  /** Longest time in s from row to row. */
  longest: number;
  /** Usual deviation from the period, as a share of it. */
  jitter: number;
  /** Whether the rows were in reversed order. */
  turned: boolean;
}

/** A record that takes the place of the simulated plant and its sensors. */
export interface RecordedTruth {
  /** Id of the record: the beginning of the SHA-256 of its file. */
  id: string;
  /** Name of the file. */
  name: string;
  /** Changes of the guessed mapping. */
  mapping: ColumnMapping;
  /** Settings of its diagnosis. */
  settings: RecordSettings;
  /** Inputs between two rows: those of the row before, those of the row after (written before they changed), or a straight line. */
  between: 'held' | 'held-before' | 'linear';
  /** Those of the experiment's `parameters` that were fitted on this record: observers use them, and the diagnosis fits them again, from the plant's own values. */
  fitted: (string)[];
}

/** A record that takes the place of the simulated plant and its sensors. */
export interface RecordedTruthInput {
  /** Id of the record: the beginning of the SHA-256 of its file. */
  id: string;
  /** Name of the file. */
  name?: string;
  /** Changes of the guessed mapping. */
  mapping?: ColumnMappingInput;
  /** Settings of its diagnosis. */
  settings?: RecordSettingsInput;
  /** Inputs between two rows: those of the row before, those of the row after (written before they changed), or a straight line. */
  between?: 'held' | 'held-before' | 'linear';
  /** Those of the experiment's `parameters` that were fitted on this record: observers use them, and the diagnosis fits them again, from the plant's own values. */
  fitted?: (string)[];
}

/** A command was refused; nothing has changed. */
export interface Refused {
  type: 'refused';
  /** Id of the command; null if the message had none. */
  id: number | null;
  /** Path of the offending field, for example fault.channel. */
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

/** Remove a note. */
export interface RemoveNote {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'remove-note';
  /** Id of the note. */
  note: string;
}

/** Remove an observer. */
export interface RemoveObserver {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  command: 'remove-observer';
  label: string;
}

/** Remove an observer. */
export interface RemoveObserverInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  command: 'remove-observer';
  label: string;
}

/** Remove an observer. */
export interface RemoveObserverNow {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'remove-observer';
  label: string;
}

/** The record of a student, for the wall. */
export interface Replay {
  id: string;
  /** Time in s between rows. */
  record: number;
  panels: (CurvePanel)[];
  /** The rows of each strip. */
  values: ((number | null)[])[];
  answer: ChallengeAnswer | null;
  outcome: Outcome | null;
}

/** Go back to t = 0 and to the original experiment; the log is cleared. */
export interface Reset {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'reset';
}

/** The smallest fault in one channel that can be found, with the given noise and gains. */
export interface Resolution {
  /** The fault channel. */
  channel: string;
  /** Standard deviation of the estimate in the fault's unit, at the end. */
  sigma: number | null;
  /** Size of a typical fault in this channel. */
  typical: number;
  /** Smallest step that can be found within the longest window; null: none. */
  smallest: number | null;
  /** Whether a typical fault can be found. */
  resolvable: boolean;
  /** Whether the input in the last window excites the fault enough. */
  identifiable: boolean;
  /** The same in a sentence: the smallest size, or the reason why it is missing. */
  text: Text | null;
}

/** Rows and log entries from this row on are discarded; a new epoch begins. */
export interface Rewound {
  type: 'rewound';
  epoch: number;
  row: number;
  t: number;
}

/** The share of the steps between rows in which a column, or the difference of two, rises: from 0 to 1. */
export interface Rises {
  kind: 'rises';
  /** A column of the session, say y.y1. */
  column: string;
  minus: string | null;
  /** Time in s after the mark. */
  start: number;
  /** None: until the end of the step. */
  end: number | null;
}

/** The share of the steps between rows in which a column, or the difference of two, rises: from 0 to 1. */
export interface RisesInput {
  kind: 'rises';
  /** A column of the session, say y.y1. */
  column: string;
  minus?: string | null;
  /** Time in s after the mark. */
  start?: number;
  /** None: until the end of the step. */
  end?: number | null;
}

/** Another explanation of the record, and how long it fitted: by the best size and onset that it can have. */
export interface Rival {
  /** Name of the channel; empty: no fault. */
  channel: string;
  /** Time in s from which three deviations separate it; null: never. */
  fair_until: number | null;
  /** Time in s from which five deviations separate it; null: never. */
  until: number | null;
}

/** Alarms without faults against faults found, at each value of a factor. */
export interface Roc {
  points: (RocPointAnswer)[];
}

/** A point of the receiver operating characteristic. */
export interface RocPointAnswer {
  /** The value of the factor that sets how soon an alarm is raised. */
  value: number | string;
  /** Runs without faults in which there was an alarm. */
  false: RateAnswer;
  /** Runs with faults in which all of them were found. */
  found: RateAnswer;
  /** Delay in s of the faults that were found. */
  delay: SpreadAnswer;
}

/** A room, as its teacher gets it. The token is that of the teacher. */
export interface RoomOpened {
  token: string;
  code: string;
  /** Where students join. */
  address: string;
  /** Whether other machines can reach that address. */
  reachable: boolean;
  /** The QR code of the address: a text of 0 and 1 for each row. */
  qr: (string)[];
}

/** A new round; it ends the one before. */
export interface RoundRequest {
  /** follow: all see the teacher's session, and vote; own: each has a record with a hidden fault. */
  kind: 'follow' | 'own';
  /** The plant of hidden faults: a set-up of the library. */
  setup?: string | null;
  /** Time in s for finding a hidden fault. */
  seconds?: number;
}

/** The present round. */
export interface RoundView {
  /** Of the round, counted from 1. */
  number: number;
  kind: 'follow' | 'own';
  /** Whether the hidden faults are shown. */
  revealed: boolean;
  /** Seconds until they are; null: no time runs. */
  left: number | null;
  /** The plant of hidden faults. */
  title: Words | null;
  /** The faults among which students choose. */
  choices: (MysteryChoice)[];
  /** Length of a record in s. */
  horizon: number | null;
  lead: LeadView | null;
}

/** A run of an experiment. Its id is the hash of everything that determines its numbers (`Experiment.spec_hash`). */
export interface Run {
  /** Hash of the canonical spec. */
  id: string;
  status: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  /** Completed share, 0 to 1. */
  progress: number;
  spec: Experiment;
  /** Set when the run is done. */
  summary: RunSummary | null;
  /** Set when the run has failed. */
  problem: Problem | null;
  created: string;
  /** Whether the run is kept when the store is full. */
  pinned: boolean;
  /** Why the run could not be stored: it is in memory only. */
  warning: string | null;
  links: {[name: string]: string};
}

/** A setting in which a run differs from the library's experiment. */
export interface RunChange {
  /** Path of the setting; items of lists by label, channel or output. */
  path: string;
  /** Name of the setting. */
  label: Text;
  /** Value in the library's experiment; null: it is not given there. */
  from: number | string | null;
  /** Value in the run; null: it is not given. */
  to: number | string | null;
}

/** Two to six runs compared, in the order in which they were asked for. */
export interface RunComparison {
  runs: (RunLine)[];
  /** The observer that is compared in each run. */
  observers: (string | null)[];
  /** Observers that can be compared: those of all runs first. */
  choices: (string)[];
  differences: (SettingRow)[];
  /** Number of settings that are equal in all runs. */
  same: number;
  measures: (MeasureRow)[];
  /** What this client noted about the comparison of these runs. */
  notes: string;
  /** That the notes are damaged in the store and left out. */
  warning: string;
  links: {[name: string]: string};
}

/** How many runs the list has, without filter, and how many were found. */
export interface RunCounts {
  all: number;
  pinned: number;
  kinds: {[name: string]: number};
  /** Stored runs that meet the filter. */
  found: number;
}

/** A fault of a run and its estimate at a few evenly spaced times. */
export interface RunCurve {
  channel: string;
  /** The fault; null: unknown, in a record. */
  truth: (number | null)[] | null;
  estimate: (number | null)[];
}

/** A group of the runs that were found. */
export interface RunGroup {
  /** Id of the experiment, empty without one; or the tags as a JSON list. */
  key: string;
  title: string;
  /** Number of runs of the group that were found. */
  n: number;
}

/** A run in a list. */
export interface RunLine {
  id: string;
  title: string;
  /** damaged: what is stored does not have its checksum; run the experiment again, or remove the run. */
  status: 'queued' | 'running' | 'done' | 'failed' | 'cancelled' | 'damaged';
  /** Completed share, 0 to 1. */
  progress: number;
  created: string;
  pinned: boolean;
  /** Name that this client gave it. */
  name: string;
  /** Tags that this client gave it. */
  tags: (string)[];
  /** That name and tags are damaged in the store and left out. */
  warning: string;
  /** Whether this client may name, tag, pin and remove it. */
  mine: boolean;
  /** session: a live session that was saved; record: observers on a record. */
  kind: 'run' | 'session' | 'record';
  /** Id of the library's experiment that it follows. */
  experiment: string | null;
  /** Id of its plant. */
  plant: string | null;
  /** Name of its record. */
  record: string | null;
  /** Differences from the library's experiment; null: it follows none. */
  changes: (RunChange)[] | null;
  /** The observer whose measures follow. */
  observer: string | null;
  /** The state of the RMSE. */
  state: string | null;
  /** Root mean square error of the state over the run. */
  rmse: number | null;
  /** Median delay in s of the faults found. */
  delay: number | null;
  false_alarms: number | null;
  curve: RunCurve | null;
  links: {[name: string]: string};
}

/** Active runs, then the stored ones; and figures of the store. */
export interface RunList {
  runs: (RunLine)[];
  groups: (RunGroup)[];
  tags: (RunTag)[];
  counts: RunCounts;
  store: RunUsage;
}

/** What a client changes about a run of its own; fields that are left out stay. */
export interface RunNotes {
  name?: string | null;
  tags?: (string)[] | null;
  pinned?: boolean | null;
}

/** An experiment of the library, with values changed by path. */
export interface RunRequest {
  /** Id of a library experiment. */
  experiment: string;
  /** Path → new value. Items of lists by index, label or name; a number for an input means a constant. */
  set?: {[name: string]: JsonValue};
}

/** The results of a run without its data. */
export interface RunSummary {
  /** Number of columns of the data. */
  columns: number;
  /** Number of recorded times. */
  rows: number;
  /** Step of the integration in s. */
  step: number;
  /** Substeps of each integration step. */
  substeps: number;
  /** Accuracy of the integration; null for fixed substeps and in discrete time. */
  accuracy: Accuracy | null;
  /** Divergence of the plant itself. */
  diverged: Divergence | null;
  observers: (ObserverSummary)[];
  /** Observers, faults, noise, alarms and verdicts at the end of the run. */
  facts: Facts | null;
  /** The observers compared on the same data. */
  comparison: Comparison | null;
  /** The diagnosis: which fault, since when, its size and confidence. */
  diagnosis: Diagnosis | null;
  /** The diagnosis of the record that takes the place of the simulated plant. */
  record: RecordDiagnosis | null;
  notes: (Text)[];
  /** Wall time of each stage in s. */
  seconds: {[name: string]: number};
}

/** A tag with the number of its runs. */
export interface RunTag {
  tag: string;
  n: number;
}

/** Runs and the space of their results. */
export interface RunUsage {
  /** Runs that wait or are computed. */
  active: number;
  /** Runs in the store. */
  runs: number;
  /** Results in the store. */
  results: number;
  /** Bytes of these results. */
  bytes: number;
  /** Bytes that results may take. */
  limit: number;
}

/** Sampled measurement: observers see y at 0, period, 2·period, …, held in between. */
export interface SampledMeasurement {
  mode: 'sampled';
  /** Sample period in s. */
  period: number;
}

/** Sampled measurement: observers see y at 0, period, 2·period, …, held in between. */
export interface SampledMeasurementInput {
  mode: 'sampled';
  /** Sample period in s. */
  period: number;
}

/** A sentence on what happened, shown where its conditions hold; {name} is a measured number. */
export interface Saw {
  text: Words;
  when: (Condition)[];
}

/** A sentence on what happened, shown where its conditions hold; {name} is a measured number. */
export interface SawInput {
  text: WordsInput;
  when?: (ConditionInput)[];
}

/** The points of an answer. */
export interface Score {
  /** Points together, at most 100. */
  total: number;
  points: (Points)[];
}

/** Everything on a student's phone. */
export interface SeatView {
  type: 'seat';
  code: string;
  animal: Caption;
  name: string | null;
  /** Students in the room. */
  students: number;
  round: RoundView | null;
  /** Place of the student's vote in this step. */
  vote: number | null;
  /** The student's answer about the hidden fault. */
  answer: ChallengeAnswer | null;
  /** After the reveal. */
  outcome: Outcome | null;
  /** Place among the right answers by speed, after the reveal. */
  rank: number | null;
}

/** Go back to an earlier time. Rows, commands and notes after it are discarded; fork first to keep them. */
export interface Seek {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'seek';
  /** Time in s, rounded to a row, at most the present time. */
  t: number;
}

/** What each factor does to a measure, the strongest first. */
export interface Sensitivities {
  factors: (SensitivityAnswer)[];
}

/** What a factor does to a measure. */
export interface SensitivityAnswer {
  factor: string;
  /** Spearman's rank correlation; null for a factor of names. */
  rank: number | null;
  /** First-order Sobol index: the share of variance that it explains. */
  first: number | null;
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
  /** Id of a library experiment; an alternative to `spec`. */
  experiment?: string | null;
  /** Values to change in the library experiment, by path. */
  set?: {[name: string]: JsonValue};
  /** A full experiment with its timed commands. */
  spec?: ExperimentInput | null;
  /** Start playing immediately. */
  play?: boolean;
  /** Simulated seconds per second; null: as fast as possible. */
  speed?: number | null;
  /** Time in s at which the session opens. */
  t?: number;
}

/** The state of a session, and its experiment with all faults and timed commands up to now. */
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

/** Change a gain of an observer. */
export interface SetGain {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** Label of the observer. */
  observer: string;
  /** Name of the gain. */
  gain: string;
  /** The new value: a number, a list for a column, or a list of rows for a matrix. */
  value: number | (number)[] | ((number)[])[];
  command: 'set-gain';
}

/** Change a gain of an observer. */
export interface SetGainInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** Label of the observer. */
  observer: string;
  /** Name of the gain. */
  gain: string;
  /** The new value: a number, a list for a column, or a list of rows for a matrix. */
  value: number | (number)[] | ((number)[])[];
  command: 'set-gain';
}

/** Set a gain of an observer from now on. */
export interface SetGainNow {
  /** Number of the command, chosen by the client. */
  id: number;
  /** Label of the observer. */
  observer: string;
  /** Name of the gain. */
  gain: string;
  /** The new value: a number, a list for a column, or a list of rows for a matrix. */
  value: number | (number)[] | ((number)[])[];
  type: 'set-gain';
}

/** Change the measurement noise of one output. */
export interface SetNoise {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** Name of the output. */
  output: string;
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time: number;
  command: 'set-noise';
}

/** Change the measurement noise of one output. */
export interface SetNoiseInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** Name of the output. */
  output: string;
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time?: number;
  command: 'set-noise';
}

/** Set the measurement noise of an output from now on. */
export interface SetNoiseNow {
  /** Number of the command, chosen by the client. */
  id: number;
  /** Name of the output. */
  output: string;
  /** Standard deviation, in the output's unit. */
  std: number;
  /** Time in s for which each drawn value is held. */
  sample_time?: number;
  type: 'set-noise';
}

/** One reference r: a set point of the controllers, which experiments and viewers set like an input. */
export interface SetPoint {
  /** Name in the controllers' expressions. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  /** Value if an experiment sets no signal, in the reference's unit. */
  default: number;
  /** Plausible range, in the reference's unit. */
  bounds: [number | null, number | null];
  description: string;
}

/** One reference r: a set point of the controllers, which experiments and viewers set like an input. */
export interface SetPointInput {
  /** Name in the controllers' expressions. */
  name: string;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  /** Value if an experiment sets no signal, in the reference's unit. */
  default?: number;
  /** Plausible range, in the reference's unit. */
  bounds?: [number | null, number | null];
  description?: string | {[name: string]: string};
}

/** Replace an input or a known signal. The time of the new signal is that of the run, not counted from `at`. */
export interface SetSignal {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** Name of an input or a known signal of the plant. */
  name: string;
  signal: ConstantSignal | StepsSignal | PulseSignal | SquareSignal | SineSignal | RampSignal | ChirpSignal | PrbsSignal | NoiseSignal | TableSignal | ExpressionSignal;
  command: 'set-signal';
}

/** Replace an input or a known signal. The time of the new signal is that of the run, not counted from `at`. */
export interface SetSignalInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** Name of an input or a known signal of the plant. */
  name: string;
  signal: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput;
  command: 'set-signal';
}

/** Set an input or known signal from now on. The signal's time is that of the session. */
export interface SetSignalNow {
  /** Number of the command, chosen by the client. */
  id: number;
  /** Name of an input or a known signal of the plant. */
  name: string;
  signal: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput;
  type: 'set-signal';
}

/** Set the number of substeps of every integration step, for stiff gains. */
export interface SetSubsteps {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  command: 'set-substeps';
  substeps: number;
}

/** Set the number of substeps of every integration step, for stiff gains. */
export interface SetSubstepsInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  command: 'set-substeps';
  substeps: number;
}

/** Change the true plant and its sensors; observers and the detector keep their model. */
export interface SetTruth {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** The truth in full; its `states` stay as they were when the run began. */
  truth: Truth;
  command: 'set-truth';
}

/** Change the true plant and its sensors; observers and the detector keep their model. */
export interface SetTruthInput {
  /** Time in s at which it takes effect, a multiple of the step. */
  at: number;
  /** The truth in full; its `states` stay as they were when the run began. */
  truth: TruthInput;
  command: 'set-truth';
}

/** Set the true plant and its sensors from now on; observers and the detector keep their model. */
export interface SetTruthNow {
  /** Number of the command, chosen by the client. */
  id: number;
  /** The truth in full; its `states` stay as they were when the run began. */
  truth: TruthInput;
  type: 'set-truth';
}

/** A setting in which the runs differ. */
export interface SettingRow {
  /** Path of the setting; items of lists by label, channel or output. */
  path: string;
  /** Name of the setting. */
  label: Text;
  /** Value in each run; null: it is not given. */
  values: (number | string | null)[];
}

/** The time in s after `since` from which |column − to| stays within a tolerance; none where it does not. */
export interface Settles {
  kind: 'settles';
  /** A column of the session, say y.y1. */
  column: string;
  /** Another column, or a number. */
  to: string | number;
  /** The tolerance, in the column's unit. */
  within: number;
  /** Time in s after the mark. */
  since: number;
  /** Where looking ends. None: the end of the rows. */
  end: number | null;
}

/** The time in s after `since` from which |column − to| stays within a tolerance; none where it does not. */
export interface SettlesInput {
  kind: 'settles';
  /** A column of the session, say y.y1. */
  column: string;
  /** Another column, or a number. */
  to: string | number;
  /** The tolerance, in the column's unit. */
  within: number;
  /** Time in s after the mark. */
  since?: number;
  /** Where looking ends. None: the end of the rows. */
  end?: number | null;
}

/** The settling of an estimate after one step of a fault. */
export interface Settling {
  channel: string;
  /** Time of the step in s. */
  at: number;
  /** Size of the step. */
  size: number;
  /** Half-width of the band around the new value, as a fraction of the size. */
  within: number;
  /** Time in s after the step at which the band is first reached. */
  reached: number | null;
  /** Time in s after the step from which the estimate stays in the band. */
  time: number | null;
  /** Time in s at which the evaluation ends: the next event, or the end of the run. */
  until: number;
}

/** Points of a signal: straight lines between them are what a figure with that many columns shows. */
export interface SignalCurve {
  /** Times in s, in order; a jump has both limits at one time. */
  t: (number)[];
  /** Values at these times, in the signal's unit. */
  values: (number)[];
}

/** A signal, and the span that a figure shows. */
export interface SignalCurveRequest {
  signal: ConstantSignalInput | StepsSignalInput | PulseSignalInput | SquareSignalInput | SineSignalInput | RampSignalInput | ChirpSignalInput | PrbsSignalInput | NoiseSignalInput | TableSignalInput | ExpressionSignalInput;
  /** Start of the span in s. */
  start: number;
  /** End of the span in s. */
  end: number;
  /** Columns of the figure. */
  places?: number;
}

/** A kind of signal with its fields. */
export interface SignalForm {
  kind: string;
  description: string;
  fields: (FormField)[];
  example: {[name: string]: JsonValue};
}

/** The outputs of the plant, with fitted parameters if there are any, simulated without corrections, thinned. */
export interface SimulatedOutputs {
  /** Times of rows in s after the first row. */
  t: (number)[];
  /** Values at these times, by output; null: the simulation has diverged. */
  outputs: {[name: string]: (number | null)[]};
}

/** θ = size·sin(2π·frequency·τ + phase). */
export interface SineFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
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
  /** Time in s at which it disappears; null: never. */
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

/** Faults of one size. */
export interface SizeAnswer {
  /** The size, in the channel's unit. */
  size: number;
  /** Runs in which the fault was found. */
  found: RateAnswer;
  /** Delay in s of the faults that were found. */
  delay: SpreadAnswer;
  /** Number of the first run there. */
  run: number;
}

/** A curve that the student draws on a strip, from the beginning of the step to its end, before it runs. */
export interface Sketch {
  /** A column of the session, say y.y1. */
  strip: string;
  /** The least value that can be drawn, in the unit of the strip. */
  low: number;
  /** The greatest value that can be drawn. */
  high: number;
  /** The level line from which the drawing begins; it does not meet the step's conditions. */
  value: number;
  /** A curve that meets them. The student draws as many values. */
  solution: (number)[];
}

/** A curve that the student draws on a strip, from the beginning of the step to its end, before it runs. */
export interface SketchInput {
  /** A column of the session, say y.y1. */
  strip: string;
  /** The least value that can be drawn, in the unit of the strip. */
  low: number;
  /** The greatest value that can be drawn. */
  high: number;
  /** The level line from which the drawing begins; it does not meet the step's conditions. */
  value?: number;
  /** A curve that meets them. The student draws as many values. */
  solution: (number)[];
}

/** The experiment with all changes up to now; sent after every command that changes it. */
export interface Spec {
  type: 'spec';
  spec: Experiment;
}

/** Set the speed in simulated seconds per second; null: as fast as possible. */
export interface Speed {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'speed';
  value: number | null;
}

/** A measure over some runs. */
export interface SpreadAnswer {
  /** Runs that have a value. */
  n: number;
  /** Runs. */
  of: number;
  /** Its median, in the unit of the measure; null: no run has a value. */
  median: number | null;
  /** Lower end of the middle half of the runs. */
  low: number | null;
  /** Upper end of the middle half of the runs. */
  high: number | null;
}

/** Square wave: offset + amplitude on [start + k·period, start + (k + ½)·period), otherwise offset − amplitude. */
export interface SquareSignal {
  kind: 'square';
  /** Half the height of the jumps, in the signal's unit. */
  amplitude: number;
  /** Period in s. */
  period: number;
  /** Start of one of the upper halves in s. */
  start: number;
  /** Mean value, in the signal's unit. */
  offset: number;
}

/** Square wave: offset + amplitude on [start + k·period, start + (k + ½)·period), otherwise offset − amplitude. */
export interface SquareSignalInput {
  kind: 'square';
  /** Half the height of the jumps, in the signal's unit. */
  amplitude: number;
  /** Period in s. */
  period: number;
  /** Start of one of the upper halves in s. */
  start?: number;
  /** Mean value, in the signal's unit. */
  offset?: number;
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
  /** Size of a typical change, in the state's unit; null: found in a simulation without faults. */
  scale: number | null;
  description: string;
}

/** New values of states where a condition holds at the end of a step: a relay that switches, a ball that bounces. */
export interface StateEvent {
  /** Condition, examined at the end of every step of the integration. */
  when: string;
  /** New value by state, from the values before. */
  set: {[name: string]: string};
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
  /** Size of a typical change, in the state's unit; null: found in a simulation without faults. */
  scale?: number | null;
  description?: string | {[name: string]: string};
}

/** The statistic along the record, thinned for drawing: the largest value in each interval of time. */
export interface StatisticCurve {
  /** Beginnings of the intervals in s after the first row. */
  t: (number)[];
  largest: (number)[];
}

/** The status of the session; it replaces earlier ones. */
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

/** Advance by `rows` rows as fast as possible, then pause. */
export interface Step {
  /** Number of the command, chosen by the client. */
  id: number;
  type: 'step';
  rows?: number;
}

/** What students see of a step: its words, its question, and the curves that go with it. */
export interface StepCard {
  /** Number of the step, counted from 1. */
  place: number;
  /** Number of steps. */
  of: number;
  title: Caption;
  say: (Caption)[];
  ask: Caption | null;
  options: (Caption)[];
}

/** What students see of a step: its words, its question, and the curves that go with it. */
export interface StepCardInput {
  /** Number of the step, counted from 1. */
  place: number;
  /** Number of steps. */
  of: number;
  title: Caption;
  say?: (Caption)[];
  ask?: Caption | null;
  options?: (Caption)[];
}

/** θ = size from the onset on. */
export interface StepFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'step';
  /** Size, in the channel's unit. */
  size: number;
}

/** θ = size from the onset on. */
export interface StepFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's fault channel. */
  channel: string;
  shape: 'step';
  /** Size, in the channel's unit. */
  size: number;
}

/** The settling of an estimate after one step of a fault. */
export interface StepFollowed {
  channel: string;
  /** Time of the step in s. */
  at: number;
  /** New value minus old value, in the channel's unit. */
  size: number;
  /** Seconds until the error stays within 10 % of the size; null: never. */
  ten: number | null;
  /** Seconds until the error stays within 5 % of the size; null: never. */
  five: number | null;
}

/** The newest fault of a channel, and its outcome so far. */
export interface StepFound {
  /** Id of the fault. */
  id: string;
  /** The outcome so far; null without a detector, or if θ is zero. */
  outcome: 'found' | 'covered' | 'missed' | null;
  /** Seconds from the onset to the alarm that found it. */
  delay: number | null;
}

/** What the button of a step does: commands, then time. */
export interface StepRun {
  text: Words | null;
  /** Time of the session in s that passes. */
  seconds: number;
  /** Commands of a live session, without ids. */
  do: ({[name: string]: unknown})[];
}

/** What the button of a step does: commands, then time. */
export interface StepRunInput {
  text?: WordsInput | null;
  /** Time of the session in s that passes. */
  seconds: number;
  do?: (Inject | Clear | SetGainNow | SetSignalNow | SetNoiseNow | SetTruthNow | AddObserverNow | RemoveObserverNow | AddNote | RemoveNote | Reset)[];
}

/** The session with which a step begins: a new one of an experiment of the lesson, paused at a time. */
export interface StepStart {
  experiment: string;
  /** Time in s at which it is paused. */
  t: number;
}

/** The session with which a step begins: a new one of an experiment of the lesson, paused at a time. */
export interface StepStartInput {
  experiment: string;
  /** Time in s at which it is paused. */
  t?: number;
}

/** What of the session a step shows. */
export interface StepView {
  /** Names of strips, from the top. */
  strips: (string)[];
  /** copy: the plant and the observer beside it, with their levels; hysteresis: its loop and gaps. */
  picture: 'plant' | 'copy' | 'hysteresis' | 'none';
  /** Whether true states and faults are visible. */
  truth: boolean;
  /** Whether the detector's findings are visible. */
  diagnosis: boolean;
  /** A level on one of the strips. */
  line: LevelLine | null;
}

/** What of the session a step shows. */
export interface StepViewInput {
  /** Names of strips, from the top. */
  strips?: (string)[];
  /** copy: the plant and the observer beside it, with their levels; hysteresis: its loop and gaps. */
  picture?: 'plant' | 'copy' | 'hysteresis' | 'none';
  /** Whether true states and faults are visible. */
  truth?: boolean;
  /** Whether the detector's findings are visible. */
  diagnosis?: boolean;
  /** A level on one of the strips. */
  line?: LevelLine | null;
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

/** A part of the record, in s after its first row. */
export interface Stretch {
  /** Its beginning in s after the first row. */
  begin: number;
  /** Its end in s after the first row. */
  end: number;
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

/** The measurement is `value`. */
export interface StuckFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'stuck';
  /** Measured value, in the output's unit. */
  value: number;
}

/** The measurement is `value`. */
export interface StuckFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
  end?: number | null;
  /** Name of the plant's output. */
  output: string;
  shape: 'stuck';
  /** Measured value, in the output's unit. */
  value: number;
}

/** An experiment, what varies in it, how the points are chosen, and what is measured in each run. */
export interface Study {
  title: string;
  description: string;
  /** Id of a library experiment, or a complete experiment. */
  experiment: string | Experiment;
  /** Values of the experiment that differ in all runs, by path. */
  set: {[name: string]: JsonValue};
  vary: (ListFactor | RangeFactor | CasesFactor | FaultsFactor | ObserversFactor)[];
  /** Grid: all combinations. Otherwise `points` points in the box of all factors. */
  design: 'grid' | 'random' | 'latin-hypercube' | 'sobol';
  /** Number of points of a sampled design. */
  points: number | null;
  /** Seed of a sampled design. */
  design_seed: number;
  /** Runs at each point, with the experiment's seed and those that follow it. */
  seeds: number;
  /** Runs with the faults, without any, or each of them once. */
  faults: 'with' | 'without' | 'both';
  /** Without `detection` no detector runs, and runs of one shape are computed together, much faster. */
  measures: ('rmse' | 'peak' | 'settling' | 'detection' | 'operations')[];
  /** Further numbers of each run, by name. */
  numbers: {[name: string]: Settles | Level | Crosses | Counts | Decays | Rises | Found | Diverged | GainNow};
  /** Time in s from which errors are measured. */
  since: number;
}

/** An experiment, what varies in it, how the points are chosen, and what is measured in each run. */
export interface StudyInput {
  title?: string | {[name: string]: string};
  description?: string | {[name: string]: string};
  /** Id of a library experiment, or a complete experiment. */
  experiment: string | ExperimentInput;
  /** Values of the experiment that differ in all runs, by path. */
  set?: {[name: string]: JsonValue};
  vary?: (ListFactorInput | RangeFactorInput | CasesFactorInput | FaultsFactorInput | ObserversFactorInput)[];
  /** Grid: all combinations. Otherwise `points` points in the box of all factors. */
  design?: 'grid' | 'random' | 'latin-hypercube' | 'sobol';
  /** Number of points of a sampled design. */
  points?: number | null;
  /** Seed of a sampled design. */
  design_seed?: number;
  /** Runs at each point, with the experiment's seed and those that follow it. */
  seeds?: number;
  /** Runs with the faults, without any, or each of them once. */
  faults?: 'with' | 'without' | 'both';
  /** Without `detection` no detector runs, and runs of one shape are computed together, much faster. */
  measures?: ('rmse' | 'peak' | 'settling' | 'detection' | 'operations')[];
  /** Further numbers of each run, by name. */
  numbers?: {[name: string]: SettlesInput | LevelInput | CrossesInput | CountsInput | DecaysInput | RisesInput | FoundInput | DivergedInput | GainNowInput};
  /** Time in s from which errors are measured. */
  since?: number;
}

/** The studies of a client, the newest first. */
export interface StudyList {
  studies: (StudyState)[];
}

/** The size of a study before it is begun. */
export interface StudySize {
  /** The id that it will have. */
  id: string;
  /** Number of runs. */
  runs: number;
  /** Number of points of the design. */
  points: number;
  /** Runs at each point, with as many seeds. */
  seeds: number;
  /** Seconds of one processor, by the time that the first runs take; null: they took too long to tell. */
  seconds: number | null;
}

/** A study: how far it is, and what its table holds. */
export interface StudyState {
  /** Hash of the spec: the same study has the same id. */
  id: string;
  title: string;
  /** Id of the experiment that it repeats. */
  experiment: string;
  status: 'running' | 'done' | 'cancelled' | 'failed';
  /** Number of runs. */
  runs: number;
  /** Runs whose rows are kept. */
  done: number;
  /** Number of points of the design. */
  points: number;
  created: string;
  /** Whether this client may cancel and remove it. */
  mine: boolean;
  /** Why it failed. */
  problem: Problem | null;
  /** Columns of what varies. */
  factors: (string)[];
  /** Those of `factors` that are the size of a fault. */
  sizes: (string)[];
  /** Columns of numbers that were measured, as far as they are known. */
  measures: (string)[];
  /** Runs of the kept ones that were refused; the table says why. */
  refused: number;
  links: {[name: string]: string};
}

/** Values y at increasing x; `interp(x, name)` is the value between them. */
export interface Table {
  /** Name in the second argument of interp. */
  name: string;
  /** Increasing arguments, at least two. */
  x: (number)[];
  /** Values, one for each argument. */
  y: (number)[];
  /** Straight lines, or cubic pieces that keep the shape (PCHIP). */
  method: 'linear' | 'cubic';
  /** Beyond the ends: the value at the end, or a line with the slope there. */
  outside: 'hold' | 'continue';
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  description: string;
}

/** θ from a table over τ; the first value applies before its time, the last one after its time. */
export interface TableFault {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
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

/** θ from a table over τ; the first value applies before its time, the last one after its time. */
export interface TableFaultInput {
  /** Time in s at which the fault appears. */
  onset: number;
  /** Time in s at which it disappears; null: never. */
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

/** Values y at increasing x; `interp(x, name)` is the value between them. */
export interface TableInput {
  /** Name in the second argument of interp. */
  name: string;
  /** Increasing arguments, at least two. */
  x: (number)[];
  /** Values, one for each argument. */
  y: (number)[];
  /** Straight lines, or cubic pieces that keep the shape (PCHIP). */
  method?: 'linear' | 'cubic';
  /** Beyond the ends: the value at the end, or a line with the slope there. */
  outside?: 'hold' | 'continue';
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  description?: string | {[name: string]: string};
}

/** Values at given times; the first value applies before them, the last one after them. */
export interface TableSignal {
  kind: 'table';
  /** Times in s, increasing. */
  times: (number)[];
  /** Values at these times. */
  values: (number)[];
  /** Between two times: linear, or hold the earlier value. */
  interpolation: 'hold' | 'linear';
}

/** Values at given times; the first value applies before them, the last one after them. */
export interface TableSignalInput {
  kind: 'table';
  /** Times in s, increasing. */
  times: (number)[];
  /** Values at these times. */
  values: (number)[];
  /** Between two times: linear, or hold the earlier value. */
  interpolation?: 'hold' | 'linear';
}

/** A message: code, arguments, and the sentence in the requested language. */
export interface Text {
  /** Key of the sentence in the catalogues, GET /api/messages/{language}. */
  code: string;
  /** Arguments of the sentence by name; a nested message is {code, args}. */
  args: {[name: string]: JsonValue};
  /** The sentence in the requested language. */
  text: string;
}

/** Changes of a plant's text: numbers by path, further items of lists, further equations; and its format. */
export interface TextEdit {
  text: string;
  /** New values by path. */
  values?: {[name: string]: number};
  /** States to add. */
  states?: (StateInput)[];
  /** Parameters to add. */
  parameters?: (ParameterInput)[];
  /** Fault channels to add. */
  channels?: (ChannelInput)[];
  /** Equations to add to `dynamics`, by state. */
  equations?: {[name: string]: string};
  /** YAML or JSON; null: the format stays. */
  format?: 'yaml' | 'json' | null;
}

/** An error or a warning, and its place in the text. */
export interface TextError {
  /** Path of the field, for example faults[0].end. */
  field: string;
  /** The value that arrived, shortened. */
  value: unknown;
  /** Key of the problem's sentence in the catalogues, GET /api/messages/{language}. */
  code: string;
  /** Arguments of both sentences by name. */
  args: {[name: string]: JsonValue};
  /** The problem, in the requested language. */
  problem: string;
  /** The remedy, in the requested language. */
  remedy: string;
  severity: 'error' | 'warning';
  place: TextPlace;
  /** The change that corrects it; null: there is no single one. */
  fix: TextFix | null;
}

/** A change that corrects an error: these characters are replaced by `text`. */
export interface TextFix {
  line: number;
  column: number;
  /** Length, line breaks included; 0: a place between two characters. */
  length: number;
  text: string;
}

/** Characters of a text. Lines and columns count from 1; columns and lengths are UTF-16 code units. */
export interface TextPlace {
  line: number;
  column: number;
  /** Length, line breaks included; 0: a place between two characters. */
  length: number;
}

/** A student on the wall. */
export interface Tile {
  id: string;
  animal: Caption;
  name: string | null;
  /** Whether no page of this student is connected; the place is kept. */
  asleep: boolean;
  answered: boolean;
  /** Place of the vote, after the step was run. */
  choice: number | null;
  mark: 'right' | 'wrong' | null;
  /** About the hidden fault, after the reveal. */
  answer: ChallengeAnswer | null;
  /** After the reveal. */
  outcome: Outcome | null;
}

/** The times of the rows: a column, or a period for rows without one. */
export interface TimeMapping {
  /** The column of times; null: none, the period is used. */
  column: string | null;
  /** Unit of the column; null: the guess. */
  unit: 's' | 'ms' | 'us' | 'ns' | 'min' | 'h' | 'd' | 'epoch-s' | 'epoch-ms' | 'epoch-us' | 'epoch-ns' | 'datetime' | 'clock' | 'spreadsheet-days' | null;
  /** Time in s from row to row, if there is no column of times. */
  period: number | null;
}

/** The times of the rows: a column, or a period for rows without one. */
export interface TimeMappingInput {
  /** The column of times; null: none, the period is used. */
  column?: string | null;
  /** Unit of the column; null: the guess. */
  unit?: 's' | 'ms' | 'us' | 'ns' | 'min' | 'h' | 'd' | 'epoch-s' | 'epoch-ms' | 'epoch-us' | 'epoch-ns' | 'datetime' | 'clock' | 'spreadsheet-days' | null;
  /** Time in s from row to row, if there is no column of times. */
  period?: number | null;
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

/** A sensor that differs from the model's: noise with memory, its own sample times, an unmodelled part. */
export interface TrueSensor {
  /** Correlation time of the noise in s; its standard deviation stays as declared. Null: white noise. */
  correlation: number | null;
  /** Sample period in s, a multiple of the step; the value is held in between. Null: that of the measurement or, for missing or late samples of a continuous measurement, the sample time of the noise. */
  period: number | null;
  /** Share of samples that are lost; the value before is held. */
  missing: number;
  /** Samples are taken late by up to this time in s, evenly distributed, rounded to the step. */
  jitter: number;
  /** Expression that is added to the output's equation, in states of plant and truth. */
  adds: string | null;
}

/** A sensor that differs from the model's: noise with memory, its own sample times, an unmodelled part. */
export interface TrueSensorInput {
  /** Correlation time of the noise in s; its standard deviation stays as declared. Null: white noise. */
  correlation?: number | null;
  /** Sample period in s, a multiple of the step; the value is held in between. Null: that of the measurement or, for missing or late samples of a continuous measurement, the sample time of the noise. */
  period?: number | null;
  /** Share of samples that are lost; the value before is held. */
  missing?: number;
  /** Samples are taken late by up to this time in s, evenly distributed, rounded to the step. */
  jitter?: number;
  /** Expression that is added to the output's equation, in states of plant and truth. */
  adds?: string | null;
}

/** A state of the true plant that the model lacks. */
export interface TrueState {
  /** Name in the expressions of the truth. */
  name: string;
  /** Value at t = 0, in the state's unit. */
  initial: number;
  /** Unit in plain text, empty when dimensionless. */
  unit: string;
  description: string;
}

/** A state of the true plant that the model lacks. */
export interface TrueStateInput {
  /** Name in the expressions of the truth. */
  name: string;
  /** Value at t = 0, in the state's unit. */
  initial?: number;
  /** Unit in plain text, empty when dimensionless. */
  unit?: string;
  description?: string | {[name: string]: string};
}

/** The true plant and its sensors, where they differ from the model that observers and the detector know. */
export interface Truth {
  /** Share by which every parameter that `parameters` does not name differs from the model, upwards or downwards by the seed, within its bounds. */
  deviation: number;
  /** True values of parameters, by name. */
  parameters: {[name: string]: number};
  /** Process noise by state: standard deviation per √s, in the state's unit. */
  process_noise: {[name: string]: number};
  /** True sensors, by output. */
  outputs: {[name: string]: TrueSensor};
  /** States of the true plant that the model lacks. */
  states: (TrueState)[];
  /** Right-hand side of each of these states; for a state of the plant, an expression that is added to its right-hand side. */
  dynamics: {[name: string]: string};
  /** A record in place of the simulated plant; then nothing else of the truth is given. */
  record: RecordedTruth | null;
}

/** The true plant and its sensors, where they differ from the model that observers and the detector know. */
export interface TruthInput {
  /** Share by which every parameter that `parameters` does not name differs from the model, upwards or downwards by the seed, within its bounds. */
  deviation?: number;
  /** True values of parameters, by name. */
  parameters?: {[name: string]: number};
  /** Process noise by state: standard deviation per √s, in the state's unit. */
  process_noise?: {[name: string]: number};
  /** True sensors, by output. */
  outputs?: {[name: string]: TrueSensorInput};
  /** States of the true plant that the model lacks. */
  states?: (TrueStateInput)[];
  /** Right-hand side of each of these states; for a state of the plant, an expression that is added to its right-hand side. */
  dynamics?: {[name: string]: string};
  /** A record in place of the simulated plant; then nothing else of the truth is given. */
  record?: RecordedTruthInput | null;
}

/** The smallest fault of a channel that would have been found. */
export interface VisibleFault {
  channel: string;
  unit: string;
  /** Smallest step that would be found; null: none can be seen. */
  smallest: number | null;
  /** Size of a typical fault. */
  typical: number;
}

/** A student's prediction in a step that the teacher shows. */
export interface VoteRequest {
  /** The step as the room names it. */
  step: string;
  /** Place of the answer, counted from 0. */
  choice: number;
}

/** Everything on the wall. Votes are counted; answers come after the reveal. */
export interface WallView {
  type: 'wall';
  code: string;
  tiles: (Tile)[];
  /** Votes for each answer of the step. */
  votes: (number)[];
  round: RoundView | null;
  /** null: nobody came from a learning platform. */
  grades: GradesView | null;
}

/** A symbol of an observer's equations and its meaning. */
export interface WhereLine {
  math: string;
  text: string;
}

/** An interval of the run between two events: onsets and ends of faults, start and end of the run. */
export interface Window {
  /** Time in s at which it begins. */
  start: number;
  /** Time in s at which it ends. */
  end: number;
}

/** The observers of a session over the window that the page shows. */
export interface WindowComparison {
  /** Present time of the session in s. */
  t: number;
  /** The state whose errors are compared. */
  state: string;
  /** The fault channel; null: the plant has none. */
  channel: string | null;
  /** The newest fault of the channel; null: none so far. */
  fault: StepFound | null;
  observers: (ObserverInWindow)[];
}

/** All estimates of all observers of a session over one window. */
export interface WindowTable {
  /** Present time of the session in s. */
  t: number;
  observers: (ObserverTable)[];
}

/** A text in the languages of the page, at least in one; readers of the other one get that. */
export interface Words {
  en: string;
  zh: string;
}

/** A text in the languages of the page, at least in one; readers of the other one get that. */
export interface WordsInput {
  en?: string | {[name: string]: string};
  zh?: string | {[name: string]: string};
}

/** Computations in worker processes. */
export interface WorkUsage {
  running: number;
  waiting: number;
}
