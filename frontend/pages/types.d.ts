// The types of the page of runs: its state, the events that change it, and what the views get.

import type {Problem} from '../common/api.js';
import type * as service from '../types/service.js';
import type {PlotlyFigure} from '../types/globals.js';

export type Experiment = service.Experiment;
export type Plant = service.Plant;
export type Run = service.Run;
export type Progress = service.Progress;
export type RunSummary = service.RunSummary;
export type ObserverSummary = service.ObserverSummary;
export type Comparison = service.Comparison;
export type ComparisonRow = service.ComparisonRow;
export type Diagnosis = service.Diagnosis;
export type ObserverDiagnosis = service.ObserverDiagnosis;
export type PlantLine = service.PlantLine;
export type ExperimentLine = service.ExperimentLine;

/** Changed values by their path in the spec. */
export type Changes = {[path: string]: unknown};

export type Phase = 'idle' | 'running' | 'done' | 'cancelled' | 'failed';

export interface RunState {
  /** The library's list; null while it loads. */
  experiments: readonly ExperimentLine[] | null;
  plants: {[id: string]: PlantLine};
  /** Id of the chosen experiment. */
  chosen: string | null;
  /** The chosen experiment as the library has it. */
  spec: Experiment | null;
  /** Its plant in full. */
  plant: Plant | null;
  /** A run that is not of the library: it can be shown, not changed. */
  foreign: boolean;
  changes: Changes;
  phase: Phase;
  progress: Pick<Progress, 'status' | 'progress' | 'links'>;
  /** The last run that succeeded. */
  run: Run | null;
  /** The changes of that run as JSON, to tell whether the form has changed since. */
  ranWith: string | null;
  problem: Problem | null;
}

export type RunEvent =
  | {type: 'library'; experiments: readonly ExperimentLine[]; plants: RunState['plants']}
  | {type: 'choose'; id: string; changes?: Changes}
  | {type: 'spec'; spec: Experiment; plant: Plant}
  | {type: 'foreign'; spec: Experiment; plant: Plant}
  | {type: 'change'; path: string; to: unknown}
  | {type: 'changes'; changes: Changes}
  | {type: 'start'}
  | {type: 'progress'; progress: RunState['progress']}
  | {type: 'done'; run: Run; changes: Changes}
  | {type: 'cancelled'}
  | {type: 'failed'; problem: Problem};

export type RunView = (state: RunState, before: RunState) => unknown;

export interface RunStore {
  readonly state: RunState;
  subscribe(view: RunView): void;
  dispatch(event: RunEvent): void;
}

/** The actions of runs.js. */
export interface RunActions {
  choose(id: string, options?: {changes?: Changes; run?: string | null; push?: boolean}): Promise<void>;
  run(): Promise<void>;
  runSpec(make: () => Promise<service.ExperimentInput>): Promise<void>;
  cancel(): Promise<void>;
  change(path: string, to: unknown): void;
  replace(changes: Changes): void;
}

/** A figure of a run on the page. */
export interface FigureBox {
  plot: HTMLElement & {data?: unknown};
  caption: HTMLElement;
  section: HTMLElement;
  address: string;
  /** The address that is drawn or being drawn. */
  drawn: string | null;
  figure?: PlotlyFigure;
  failed?: HTMLElement;
}
