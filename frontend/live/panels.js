// The panels around the scope: where each stands and which module fills it.

const PANELS = [
  ['panel-header', 'header'], ['panel-title', 'title'],
  ['panel-plant', 'plant'], ['panel-inject', 'inject'], ['panel-try', 'try'],
  ['panel-diagnosis', 'diagnosis'], ['panel-observers', 'observers'], ['panel-comparison', 'comparison'], ['panel-log', 'log'],
  ['panel-dialogs', 'dialogs'], [null, 'keyboard'],
];

/** Load and mount every panel; one that fails leaves its place empty. */
export async function mountPanels(app) {
  await Promise.all(PANELS.map(async ([id, name]) => {
    try {
      const {mount} = await import(`./panels/${name}.js`);
      mount(id === null ? document.body : document.getElementById(id), app);
    } catch (error) {
      console.error(`panel ${name}:`, error);
    }
  }));
}
