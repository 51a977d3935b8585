// The words of Plotly.js in the page's language, for its options: it has them by its own English ones.

import {language, t} from './words.js';

/** @returns {{locale?: string, locales?: {[language: string]: {dictionary: {[english: string]: string}}}}} */
export function plotlyLocale() {
  if (language() === 'en') return {};
  const dictionary = {
    'Download plot as a PNG': t('page.plotly.download'),
    Zoom: t('page.plotly.zoom'),
    Pan: t('page.plotly.pan'),
    'Zoom in': t('page.plotly.zoom-in'),
    'Zoom out': t('page.plotly.zoom-out'),
    'Reset axes': t('page.plotly.reset'),
    Autoscale: t('page.plotly.autoscale'),
    'Taking snapshot - this may take a few seconds': t('page.plotly.snapshot'),
    'Snapshot succeeded': t('page.plotly.snapshot-done'),
    'Double-click to zoom back out': t('page.plotly.zoom-back'),
  };
  return {locale: language(), locales: {[language()]: {dictionary}}};
}
