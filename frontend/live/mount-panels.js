// The panels around the scope: where each stands and which module fills it.

const PANELS = [
  ['panel-header', 'header/header'],
  ['panel-title', 'header/title'],
  ['panel-plant', 'plant/plant'],
  ['panel-inject', 'inject/inject'],
  ['panel-try', 'try'],
  ['panel-diagnosis', 'diagnosis'],
  ['panel-observers', 'observers/observers'],
  ['panel-comparison', 'comparison/comparison'],
  ['panel-log', 'log'],
  ['panel-dialogs', 'dialogs/dialogs'],
  [null, 'dialogs/keyboard'],
];

/** Load every panel, then mount them all at once, so that keys work as soon as there is something to see; one that fails leaves its place empty. */
export async function mountPanels(app) {
  const loaded = await Promise.allSettled(PANELS.map(([, name]) => import(`./panels/${name}.js`)));
  PANELS.forEach(([id, name], place) => {
    try {
      if (loaded[place].reason) throw loaded[place].reason;
      loaded[place].value.mount(id === null ? document.body : document.getElementById(id), app);
    } catch (error) {
      console.error(`panel ${name}:`, error);
    }
  });
}
