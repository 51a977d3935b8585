// The types of the workshop: its state, and what the views and the editor get.

import type {Problem} from '../../common/api.js';
import type * as service from '../../types/service.js';
import type {Signal} from '../../widgets/signal/shapes.js';

export type TextCheck = service.PlantTextCheck;
export type TextError = service.TextError;
export type Trial = service.PlantTrial;
export type Ranked = service.RankedObserver;
export type MyPlantLine = service.MyPlantLine;

/** Values of the sliders and shapes of the inputs that the text does not have yet. */
export interface Tried {
  parameters: {[name: string]: number};
  initial: {[name: string]: number};
  inputs: {[name: string]: Signal};
}

/** What the text was opened from. */
export interface Source {
  kind: 'mine' | 'library' | 'new';
  /** Id under which it was opened; of the library or of my plants. */
  id: string;
  /** The version that was opened or saved last; null: it was not saved yet. */
  version: number | null;
  saved: number | null;
  /** The text as it is in the store or the library: what differs is a change. */
  text: string;
}

export interface ShopState {
  source: Source;
  text: string;
  /** The last answer, of this text or of an earlier one while a check runs. */
  check: TextCheck | null;
  checking: boolean;
  /** The last answer without errors: the cards show it. */
  good: TextCheck | null;
  tried: Tried;
  trial: Trial | null;
  /** Why there is no trial. */
  trialProblem: Problem | null;
  ranking: readonly Ranked[] | null;
  /** Kinds of observers that are ticked; null: the first two of the ranking. */
  chosen: readonly string[] | null;
  mine: readonly MyPlantLine[];
  library: readonly service.PlantLine[];
  kinds: {[kind: string]: string};
  problem: Problem | null;
  /** A line about what was done, and how to undo it. */
  notice: {text: string; undo: (() => void) | null} | null;
  /** Time in ms at which the text was kept in this browser. */
  kept: number | null;
  /** The place of the cursor. */
  cursor: {line: number; column: number};
}

export interface ShopStore {
  readonly state: ShopState;
  set(changes: Partial<ShopState>): void;
  subscribe(select: (state: ShopState) => unknown, show: (state: ShopState) => void): void;
}

export interface ShopActions {
  tell(text: string): void;
  openMine(id: string, version?: number): Promise<void>;
  openLibrary(id: string): Promise<void>;
  openTemplate(name: string): void;
  openText(text: string, name?: string): void;
  save(): Promise<boolean>;
  remove(id: string): Promise<void>;
  openLive(): Promise<void>;
  run(): Promise<void>;
  findFaults(): Promise<void>;
  link(): Promise<string>;
  download(): void;
  convert(format: 'yaml' | 'json'): Promise<void>;
  toFirstError(): void;
  edit(changes: {values?: {[path: string]: number}; channels?: object[]}): Promise<void>;
}

/** A text editor: CodeMirror, or a plain field where it is not installed. */
export interface Editor {
  element: HTMLElement;
  text(): string;
  /** Replace the text. `asEdit`: one step that can be undone; else a new document. */
  setText(text: string, asEdit?: boolean): void;
  showErrors(errors: readonly TextError[], apply: (error: TextError) => void): void;
  replace(place: service.TextPlace, by: string): void;
  select(place: service.TextPlace): void;
  names(words: readonly string[]): void;
  mark(lines: readonly number[]): void;
  undo(): void;
}

export interface EditorEvents {
  change(text: string): void;
  cursor(line: number, column: number): void;
  save(): void;
  live(): void;
  fix(): void;
  next(): void;
}
