// Globals of the pages: the theme (common/theme.js), Plotly.js (loaded when a figure is first shown), and the live
// page's app.

import type {App} from '../live/types.js';

export interface PlotlyFigure {
  data: {[name: string]: unknown}[];
  layout: {[name: string]: unknown; meta?: {narrow?: object; title?: string; caption?: string}};
}

export interface PlotlyLibrary {
  newPlot(
    element: HTMLElement,
    data: PlotlyFigure['data'],
    layout: PlotlyFigure['layout'],
    options: object,
  ): Promise<void>;
  react(
    element: HTMLElement,
    data: PlotlyFigure['data'],
    layout: PlotlyFigure['layout'],
    options: object,
  ): Promise<void>;
  relayout(element: HTMLElement, changes: object): Promise<void>;
  purge(element: HTMLElement): void;
  toImage(figure: PlotlyFigure | HTMLElement, options: object): Promise<string>;
  Plots: {resize(element: HTMLElement): void};
}

declare global {
  const Plotly: PlotlyLibrary;

  interface Window {
    theme: {readonly now: 'light' | 'dark'; toggle(): void};
    /** Set once /assets/plotly.min.js is loaded. */
    Plotly: PlotlyLibrary;
    /** The live page's app, for the console and the tests. */
    thetascope: App;
  }

  interface WindowEventMap {
    theme: CustomEvent<'light' | 'dark'>;
  }
}
