// The types of the page of records: its state, its actions, and what pictures are drawn from.

import type {Problem} from '../../common/api.js';
import type {Child} from '../../types/dom.js';
import type * as service from '../../types/service.js';

export type Plant = service.Plant;
export type Inspection = service.RecordInspection;
export type Preview = service.RecordPreview;
export type Diagnosis = service.RecordDiagnosis;
export type Settings = service.RecordSettings;
export type Mapping = service.ColumnMapping;
/** Id of a plant of the library, or a plant of one's own. */
export type PlantChoice = string | Plant;

export type Step = 1 | 2 | 3;

/** What the page is doing that can be cancelled. */
export type Work = 'reading' | 'mapping' | 'diagnosing' | 'fitting' | 'simulating' | 'observing';

/** Columns of a run by name; null: missing. */
export type Columns = {t: number[]; [name: string]: (number | null)[]} & {t: number[]};

/** A stored run of observers on the record. */
export interface RecordRun {
  id: string;
  labels: readonly string[];
  spec: service.Experiment;
  links: service.Run['links'];
  columns: Columns;
  /** Whether its curves are drawn. */
  shown: boolean;
}

export interface RecordState {
  plants: readonly service.PlantLine[];
  choice: PlantChoice | null;
  /** The chosen plant in full. */
  plant: Plant | null;
  inspection: Inspection | null;
  /** The mapping that was sent, if it is not the guess. */
  mapping: Mapping | null;
  preview: Preview | null;
  settings: Settings;
  diagnosis: Diagnosis | null;
  /** Kinds of observers. */
  kinds: readonly service.ObserverKind[];
  /** Those that are to run on the record. */
  observers: readonly {label: string; kind: string}[];
  /** Runs on the record, the last one first. */
  runs: readonly RecordRun[];
  /** Plants that were saved on the server. */
  mine: service.MyPlantList['plants'];
  /** Whether mapping or settings have changed since the diagnosis. */
  stale: boolean;
  step: Step;
  work: Work | null;
  problem: Problem | null;
  /** The work that was refused. */
  refused: Work | null;
  /** Records that this browser has uploaded before, the last one first. */
  earlier: service.RecordList['records'];
  /** A sentence about the file, such as where a simulated record comes from. */
  remark: (() => string) | null;
}

export interface RecordActions {
  open(file: File): Promise<void>;
  simulate(): Promise<void>;
  choose(choice: PlantChoice | null): Promise<void>;
  usePlantText(text: string): Promise<void>;
  map(mapping: Mapping): Promise<void>;
  set(changes: Partial<Settings>): void;
  diagnose(changes?: {mapping?: Mapping; parameters?: string[]}): Promise<void>;
  downloadPlant(format: 'yaml' | 'json'): Promise<void>;
  chooseMine(id: string): Promise<void>;
  observe(observers: RecordState['observers']): void;
  runObservers(): Promise<void>;
  compare(id: string, shown: boolean): void;
  replay(): Promise<void>;
  go(step: Step): void;
  cancel(): void;
  startOver(): void;
}

/** One strip of a picture: a quantity over time. */
export interface Strip {
  key: string;
  /** Its symbol or words. */
  label: Child;
  title: string;
  unit: string;
  low: readonly (number | null)[];
  high: readonly (number | null)[];
  /** A second curve: values at times in s. */
  second?: {t: readonly number[]; values: readonly (number | null)[]};
  /** Further curves, each with a band if it has low and high. */
  curves?: readonly StripCurve[];
  /** Dashed lines on both sides of zero. */
  limits?: number;
  /** The axis shows zero. */
  zero?: boolean;
  /** Values are held from one interval to the next, as of inputs. */
  held?: boolean;
  /** Intervals without values that make no gap. */
  bridged?: number;
  /** A logarithmic axis. */
  logarithmic?: boolean;
  /** A horizontal line, such as a threshold. */
  line?: {at: number; title: string};
  /** Values beyond it are drawn at the edge. */
  most?: number;
  small?: boolean;
}

export interface StripCurve {
  t: readonly number[];
  values: readonly (number | null)[];
  low?: readonly (number | null)[];
  high?: readonly (number | null)[];
  colour: string;
  dashed?: boolean;
}

export interface Band {
  from: number;
  to: number;
  kind: 'gap' | 'fault' | 'healthy' | 'veil' | 'onset';
  title?: string;
}

export interface Mark {
  t: number;
  /** Key of the strip. */
  strip: string;
  sign: Child;
  title: string;
  kind: 'finding' | 'wrong' | 'alarm' | 'fault';
  /** Id of the finding. */
  id?: string;
}
