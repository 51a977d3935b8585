// The types of the live page: its state, the `app` that panels get, and what the scope draws. The messages and answers
// of the
// service are generated (types/service.d.ts).

import type {Alarm} from '../diagnosis/alarms.js';
import type * as service from '../types/service.js';
import type {Edge} from './loop.js';
import type {Plane} from './state/planes.js';
import type {Message} from '../i18n/render.js';
import type {Range} from './scope/axes.js';
import type {Samples} from './state/samples.js';
import type {Scope} from './scope/scope.js';

export type Plant = service.Plant;
export type Catalogue = service.Catalogue;
export type Event = service.Event;
export type Ack = service.Ack;
export type Run = service.Run;
export type Check = service.AssumptionCheck;
export type Diagnosis = service.ObserverDiagnosis;
export type Noise = service.Noise;
export type Fault = service.Experiment['faults'][number];
export type FaultInput = service.Inject['fault'];
export type TimedCommand = service.Experiment['commands'][number];
export type Jump = service.Jump;
export type Channel = Plant['channels'][number];
export type Output = Plant['outputs'][number];
export type Gain = number | number[] | number[][];

/** An experiment with its plant in full, as sessions have it. */
export type Experiment = Omit<service.Experiment, 'plant'> & {plant: Plant};

type WithPlant<T> = T extends {spec: service.Experiment} ? Omit<T, 'spec'> & {spec: Experiment} : T;

/** A message of a session, whose experiment has its plant in full. */
export type ServerMessage = WithPlant<service.ServerMessage>;

type WithoutId<T> = T extends unknown ? Omit<T, 'id'> : never;

/** A command of a batch: all of them act from the same row on. */
export type BatchCommand = WithoutId<service.Batch['commands'][number]>;

/** A command as panels send it: the connection gives it its id. */
export type Command =
  WithoutId<Exclude<service.ClientMessage, service.Batch>> | {type: 'batch'; commands: BatchCommand[]};

export type Note = service.Note;

export type Language = 'en' | 'zh';
export type Theme = 'light' | 'dark';
export type Connection = 'starting' | 'live' | 'reconnecting' | 'ended' | 'full' | 'failed';

/** A running observer with its colour. */
export interface ObserverState extends service.ObserverNow {
  /** `var(--o0)` …, the same until the observer is removed. */
  colour: string;
  /** Number of the colour. */
  place: number;
  /** Its curves are dash-dotted: the colour is taken, or they coincide with an earlier observer's. */
  dashed: boolean;
}

/** A fault of the spec. */
export interface FaultState extends service.FaultNow {
  /** On a channel, not on a measurement. */
  onChannel: boolean;
}

/** What is known of the session that this one was forked from. */
export interface Origin {
  observers: ObserverState[];
  faults: FaultState[];
  alarms: Alarm[];
}

/** A line of the notice. `alone`: the action is offered only while nobody else views the session. */
export interface NoticeLine {
  message: Message | string;
  kind: 'note' | 'problem';
  action: {message: Message | string; act: () => void; alone?: boolean} | null;
  at: number;
}

/** The state of the live page. It is never changed in place. */
export interface State {
  connection: Connection;
  /** Id of the session. */
  session: string | null;
  /** Viewers cannot send commands. */
  role: 'control' | 'view';
  /** Id of the library experiment that the session began with; null: a custom spec. */
  experiment: string | null;
  /** The experiment with all faults and commands so far. */
  spec: Experiment | null;
  plant: Plant | null;
  columns: string[];
  epoch: number;
  /** Step of the integration in s. */
  step: number;
  /** Time in s between rows. */
  record: number;
  /** Rows so far, updated a few times a second by `status`. */
  row: number;
  /** Present time in s, updated likewise. */
  t: number;
  playing: boolean;
  /** Simulated seconds per second; null: as fast as possible. */
  speed: number | null;
  /** Measured speed. */
  rate: number | null;
  viewers: number;
  /** At the horizon, or the plant diverged. */
  ended: boolean;
  /** Oldest first. */
  log: Event[];
  /** Alarms of the detector, oldest first. */
  alarms: Alarm[];
  /** The detector's latest report, a little ahead of the rows that are shown. */
  diagnosis: Diagnosis | null;
  /** Assumption checks by observer label. */
  checks: {[label: string]: Check[]};
  observers: ObserverState[];
  /** Oldest first. */
  faults: FaultState[];
  /** Present measurement noise by output. */
  noise: {[output: string]: Noise};
  /** Time in s at which the plant itself diverged. */
  broken: number | null;
  /** The facts of the server at the row that is shown: observers, faults, noise, alarms and the verdicts on them. */
  facts: service.Facts | null;
  /** The facts as they were at the time that is looked back to; null: the present is shown. */
  past: service.Facts | null;
  /** Labels of the observers whose curves coincide with those of an earlier one. */
  twins: string[];
  /** Labels of the observers whose bias may exceed their bands, at the end of the window. */
  converging: string[];
  /** Colour numbers by observer label, of removed observers too. */
  places: {[label: string]: number};
  /** The session that this one was forked from. */
  parent: {id: string; t: number | null} | null;
  origin: Origin | null;
  /** Length of the scope's window in s; null: the whole session. */
  window: number | null;
  /** Lengths to choose from. */
  windows: number[];
  /** Whether the session began with an unchanged library experiment. */
  begunPlain: boolean;
  /** Zoomed time span. */
  selection: [number, number] | null;
  /** Time under the pointer. */
  cursor: number | null;
  /** Time selected on the timeline. */
  looking: number | null;
  /** The observer whose band alone is drawn; null: all bands. */
  band: string | null;
  /** Whether strips are shown, where chosen by hand. */
  strips: {[name: string]: boolean};
  /** Phase planes: ids of the quantities of their axes. */
  planes: Plane[];
  /** Whether the full comparison is open. */
  table: boolean;
  /** Fault site selected in the plant. */
  site: string | null;
  presentation: boolean;
  /** The open tab in presentation mode. */
  desk: string;
  theme: Theme;
  language: Language;
  /** Why there is no session. */
  problem: {title: string; detail: string} | null;
  notice: NoticeLine | null;
  /** The note whose text is being changed, a new one or one of the session. */
  noting: Note | null;
  /**
   * The step of a lesson that is shown, whether true states and faults, and the diagnosis, are visible in it, a level on
   * one of its strips, and the time until which it will run; null where it has run.
   */
  lesson: {
    id: string;
    place: number;
    truth: boolean;
    diagnosis: boolean;
    line: {strip: string; at: number} | null;
    sketch: Sketched | null;
    /** Places in the plant's picture that can be pointed at. */
    sites: string[];
    until: number | null;
  } | null;
}

/** What the diagnosis is shown from, of a session or a run. */
export type DiagnosisState = Pick<State, 'plant' | 'diagnosis' | 'faults' | 'alarms' | 't'> & {
  spec: service.Experiment | Experiment | null;
};

/** The page's own events; the others are the server's messages. */
export type OwnEvent =
  | {type: 'connection'; now: Connection}
  | {
      type: 'begin';
      session: string;
      role: State['role'];
      experiment: string | null;
      parent?: State['parent'];
    }
  | {type: 'failed'; problem: NonNullable<State['problem']>}
  | ({type: 'set'} & Partial<State>)
  | {type: 'strip'; name: string; shown: boolean}
  | {type: 'twins'; labels: string[]};

export type StateEvent = ServerMessage | OwnEvent;

export interface Store {
  readonly state: State;
  subscribe: <const T>(select: (state: State) => T, fn: (value: T, before: T | undefined) => unknown) => () => void;
  dispatch(event: StateEvent): void;
}

export interface StartOptions {
  experiment?: string | null;
  spec?: Experiment | null;
  t?: number;
  play?: boolean;
  then?: () => void;
}

/** The functions of main.js that change the session. */
export interface SessionLink {
  token(): string | null;
  begin(options: StartOptions): Promise<void>;
  fork(t?: number): Promise<void>;
  visit(id: string): Promise<void>;
  restart(spec: Experiment): Promise<void>;
}

/** Actions that are more than one command (README.md lists them). */
export interface Actions {
  together(commands: BatchCommand[]): Promise<Ack>;
  play(): Promise<Ack | null>;
  pause(): Promise<Ack | null>;
  toggle(): Promise<Ack | null>;
  step(rows?: number): Promise<Ack | null>;
  speed(value: number | null): Promise<Ack | null>;
  reset(): Promise<void>;
  seek(t: number): Promise<void>;
  open(id: string | null): Promise<void>;
  openSpec(spec: Experiment, options?: {t?: number}): Promise<void>;
  fork(t?: number): Promise<void>;
  visit(id: string): Promise<void>;
  /** Rejects with a Problem where the experiment is refused. */
  restart(spec: Experiment): Promise<void>;
  save(): Promise<Run>;
  link(options?: {view?: boolean}): Promise<string>;
  window(length: number | null): void;
  select(t0: number | null, t1?: number): void;
  look(t: number | null): void;
  band(label: string | null): void;
  strip(name: string | null, shown?: boolean): void;
  /** Set a phase plane, add one at the end, or (null) remove it. */
  plane(place: number, plane: Plane | null): void;
  /** Open or close the full comparison. */
  table(on: boolean): void;
  site(name: string | null): void;
  present(on: boolean): void;
  desk(name: string): void;
  theme(wanted: Theme | null): void;
  language(language: Language): Promise<void>;
  tell(message: Message | string, how?: {kind?: NoticeLine['kind']; action?: NoticeLine['action']}): void;
  refused(error: unknown): void;
  notes: {
    /** Ask for the text of a new note at the moment that is shown. */
    begin(): void;
    /** Ask for the text of a note of the session. */
    edit(note: Note): void;
    /** Ask no longer. */
    close(): void;
    /** Add a note, or change the one that has its id. False: it was refused, and the notice says why. */
    keep(note: Note): Promise<boolean>;
    /** Remove a note; for a while this can be undone. */
    remove(note: Note): Promise<void>;
    /** Look at its moment. */
    visit(note: Note): void;
    find(id: string): Note | null;
  };
  figure(what?: {strip?: string | null; format?: 'png' | 'svg'}): Promise<Blob>;
}

/** What every panel gets. */
export interface App {
  readonly state: State;
  readonly store: Store;
  /** The catalogue of the service, requested once. */
  readonly catalogue: Promise<Catalogue>;
  samples: Samples;
  /** The samples of the parent session; `state.origin` has the rest of what is known of it. */
  ghost: Samples | null;
  edge: Edge;
  /** Id of the experiment that the page opens with. */
  first: string;
  act: Actions;
  scope: Scope;
  subscribe: Store['subscribe'];
  wake(): void;
  /** Call `fn(now)` in the animation frame whenever something is to be drawn. Returns a function that ends it. */
  onFrame(fn: (now: number) => unknown): () => void;
  /** Call `fn(t)` about five times a second while something moves. Returns a function that ends it. */
  onTick(fn: (t: number) => unknown): () => void;
  latest(column: string): number;
  at(column: string, t: number): number;
  window(column: string, t0: number, t1: number): {t: Float64Array; v: Float32Array};
  range(column: string, t0: number, t1: number): {min: number; max: number; mean: number; count: number};
  strips(): Strip[];
  span(): [number, number];
  cursor(t: number | null): void;
  drop(): void;
  send(command: Command): Promise<Ack>;
}

/** A curve of a strip. */
export interface Trace {
  /** Observer. */
  label: string;
  /** `var(--o0)` … */
  colour: string;
  place: number;
  /** Drawn dash-dotted. */
  dashed: boolean;
  /** Time in s at which the observer diverged. */
  fallen: number | null;
  column: string;
  /** Columns between which the band lies. */
  low?: string;
  high?: string;
}

/** A curve that a student draws on a strip: values at equal times; `at` is the one that the keys move. */
export interface Sketched {
  strip: string;
  values: number[];
  from: number;
  until: number;
  low: number;
  high: number;
  at: number | null;
}

/** One axis of the scope with its curves. */
export interface Strip {
  /** theta.theta1, x.x1, r.r, u.q, signal.phi, residual.y, excitation */
  name: string;
  kind: 'theta' | 'state' | 'loop' | 'input' | 'residual' | 'relation' | 'excitation';
  /** Name to be set as mathematics. */
  symbol: string;
  /** Channel, state or output. */
  subject: string;
  title: string | {[language: string]: string};
  unit: string;
  /** Column of the true value; of a loop, the set point or the input that is set. */
  truth: string | null;
  /** Column and name of a reading, beside a set point. */
  reading?: {column: string; label: string};
  traces: Trace[];
  /** Values that are always within the axis. */
  base: [number, number] | null;
  /** Smallest height of the axis. */
  least: number;
  /** Whether the columns hold logarithms. */
  log: boolean;
  threshold: number | null;
  /** A level above zero and below, of a lesson. */
  line?: number | null;
  /** What a student draws or has drawn. */
  sketch?: Sketched | null;
  /** Relative height. */
  weight: number;
  /** Shown unless hidden by hand. */
  usual: boolean;
  shown: boolean;
  /** Of a channel: whether it has a fault. */
  stirred?: boolean;
}

/** A curve beyond its axis between two times. */
export interface Leaving {
  from: number;
  to: number;
  up: boolean;
  place: number;
  trace: number;
}

/** A strip with the marks of its axis. */
export interface DrawnStrip extends Strip {
  ticks: number[];
  labels: string[];
  /** Common power of ten of the labels. */
  power: string;
  leaving?: Leaving[];
}

/** Where the plot area lies in its canvas, in CSS pixels; `full` is the width of the canvas. */
export interface Place {
  left: number;
  width: number;
  height: number;
  full: number;
}

/** A strip of the scope with its elements. */
export interface Row {
  strip: DrawnStrip;
  range: Range;
  place: Place;
  element: HTMLElement;
  label: HTMLElement;
  plot: HTMLElement;
  values: HTMLElement;
  unresolved: HTMLElement;
  canvas: HTMLCanvasElement;
  ctx: CanvasRenderingContext2D;
  all: HTMLElement;
  whole: boolean;
}

/** Colours and fonts of the style sheet. */
export interface Palette {
  ink: string;
  soft: string;
  line: string;
  grid: string;
  card: string;
  tint: string;
  fault: string;
  amber: string;
  accent: string;
  alarm: string;
  ok: string;
  observers: string[];
  number: string;
  words: string;
  /** Relative to the usual size of text. */
  size: number;
}

/** What all strips of a frame share. */
export interface View {
  t0: number;
  t1: number;
  /** Between marks of the time axis. */
  step: number;
  samples: Samples;
  ghost: Samples | null;
  now: number;
  /** Time between rows. */
  row: number;
  faults: FaultState[];
  alarms: Alarm[];
  /** Time in s up to which the detector has judged, while it is behind. */
  judged: number | null;
  /** The time that a step of a lesson has yet to run, and the words to write there. */
  pending: {until: number; words: string} | null;
  /** Observers whose bands are drawn. */
  bands: Set<string>;
}

/** From time and value to pixels. */
export interface Scale {
  x(t: number): number;
  y(value: number): number;
}

/** Bins of a column: entry i of the rings is at i & mask. */
export interface Source {
  low: Float32Array;
  high: Float32Array;
  mask: number;
  /** Rows per bin. */
  rows: number;
  /** Two bins are drawn as one. */
  pair: boolean;
}

/** A column that is computed from others when rows arrive. */
export interface DerivedColumn {
  name: string;
  /** The columns that `make` gets, one or two. */
  of: string[];
  make(a: number, b: number): number;
}

/** A column as minima and maxima of bins; the first bin is number `from`, each has `each` rows. */
export interface Bins {
  low: number[];
  high: number[];
  each: number;
  from: number;
}

/** What this tab remembers of a session that it has begun. */
export interface KeptSession {
  id: string;
  token: string | null;
  address: string;
  experiment: string | null;
  plain: boolean;
  parent: State['parent'];
}

/** A binary message of the stream. `data` holds one column after the other. */
export interface Frame {
  sequence: number;
  epoch: number;
  first: number;
  count: number;
  columns: number;
  data: Float32Array;
}

export type {Alarm, Range, Samples, Scope};
